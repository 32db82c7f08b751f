// A room with virtual lights as a bake makes them, loaded by the runtime, and what exact irradiance and rays make of them.
#pragma once
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "lightwell/lightwell.h"
#include "precompute/bake/sections.h"
#include "precompute/core/parallel.h"
#include "precompute/core/random.h"
#include "tests/support/prepared_scene.h"
#include "tests/support/scenes.h"

namespace lightwell::bake {

/// Irradiance and how much of what could come does come, of each slot.
struct SlotLight {
  std::vector<Vec3d> irradiance_rgb;
  std::vector<double> visible_share;
};

struct LitRoom {
  test::PreparedScene p;
  std::vector<uint8_t> file;
  lw_container* container = nullptr;
  lw_virtual_lights* virtual_lights = nullptr;
  std::vector<lw_virtual_light> lights;

  LitRoom(scene::Scene scene, int size, uint32_t count) : p(std::move(scene), size) {
    const transport::LightPaths paths(p.scene, p.atlas, *p.tracer, p.scene.lights, nullptr, {.paths = 20000});
    const auto points = paths.trace(0, paths.count(), nullptr);
    const VplResult vpl{.points = points.size(), .lights = transport::clusterPoints(points, 2.0f, {.lights = count})};
    format::Writer writer;
    addSceneSection(writer, p.scene);
    addGeometrySection(writer, p.scene, p.atlas);
    addAtlasSection(writer, p.atlas);
    addVplSection(writer, vpl, p.scene);
    file = writer.bytes();
    EXPECT_EQ(lw_open_memory(file.data(), file.size(), nullptr, &container), LW_OK);
    EXPECT_EQ(lw_virtual_lights_load(container, &virtual_lights), LW_OK);
    lw_virtual_lights_info info{};
    EXPECT_EQ(lw_virtual_lights_get_info(virtual_lights, &info), LW_OK);
    lights.resize(info.lights);
    for (uint32_t i = 0; i < info.lights; ++i) EXPECT_EQ(lw_virtual_lights_get(virtual_lights, i, &lights[i]), LW_OK);
  }
  ~LitRoom() {
    lw_virtual_lights_release(virtual_lights);
    lw_close(container);
  }
  LitRoom(const LitRoom&) = delete;
  LitRoom& operator=(const LitRoom&) = delete;

  /// `samples` points of each texel, each with one ray to each light.
  SlotLight trace(uint32_t samples, bool shadows = true) const {
    SlotLight light{std::vector<Vec3d>(p.atlas.slots.size(), Vec3d(0.0)), std::vector<double>(p.atlas.slots.size(), 1.0)};
    parallelFor(p.atlas.slots.size(), 16, 2, nullptr, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) traceSlot(i, samples, shadows, light);
    });
    return light;
  }

 private:
  void traceSlot(size_t index, uint32_t samples, bool shadows, SlotLight& out) const {
    const atlas::Slot& slot = p.atlas.slots[index];
    const Sampler sampler(7, slot.texel);
    std::vector<atlas::SurfacePoint> at;
    for (uint32_t i = 0; i < samples; ++i) at.push_back(atlas::sampleSlot(p.scene.mesh, p.atlas, slot, sampler.get1D(i, 0), sampler.get2D(i, 1)));
    const float metres = float(p.scene.metres_per_unit);
    double unoccluded = 0, seen = 0;
    for (uint32_t l = 0; l < lights.size(); ++l) {
      Vec3d exact(0.0);
      double expected = 0, found = 0;
      for (uint32_t i = 0; i < samples; ++i) {
        const Vec3 position_m = at[i].position * metres;
        float rgb[3];
        EXPECT_EQ(lw_virtual_light_irradiance(&lights[l], &position_m.x, &at[i].normal.x, 0, rgb), LW_OK);
        if (!(rgb[0] + rgb[1] + rgb[2] > 0)) continue;
        exact += Vec3d(rgb[0], rgb[1], rgb[2]) / samples;
        const Vec2 uv = sampler.get2D(i, 2 + l);
        Vec3 target;
        EXPECT_EQ(lw_virtual_light_point(&lights[l], &uv.x, &target.x), LW_OK);
        target /= metres;
        const Vec3 light_normal(lights[l].normal[0], lights[l].normal[1], lights[l].normal[2]), offset = target - at[i].position;
        const Vec3 direction = offset.normalized();
        const double sent = lights[l].type == LW_VIRTUAL_SPHERE ? 1.0 : std::max(-double(direction.dot(light_normal)), 0.0);
        const double weight = std::max(double(direction.dot(at[i].normal)), 0.0) * sent / double(offset.length2());
        if (!(weight > 0)) continue;
        expected += weight;
        if (!shadows) found += weight;
        if (!shadows || !(direction.dot(at[i].geometric_normal) > 0)) continue;
        const Vec3 origin = trace::Tracer::offsetOrigin(at[i].position, at[i].geometric_normal, direction);
        const Vec3 end = trace::Tracer::offsetOrigin(target, light_normal, -direction);
        const trace::Ray ray{.origin = origin, .direction = end - origin, .t_max = 1.0f - 1e-4f, .key = l};
        float passed = 0;
        p.tracer->transmittance({&ray, 1}, {&passed, 1});
        found += weight * double(passed);
      }
      if (!(expected > 0)) continue;
      out.irradiance_rgb[index] += exact * (found / expected);
      unoccluded += exact.x + exact.y + exact.z;
      seen += (exact.x + exact.y + exact.z) * (found / expected);
    }
    out.visible_share[index] = unoccluded > 0 ? seen / unoccluded : 1;
  }
};

