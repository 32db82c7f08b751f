// Any bytes as a container in the C runtime: every section is loaded, every array decoded, everything loaded is evaluated.
//
// Besides memory safety: memory stays within the limit, what verify calls sound is loaded, and results are no NaN.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "format/encode/verify.h"
#include "lightwell/lightwell.h"
#include "lightwell/lightwell_error.h"
#include "lightwell/lightwell_prm_probes.h"
#include "lightwell/lightwell_prm_state.h"
#include "tests/fuzz/require.h"

namespace lightwell::fuzz {
namespace {

constexpr uint64_t kMostDecodedBytes = 1 << 22, kMostTexels = 1 << 18, kMostLinks = 1 << 20;
// What loading takes at most: docs/runtime.md, "Hostile files". The largest lattice of probes takes 8 bytes a point, whatever the file holds.
constexpr uint64_t kMostBytes = 8 * kMostDecodedBytes + (36 << 20);

/// The caller's memory, counted, and the last message.
struct Host {
  size_t live = 0, most = 0;
  std::string message;
  lw_config config() {
    lw_config config = LW_CONFIG_INIT;
    config.max_decoded_bytes = kMostDecodedBytes;
    config.allocator_user = config.message_user = this;
    config.message = [](void* user, lw_result, const char* text) { static_cast<Host*>(user)->message = text; };
    config.allocate = [](void* user, size_t bytes) -> void* {
      auto& self = *static_cast<Host*>(user);
      char* block = static_cast<char*>(std::malloc(bytes + 16));
      require(block, "memory for the test");
      std::memcpy(block, &bytes, sizeof bytes);
      self.live += bytes;
      self.most = std::max(self.most, self.live);
      return block + 16;
    };
    config.release = [](void* user, void* memory) {
      if (!memory) return;
      size_t bytes;
      std::memcpy(&bytes, static_cast<char*>(memory) - 16, sizeof bytes);
      static_cast<Host*>(user)->live -= bytes;
      std::free(static_cast<char*>(memory) - 16);
    };
    return config;
  }
};

void requireNumbers(const float* values, size_t count, const char* what) {
  for (size_t i = 0; i < count; ++i) require(!std::isnan(values[i]), what);
}
void requireNumbers(const std::vector<float>& values, const char* what) { requireNumbers(values.data(), values.size(), what); }

const lw_light kLights[] = {{LW_LIGHT_POINT, {0.5f, 0.5f, 1}, {0, 0, 0}, {10, 20, 30}, 0, 0, 0},
                            {LW_LIGHT_SPOT, {1, 2, 0.5f}, {0, -1, 0}, {100, 100, 100}, 0.2f, 0.6f, 5},
                            {LW_LIGHT_DIRECTIONAL, {0, 0, 0}, {0.3f, -1, 0.2f}, {1000, 900, 800}, 0, 0, 0}};
const float kNormal[3] = {0, 0, 1}, kPosition[3] = {0.3f, 0.4f, 0.2f};

/// Loads and evaluates each section of one container.
class Walk {
 public:
  Walk(const lw_container* container, const Host& host) : container_(container), host_(host) {}
  std::string refused;  // the last of what was there and could not be used

  void all() {
    scene(), arrays(), prm(), lightmap(), vpl(), points(), environment(), radiosity(), errors();
  }

