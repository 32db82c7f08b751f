// Rooms with doors, baked to radiosity, and their light for every state of the doors.
#pragma once
#include <gtest/gtest.h>

#include <memory>

#include "precompute/core/parallel.h"
#include "precompute/transport/pooled_error.h"
#include "precompute/transport/radiosity/bake_radiosity.h"
#include "precompute/transport/radiosity/solve.h"
#include "precompute/transport/reference/reference.h"
#include "tests/support/door_scenes.h"
#include "tests/support/prepared_scene.h"
#include "tests/support/stages.h"

namespace lightwell::transport {

/// A baked scene with everything that solving it takes.
struct Baked {
  test::PreparedScene p;
  RadiositySettings settings;
  Sides sides;
  std::unique_ptr<RadiosityBaker> baker;
  TrainedFactors trained;
  RadiosityResult result;

  explicit Baked(scene::Scene scene, uint32_t rays = 512, int size = 128, uint32_t grain = 64, int threads = 2) : p(std::move(scene), size), sides(surfaceSides(p.atlas)) {
    settings.rays = rays;
    settings.training_lights = 32;
    const Bytes patches = makePatchBytes(p.scene, p.atlas, *p.tracer, settings, threads, nullptr);
    baker = std::make_unique<RadiosityBaker>(p.scene, p.atlas, *p.tracer, settings, patches);
    const auto stage = [&](uint32_t count, auto function) { return test::inRanges(count, grain, threads, function); };
    using test::views;
    const auto hits = stage(baker->patchCount(), [&](uint32_t a, uint32_t b) { return baker->hits(a, b); });
    const auto direct = stage(baker->trainingLightCount(), [&](uint32_t a, uint32_t b) { return baker->direct(a, b); });
    const Bytes bytes = baker->train(views(hits), views(direct));
    trained = baker->readTrained(bytes);
    const auto links = stage(baker->patchCount(), [&](uint32_t a, uint32_t b) { return baker->links(a, b, bytes); });
    result = baker->assemble(views(links), threads, nullptr);
  }

  std::vector<float> gates(const std::vector<float>& portal_open) const {
    std::vector<float> open;
    for (size_t i = 0; i < p.scene.portals.size(); ++i)
      for (uint32_t s = 0; s < p.scene.portals[i].strips; ++s) open.push_back(std::clamp(portal_open[i] * float(p.scene.portals[i].strips) - float(s), 0.0f, 1.0f));
    return open;
  }
  /// Indirect irradiance per slot under a light.
  std::vector<Rgb> indirect(const scene::Light& light, const std::vector<float>& portal_open) const {
    const trace::Tracer tracer(p.scene, 1, portal_open);
    constexpr int kSeeds = 24;
    std::vector<Rgb> direct(result.patches.count(), Rgb(0.0f)), dark = direct;
    for (uint64_t seed = 1; seed <= kSeeds; ++seed) {
      const auto irradiance = patchIrradiance(p.scene, p.atlas, tracer, sides, result.patches, light, seed);
      for (size_t i = 0; i < direct.size(); ++i) direct[i] += Rgb(irradiance[i] / kSeeds);
    }
    const auto solution = solveRadiosity(result.links, result.tree, result.patches.albedo_rgb, direct, dark, 1e-7, 1000, gates(portal_open));
    std::vector<Rgb> irradiance(p.atlas.slots.size(), Rgb(0.0f));
    for (size_t i = 0; i < result.texel.size(); ++i)
      for (size_t k = 0; k < 4; ++k)
        if (result.texel_patch[i][k] != kNone)
          irradiance[p.atlas.texel_slot[result.texel[i]]] += solution.irradiance_rgb[result.texel_patch[i][k]] * (result.texel_weight[i][k] * result.texel_exposed[i]);
    return irradiance;
  }
  /// Path-traced, three times.
  std::vector<std::vector<Rgb>> reference(const scene::Light& light, const std::vector<float>& portal_open, uint32_t samples) const {
    const trace::Tracer tracer(p.scene, 0, portal_open);
    std::vector<std::vector<Rgb>> maps;
    for (uint64_t seed = 1; seed <= 3; ++seed)
      maps.push_back(referenceIrradiance(p.scene, p.atlas, tracer, {light}, Component::indirect, {.samples = samples, .seed = seed}).irradiance_rgb);
    return maps;
  }
  bool isOnLeaf(const atlas::Slot& slot) const {
    for (const scene::Portal& portal : p.scene.portals)
      if (portal.holds(p.atlas.patches[slot.first_patch].triangle)) return true;
    return false;
  }
  /// Error over the slots of a room, or, with −1, over all that are not on a leaf.
  PooledError error(const std::vector<std::vector<Rgb>>& references, const std::vector<Rgb>& candidate, int room) const {
    std::vector<std::vector<Rgb>> chosen(references.size());
    std::vector<Rgb> values;
    for (size_t slot = 0; slot < candidate.size(); ++slot) {
      if (isOnLeaf(p.atlas.slots[slot]) || (room >= 0 && test::roomOf(p.atlas.slots[slot].position) != room)) continue;
      for (size_t i = 0; i < references.size(); ++i) chosen[i].push_back(references[i][slot]);
      values.push_back(candidate[slot]);
    }
    return compareWithReferences(chosen, values);
  }
};

inline const scene::Light kLamp = test::pointLight({1.2f, 2.2f, -0.8f}, 20);

}  // namespace lightwell::transport
