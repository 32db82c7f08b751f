// What a report measured, in memory and as JSON (schemas/report.schema.json).
#pragma once
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace lightwell::report {

/// One way of getting a container's light onto the atlas: its error, and what it costs a game.
struct Evaluated {
  std::string variant;            // "", or what differs from the default: "brightest 32", "OpenGL"
  std::string command;            // of `lightwell evaluate`, run in the report's folder
  std::string map;                // EXR in the report's folder, which `lightwell compare` takes
  uint64_t texels = 0;            // compared
  double relrmse = 0, texrel = 0, bias = 0, p99 = 0, max = 0;  // of compareMaps; relative
  double relrmse_low = 0, relrmse_high = 0;                    // 95 % interval over the texels' scatter, the references' noise included
  std::optional<double> cpu_ms, gl_ms;         // a frame in which the light changes
  std::optional<double> load_ms;               // once, until the light is there: OpenGL, without reading the file
  std::optional<double> fetched_bytes_per_texel;  // by the pass that fills the atlas, what all texels share spread over them
  std::optional<uint64_t> texture_bytes;       // on OpenGL
};

struct Phase {
  std::string name;
  double seconds = 0;
};

/// A bake, or a container that was given.
struct Baked {
  std::string series;             // seriesNamed() explains it
  std::string setting;            // what differs within the series
  std::string technique;          // section that is evaluated
  std::string command;            // of `lightwell bake`, run in the report's folder; empty for a given container
  std::string file;               // container; in the report's folder unless given
  std::string key;                // content hash of all that the figures depend on
  std::optional<double> seconds;  // import, atlas and all tasks; without measuring errors
  std::optional<uint64_t> rays;
  std::vector<Phase> phases;
  uint64_t container_bytes = 0, section_bytes = 0;
  std::optional<uint64_t> uncompressed_bytes;  // radiosity: 8 for each pair of patches that exchange light
  std::vector<Evaluated> evaluated;
};

/// One reflection of the scene's lamps that OpenGL finds anew in each frame, against path tracing that ends after one.
struct LampAnswer {
  bool incremental = false;       // virtual lights stay in place while the lamp shines there
  uint32_t lights = 0, shadow_side = 0;  // virtual lights of each lamp, texels along their shadow maps (0: none)
  double relrmse = 0;
  double gl_ms = 0;               // of a frame in which one lamp has moved
};

/// Answers of a sky's cells against quadrature over the map, nothing in the way; the shadowed models on the scene's surfaces against path tracing.
struct SkyAnswer {
  std::string model;              // "sky", "spread", "paper", "one sample", "shadowed, rays", "shadowed, OpenGL"
  uint32_t shininess = 1;         // 1: irradiance
  uint32_t cells = 0;             // lights that a game draws
  double seconds = 0;             // of the bake
  double relrmse = 0;
};

struct RayRate {
  double tracer_mrays = 0, raw_mrays = 0, raw_robust_mrays = 0;  // closest hits per CPU second of one thread, million
};

struct Reference {
  uint32_t samples = 0;           // paths a texel in each of the two
  uint64_t first_seed = 0, second_seed = 0;
  double seconds = 0;             // both
  std::string first, second;      // EXRs in the report's folder
  std::string first_command, second_command;
  double noise = 0;               // of their mean: rms(A − B) / 2 / rms(r)
  double resolution = 0;          // the smallest relrmse that can be told from none, 95 %
  double mean_irradiance = 0;
};

struct Skipped {
  std::string what, reason;
};

struct Report {
  std::string scene, environment, version, key;
  std::string lights;             // LIGHTS.json that was used, or empty: the scene's own
  std::string made_lights;        // why the report put lamps of its own; empty when it did not
  int lightmap_size = 0, threads = 0;
  uint64_t texels = 0, triangles = 0, lamps = 0;
  double budget_s = 0, seconds = 0;  // of this run
  double stage_seconds = 0;       // import, atlas and the like, which each bake would need
  uint64_t measured = 0, reused = 0;
  bool has_gl = false;
  Reference reference;
  std::vector<Baked> bakes;
  std::vector<SkyAnswer> sky;
  std::vector<LampAnswer> live_lamps;
  std::optional<RayRate> rays;
  std::vector<Skipped> skipped;
};

void to_json(nlohmann::json& json, const Baked& baked);
void from_json(const nlohmann::json& json, Baked& baked);
void to_json(nlohmann::json& json, const SkyAnswer& answer);
void from_json(const nlohmann::json& json, SkyAnswer& answer);
void to_json(nlohmann::json& json, const LampAnswer& answer);
void from_json(const nlohmann::json& json, LampAnswer& answer);
void to_json(nlohmann::json& json, const RayRate& rate);
void from_json(const nlohmann::json& json, RayRate& rate);
void to_json(nlohmann::json& json, const Reference& reference);
void from_json(const nlohmann::json& json, Reference& reference);
void to_json(nlohmann::json& json, const Report& report);

/// One line for each evaluation, and a head.
std::string csvOf(const Report& report);

}  // namespace lightwell::report