 private:
  bool done(lw_result result) {
    require(result >= LW_OK && result <= LW_INVALID_ARGUMENT && result != LW_OUT_OF_MEMORY, "a documented result");
    if (result != LW_OK && result != LW_NOT_FOUND && result != LW_LIMIT_EXCEEDED && result != LW_TOO_NEW) refused = lw_result_name(result) + (": " + host_.message);
    return result == LW_OK;
  }
  void scene() {
    lw_scene_info info;
    if (!done(lw_get_scene_info(container_, &info))) return;
    lw_light light;
    for (uint32_t i = 0; i < std::min(info.light_count, 1000u) && done(lw_get_light(container_, i, &light)); ++i) requireNumbers(light.intensity_rgb, 3, "a light's intensity");
  }
  void arrays() {
    for (int array = 0; array < 24; ++array) {
      lw_array_info info;
      if (array == 0 || (array > LW_ARRAY_TRIANGLE_ALPHA && array < LW_ARRAY_ATLAS_SOURCE) || array > LW_ARRAY_ATLAS_EMISSION) continue;
      if (!done(lw_get_array_info(container_, lw_array(array), &info)) || info.bytes > 4 * kMostDecodedBytes) continue;
      std::vector<char> bytes(info.bytes);
      done(lw_decode_array(container_, lw_array(array), bytes.data(), bytes.size()));
    }
    lw_alpha_material material;
    for (uint32_t i = 0; i < 100 && done(lw_get_alpha_material(container_, i, &material)); ++i) {
      if (material.texture < 0 || uint64_t(material.texture_width) * material.texture_height > kMostDecodedBytes) continue;
      std::vector<char> texels(size_t(material.texture_width) * material.texture_height);
      done(lw_decode_alpha_texture(container_, uint32_t(material.texture), texels.data(), texels.size()));
    }
  }
  void prm() {
    lw_prm* prm = nullptr;
    lw_prm_info info;
    if (!done(lw_prm_load(container_, &prm))) return;
    lw_prm_get_info(prm, &info);
    if (uint64_t(info.width) * info.height <= kMostTexels && uint64_t(info.clusters) * info.texels <= 16 * kMostLinks) {
      std::vector<float> entries(3 * size_t(info.entries)), clusters(3 * size_t(info.clusters)), atlas(4 * size_t(info.width) * info.height);
      std::vector<float> scratch(lw_prm_scratch_bytes(prm) / 4 + 1);
      lw_prm_options options = LW_PRM_OPTIONS_INIT;
      options.emitters = LW_EMITTERS_DIRECT | LW_EMITTERS_INDIRECT | LW_SKY_DIRECT | LW_SKY_INDIRECT;
      options.brightest = info.brightest;
      require(lw_prm_entry_irradiance(prm, kLights, 3, nullptr, nullptr, entries.data()) == LW_OK, "irradiance at entries");
      requireNumbers(entries, "irradiance at entries");
      require(lw_prm_cluster_irradiance(prm, entries.data(), clusters.data()) == LW_OK, "irradiance of clusters");
      requireNumbers(clusters, "irradiance of clusters");
      const lw_result result = lw_prm_evaluate(prm, clusters.data(), &options, scratch.data(), lw_prm_scratch_bytes(prm), atlas.data());
      require(result == LW_OK || result == LW_INVALID_ARGUMENT, "irradiance of texels");
      if (result == LW_OK)
        for (const float value : atlas) require(std::isfinite(value) && value >= 0, "irradiance of texels");
      if (result == LW_OK && scratch.size() <= kMostLinks) frames(prm, options, clusters);
      if (lw_prm_probes* probes = nullptr; info.layout == LW_PRM_LOCAL_BASES && done(lw_prm_probes_load(container_, prm, &probes))) {
        lw_prm_probes_info known;
        lw_prm_probes_get_info(probes, &known);
        std::vector<float> light(27 * size_t(known.probes)), memory(lw_prm_probes_scratch_bytes(probes) / 4);
        const lw_result lit = lw_prm_probes_evaluate(probes, clusters.data(), nullptr, memory.data(), memory.size() * 4, light.data());
        require(lit == LW_OK || lit == LW_INVALID_ARGUMENT, "light of probes");
        if (lit == LW_OK) requireNumbers(light, "light of probes");
        lw_prm_probes_release(probes);
      }
    }
    lw_prm_release(prm);
  }
  /// Light that comes and goes, into one atlas.
  void frames(const lw_prm* prm, const lw_prm_options& options, std::vector<float> clusters) {
    lw_prm_state* state = nullptr;
    if (!done(lw_prm_state_create(prm, &state))) return;
    lw_prm_info info;
    lw_prm_get_info(prm, &info);
    std::vector<float> atlas(4 * size_t(info.width) * info.height);
    for (const float brighter : {1.0f, 1.0f, 0.0f, 2.0f}) {
      for (size_t i = 0; i < clusters.size(); i += 2) clusters[i] *= brighter;
      lw_prm_changes changes;
      if (lw_prm_state_update(state, clusters.data(), &options, atlas.data(), &changes) != LW_OK) continue;
      require(changes.first_row + changes.rows <= info.height && changes.texels <= info.width * info.height, "rows that have changed");
      requireNumbers(atlas, "irradiance of texels from frame to frame");
    }
    lw_prm_state_release(state);
  }
  void lightmap() {
    lw_lightmap* map = nullptr;
    lw_lightmap_info info;
    if (!done(lw_lightmap_load(container_, &map))) return;
    lw_lightmap_get_info(map, &info);
    if (const uint64_t texels = uint64_t(info.width) * info.height; texels <= kMostTexels) {
      std::vector<float> atlas(4 * texels), gradients(3 * texels);
      require(lw_lightmap_shade(map, nullptr, atlas.data()) == LW_OK, "a light map");
      requireNumbers(atlas, "a light map");
      require(lw_lightmap_shade_gradients(map, nullptr, gradients.data()) == LW_OK, "its gradients");
      requireNumbers(gradients, "a light map's gradients");
      for (uint32_t i = 0; i < std::min<uint64_t>(texels, 64); ++i) {
        float rgb[3];
        require(lw_lightmap_irradiance(map, nullptr, i % info.width, i / info.width, kNormal, kNormal, rgb) == LW_OK, "a texel's irradiance");
        requireNumbers(rgb, 3, "a texel's irradiance");
      }
    }
    lw_lightmap_release(map);
  }
  void vpl() {
    lw_virtual_lights* lights = nullptr;
    lw_virtual_lights_info info;
    if (!done(lw_virtual_lights_load(container_, &lights))) return;
    lw_virtual_lights_get_info(lights, &info);
    for (uint32_t i = 0; i < info.lights; ++i) {
      lw_virtual_light light;
      require(lw_virtual_lights_get(lights, i, &light) == LW_OK, "a virtual light");
      float rgb[3], point[3];
      const float uv[2] = {0.25f, 0.75f};
      if (lw_virtual_light_irradiance(&light, kPosition, kNormal, 0.01f, rgb) == LW_OK) requireNumbers(rgb, 3, "a virtual light's irradiance");
      if (lw_virtual_light_point(&light, uv, point) == LW_OK) requireNumbers(point, 3, "a point of a virtual light");
    }
    lw_virtual_lights_release(lights);
  }
  void points() {
    lw_points* points = nullptr;
    lw_points_info info;
    if (!done(lw_points_load(container_, &points))) return;
    lw_points_get_info(points, &info);
    requireNumbers(info.position_m, 3 * size_t(info.points), "positions of points");
    requireNumbers(info.normal, 3 * size_t(info.points), "normals of points");
    lw_points_release(points);
  }
  void environment() {
    lw_environment* environment = nullptr;
    if (!done(lw_environment_load(container_, &environment))) return;
    float rgb[3];
    require(lw_environment_irradiance(environment, kNormal, nullptr, rgb) == LW_OK, "a sky's irradiance");
    requireNumbers(rgb, 3, "a sky's irradiance");
    require(lw_environment_phong(environment, kNormal, 100, nullptr, rgb) == LW_OK, "a sky's reflection");
    requireNumbers(rgb, 3, "a sky's reflection");
    require(lw_environment_ggx(environment, kPosition, 0.3f, nullptr, rgb) == LW_OK, "a sky's reflection");
    requireNumbers(rgb, 3, "a sky's reflection");
    lw_environment_release(environment);
  }
  void radiosity() {
    lw_radiosity* radiosity = nullptr;
    lw_radiosity_info info;
    if (!done(lw_radiosity_load(container_, &radiosity))) return;
    lw_radiosity_get_info(radiosity, &info);
    lw_radiosity_state* state = nullptr;
    require(lw_radiosity_state_create(radiosity, &state) == LW_OK, "a state of radiosity");
    std::vector<float> direct(3 * size_t(info.patches), 1);
    lw_radiosity_injector* injector = nullptr;
    if (done(lw_radiosity_injector_create(container_, radiosity, 8, &injector))) {
      lw_radiosity_injector_set_portals(injector, state);
      if (lw_radiosity_inject(injector, kLights, 3, direct.data()) == LW_OK) requireNumbers(direct, "injected light");
    }
    for (uint32_t i = 0; i < std::min(info.portals, 4u); ++i) lw_radiosity_set_portal(state, i, 0.3f);
    if (lw_radiosity_set_direct(state, direct.data()) == LW_OK && info.links <= kMostLinks) {
      lw_radiosity_step(state, 2);
      lw_radiosity_report report;
      lw_radiosity_solve(state, 1e-3, 20, &report);
      lw_radiosity_get_irradiance(state, LW_RADIOSITY_INDIRECT | LW_RADIOSITY_EMITTERS, direct.data());
      requireNumbers(direct, "radiosity");
      if (uint64_t(info.width) * info.height <= kMostTexels) {
        std::vector<float> atlas(4 * size_t(info.width) * info.height);
        require(lw_radiosity_shade(state, nullptr, atlas.data()) == LW_OK, "radiosity as an atlas");
        requireNumbers(atlas, "radiosity as an atlas");
      }
      probes(radiosity, state);
    }
    lw_radiosity_injector_destroy(injector);
    lw_radiosity_state_destroy(state);
    lw_radiosity_release(radiosity);
  }
  void probes(const lw_radiosity* radiosity, lw_radiosity_state* state) {
    lw_probes* probes = nullptr;
    lw_probes_info info;
    if (!done(lw_probes_load(container_, radiosity, &probes))) return;
    lw_probes_get_info(probes, &info);
    requireNumbers(info.position_m, 3 * size_t(info.probes), "positions of probes");
    std::vector<float> sh(27 * size_t(info.probes));
    require(lw_probes_evaluate(probes, state, nullptr, sh.data()) == LW_OK, "light at probes");
    requireNumbers(sh, "light at probes");
    float here[9][3], rgb[3];
    require(lw_probes_sample(probes, sh.data(), kPosition, here) == LW_OK, "light at a place");
    requireNumbers(&here[0][0], 27, "light at a place");
    if (lw_sh_irradiance(here, kNormal, rgb) == LW_OK) requireNumbers(rgb, 3, "light at a place");
    lw_probes_release(probes);
  }
  void errors() {
    uint32_t count = 0;
    if (!done(lw_count_measured_errors(container_, nullptr, &count))) return;
    std::vector<lw_measured_error> all(std::min(count, 100u));
    const bool sound = done(lw_get_measured_errors(container_, nullptr, uint32_t(all.size()), all.data()));
    lw_measured_error error;
    for (size_t i = 0; i < all.size(); ++i)
      if (done(lw_get_measured_error(container_, nullptr, uint32_t(i), &error)) && sound) require(error.relrmse.value == all[i].relrmse.value, "one error or all");
  }
  const lw_container* container_;
  const Host& host_;
};

}  // namespace
}  // namespace lightwell::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lightwell;
  fuzz::Host host;
  const lw_config config = host.config();
  lw_container* container = nullptr;
  if (lw_open_memory(data, size, &config, &container) == LW_OK) {
    fuzz::Walk walk(container, host);
    walk.all();
    lw_close(container);
    if (!walk.refused.empty() && format::isSound(format::verify(format::memorySource(data, size)))) fuzz::require(false, ("what is sound is loaded; " + walk.refused).c_str());
  }
  fuzz::require(host.live == 0, "all memory is released");
  fuzz::require(host.most <= fuzz::kMostBytes, "memory within the limit");
  return 0;
}
