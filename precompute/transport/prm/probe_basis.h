// What moving objects receive: probes at points in the air, from the same bounces, wavelets and training lights as the texels.
//
// A probe is a block of twelve values: for a normal n each, ∫ L(ω) K(n · ω) dω with K the cosine lobe cut after band 2 of spherical harmonics (Ramamoorthi, Hanrahan: "An Efficient
// Representation for Irradiance Environment Maps"). At the corners of an icosahedron, whose equal weights integrate polynomials of degree 5 exactly, twelve values are
// nine coefficients, and back; they are hardly ever negative, and their mean is the light that passes the point, which the basis keeps.
#pragma once
#include "precompute/transport/prm/local_bases.h"

namespace lightwell::transport {

inline constexpr uint32_t kProbeValues = 12;

/// The normals of a probe's values: (0, ±1, ±φ) / |…| and its cyclic shifts.
std::array<Vec3, kProbeValues> probeNormals();

/// One probe's share of PrmProbes.
struct ProbeBasis {
  BasisBlock block;                        // without slots; its "texels" are the values
  std::array<Rgb, 9> emitter_radiance_sh;  // of emitting surfaces, after any number of reflections
};

/// Traces `options.rays` rays from each point and fits its basis. `first_owner` and those after it key the random numbers.
std::vector<ProbeBasis> fitProbes(std::span<const Vec3> points, uint64_t first_owner, const Gatherer& gatherer, const EntryClusters& clusters, const WaveletIndex& wavelets,
                                  const MultiBounce& multi_bounce, const TrainingLights& training, const EmitterLight& emitters, const LocalBasesOptions& options);

}  // namespace lightwell::transport