/// An open box, 4 × 3 × 4 m, with a large and a small box in it and a lamp near the ceiling.
inline scene::Scene boxesInBox() {
  test::SceneBuilder builder;
  const uint32_t wall = builder.material(test::diffuse(0.7f));
  builder.room({-2, 0, -2}, {2, 3, 2}, wall);
  const auto box = [&](const Vec3& low, const Vec3& high) {
    const Vec3 x(high.x - low.x, 0, 0), y(0, high.y - low.y, 0), z(0, 0, high.z - low.z);
    builder.quad(low + y, z, x, wall).quad(low, z, y, wall).quad(low + x, y, z, wall).quad(low, y, x, wall).quad(low + z, x, y, wall);
  };
  box({-1.2f, 0, -1.2f}, {-0.2f, 1.6f, -0.2f});
  box({0.3f, 0, 0.2f}, {1.1f, 0.8f, 1.0f});
  scene::Scene scene = builder.take();
  scene.lights.push_back(test::pointLight({0.4f, 2.6f, -0.1f}, 10));
  return scene;
}

/// Two rooms of 3 × 2.5 × 3 m with a doorway of 1 × 2 m between them; only one has a lamp.
inline scene::Scene twoRooms() {
  test::SceneBuilder builder;
  const uint32_t wall = builder.material(test::diffuse(0.7f));
  builder.room({-3.1f, 0, -1.5f}, {3.1f, 2.5f, 1.5f}, wall);
  for (const auto& [low, high] : {std::pair<Vec3, Vec3>{{-0.1f, 0, -1.5f}, {0.1f, 2.5f, -0.5f}}, {{-0.1f, 0, 0.5f}, {0.1f, 2.5f, 1.5f}}, {{-0.1f, 2, -0.5f}, {0.1f, 2.5f, 0.5f}}}) {
    const Vec3 x(high.x - low.x, 0, 0), y(0, high.y - low.y, 0), z(0, 0, high.z - low.z);
    builder.quad(low, z, y, wall).quad(low + x, y, z, wall);
    if (low.y > 0) builder.quad(low, x, z, wall);
    else builder.quad(low.z < 0 ? low + z : low, low.z < 0 ? x : y, low.z < 0 ? y : x, wall);
  }
  scene::Scene scene = builder.take();
  scene.lights.push_back(test::pointLight({-1.6f, 2.0f, 0.3f}, 10));
  return scene;
}

/// A hall of 6 × 3 × 6 m with nine columns from floor to ceiling and two lamps.
inline scene::Scene columns() {
  test::SceneBuilder builder;
  const uint32_t wall = builder.material(test::diffuse(0.6f));
  builder.room({-3, 0, -3}, {3, 3, 3}, wall);
  for (int i = -1; i <= 1; ++i)
    for (int j = -1; j <= 1; ++j) {
      const Vec3 low(1.7f * float(i) - 0.2f, 0, 1.7f * float(j) - 0.2f), x(0.4f, 0, 0), y(0, 3, 0), z(0, 0, 0.4f);
      builder.quad(low, z, y, wall).quad(low + x, y, z, wall).quad(low, y, x, wall).quad(low + z, x, y, wall);
    }
  scene::Scene scene = builder.take();
  scene.lights.push_back(test::pointLight({0.8f, 2.4f, 0.9f}, 10));
  scene.lights.push_back(test::pointLight({-2.4f, 1.2f, -2.2f}, 6));
  return scene;
}

}  // namespace lightwell::bake
