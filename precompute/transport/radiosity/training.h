// Radiosities of the scene under lights drawn from the prior: what decides which links matter.
#pragma once
#include <Eigen/Core>

#include "precompute/transport/prm/light_prior.h"
#include "precompute/transport/radiosity/form_factors.h"

namespace lightwell::transport {

struct RadiosityTraining {
  using Matrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Matrix radiosity;   // [patch][light], grey, after all bounces; each light scaled so that the patches' mean irradiance from others is 1
  Matrix irradiance;  // [patch][light]: what each patch receives from the others
  std::vector<char> open;  // per light: whether all portals are open under it, else all are shut; empty without portals
  uint32_t lights() const { return uint32_t(radiosity.cols()); }
  /// 1 for the lights under which sets of a class count, else 0. What depends on one portal open and another one shut is taken for open.
  Eigen::RowVectorXf counts(GateClass c) const;
};

/// Whether training light i shines on open portals.
constexpr bool isTrainedOpen(uint32_t light) { return light % 2 == 1; }

/// Direct irradiance of one grey light on the patches, shadowed, from a few points each.
std::vector<float> patchIrradiance(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const Sides& sides,
                                   const Patches& patches, const scene::Light& light, uint64_t seed);

/// `direct` has one vector per light: irradiance per patch. Lights that hardly anything receives light from (in sealed pockets) are left out; where none is
/// left, in a black scene, all patches shine alike. Never without a light. In scenes with portals every other light (isTrainedOpen) is one with all of them open.
RadiosityTraining trainRadiosity(const Patches& patches, const FormFactors& factors, std::span<const std::vector<float>> direct);

}  // namespace lightwell::transport
