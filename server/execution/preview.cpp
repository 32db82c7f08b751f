#include "server/execution/preview.h"

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#include <stb_image_write.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "lightwell/lightwell.h"
#include "precompute/bake/container_scene.h"
#include "precompute/trace/tracer.h"

namespace lightwell::server {
namespace {

constexpr uint32_t kMostSide = 512;

struct Release {
  void operator()(lw_container* container) const { lw_close(container); }
  void operator()(lw_prm* prm) const { lw_prm_release(prm); }
};

struct Shadows {
  const scene::Scene& scene;
  const trace::Tracer& tracer;
};

void traceShadows(void* user, const lw_shadow_ray* rays, uint32_t count, float* visibility) {
  const auto& [scene, tracer] = *static_cast<const Shadows*>(user);
  constexpr float kShortOfLight = 1 - 1e-4f;  // a lamp's own body does not hide it
  const float units_per_metre = float(1 / scene.metres_per_unit);
  std::vector<trace::Ray> segments(count);
  for (uint32_t i = 0; i < count; ++i) {
    const auto vector = [](const float* v) { return Vec3(v[0], v[1], v[2]); };
    const Vec3 direction = vector(rays[i].direction);
    const Vec3 origin = trace::Tracer::offsetOrigin(vector(rays[i].origin_m) * units_per_metre, vector(rays[i].normal), direction);
    segments[i] = {.origin = origin, .direction = direction, .t_max = rays[i].distance_m * units_per_metre * kShortOfLight,
                   .key = rays[i].entry};
  }
  tracer.transmittance(segments, std::span(visibility, count));
}

struct LightMap {
  uint32_t width = 0, height = 0;
  std::vector<float> rgba;
};

LightMap evaluate(std::span<const uint8_t> bytes) {
  lw_container* opened = nullptr;
  if (lw_open_memory(bytes.data(), bytes.size(), nullptr, &opened) != LW_OK) return {};
  const std::unique_ptr<lw_container, Release> container(opened);
  lw_prm* loaded = nullptr;
  if (!lw_has_section(opened, "prm") || lw_prm_load(opened, &loaded) != LW_OK) return {};
  const std::unique_ptr<lw_prm, Release> prm(loaded);
  lw_prm_info info;
  lw_scene_info scene_info;
  if (lw_prm_get_info(loaded, &info) != LW_OK || lw_get_scene_info(opened, &scene_info) != LW_OK) return {};

  std::vector<lw_light> lights(scene_info.light_count);
  for (uint32_t i = 0; i < lights.size(); ++i) lw_get_light(opened, i, &lights[i]);
  std::vector<float> entries(size_t(info.entries) * 3), clusters(size_t(info.clusters) * 3);
  if (lights.empty()) {
    if (!info.has_emitter) std::fill(clusters.begin(), clusters.end(), 1.0f);
  } else {
    Diagnostics ignored;
    const bake::ContainerScene scene = bake::loadContainerScene(format::Reader({bytes.begin(), bytes.end()}), ignored);
    const trace::Tracer tracer(scene.scene, 1);
    Shadows shadows{scene.scene, tracer};
    if (lw_prm_entry_irradiance(loaded, lights.data(), uint32_t(lights.size()), traceShadows, &shadows, entries.data()) != LW_OK ||
        lw_prm_cluster_irradiance(loaded, entries.data(), clusters.data()) != LW_OK)
      return {};
  }
  lw_prm_options options = LW_PRM_OPTIONS_INIT;
  options.brightest = info.brightest;
  LightMap map{info.width, info.height, std::vector<float>(size_t(info.width) * info.height * 4)};
  std::vector<float> scratch(lw_prm_scratch_bytes(loaded) / sizeof(float) + 1);
  if (lw_prm_evaluate(loaded, clusters.data(), &options, scratch.data(), scratch.size() * sizeof(float), map.rgba.data()) != LW_OK) return {};
  return map;
}

uint8_t srgb(float linear) {
  const float x = std::clamp(linear, 0.0f, 1.0f);
  return uint8_t(std::lround(255 * (x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1 / 2.4f) - 0.055f)));
}

/// The 98th percentile of the brightest channel becomes white.
float exposureOf(const std::vector<float>& rgba) {
  std::vector<float> values;
  for (size_t i = 0; i + 3 < rgba.size(); i += 4)
    if (const float most = std::max({rgba[i], rgba[i + 1], rgba[i + 2]}); most > 0) values.push_back(most);
  if (values.empty()) return 1;
  const auto nth = values.begin() + ptrdiff_t(values.size() * 98 / 100);
  std::nth_element(values.begin(), nth, values.end());
  return 1 / std::max(*nth, 1e-30f);
}

}  // namespace

std::vector<uint8_t> previewPng(std::span<const uint8_t> container) {
  const LightMap map = evaluate(container);
  if (map.rgba.empty()) return {};
  const float exposure = exposureOf(map.rgba);
  const uint32_t step = (std::max(map.width, map.height) + kMostSide - 1) / kMostSide;
  const int width = int(map.width / step), height = int(map.height / step);
  std::vector<uint8_t> rgb;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int channel = 0; channel < 3; ++channel) {
        float sum = 0;
        for (uint32_t j = 0; j < step; ++j)
          for (uint32_t i = 0; i < step; ++i)
            sum += map.rgba[(size_t(uint32_t(y) * step + j) * map.width + uint32_t(x) * step + i) * 4 + size_t(channel)];
        rgb.push_back(srgb(sum * exposure / float(step * step)));
      }
  std::vector<uint8_t> png;
  const auto append = [](void* bytes, void* data, int size) {
    auto* out = static_cast<std::vector<uint8_t>*>(bytes);
    out->insert(out->end(), static_cast<uint8_t*>(data), static_cast<uint8_t*>(data) + size);
  };
  if (!stbi_write_png_to_func(append, &png, width, height, 3, rgb.data(), width * 3)) png.clear();
  return png;
}

}  // namespace lightwell::server
