// Containers say how far off they are, and how sure that is: bakes of random rooms with random settings against far better references that know nothing of the measurement. LIGHTWELL_BAKES says how
// many bakes; of all intervals at least nine in ten must hold the truth.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <map>
#include <numeric>

#include "cli/lightmap_evaluator.h"
#include "cli/prm_evaluator.h"
#include "cli/radiosity_evaluator.h"
#include "cli/vpl_evaluator.h"
#include "precompute/bake/run.h"
#include "precompute/core/random.h"
#include "precompute/transport/many_lights/virtual_light_irradiance.h"
#include "precompute/transport/pooled_error.h"
#include "precompute/transport/prm/light_prior.h"
#include "precompute/transport/reference/reference.h"
#include "tests/cli/scenes.h"
#include "tests/support/temporary_folder.h"

namespace lightwell::bake {
namespace {

using transport::Component;
using transport::PooledError;

constexpr int kThreads = 2;
constexpr uint32_t kTruthPaths = 256;  // in each of four references, at every texel
constexpr uint64_t kTruthSeed = 0x7472757468ull;

/// Random numbers of one bake.
class Draw {
 public:
  explicit Draw(uint32_t bake) : sampler_(17, bake) {}
  float between(float low, float high) { return low + (high - low) * sampler_.get1D(0, dimension_++); }
  uint32_t below(uint32_t count) { return std::min(uint32_t(between(0, float(count))), count - 1); }

 private:
  Sampler sampler_;
  uint32_t dimension_ = 0;
};

/// How often intervals held the truth.
struct Tally {
  int held = 0, all = 0;
  double width = 0, size = 0;  // of the intervals, of the errors
  void add(double truth, double low, double high) {
    ++all;
    size += std::abs(truth);
    held += low <= truth && truth <= high;
    width += high - low;
  }
};

class MeasuredErrors : public testing::Test {
 protected:
  /// A room with or without boxes, emitters and a lamp; what moves light differs as what does not.
  void bakeRandomly(uint32_t number, bool of_moving_lights) {
    Draw draw(number * 2 + of_moving_lights);
    test::RoomOptions room{.albedo = draw.between(0.2f, 0.85f), .boxes = draw.below(4) > 0, .box_x = draw.between(-0.7f, -0.25f), .box_albedo = draw.between(0.1f, 0.8f)};
    const bool emits = !of_moving_lights && room.boxes && draw.below(3) == 0;
    if (emits) room.box_emission = draw.between(1, 20);
    std::ofstream(folder_.path() / "room.gltf") << test::roomGltf(room);
    std::ofstream lights(folder_.path() / "lights.json");
    lights << R"({"lights": [)";
    const uint32_t lamps = draw.below(3) + (emits ? 0 : 1);
    for (uint32_t i = 0; i < lamps; ++i)
      lights << (i ? ", " : "") << R"({"type": "point", "color": [1, )" << draw.between(0.3f, 1) << ", " << draw.between(0.3f, 1) << R"(], "intensity": )" << draw.between(1, 20)
             << R"(, "position": [)" << draw.between(-0.8f, 0.8f) << ", " << draw.between(0, 0.9f) << ", " << draw.between(-0.8f, 0.8f) << "]}";
    lights << "]}";
    lights.close();
    settings_ = {};
    settings_.techniques = of_moving_lights ? std::vector{plan::Technique::prm, plan::Technique::radiosity} : std::vector{plan::Technique::lightmap, plan::Technique::vpl};
    settings_.lightmap_size = of_moving_lights ? 24 : 24 + 12 * int(draw.below(3));
    settings_.quality = plan::Quality::preview;
    settings_.refinement = -int(draw.below(3));
    if (of_moving_lights) settings_.prm_clusters = 64 << draw.below(3);
    if (!of_moving_lights) settings_.virtual_lights = 20 << draw.below(4);
    settings_.seed = number + 1;
    const SceneSource source{.scene = folder_.path() / "room.gltf", .lights = folder_.path() / "lights.json"};
    NullStore store;
    const CancelFlag never;
    Diagnostics diagnostics;
    const Baked baked = runBake({.source = source, .settings = settings_, .threads = kThreads}, store, diagnostics, never, {});
    std::ofstream(folder_.path() / "room.lwc", std::ios::binary).write(reinterpret_cast<const char*>(baked.outcome.container->data()), std::streamsize(baked.outcome.container->size()));
    runtime_ = std::make_unique<cli::RuntimeContainer>(folder_.path() / "room.lwc");
    context_ = std::make_unique<BakeContext>(source, settings_, kThreads, diagnostics, never);
    of_moving_lights ? compareUnderMovingLights(baked.report) : compareUnderStaticLights(baked.report);
  }

