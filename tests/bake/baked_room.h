// Radiosity and probes of a scene as a bake makes them, loaded by the runtime.
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "lightwell/lightwell.h"
#include "precompute/bake/sections.h"
#include "precompute/core/parallel.h"
#include "tests/support/prepared_scene.h"
#include "tests/support/scenes.h"

namespace lightwell::bake {

using transport::ProbeBaker, transport::ProbeSettings, transport::RadiosityBaker;

inline transport::RadiositySettings smallRadiosity() {
  transport::RadiositySettings settings;
  settings.rays = 512;
  settings.training_lights = 16;
  return settings;
}

inline ProbeSettings lattice(float spacing) {
  ProbeSettings settings;
  settings.places.spacing = spacing;
  return settings;
}

/// Radiosity and probes of a scene, loaded by the runtime.
struct BakedRoom {
  test::PreparedScene p;
  transport::RadiositySettings radiosity_settings = smallRadiosity();
  std::unique_ptr<RadiosityBaker> baker;
  transport::RadiosityResult radiosity;
  Bytes places;
  transport::ProbeResult probes;
  std::vector<uint8_t> file;
  lw_container* container = nullptr;
  lw_radiosity* form_factors = nullptr;
  lw_radiosity_state* state = nullptr;
  lw_probes* loaded = nullptr;
  lw_probes_info info{};

  explicit BakedRoom(scene::Scene scene, const ProbeSettings& settings, int size = 64, uint32_t grain = 64, int threads = 2) : p(std::move(scene), size) {
    const Bytes patches = transport::makePatchBytes(p.scene, p.atlas, *p.tracer, radiosity_settings, threads, nullptr);
    baker = std::make_unique<RadiosityBaker>(p.scene, p.atlas, *p.tracer, radiosity_settings, patches);
    const auto views = [](const std::vector<Bytes>& parts) { return std::vector<ByteView>(parts.begin(), parts.end()); };
    const std::vector<Bytes> hits{baker->hits(0, baker->patchCount())}, direct{baker->direct(0, baker->trainingLightCount())};
    const Bytes trained = baker->train(views(hits), views(direct));
    const std::vector<Bytes> links{baker->links(0, baker->patchCount(), trained)};
    radiosity = baker->assemble(views(links), 2, nullptr);
    places = transport::makeProbeBytes(p.scene, *p.tracer, *baker, settings, threads, nullptr);
    const ProbeBaker probe_baker(*baker, settings, places);
    std::vector<Bytes> probe_links((probe_baker.probes().count() + grain - 1) / grain);
    parallelFor(probe_links.size(), 1, threads, nullptr, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const auto first = uint32_t(i * grain);
        probe_links[i] = probe_baker.links(first, probe_baker.hits(first, std::min(first + grain, probe_baker.probes().count())), trained);
      }
    });
    probes = probe_baker.assemble(views(probe_links));
    format::Writer writer;
    addSceneSection(writer, p.scene);
    addGeometrySection(writer, p.scene, p.atlas);
    addAtlasSection(writer, p.atlas);
    addRadiositySection(writer, radiosity, p.scene);
    addProbesSection(writer, probes, p.scene.metres_per_unit);
    file = writer.bytes();
    EXPECT_EQ(lw_open_memory(file.data(), file.size(), nullptr, &container), LW_OK);
    EXPECT_EQ(lw_radiosity_load(container, &form_factors), LW_OK);
    EXPECT_EQ(lw_radiosity_state_create(form_factors, &state), LW_OK);
    EXPECT_EQ(lw_probes_load(container, form_factors, &loaded), LW_OK);
    EXPECT_EQ(lw_probes_get_info(loaded, &info), LW_OK);
  }
  ~BakedRoom() {
    lw_probes_release(loaded);
    lw_radiosity_state_destroy(state);
    lw_radiosity_release(form_factors);
    lw_close(container);
  }
  BakedRoom(const BakedRoom&) = delete;
  BakedRoom& operator=(const BakedRoom&) = delete;

  void shine(const scene::Light& light) {
    std::vector<float> direct_rgb;
    for (const float e : transport::patchIrradiance(p.scene, p.atlas, *p.tracer, baker->sides(), baker->patches(), light, 1)) direct_rgb.insert(direct_rgb.end(), 3, e);
    EXPECT_EQ(lw_radiosity_set_direct(state, direct_rgb.data()), LW_OK);
  }
  /// All bounces, and what all probes have of them.
  std::vector<float> evaluate() {
    EXPECT_EQ(lw_radiosity_solve(state, 1e-7, 500, nullptr), LW_OK);
    std::vector<float> sh(size_t(info.probes) * 27);
    EXPECT_EQ(lw_probes_evaluate(loaded, state, nullptr, sh.data()), LW_OK);
    return sh;
  }
};

}  // namespace lightwell::bake
