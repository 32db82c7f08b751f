// Doors in a radiosity bake: what rays meet, and form factors and links for every state of the doors.
#include <gtest/gtest.h>

#include <map>

#include "tests/transport/baked_doors.h"

namespace lightwell::transport {
namespace {

/// Small, for what does not depend on accuracy.
const Baked& oneDoor() {
  static const Baked baked(test::roomsInARow(), 256, 64);
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
    EXPECT_NEAR(shut, 1.0, 0.02) << b.result.patches.position[row] << b.result.patches.normal[row];
    EXPECT_NEAR(open, 1.0, 0.02) << b.result.patches.position[row] << b.result.patches.normal[row];
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

/// Wherever texels lie to the leaf: those that reach over from one side to the other receive the lamp's light on one.
TEST(Portals, NoTexelCarriesLightAcrossAShutDoor) {
  for (const int size : {40, 52, 60, 72})
    for (const float thickness : {0.0f, 0.02f}) {
      const Baked b(test::roomsInARow({.strips = 2, .thickness = thickness}), 64, size);
      const auto irradiance = b.indirect(kLamp, {0.0f});
      for (size_t slot = 0; slot < irradiance.size(); ++slot)
        if (test::roomOf(b.p.atlas.slots[slot].position) == 1) {
          ASSERT_EQ(irradiance[slot], Rgb(0.0f)) << size << ", leaf " << thickness;
        }
    }
}

/// Two rooms that see the same node, each another part of it.
TEST(Portals, NodesKeepToWhatIsConnectedWhenDoorsAreShut) {
  Patches patches;
  patches.area.assign(16, 1.0f);
  const PatchTree tree = makePatchTree(patches);
  FormFactors factors;
  const uint32_t through = factors.sets.number(std::vector<GateEntry>{openGate(0)});
  factors.own_gate.assign(16, kNoEntry);
  for (uint32_t row = 0; row < 16; ++row) {
    // Patches 0 to 3 and 8 to 11 are one room, the others the other; node 16 has four of each.
    for (uint32_t other = 0; other < 16; ++other)
      if (row / 8 != other / 8 && row / 4 % 2 == other / 4 % 2) {
        factors.patch.push_back(other);
        factors.set.push_back(0);
        factors.value.push_back(0.2f);
      }
    factors.patch.push_back(15 - row);
    factors.set.push_back(through);
    factors.value.push_back(0.1f);
    factors.first.push_back(factors.patch.size());
  }
  ASSERT_EQ(tree.nodeCount(), 18u);
  EXPECT_EQ(nodesThatSeeTheSame(factors, tree)[16], 0);
  for (uint32_t& set : factors.set) set = 0;
  EXPECT_EQ(nodesThatSeeTheSame(factors, tree)[16], 1) << "without a door there is one room";
  factors.own_gate[2] = closedGate(1);
  EXPECT_EQ(nodesThatSeeTheSame(factors, tree)[16], 0) << "a leaf's patch is there only while it is shut";
}

TEST(Portals, AnOpenDoorIsNoDoor) {
  const Baked b(test::roomsInARow(), 512, 96), without(test::roomsInARow({.leaves = false}), 512, 96);
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
    EXPECT_NEAR(sum[0] / area[0] / (sum[1] / area[1]), 1, 0.03) << "room " << room;
  }
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