  std::vector<uint32_t> allSlots() const {
    std::vector<uint32_t> slots(context_->atlas().slots.size());
    std::iota(slots.begin(), slots.end(), 0u);
    return slots;
  }
  std::vector<std::vector<Rgb>> references(const std::vector<scene::Light>& lights, Component component, uint32_t samples, uint64_t seed, std::span<const uint32_t> slots) const {
    std::vector<std::vector<Rgb>> maps_rgb;
    for (uint64_t k = 1; k <= 4; ++k)
      maps_rgb.push_back(transport::referenceIrradianceOf(slots, context_->scene(), context_->atlas(), *context_->tracer(), lights, component,
                                                          {.samples = samples, .seed = combineKeys(seed, k), .threads = kThreads})
                             .irradiance_rgb);
    return maps_rgb;
  }
  std::vector<Rgb> slotsOf(const std::vector<float>& atlas_rgba) const {
    std::vector<Rgb> values_rgb;
    for (const auto& slot : context_->atlas().slots) values_rgb.emplace_back(atlas_rgba[slot.texel * 4], atlas_rgba[slot.texel * 4 + 1], atlas_rgba[slot.texel * 4 + 2]);
    return values_rgb;
  }

  void compareUnderStaticLights(const Report& report) {
    const std::vector<uint32_t> all_slots = allSlots();
    const auto total = references(context_->scene().lights, Component::total, kTruthPaths, kTruthSeed, all_slots);
    const auto totalOf = [&](std::span<const uint32_t> slots) { return references(context_->scene().lights, Component::total, kTruthPaths * transport::kRetracedPaths, kTruthSeed + 3, slots); };
    check(report, "lightmap", transport::compareWithReferences(total, slotsOf(cli::evaluateLightmapOnCpu(*runtime_, LW_LIGHTMAP_DIRECT | LW_LIGHTMAP_INDIRECT)), {}, totalOf));
    // Reflected light, and what emitters give straight.
    const auto heldBy = [&](std::span<const uint32_t> slots, uint32_t paths, uint64_t seed) {
      auto held = references(context_->scene().lights, Component::indirect, paths, seed, slots);
      const auto straight = references({}, Component::direct, paths / 2, seed + 100, slots);
      for (size_t k = 0; k < held.size(); ++k)
        for (size_t i = 0; i < held[k].size(); ++i) held[k][i] += straight[k][i];
      return held;
    };
    const auto held = heldBy(all_slots, kTruthPaths, kTruthSeed + 1);
    Diagnostics diagnostics;
    const ContainerScene container = loadContainerScene(format::Reader(folder_.path() / "room.lwc"), diagnostics);
    const trace::Tracer tracer(container.scene, kThreads);
    const CancelFlag never;
    const auto lights = cli::evaluateVplOnCpu({.container = *runtime_, .scene = container, .tracer = tracer, .component = Component::total, .samples = 256, .cut_error = 0, .interpolate = false,
                                               .restore = false, .threads = kThreads, .cancel = &never, .progress = [](double) {}});
    ASSERT_EQ(lights.irradiance_rgb.size(), held[0].size());
    check(report, "vpl", transport::compareWithReferences(held, lights.irradiance_rgb, {}, [&](std::span<const uint32_t> slots) {
            return heldBy(slots, kTruthPaths * transport::kRetracedPaths, kTruthSeed + 4);
          }));
  }

  void compareUnderMovingLights(const Report& report) {
    constexpr uint32_t kLights = 32;
    const scene::Scene& scene = context_->scene();
    const auto lights = transport::samplePriorLights(scene, context_->atlas(), *context_->tracer(), kLights, kTruthSeed);
    const cli::CpuPrm prm(*runtime_);
    const auto radiosity = runtime_->loadRadiosity();
    const auto state = runtime_->createState(radiosity.get());
    Diagnostics diagnostics;
    ContainerScene container = loadContainerScene(format::Reader(folder_.path() / "room.lwc"), diagnostics);
    const trace::Tracer tracer(container.scene, kThreads);
    std::map<std::string, std::vector<PooledError>> errors;
    const std::vector<uint32_t> all_slots = allSlots();
    for (uint32_t i = 0; i < kLights; ++i) {
      const std::vector<scene::Light> light{lights[i].light};
      const auto truth = references(light, Component::indirect, 128, kTruthSeed + 10 + i, all_slots);
      lw_prm_options options = LW_PRM_OPTIONS_INIT;
      options.fill = 0, options.emitters = LW_EMITTERS_OFF;
      errors["prm"].push_back(transport::compareWithReferences(truth, slotsOf(prm.evaluate(prm.clusterIrradiance(scene, *context_->tracer(), light), options))));
      container.scene.lights = light;
      errors["radiosity"].push_back(
          transport::compareWithReferences(truth, slotsOf(cli::evaluateRadiosityOnCpu({.container = *runtime_, .scene = container, .tracer = tracer, .threads = kThreads}))));
    }
    for (const auto& [section, of_lights] : errors) check(report, section, transport::medianError(of_lights));
  }

