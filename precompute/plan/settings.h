// What a bake is asked for: everything its bytes depend on besides the scene. Threads, caches and output places are not settings.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "precompute/scene/import.h"

namespace lightwell::plan {

enum class Technique { prm, lightmap, vpl, radiosity, environment };
enum class Quality { draft, preview, production };
/// How the section prm stores the transport: bases fitted to blocks of texels, or the paper's panes, one per cluster of entry points.
enum class PrmLayout { local_bases, panes };
/// How panes are estimated: by gathering at the texels, or by the paper's walks from the entry points.
enum class PrmEstimator { gather, walks };

/// Which lights a game will move, switch or colour: what radiance maps are made good for. With `none` only fixed light is baked.
enum class MovingLights { anywhere, ceilings, sun, lamps, paths, none };

/// What virtual lights are; automatic: by expected error, each of them.
enum class VirtualLightShape { automatic, point, disk, sphere, polygon };

inline constexpr int kMostLightmapSize = 8192;
inline constexpr uint32_t kMostPrmEntries = 1u << 20, kMostPrmClusters = 1u << 16, kMostPrmPanes = 4096;
inline constexpr uint32_t kMostVirtualLights = 1u << 20;
inline constexpr uint32_t kMostVirtualBounces = 1u << 14;
inline constexpr uint32_t kMostPoints = 1u << 22;
inline constexpr float kLeastRadiosityDensity = 1.0f / 64;
inline constexpr float kAutomaticProbeSpacing = -1, kMostProbeSpacing_m = 1e6f;
inline constexpr size_t kMostProbePoints = 65536;
inline constexpr uint32_t kMostEnvironmentSamples = 4096, kFewestSkyFaceCells = 16, kMostSkyFaceCells = 256;
inline constexpr int kFinestRefinement = 3, kCoarsestRefinement = -6;

inline constexpr size_t kMostPortalNames = 4096;
inline constexpr size_t kMostLightPathPoints = 65536;

inline constexpr float kMostRadiance = 1e12f, kMostEnvironmentIntensity = 1e6f;

/// How an environment map is put into the world.
struct EnvironmentPlacement {
  float rotation_deg = 0;  // about +Y, from +Z towards +X
  float intensity = 1;     // factor on radiance, ≥ 0
  std::optional<std::array<float, 3>> ground_radiance_rgb;  // what is seen below the horizon instead, times intensity
  bool operator==(const EnvironmentPlacement&) const = default;
};

struct Settings {
  std::vector<Technique> techniques;  // as named, without repetitions; empty: auto, what the scene can use
  int lightmap_size = 256;            // texels along each side of the atlas, 1 to kMostLightmapSize
  Quality quality = Quality::production;
  int refinement = 0;                 // steps finer (> 0) or coarser (< 0) than the quality's own; chosen by a bake with limits
  uint64_t seed = 1;
  scene::LightUnits light_units = scene::LightUnits::spec;
  PrmLayout prm_layout = PrmLayout::local_bases;
  PrmEstimator prm_estimator = PrmEstimator::gather;
  uint32_t prm_entries = 0;           // entry points over all clusters, about, up to kMostPrmEntries; 0: the quality's
  uint32_t prm_clusters = 0;          // clusters of entry points, about, up to kMostPrmClusters (panes: kMostPrmPanes); 0: the quality's
  float radiosity_density = 0;        // patches per light-map texel along a side, rounded to a power of two, kLeastRadiosityDensity to 1; 0: adaptive
  MovingLights moving_lights = MovingLights::anywhere;
  std::vector<std::vector<std::array<double, 3>>> light_paths_m;  // for MovingLights::paths: places and lines in the glTF file's world
  bool geometry = true;               // surfaces to draw and to cast shadows; without, the game has its own
  bool keep_all = false;              // bake what the plan finds no use for, too
  bool directional = false;           // the section lightmap also says how light changes with the normal
  VirtualLightShape virtual_light = VirtualLightShape::automatic;
  uint32_t virtual_lights = 0;        // aimed at, up to kMostVirtualLights; 0: the quality's
  uint32_t virtual_bounces = 0;       // reflections that virtual lights hold at most, up to kMostVirtualBounces; 0: all
  uint32_t points = 0;                // on surfaces, for shadow maps of lights that move, up to kMostPoints; 0: no section points
  float probe_spacing_m = 0;          // of the lattice of probes for moving objects; kAutomaticProbeSpacing: by the scene's size; 0: no lattice
  std::vector<std::array<double, 3>> probe_points_m;  // more probes, in the glTF file's world; up to kMostProbePoints
  uint32_t environment_samples = 128; // cells of the environment, suns included, 1 to kMostEnvironmentSamples
  uint32_t sky_face_cells = 64;       // along a face of the sky's cube: even, kFewestSkyFaceCells to kMostSkyFaceCells
  EnvironmentPlacement environment;
  std::vector<std::string> portals;   // names of nodes that are portals besides those that the scene marks: ImportOptions::portals
};

std::string_view name(Technique technique);
std::string_view name(Quality quality);
std::string_view name(scene::LightUnits units);
std::string_view name(PrmLayout layout);
std::string_view name(PrmEstimator estimator);
std::string_view name(VirtualLightShape shape);
std::string_view name(MovingLights lights);
std::optional<Technique> techniqueNamed(std::string_view name);
std::optional<Quality> qualityNamed(std::string_view name);
std::optional<scene::LightUnits> lightUnitsNamed(std::string_view name);
std::optional<PrmLayout> prmLayoutNamed(std::string_view name);
std::optional<PrmEstimator> prmEstimatorNamed(std::string_view name);
std::optional<VirtualLightShape> virtualLightShapeNamed(std::string_view name);
/// Not of paths: they have no name of their own, but points.
std::optional<MovingLights> movingLightsNamed(std::string_view name);
/// All names of an option, in order, for messages and help.
std::vector<std::string> techniqueNames();
std::vector<std::string> qualityNames();
std::vector<std::string> lightUnitsNames();
std::vector<std::string> prmLayoutNames();
std::vector<std::string> prmEstimatorNames();
std::vector<std::string> virtualLightShapeNames();

/// "auto" or a comma-separated list, as --techniques takes it. Throws UsageError.
std::vector<Technique> parseTechniques(std::string_view list);

/// One line of JSON, keys sorted, all keys present: equal settings give equal text.
std::string canonicalJson(const Settings& settings);
/// The inverse. Keys that are missing keep their defaults; throws UsageError for unknown keys, wrong types and values out of range.
Settings settingsFromJson(std::string_view json);

}  // namespace lightwell::plan
