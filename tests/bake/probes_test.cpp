// Probes for moving objects, from the bake to what the runtime makes of them: closed rooms, path tracing at small free facets, walls that no light may pass.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "format/encode/verify.h"
#include "lightwell/lightwell.h"
#include "precompute/bake/sections.h"
#include "precompute/core/parallel.h"
#include "precompute/transport/reference/reference.h"
#include "tests/support/prepared_scene.h"
#include "tests/support/scenes.h"

namespace lightwell::bake {
namespace {

using transport::ProbeBaker;
using transport::ProbeSettings;
using transport::RadiosityBaker;

transport::RadiositySettings smallRadiosity() {
  transport::RadiositySettings settings;
  settings.rays = 512;
  settings.training_lights = 16;
  return settings;
}

ProbeSettings lattice(float spacing) {
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

Vec3 irradianceAbout(const float* sh, const Vec3& normal) {
  const float n[3] = {normal.x, normal.y, normal.z};
  float rgb[3];
  EXPECT_EQ(lw_sh_irradiance(reinterpret_cast<const float(*)[3]>(sh), n, rgb), LW_OK);
  return {rgb[0], rgb[1], rgb[2]};
}

/// A room with a solid box on its floor, whose bottom is left out, of walls in three colours.
void addRoomWithBox(test::SceneBuilder& builder) {
  scene::Material red = test::diffuse(0.6f), green = test::diffuse(0.6f);
  red.base_color = Rgb(0.6f, 0.1f, 0.1f), green.base_color = Rgb(0.1f, 0.5f, 0.1f);
  const uint32_t wall = builder.material(test::diffuse(0.7f)), left = builder.material(red), right = builder.material(green);
  const Vec3 low(-4, -3, -4), high(4, 3, 4), x(8, 0, 0), y(0, 6, 0), z(0, 0, 8);
  builder.quad(low, z, x, wall).quad(low + y, x, z, wall).quad(low, y, z, left).quad(low + x, z, y, right).quad(low, x, y, wall).quad(low + z, y, x, wall);
  const Vec3 bx(2.2f, 0, 0), by(0, 2.5f, 0), bz(0, 0, 2.2f), corner(-1.6f, -3, -1.2f);
  builder.quad(corner + by, bz, bx, wall);
  builder.quad(corner, bz, by, wall).quad(corner + bx, by, bz, wall).quad(corner, by, bx, wall).quad(corner + bz, bx, by, wall);
}
bool isInBox(const Vec3& v) { return v.x > -1.6f && v.x < 0.6f && v.y < -0.5f && v.z > -1.2f && v.z < 1.0f; }

TEST(Probes, AClosedRoomLooksTheSameFromAllSides) {
  for (const float albedo : {0.5f, 0.9f}) {
    BakedRoom room(test::closedBox({2, 1.5f, 3}, test::diffuse(albedo, 1.0f)), lattice(0.8f), 48);
    ASSERT_GT(room.info.probes, 50u);
    const auto sh = room.evaluate();
    const float exact = kPi / (1 - albedo);
    for (uint32_t i = 0; i < room.info.probes; ++i)
      for (int k = 0; k < 27; ++k) {
        const Vec3 way(float(k % 3 - 1), float(k / 3 % 3 - 1), float(k / 9 - 1));
        if (way.length2() == 0) continue;
        ASSERT_NEAR(irradianceAbout(&sh[i * 27], way).x / exact, 1, 0.01) << "probe " << i << ", albedo " << albedo;
      }
    // And between them.
    for (const Vec3& at : {Vec3(0.1f, 0.2f, 0.3f), Vec3(-1.9f, -1.4f, 2.9f), Vec3(1.99f, 0, 0)}) {
      float between[9][3];
      const float position[3] = {at.x, at.y, at.z};
      ASSERT_EQ(lw_probes_sample(room.loaded, sh.data(), position, between), LW_OK);
      EXPECT_NEAR(irradianceAbout(&between[0][0], {0, 1, 0}).x / exact, 1, 0.01);
    }
  }
}

TEST(Probes, TheirLightIsThatOfPathTracing) {
  test::SceneBuilder builder;
  addRoomWithBox(builder);
  ProbeSettings settings = lattice(0);
  settings.places.points = {{2.5f, 0.4f, 1}, {-2.9f, -1.1f, 2.2f}, {0, 1.7f, -3}, {-0.5f, 0.3f, 0}, {1.4f, -2.4f, 0.1f}, {3.4f, 2.2f, -3.2f}};
  BakedRoom room(builder.take(), settings, 96);
  const scene::Light lamp = test::pointLight({2, 1, -1}, 10);
  room.shine(lamp);
  const auto sh = room.evaluate();

  // The same room with six small black facets around each of these points.
  test::SceneBuilder with_facets;
  addRoomWithBox(with_facets);
  const uint32_t black = with_facets.material(test::diffuse(0));
  std::vector<Vec3> normals;
  const uint32_t first_facet = 11;
  constexpr float kHalf = 0.01f;
  for (const Vec3& point : settings.places.points)
    for (int side = 0; side < 6; ++side) {
      Vec3 n(0.0f), u(0.0f), v(0.0f);
      n[side / 2] = side % 2 ? -1.0f : 1.0f;
      u[(side / 2 + 1) % 3] = 2 * kHalf;
      v = n.cross(u);
      with_facets.quad(point + n * kHalf - (u + v) * 0.5f, u, v, black);
      normals.push_back(n);
    }
  scene::Scene scene = with_facets.take();
  atlas::Atlas atlas = test::quadAtlas(scene, 1);
  trace::Tracer tracer(scene, 1);
  std::vector<uint32_t> slots;
  for (uint32_t i = 0; i < normals.size(); ++i) slots.push_back(atlas.texel_slot[first_facet + i]);
  const auto reference = transport::referenceIrradianceOf(slots, scene, atlas, tracer, {lamp}, transport::Component::indirect, {.samples = 16384}).irradiance_rgb;
  double difference2 = 0, square = 0, sum = 0, exact = 0;
  for (size_t i = 0; i < slots.size(); ++i) {
    const Vec3 found = irradianceAbout(&sh[i / 6 * 27], normals[i]);
    difference2 += double((found - reference[i]).length2()), square += double(reference[i].length2());
    sum += luminance(found), exact += luminance(reference[i]);
  }
  RecordProperty("relrmse", std::to_string(std::sqrt(difference2 / square)));
  EXPECT_LT(std::sqrt(difference2 / square), 0.05);
  EXPECT_NEAR(sum / exact, 1, 0.02);
}

/// Two rooms side by side with nothing but a double-sided sheet in between, at x = 0.3.
scene::Scene twoRooms(bool solid) {
  test::SceneBuilder builder;
  scene::Material sheet = test::diffuse(0.5f);
  sheet.double_sided = true;
  const uint32_t wall = builder.material(test::diffuse(0.6f));
  if (solid) {
    builder.room({-4, -2, -3}, {0.28f, 2, 3}, wall).room({0.32f, -2, -3}, {4, 2, 3}, wall);
  } else {
    // Floors that end at the sheet: a patch of one floor under both rooms would take light through.
    for (const float begin : {-4.0f, 0.3f}) {
      const Vec3 low(begin, -2, -3), x(begin < 0 ? 4.3f : 3.7f, 0, 0), y(0, 4, 0), z(0, 0, 6);
      builder.quad(low, z, x, wall).quad(low + y, x, z, wall).quad(low, x, y, wall).quad(low + z, y, x, wall);
    }
    builder.quad({-4, -2, -3}, {0, 4, 0}, {0, 0, 6}, wall).quad({4, -2, -3}, {0, 0, 6}, {0, 4, 0}, wall);
    builder.quad({0.3f, -2, -3}, {0, 4, 0}, {0, 0, 6}, builder.material(sheet));
  }
  return builder.take();
}

TEST(Probes, NoLightComesThroughAThinWall) {
  for (const bool solid : {false, true}) {
    BakedRoom room(twoRooms(solid), lattice(1.1f));
    room.shine(test::pointLight({-2, 0, 0}, 1000));
    const auto sh = room.evaluate();
    // The size of what the lit room has.
    float lit[9][3];
    const float far[3] = {-2, 0, 0};
    ASSERT_EQ(lw_probes_sample(room.loaded, sh.data(), far, lit), LW_OK);
    ASSERT_GT(irradianceAbout(&lit[0][0], {0, 1, 0}).x, 10.0f);
    for (float gap : {0.04f, 0.1f, 0.3f, 0.6f, 1.0f, 2.0f})
      for (float y = -1.9f; y < 2; y += 0.38f)
        for (float z = -2.9f; z < 3; z += 0.29f) {
          float dark[9][3], bright[9][3];
          const float behind[3] = {0.3f + gap, y, z}, before[3] = {0.3f - gap, y, z};
          ASSERT_EQ(lw_probes_sample(room.loaded, sh.data(), behind, dark), LW_OK);
          ASSERT_LT(dark[0][0], 1e-3f * lit[0][0]) << (solid ? "solid" : "sheet") << " gap " << gap << " at " << y << ", " << z;
          ASSERT_EQ(lw_probes_sample(room.loaded, sh.data(), before, bright), LW_OK);
          ASSERT_GT(bright[0][0], 0.5f * lit[0][0]) << (solid ? "solid" : "sheet") << " gap " << gap << " at " << y << ", " << z;
        }
  }
}

TEST(Probes, StandInTheOpen) {
  test::SceneBuilder builder;
  addRoomWithBox(builder);
  BakedRoom room(builder.take(), lattice(0.7f));
  const transport::Probes& probes = room.probes.probes;
  EXPECT_GT(probes.inside, 5u);
  EXPECT_GT(probes.moved, 5u);
  EXPECT_EQ(probes.count() + probes.inside + probes.sealed, probes.lattice.size());
  for (uint32_t i = 0; i < probes.count(); ++i) {
    EXPECT_FALSE(isInBox(probes.position[i])) << i;
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(room.info.position_m[i * 3 + uint32_t(k)], probes.position[i][k], 1e-5);
  }
}

TEST(Probes, SealedPocketsHaveNone) {
  test::SceneBuilder builder;
  const uint32_t wall = builder.material(test::diffuse(0.5f));
  builder.room({-4, -3, -4}, {4, 3, 4}, wall).room({1.02f, -0.98f, 1.02f}, {1.98f, 0.98f, 1.98f}, wall);
  // The pocket's outside.
  const Vec3 low(1, -1, 1), x(1, 0, 0), y(0, 2, 0), z(0, 0, 1);
  builder.quad(low, x, z, wall).quad(low + y, z, x, wall).quad(low, z, y, wall).quad(low + x, y, z, wall).quad(low, y, x, wall).quad(low + z, x, y, wall);
  BakedRoom room(builder.take(), lattice(0.8f));
  EXPECT_GT(room.probes.probes.sealed, 0u);
  for (const Vec3& v : room.probes.probes.position) EXPECT_FALSE(v.x > 1 && v.x < 2 && std::abs(v.y) < 1 && v.z > 1 && v.z < 2);
}

TEST(Probes, BytesDependNeitherOnThreadsNorOnHowTheyAreCut) {
  test::SceneBuilder a, b;
  addRoomWithBox(a), addRoomWithBox(b);
  ProbeSettings settings = lattice(1.3f);
  settings.links.rays = 256;
  BakedRoom one(a.take(), settings, 32, 17, 1), other(b.take(), settings, 32, 200, 3);
  EXPECT_EQ(one.places, other.places);
  EXPECT_EQ(one.file, other.file);
  EXPECT_TRUE(format::verify(format::memorySource(one.file.data(), one.file.size())).empty());
}

TEST(Probes, TheAutomaticLatticeKeepsToItsBudget) {
  for (const Vec3& half : {Vec3(4, 3, 5), Vec3(60, 2, 40), Vec3(5, 0, 5), Vec3(0.1f, 50, 0.1f)}) {
    const transport::ProbeLattice lattice = transport::makeProbeLattice(Box3(-half, half), {.budget = 1000}, 1);
    EXPECT_LE(lattice.size(), 1000u);
    EXPECT_GT(lattice.size(), 400u);
    for (int k = 0; k < 3; ++k) EXPECT_LE(std::abs(lattice.first[k] + half[k] - 0.5f * lattice.spacing), 0.51f * lattice.spacing);
  }
  EXPECT_EQ(transport::makeProbeLattice(Box3({-1, -1, -1}, {1, 1, 1}), {}, 1).size(), 0u);
  EXPECT_THROW(transport::makeProbeLattice(Box3({-1, -1, -1}, {1, 1, 1}), {.spacing = 1e-4f}, 1), UsageError);
}

}  // namespace
}  // namespace lightwell::bake