  void check(const Report& report, const std::string& section, const PooledError& truth) {
    const auto found = std::ranges::find_if(report.errors, [&](const auto& e) { return e.section() == section; });
    ASSERT_NE(found, report.errors.end()) << section;
    const v1::MeasuredError& e = *found;
    const auto note = [&](const char* name, double is, double value, double low, double high) {
      EXPECT_LE(low, high);
      tallies_[section + " " + name].add(is, low, high);
      if (std::getenv("LIGHTWELL_BAKES"))
        std::printf("seed %u %s %s: is %.4f, measured %.4f in [%.4f, %.4f]%s\n", unsigned(settings_.seed), section.c_str(), name, is, value, low, high, low <= is && is <= high ? "" : " MISSED");
    };
    note("relrmse", std::max(0.0, truth.relrmse), e.relrmse(), e.relrmse_low(), e.relrmse_high());
    note("texrel", std::max(0.0, truth.texrel), e.texrel(), e.texrel_low(), e.texrel_high());
    note("bias", truth.bias, e.bias(), e.bias_low(), e.bias_high());
    // Where a sample was measured, texels outside of it may be worse.
    const bool of_all = e.texels() == truth.texels;
    note("maximum", truth.maximum, e.maximum(), e.maximum_low(), of_all ? e.maximum_high() : std::max(e.maximum_high(), truth.maximum));
  }

  test::TemporaryFolder folder_;
  plan::Settings settings_;
  std::unique_ptr<cli::RuntimeContainer> runtime_;
  std::unique_ptr<BakeContext> context_;
  std::map<std::string, Tally> tallies_;  // by section and figure
};

TEST_F(MeasuredErrors, IntervalsHoldTheTruth) {
  const char* asked = std::getenv("LIGHTWELL_BAKES");
  const int bakes = asked ? std::atoi(asked) : 8;
  for (int i = 0; i < bakes; ++i) bakeRandomly(uint32_t(i), i % 4 == 3);
  Tally all;
  for (const auto& [name, tally] : tallies_) {
    std::printf("%-20s held %d of %d, mean width %.4f\n", name.c_str(), tally.held, tally.all, tally.width / tally.all);
    all.held += tally.held, all.all += tally.all;
    if (asked) {
      EXPECT_GE(tally.held, 0.9 * tally.all) << name;
    }
    // An interval that says nothing holds everything. Those of medians over lights are wide: lights differ.
    if (name.ends_with("relrmse")) {
      EXPECT_LT(tally.width, 8 * tally.size) << name;
    }
  }
  EXPECT_EQ(all.all, bakes * 8);
  EXPECT_GE(all.held, (asked ? 0.9 : 0.8) * all.all);
}

/// The bake has formulas of its own for what the runtime evaluates.
TEST(VirtualLightIrradiance, IsThatOfTheRuntime) {
  for (uint32_t n = 0; n < 4000; ++n) {
    Draw draw(n + 1000000);
    const auto direction = [&] {
      const float z = draw.between(-1, 1), phi = draw.between(0, 2 * kPi), r = std::sqrt(1 - z * z);
      return Vec3(r * std::cos(phi), r * std::sin(phi), z);
    };
    transport::VirtualLight light;
    light.type = transport::VirtualLightType(1 + n % 4);
    light.position = direction() * draw.between(0.2f, 3);
    light.normal = direction();
    light.power_rgb = Rgb(1, 2, 3);
    lw_virtual_light same{};
    std::vector<float> vertices;
    if (light.type == transport::VirtualLightType::polygon) {
      Vec3 tangent, bitangent;
      orthonormalBasis(light.normal, tangent, bitangent);
      const uint32_t corners = 3 + draw.below(6);
      const float size = draw.between(0.05f, 1.5f);
      for (uint32_t i = 0; i < corners; ++i) {
        const float angle = 2 * kPi * float(i) / float(corners);
        light.vertices.push_back(light.position + (tangent * std::cos(angle) + bitangent * std::sin(angle)) * size);
        for (int k = 0; k < 3; ++k) vertices.push_back(light.vertices.back()[k]);
      }
      same.area_m2 = float(corners) / 2 * size * size * std::sin(2 * kPi / float(corners));
      same.vertex_count = corners, same.vertices_m = vertices.data();
    } else if (light.type != transport::VirtualLightType::point) {
      light.radius = draw.between(0.02f, 0.8f);
      same.area_m2 = kPi * light.radius * light.radius;
    }
    same.type = uint32_t(light.type), same.radius_m = light.radius;
    for (int k = 0; k < 3; ++k) same.position_m[k] = light.position[k], same.normal[k] = light.normal[k], same.flux_rgb[k] = light.power_rgb[k];
    const Vec3 position = direction() * draw.between(0, 1), normal = direction();
    float expected_rgb[3];
    ASSERT_EQ(lw_virtual_light_irradiance(&same, &position.x, &normal.x, 0, expected_rgb), LW_OK);
    const double share = transport::irradianceShare(light, position, normal);
    EXPECT_NEAR(share, double(expected_rgb[0]), 2e-4 * double(expected_rgb[0]) + 2e-6) << n << ", type " << same.type;
    // Its points lie on it.
    const Vec3 point = transport::pointOnLight(light, Vec2(draw.between(0, 1), draw.between(0, 1))), offset = point - light.position;
    EXPECT_NEAR(offset.dot(light.normal), 0, 1e-5f);
    EXPECT_LE(offset.length(), (light.type == transport::VirtualLightType::polygon ? (light.vertices[0] - light.position).length() : light.radius) + 1e-5f);
  }
}

}  // namespace
}  // namespace lightwell::bake
