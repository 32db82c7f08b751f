// Doors in a radiosity bake: what rays meet, form factors for every state of the doors, and their solution against path tracing.
#include <gtest/gtest.h>

#include <map>

#include "precompute/core/parallel.h"
#include "precompute/transport/pooled_error.h"
#include "precompute/transport/radiosity/bake_radiosity.h"
#include "precompute/transport/radiosity/solve.h"
#include "precompute/transport/reference/reference.h"
#include "tests/support/door_scenes.h"
#include "tests/support/prepared_scene.h"

namespace lightwell::transport {
namespace {

using Prepared = test::PreparedScene;

/// A baked scene with everything that solving it takes.
struct Baked {
  Prepared p;
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
    const auto stage = [&](uint32_t count, auto function) {
      std::vector<Bytes> parts((count + grain - 1) / grain);
      parallelFor(parts.size(), 1, threads, nullptr, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) parts[i] = function(uint32_t(i * grain), std::min(count, uint32_t((i + 1) * grain)));
      });
      return parts;
    };
    const auto views = [](const std::vector<Bytes>& parts) { return std::vector<ByteView>(parts.begin(), parts.end()); };
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

const scene::Light kLamp = test::pointLight({1.2f, 2.2f, -0.8f}, 20);

const Baked& oneDoor() {
  static const Baked baked(test::roomsInARow());
  return baked;
}

/// Sum of a row with all portals shut or open.
double sumOf(const FormFactors& factors, uint32_t row, GateClass state) {
  double sum = 0;
  for (uint64_t i = factors.first[row]; i < factors.first[row + 1]; ++i)
    if (const GateClass c = factors.sets.classOf(factors.setOf(i)); c == GateClass::always || c == state) sum += factors.value[i];
  return sum;
}

TEST(Portals, RaysEndOnceInEveryState) {
  const Baked& b = oneDoor();
  // From the middle of the first room through the door: the leaf's strip while it is shut, the other room's far wall while it is open.
  const trace::Ray ray{.origin = {1.5f, 1.1f, 0.07f}, .direction = {1, 0, 0}};
  GateSets sets;
  std::vector<GatedHit> hits;
  b.baker->tracer().trace({&ray, 1}, kNone, sets, hits);
  ASSERT_EQ(hits.size(), 2u);
  const uint32_t gate = b.p.scene.portals[0].strip({3.7f, 1.1f, 0.07f});
  ASSERT_EQ(sets[hits[0].set].size(), 1u);
  EXPECT_EQ(sets[hits[0].set][0], closedGate(gate));
  ASSERT_EQ(sets[hits[1].set].size(), 1u) << "the leaf's other face is no gate of its own";
  EXPECT_EQ(sets[hits[1].set][0], openGate(gate));
  EXPECT_NEAR(b.result.patches.position[hits[0].patch].x, test::kRoomLength + 0.2f, 1e-3);
  EXPECT_NEAR(b.result.patches.position[hits[1].patch].x, 2 * test::kRoomLength + test::kWallThickness, 1e-3);
  // Askew through the leaf, in at one strip and out at the next.
  const trace::Ray askew{.origin = {3.0f, 1.1f, -0.45f}, .direction = Vec3(1, 0, 1).normalized()};
  b.baker->tracer().trace({&askew, 1}, kNone, sets, hits);
  ASSERT_EQ(hits.size(), 2u) << "inside, the leaf's other face absorbs";
  EXPECT_EQ(sets[hits[1].set].size(), 2u);
}

TEST(Portals, RowsFillTheHemisphereWithDoorsShutAndOpen) {
  const Baked& b = oneDoor();
  const FormFactors& factors = b.trained.factors;
  double most_shut = 0, most_open = 0, area = 0, mean_shut = 0, mean_open = 0;
  for (uint32_t row = 0; row < factors.rows(); ++row) {
    const double shut = sumOf(factors, row, GateClass::closed), open = sumOf(factors, row, GateClass::open);
    most_shut = std::max(most_shut, shut), most_open = std::max(most_open, open);
    const double weight = b.result.patches.area[row];
    area += weight, mean_shut += weight * shut, mean_open += weight * open;
    // Away from the door every ray ends on something.
    if (std::abs(b.result.patches.position[row].x - 3.75f) < 0.5f) continue;
    EXPECT_NEAR(shut, 1.0, 0.01) << b.result.patches.position[row] << b.result.patches.normal[row];
    EXPECT_NEAR(open, 1.0, 0.01) << b.result.patches.position[row] << b.result.patches.normal[row];
  }
  EXPECT_LE(most_shut, 1 + 1e-5);
  EXPECT_LE(most_open, 1 + 1e-5);
  EXPECT_NEAR(mean_open / area, 1, 0.01);
  EXPECT_NEAR(mean_shut / area, 1, 0.03) << "what lies right under the leaf has no light while it is shut";
}

TEST(Portals, ExchangesAreReciprocalInEverySet) {
  const Baked& b = oneDoor();
  const FormFactors& factors = b.trained.factors;
  // Area times form factor by pair and exchange set, without a leaf's own gate: that one is known from its zone.
  std::map<std::tuple<uint32_t, uint32_t, std::vector<GateEntry>>, std::array<double, 2>> exchange;
  double total = 0;
  for (uint32_t row = 0; row < factors.rows(); ++row)
    for (uint64_t i = factors.first[row]; i < factors.first[row + 1]; ++i) {
      const uint32_t other = factors.patch[i];
      std::vector<GateEntry> set;
      for (const GateEntry entry : factors.sets[factors.setOf(i)])
        if (!isClosed(entry)) set.push_back(entry);
      const double amount = double(b.result.patches.area[row]) * factors.value[i];
      exchange[{std::min(row, other), std::max(row, other), set}][row < other] += amount;
      total += amount;
    }
  double difference = 0;
  for (const auto& [key, amounts] : exchange)
    if (std::get<0>(key) != std::get<1>(key)) difference += std::abs(amounts[0] - amounts[1]);
  EXPECT_LT(difference / total, 0.005);
}

TEST(Portals, NothingLeadsAcrossAShutDoor) {
  const Baked& b = oneDoor();
  const auto& links = b.result.links;
  const auto& patches = b.result.patches;
  const auto behind = [&](uint32_t patch) { return patches.position[patch].x > 3.75f; };
  bool through = false;
  for (uint32_t row = 0; row < links.rows(); ++row)
    for (uint32_t l = links.first[row]; l < links.first[row + 1]; ++l)
      for (uint32_t i = b.result.tree.first_patch[links.node[l]]; i < b.result.tree.end_patch[links.node[l]]; ++i) {
        if (patches.zone[row].kind == PortalZone::threshold || patches.zone[i].kind == PortalZone::threshold || behind(row) == behind(i)) continue;
        const auto set = links.sets[links.set[l]];
        ASSERT_TRUE(std::any_of(set.begin(), set.end(), [](GateEntry e) { return !isClosed(e); }))
            << patches.position[row] << patches.normal[row] << " from " << patches.position[i] << patches.normal[i];
        through = true;
      }
  EXPECT_TRUE(through);
  const auto irradiance = b.indirect(kLamp, {0.0f});
  double lit = 0;
  for (size_t slot = 0; slot < irradiance.size(); ++slot) {
    const int room = test::roomOf(b.p.atlas.slots[slot].position);
    if (room == 1) {
      ASSERT_EQ(irradiance[slot], Rgb(0.0f)) << "texel " << b.p.atlas.slots[slot].texel;
    }
    if (room == 0) lit += double(irradiance[slot].x);
  }
  EXPECT_GT(lit, 0);
}

TEST(Portals, LightIsThatOfPathTracingHoweverFarTheDoorIsOpen) {
  const Baked& b = oneDoor();
  for (const float open : {0.0f, 0.5f, 0.7f, 1.0f}) {
    const auto references = b.reference(kLamp, {open}, open > 0 ? 256 : 64);
    const auto candidate = b.indirect(kLamp, {open});
    const PooledError everywhere = b.error(references, candidate, -1);
    EXPECT_LT(everywhere.relrmse, 0.05) << "open " << open;
    EXPECT_NEAR(everywhere.bias, 0, 0.015) << "open " << open;
    if (open == 0) continue;
    const PooledError dark = b.error(references, candidate, 1);
    EXPECT_LT(dark.relrmse, 0.05) << "open " << open;
    EXPECT_NEAR(dark.bias, 0, 0.03) << "open " << open;
  }
}

TEST(Portals, AnOpenDoorIsNoDoor) {
  const Baked& b = oneDoor();
  const Baked without(test::roomsInARow({.leaves = false}));
  const auto open = b.indirect(kLamp, {1.0f}), none = without.indirect(kLamp, {});
  // Atlases differ: compared by means of rooms.
  for (const int room : {0, 1}) {
    double sum[2] = {}, area[2] = {};
    for (const Baked* scene : {&b, &without})
      for (size_t slot = 0; slot < scene->p.atlas.slots.size(); ++slot) {
        const atlas::Slot& s = scene->p.atlas.slots[slot];
        if (scene->isOnLeaf(s) || test::roomOf(s.position) != room) continue;
        sum[scene == &b] += double((scene == &b ? open : none)[slot].x) * s.area;
        area[scene == &b] += s.area;
      }
    EXPECT_NEAR(sum[0] / area[0] / (sum[1] / area[1]), 1, 0.02) << "room " << room;
  }
}

TEST(Portals, DoorsInARowMultiply) {
  const Baked b(test::roomsInARow({.doors = 2, .strips = 3}), 512, 128);
  const auto sumOfRoom = [&](const std::vector<float>& open, int room) {
    const auto irradiance = b.indirect(kLamp, open);
    double sum = 0;
    for (size_t slot = 0; slot < irradiance.size(); ++slot)
      if (test::roomOf(b.p.atlas.slots[slot].position) == room) sum += double(irradiance[slot].x);
    return sum;
  };
  EXPECT_EQ(sumOfRoom({0, 1}, 2), 0);
  EXPECT_EQ(sumOfRoom({1, 0}, 2), 0);
  EXPECT_GT(sumOfRoom({1, 0}, 1), 0);
  const std::vector<float> half = {0.5f, 0.6f};
  const auto references = b.reference(kLamp, half, 512);
  EXPECT_LT(b.error(references, b.indirect(kLamp, half), -1).relrmse, 0.05);
  EXPECT_NEAR(b.error(references, b.indirect(kLamp, half), 2).bias, 0, 0.1);
}

TEST(Portals, SheetsAreDoorsToo) {
  const Baked b(test::roomsInARow({.strips = 4, .thickness = 0}));
  const auto shut = b.indirect(kLamp, {0.0f});
  for (size_t slot = 0; slot < shut.size(); ++slot)
    if (test::roomOf(b.p.atlas.slots[slot].position) == 1) {
      ASSERT_EQ(shut[slot], Rgb(0.0f)) << "texel " << b.p.atlas.slots[slot].texel;
    }
  const auto references = b.reference(kLamp, {0.75f}, 256);
  EXPECT_LT(b.error(references, b.indirect(kLamp, {0.75f}), 1).relrmse, 0.05);
}

TEST(Portals, RoundingKeepsTheSumsOfSets) {
  const Baked& b = oneDoor();
  const auto& links = b.result.links;
  for (uint32_t row = 0; row < links.rows(); ++row)
    for (const GateClass state : {GateClass::closed, GateClass::open}) {
      double sum = 0;
      for (uint32_t l = links.first[row]; l < links.first[row + 1]; ++l)
        if (const GateClass c = links.sets.classOf(links.set[l]); c == GateClass::always || c == state) sum += double(linkWeight(links.code[l])) * links.row_scale[row];
      const double exact = sumOf(b.trained.factors, row, state);
      ASSERT_NEAR(sum, exact, 2e-3) << "row " << row;
      ASSERT_LE(sum, exact + 1e-5) << "row " << row;
    }
}

TEST(Portals, StagesDependNeitherOnThreadsNorOnHowTheyAreCut) {
  const auto scene = test::roomsInARow({.doors = 2, .strips = 2});
  const Baked a(scene, 64, 48, 17, 1), b(scene, 64, 48, 256, 3);
  EXPECT_EQ(a.result.links.first, b.result.links.first);
  EXPECT_EQ(a.result.links.node, b.result.links.node);
  EXPECT_EQ(a.result.links.set, b.result.links.set);
  EXPECT_EQ(a.result.links.sets.entries(), b.result.links.sets.entries());
  EXPECT_EQ(a.result.links.code, b.result.links.code);
  EXPECT_EQ(a.result.links.row_scale, b.result.links.row_scale);
}

}  // namespace
}  // namespace lightwell::transport
