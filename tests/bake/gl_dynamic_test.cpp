// Virtual lights of lamps that move, on OpenGL: their power, their places, their shadows, and what they leave behind.
#include <gmock/gmock.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "lightwell/lightwell_gl_dynamic.h"
#include "precompute/bake/sections.h"
#include "precompute/core/random.h"
#include "tests/runtime/gl_test.h"
#include "tests/support/prepared_scene.h"
#include "tests/support/scenes.h"

namespace lightwell::bake {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr float kAlbedo = 0.5f;
constexpr double kReflected = 0.5027;  // of it, in eight bits of sRGB and as a half

struct Room {
  test::PreparedScene p;
  std::vector<uint8_t> file;
  lw_container* container = nullptr;

  explicit Room(scene::Scene scene, uint32_t points = 16384, int size = 64) : p(std::move(scene), size) {
    format::Writer writer;
    addSceneSection(writer, p.scene);
    addGeometrySection(writer, p.scene, p.atlas);
    addAtlasSection(writer, p.atlas);
    if (points) addPointsSection(writer, transport::spreadPoints(p.scene, p.atlas, points, 1), p.scene);
    file = writer.bytes();
    EXPECT_EQ(lw_open_memory(file.data(), file.size(), nullptr, &container), LW_OK);
  }
  ~Room() { lw_close(container); }
  Room(const Room&) = delete;
  Room& operator=(const Room&) = delete;
};

/// 4 × 3 × 4 m with the given albedo; with a wall across it at x = 0, which leaves a room on either side.
scene::Scene box(float albedo = kAlbedo, bool wall = false) {
  test::SceneBuilder builder;
  const uint32_t material = builder.material(test::diffuse(albedo));
  builder.room({-2, 0, -2}, {2, 3, 2}, material);
  if (wall) builder.quad({-0.05f, 0, -2}, {0, 0, 4}, {0, 3, 0}, material).quad({0.05f, 0, -2}, {0, 3, 0}, {0, 0, 4}, material);
  return builder.take();
}
/// With a table of four quads in it.
scene::Scene furnished() {
  test::SceneBuilder builder;
  const uint32_t material = builder.material(test::diffuse(kAlbedo));
  builder.room({-2, 0, -2}, {2, 3, 2}, material);
  const auto block = [&](const Vec3& low, const Vec3& high) {
    const Vec3 x(high.x - low.x, 0, 0), y(0, high.y - low.y, 0), z(0, 0, high.z - low.z);
    builder.quad(low + y, z, x, material).quad(low, z, y, material).quad(low + x, y, z, material).quad(low, y, x, material).quad(low + z, x, y, material);
  };
  block({-1.2f, 0, -1.0f}, {-0.3f, 1.5f, 0});
  block({0.4f, 0, 0.2f}, {1.3f, 0.9f, 1.2f});
  return builder.take();
}

lw_light pointLight(float x, float y, float z, float candela = 10) {
  lw_light light{};
  light.type = LW_LIGHT_POINT;
  light.position_m[0] = x, light.position_m[1] = y, light.position_m[2] = z;
  light.direction[1] = -1;
  for (int k = 0; k < 3; ++k) light.intensity_rgb[k] = candela * float(k + 1);
  return light;
}
lw_light spotLight(float inner, float outer) {
  lw_light light = pointLight(0.3f, 2.2f, -0.2f);
  light.type = LW_LIGHT_SPOT;
  light.direction[0] = 0.2f;
  light.inner_cone_angle_rad = inner, light.outer_cone_angle_rad = outer;
  return light;
}

struct Destroy {
  void operator()(lw_gl_dynamic* scene) const { lw_gl_dynamic_destroy(scene); }
  void operator()(lw_gl_lamp* lamp) const { lw_gl_lamp_destroy(lamp); }
};
using Scene = std::unique_ptr<lw_gl_dynamic, Destroy>;
using Lamp = std::unique_ptr<lw_gl_lamp, Destroy>;

class GlDynamic : public testing::TestWithParam<test::Api> {
 protected:
  GlDynamic() : context(GetParam()) {}
  void SetUp() override { ASSERT_TRUE(context.good()) << "no surfaceless EGL context"; }
  void TearDown() override { EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR)); }

  Scene upload(const Room& room) {
    lw_gl_config config = LW_GL_CONFIG_INIT;
    config.loader = test::GlContext::load;
    config.message = [](void* user, lw_result, const char* text) { *static_cast<std::string*>(user) = text; };
    config.message_user = &message;
    lw_gl_dynamic_options options = LW_GL_DYNAMIC_OPTIONS_INIT;
    options.atlas_format = LW_GL_ATLAS_RGBA32F;
    options.fill = 0;
    lw_gl_dynamic* scene = nullptr;
    EXPECT_EQ(lw_gl_dynamic_create(&config, room.container, &options, &scene), LW_OK) << message;
    return Scene(scene);
  }
  Lamp lampOf(const Scene& scene, lw_gl_lamp_options options) {
    lw_gl_lamp* lamp = nullptr;
    EXPECT_EQ(lw_gl_lamp_create(scene.get(), &options, &lamp), LW_OK) << message;
    return Lamp(lamp);
  }
  static lw_gl_lamp_options options(bool incremental, uint32_t lights = 256, uint32_t shadow_side = 0) {
    lw_gl_lamp_options o = LW_GL_LAMP_OPTIONS_INIT;
    o.incremental = incremental, o.lights = lights, o.shadow_side = shadow_side, o.most_updates = 8;
    return o;
  }
  lw_gl_lamp_work shine(const Lamp& lamp, const lw_light& light) {
    lw_gl_lamp_work work{};
    EXPECT_EQ(lw_gl_lamp_update(lamp.get(), &light, &work), LW_OK) << message;
    return work;
  }
  static std::vector<lw_virtual_light> lightsOf(const Lamp& lamp, uint32_t count) {
    std::vector<lw_virtual_light> lights(count);
    EXPECT_EQ(lw_gl_lamp_read_lights(lamp.get(), lights.data()), LW_OK);
    return lights;
  }
  static double power(const std::vector<lw_virtual_light>& lights, int channel = 0) {
    double sum = 0;
    for (const auto& light : lights) sum += double(light.flux_rgb[channel]);
    return sum;
  }
  std::vector<float> gather(const Room& room, const Scene& scene, const std::vector<lw_gl_lamp*>& lamps, float softness = 0.25f) {
    lw_gl_gathering gathering = LW_GL_GATHERING_INIT;
    gathering.softness = softness;
    EXPECT_EQ(lw_gl_dynamic_gather(scene.get(), lamps.data(), uint32_t(lamps.size()), &gathering), LW_OK) << message;
    std::vector<float> rgba(room.p.atlas.texel_slot.size() * 4);
    EXPECT_EQ(lw_gl_dynamic_read_atlas(scene.get(), rgba.data()), LW_OK);
    for (const float v : rgba) EXPECT_TRUE(v >= 0 && v < 1e31f);
    return rgba;
  }
  /// Mean by area of the red channel, over the slots that count.
  template <class Counts>
  static double mean(const Room& room, const std::vector<float>& rgba, Counts counts) {
    double sum = 0, area = 0;
    for (const atlas::Slot& slot : room.p.atlas.slots)
      if (counts(slot)) sum += double(rgba[size_t(slot.texel) * 4]) * double(slot.area), area += double(slot.area);
    return sum / area;
  }

  test::GlContext context;
  std::string message;
};

TEST_P(GlDynamic, LightsHaveThePowerThatTheRoomReflects) {
  const Room room(box());
  const Scene scene = upload(room);
  for (const bool incremental : {false, true})
    for (const auto& [light, lumen] : {std::pair{pointLight(0.3f, 1.2f, -0.7f), 4 * kPi}, {spotLight(0.3f, 0.6f), 2 * kPi * (1 - std::cos(0.3) + (std::cos(0.3) - std::cos(0.6)) / 3)},
                                       {spotLight(0.2f, 1.4f), 2 * kPi * (1 - std::cos(0.2) + (std::cos(0.2) - std::cos(1.4)) / 3)}}) {
      const Lamp lamp = lampOf(scene, options(incremental));
      shine(lamp, light);
      const auto lights = lightsOf(lamp, 256);
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(power(lights, k) / (10 * (k + 1) * lumen * kReflected), 1, 0.002) << light.type << incremental << light.outer_cone_angle_rad;
      // Each point for its share of the surface.
      double area = 0;
      for (const auto& l : lights) area += double(l.area_m2);
      EXPECT_TRUE(light.type != LW_LIGHT_POINT || std::abs(area / 80 - 1) < (incremental ? 0.01 : 0.25)) << area;
    }
}

TEST_P(GlDynamic, ASunLightsTheFloorThatIsOpenToIt) {
  test::SceneBuilder builder;
  const uint32_t material = builder.material(test::diffuse(kAlbedo));
  builder.quad({-2, 0, -1}, {0, 0, 2}, {4, 0, 0}, material);
  const Room room(builder.take());
  const Scene scene = upload(room);
  lw_light sun = pointLight(0, 0, 0, 3);
  sun.type = LW_LIGHT_DIRECTIONAL;
  sun.direction[0] = 0.5f;
  for (const bool incremental : {false, true}) {
    const Lamp lamp = lampOf(scene, options(incremental));
    shine(lamp, sun);
    EXPECT_NEAR(power(lightsOf(lamp, 256)) / (8 * 3 * kReflected / std::sqrt(1.25)), 1, 0.02) << incremental;
    for (int i = 0; i < 6; ++i) shine(lamp, sun);
    EXPECT_NEAR(power(lightsOf(lamp, 256)) / (8 * 3 * kReflected / std::sqrt(1.25)), 1, 0.02) << incremental;
  }
}

TEST_P(GlDynamic, LightsByFluxAllGiveTheSame) {
  const Room room(box());
  const Scene scene = upload(room);
  const Lamp lamp = lampOf(scene, options(false));
  shine(lamp, pointLight(1.2f, 0.6f, 0.4f));
  for (const auto& light : lightsOf(lamp, 256)) ASSERT_NEAR(double(light.flux_rgb[0]) * 256 / (4 * kPi * 10 * kReflected), 1, 0.01);
}

TEST_P(GlDynamic, AllOfTheReflectedLightArrives) {
  const Room room(box());
  const Scene scene = upload(room);
  for (const bool incremental : {false, true})
    for (const uint32_t side : {0u, 32u}) {
      const Lamp lamp = lampOf(scene, options(incremental, 256, side));
      shine(lamp, pointLight(0.3f, 1.2f, -0.7f));
      // In a closed room of 80 m², less what soft lights lose in corners.
      const double expected = 4 * kPi * 10 * kReflected / 80, found = mean(room, gather(room, scene, {lamp.get()}), [](const auto&) { return true; });
      std::printf("%s, maps of %u: %.3f\n", incremental ? "incremental" : "by flux", side, found / expected);
      EXPECT_NEAR(found / expected, 0.96, 0.04) << incremental << " " << side;
    }
}

TEST_P(GlDynamic, NothingGetsThroughAWall) {
  const Room room(box(kAlbedo, true));
  const Scene scene = upload(room);
  const float metres = float(room.p.scene.metres_per_unit);
  for (const bool incremental : {false, true}) {
    const Lamp lamp = lampOf(scene, options(incremental, 256, 32));
    shine(lamp, pointLight(-1, 1.5f, 0.3f));
    for (const auto& light : lightsOf(lamp, 256)) ASSERT_LE(light.position_m[0], 0.0f);
    const auto rgba = gather(room, scene, {lamp.get()});
    const double lit = mean(room, rgba, [&](const auto& s) { return s.position.x * metres < -0.04f; }), dark = mean(room, rgba, [&](const auto& s) { return s.position.x * metres > 0.04f && room.p.atlas.source[s.texel] == s.texel; });
    const double behind = mean(room, rgba, [&](const auto& s) { return s.position.x * metres > 0.5f; });
    std::printf("behind the wall: %.2f %% of the light before it, half a metre behind %.2f %%\n", 100 * dark / lit, 100 * behind / lit);
    EXPECT_LT(behind, 0.025 * lit);
    EXPECT_LT(dark, 0.04 * lit) << "what a map of 32² cannot tell from its own surface";
  }
}

TEST_P(GlDynamic, IncrementalLightsStayWithinTheirBudgetAndInSight) {
  const Room room(furnished());
  const Scene scene = upload(room);
  const Lamp lamp = lampOf(scene, options(true, 256, 16));
  EXPECT_EQ(shine(lamp, pointLight(-1.5f, 2.2f, 1.5f)).updated, 256u);
  uint32_t moved = 0;
  for (int frame = 0; frame < 40; ++frame) {
    const lw_light light = pointLight(-1.5f + 0.075f * float(frame), 2.2f, 1.5f);
    const lw_gl_lamp_work work = shine(lamp, light);
    ASSERT_LE(work.updated, 8u);
    ASSERT_EQ(work.points, uint64_t(work.updated) * 4096);
    moved += work.updated;
    if (frame % 10 != 9) continue;
    // What shines is seen by the lamp.
    uint32_t hidden = 0, shining = 0;
    const float metres = float(room.p.scene.metres_per_unit);
    for (const auto& v : lightsOf(lamp, 256)) {
      if (!(v.flux_rgb[0] > 0)) continue;
      ++shining;
      const Vec3 normal(v.normal[0], v.normal[1], v.normal[2]), at = Vec3(v.position_m[0], v.position_m[1], v.position_m[2]) / metres + normal * 0.01f;
      const Vec3 to_lamp = Vec3(light.position_m[0], light.position_m[1], light.position_m[2]) / metres - at;
      const trace::Ray ray{.origin = at, .direction = to_lamp, .t_max = 1};
      float passed = 0;
      room.p.tracer->transmittance({&ray, 1}, {&passed, 1});
      hidden += passed < 0.5f;
    }
    EXPECT_GT(shining, 200u);
    EXPECT_LE(hidden, shining / 50);
  }
  EXPECT_GT(moved, 20u) << "the lamp went past things";
  // A lamp that stands still comes to rest.
  uint32_t updated = 0;
  for (int i = 0; i < 40; ++i) updated = shine(lamp, pointLight(1.425f, 2.2f, 1.5f)).updated;
  EXPECT_EQ(updated, 0u);
  lw_gl_lamp_reset(lamp.get());
  EXPECT_EQ(shine(lamp, pointLight(0, 2.2f, 0)).updated, 256u);
}

TEST_P(GlDynamic, LateAnswersGiveTheSameLightWhenNothingMoves) {
  const Room room(furnished());
  const Scene scene = upload(room);
  std::vector<std::vector<float>> seen;
  for (const uint32_t late : {0u, 1u}) {
    lw_gl_lamp_options o = options(true, 128, 16);
    o.late = late, o.most_updates = 128;
    const Lamp lamp = lampOf(scene, o);
    for (int i = 0; i < 40; ++i) ASSERT_LE(shine(lamp, pointLight(-1.5f + 0.02f * float(i), 2.2f, 1.5f)).updated, 128u);
    for (int i = 0; i < 20; ++i) shine(lamp, pointLight(-0.7f, 2.2f, 1.5f));
    seen.push_back(gather(room, scene, {lamp.get()}));
  }
  EXPECT_LT(test::relrmse(seen[1], seen[0]), 0.1);
}

TEST_P(GlDynamic, ShadowMapsAreRarelyWrong) {
  const Room room(furnished());
  const Scene scene = upload(room);
  const float metres = float(room.p.scene.metres_per_unit);
  for (const uint32_t side : {16u, 32u, 64u}) {
    const Lamp lamp = lampOf(scene, options(false, 256, side));
    shine(lamp, pointLight(-0.4f, 2.2f, 0.9f));
    const auto lights = lightsOf(lamp, 256);
    std::vector<float> visibility(256);
    double wrong = 0, all = 0, leaks = 0, hidden = 0;
    for (size_t i = 0; i < room.p.atlas.slots.size(); i += 23) {
      const atlas::Slot& slot = room.p.atlas.slots[i];
      if (room.p.atlas.source[slot.texel] != slot.texel) continue;
      const Vec3 at_m = slot.position * metres;
      ASSERT_EQ(lw_gl_lamp_read_visibility(lamp.get(), &at_m.x, &slot.normal.x, visibility.data()), LW_OK);
      for (size_t l = 0; l < lights.size(); ++l) {
        const Vec3 normal(lights[l].normal[0], lights[l].normal[1], lights[l].normal[2]), from = Vec3(lights[l].position_m[0], lights[l].position_m[1], lights[l].position_m[2]) / metres;
        const Vec3 offset = slot.position - from;
        const float weight = std::max(offset.dot(normal), 0.0f) * std::max(-offset.dot(slot.normal), 0.0f);  // times distance⁴: what is near counts less than it would
        if (!(weight > 0.01f * offset.length2())) continue;
        const Vec3 origin = trace::Tracer::offsetOrigin(from, normal, offset), end = trace::Tracer::offsetOrigin(slot.position, slot.normal, -offset);
        const trace::Ray ray{.origin = origin, .direction = end - origin, .t_max = 1};
        float passed = 0;
        room.p.tracer->transmittance({&ray, 1}, {&passed, 1});
        const double form = double(weight) / std::pow(double(offset.length2()), 2);
        const double share = std::min(form, 1.0);
        wrong += share * std::abs(double(passed) - double(visibility[l]));
        leaks += share * std::max(double(visibility[l]) - double(passed), 0.0);
        hidden += share * (1 - double(passed));
        all += share;
      }
    }
    std::printf("maps of %u²: %.1f %% of the light is decided wrongly, %.1f %% leaks; %.1f %% is hidden\n", side, 100 * wrong / all, 100 * leaks / all, 100 * hidden / all);
    EXPECT_LT(wrong / all, side == 16 ? 0.1 : 0.06) << side;
    EXPECT_GT(hidden / all, 0.05);
  }
}

TEST_P(GlDynamic, MapsHaveNoHoles) {
  if (GetParam() != test::Api::desktop33) GTEST_SKIP() << "textures are read with glGetTexImage";
  const Room room(box(), 512);  // far fewer than texels
  const Scene scene = upload(room);
  const Lamp lamp = lampOf(scene, options(false, 16, 64));
  shine(lamp, pointLight(0.3f, 1.2f, -0.7f));
  lw_gl_lamp_lookup_values values;
  ASSERT_EQ(lw_gl_lamp_lookup(lamp.get(), nullptr, &values), LW_OK);
  std::vector<float> map(256 * 256);
  glBindTexture(GL_TEXTURE_2D, values.shadow_texture);
  glGetTexImage(GL_TEXTURE_2D, 0, GL_RED, GL_FLOAT, map.data());
  glBindTexture(GL_TEXTURE_2D, 0);
  for (const float distance_m : map) ASSERT_TRUE(distance_m > 0 && distance_m < 7) << distance_m;
}

TEST_P(GlDynamic, TwoLampsAddUpAndLampsWithoutAnUpdateAreDark) {
  const Room room(box());
  const Scene scene = upload(room);
  const Lamp a = lampOf(scene, options(false)), b = lampOf(scene, options(true)), idle = lampOf(scene, options(true));
  shine(a, pointLight(0.3f, 1.2f, -0.7f));
  shine(b, spotLight(0.2f, 0.7f));
  const auto of_a = gather(room, scene, {a.get()}), of_b = gather(room, scene, {b.get()}), both = gather(room, scene, {a.get(), b.get(), idle.get()});
  for (size_t i = 0; i < both.size(); ++i)
    ASSERT_TRUE(i % 4 == 3 || std::abs(both[i] - of_a[i] - of_b[i]) <= 1e-4f * (both[i] + 1e-3f)) << i;
}

TEST_P(GlDynamic, ExtremesStayFinite) {
  for (const float albedo : {0.0f, 0.999f}) {
    const Room room(box(albedo));
    const Scene scene = upload(room);
    for (const bool incremental : {false, true}) {
      const Lamp lamp = lampOf(scene, options(incremental, 64, 16));
      for (const lw_light& light : {pointLight(0, 0, 0), pointLight(-2, 1, 1), pointLight(2.0f, 3.0f, 2.0f), pointLight(50, 60, 70), pointLight(0.3f, 1, 0, 1e30f), pointLight(0.3f, 1, 0, 0), spotLight(0, 0.001f),
                                    spotLight(1.5f, 1.5707f)}) {
        shine(lamp, light);
        const std::vector<float> rgba = gather(room, scene, {lamp.get()}, 0);  // which expects finite numbers
        float most = 0;
        for (size_t i = 0; i < rgba.size(); ++i) most = i % 4 == 3 ? most : std::max(most, rgba[i]);
        const bool dark = albedo == 0 || light.intensity_rgb[0] == 0;
        EXPECT_TRUE(!dark || most == 0) << "nothing is reflected: " << most;
        EXPECT_TRUE(dark || light.intensity_rgb[0] < 1e29f || most > 1e20f) << most;
      }
    }
  }
  test::SceneBuilder builder;
  builder.quad({-2, 0, -1}, {0, 0, 1e-4f}, {1e-4f, 0, 0}, builder.material(test::diffuse(0.5f)));
  const Room speck(builder.take());
  const Scene scene = upload(speck);
  const Lamp lamp = lampOf(scene, options(true, 16, 8));
  for (int i = 0; i < 3; ++i) EXPECT_LE(shine(lamp, pointLight(0, 3, 0)).lights, 16u);
  for (const float v : gather(speck, scene, {lamp.get()})) EXPECT_LE(v, 1) << "there is nothing that the speck could light";
}

TEST_P(GlDynamic, AGamesOwnMapGivesTheSameLight) {
  const Room room(box());
  const Scene scene = upload(room);
  const lw_light light = spotLight(0.2f, 0.6f);
  const Lamp own = lampOf(scene, options(false)), from = lampOf(scene, options(false));
  shine(own, light);
  lw_gl_lamp_views views;
  ASSERT_EQ(lw_gl_lamp_get_views(from.get(), &light, &views), LW_OK);
  ASSERT_EQ(views.count, 1u);
  ASSERT_EQ(views.width, 128u);
  // The floor, which is all that the cone meets, by hand.
  const float* m = views.view[0].clip_from_container;
  std::vector<float> position(128 * 128 * 4), normal(position.size()), flux(position.size());
  const double axis_length = std::sqrt(1.04), ci = std::cos(0.2), co = std::cos(0.6);
  for (int y = 0; y < 128; ++y)
    for (int x = 0; x < 128; ++x) {
      // The point of the floor whose clip coordinates are the pixel's: two equations in x and z.
      const double u = (x + 0.5) / 64 - 1, v = (y + 0.5) / 64 - 1;
      const auto row = [&](int r, double at) { return std::array<double, 3>{double(m[r]) - at * double(m[3]), double(m[8 + r]) - at * double(m[11]), at * double(m[15]) - double(m[12 + r])}; };
      const auto a = row(0, u), b = row(1, v);
      const double det = a[0] * b[1] - a[1] * b[0], px = (a[2] * b[1] - a[1] * b[2]) / det, pz = (a[0] * b[2] - a[2] * b[0]) / det;
      const double dx = px - double(light.position_m[0]), dy = -double(light.position_m[1]), dz = pz - double(light.position_m[2]), square = dx * dx + dy * dy + dz * dz, length = std::sqrt(square);
      const double edge = std::clamp(((dx * 0.2 - dy) / length / axis_length - co) / (ci - co), 0.0, 1.0);
      float* const p = &position[size_t(y * 128 + x) * 4];
      p[0] = float(px), p[1] = 0, p[2] = float(pz), p[3] = 1;
      float* const n = &normal[size_t(y * 128 + x) * 4];
      n[0] = n[2] = 0, n[1] = 1, n[3] = float(square * length / -dy);
      for (int k = 0; k < 3; ++k) flux[size_t(y * 128 + x) * 4 + size_t(k)] = float(10 * (k + 1) * edge * edge * kReflected);
    }
  GLuint textures[3];
  glGenTextures(3, textures);
  const std::vector<float>* const values[] = {&position, &normal, &flux};
  for (int i = 0; i < 3; ++i) {
    glBindTexture(GL_TEXTURE_2D, textures[i]);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, 128, 128, 0, GL_RGBA, GL_FLOAT, values[i]->data());
  }
  const lw_gl_reflective_shadow_map map{textures[0], textures[1], textures[2]};
  EXPECT_EQ(lw_gl_lamp_update_from(from.get(), &light, &map, nullptr), LW_OK) << message;
  EXPECT_NEAR(power(lightsOf(from, 256)) / power(lightsOf(own, 256)), 1, 2e-3);
  EXPECT_LT(test::relrmse(gather(room, scene, {from.get()}), gather(room, scene, {own.get()})), 0.02);
  const lw_gl_reflective_shadow_map missing{textures[0], 0, textures[2]};
  EXPECT_EQ(lw_gl_lamp_update_from(from.get(), &light, &missing, nullptr), LW_INVALID_ARGUMENT);
  glDeleteTextures(3, textures);
}

TEST_P(GlDynamic, LeavesTheStateAsItWas) {
  const Room room(box());
  const Scene scene = upload(room);
  const Lamp lamp = lampOf(scene, options(true, 64, 16));
  GLuint texture, framebuffer, array;
  glGenTextures(1, &texture), glGenFramebuffers(1, &framebuffer), glGenVertexArrays(1, &array);
  const auto state = [] {
    std::vector<GLint> values;
    for (const GLenum e : {GL_CURRENT_PROGRAM, GL_VERTEX_ARRAY_BINDING, GL_DRAW_FRAMEBUFFER_BINDING, GL_READ_FRAMEBUFFER_BINDING, GL_ACTIVE_TEXTURE, GL_PIXEL_PACK_BUFFER_BINDING, GL_DEPTH_FUNC,
                           GL_BLEND_SRC_RGB, GL_BLEND_DST_ALPHA, GL_BLEND_EQUATION_RGB, GL_UNPACK_ALIGNMENT}) {
      GLint v = 0;
      glGetIntegerv(e, &v);
      values.push_back(v);
    }
    GLint box[4];
    for (const GLenum e : {GL_VIEWPORT, GL_SCISSOR_BOX}) glGetIntegerv(e, box), values.insert(values.end(), box, box + 4);
    for (const GLenum e : {GL_BLEND, GL_SCISSOR_TEST, GL_CULL_FACE, GL_DEPTH_TEST, GL_STENCIL_TEST, GL_POLYGON_OFFSET_FILL}) values.push_back(glIsEnabled(e));
    GLboolean mask = 0;
    glGetBooleanv(GL_DEPTH_WRITEMASK, &mask);
    values.push_back(mask);
    GLint active = 0;
    glGetIntegerv(GL_ACTIVE_TEXTURE, &active);
    for (GLenum unit = 0; unit < 7; ++unit) {
      GLint v = 0;
      glActiveTexture(GL_TEXTURE0 + unit);
      glGetIntegerv(GL_TEXTURE_BINDING_2D, &v), values.push_back(v);
      glGetIntegerv(GL_TEXTURE_BINDING_2D_ARRAY, &v), values.push_back(v);
    }
    glActiveTexture(GLenum(active));
    return values;
  };
  for (GLenum unit = 0; unit < 7; ++unit) glActiveTexture(GL_TEXTURE0 + unit), glBindTexture(GL_TEXTURE_2D, texture);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glBindVertexArray(array);
  glEnable(GL_BLEND), glEnable(GL_SCISSOR_TEST), glEnable(GL_CULL_FACE), glEnable(GL_DEPTH_TEST), glEnable(GL_STENCIL_TEST), glEnable(GL_POLYGON_OFFSET_FILL);
  glDepthFunc(GL_NEVER), glDepthMask(GL_FALSE), glBlendFunc(GL_ZERO, GL_SRC_ALPHA), glBlendEquation(GL_FUNC_SUBTRACT);
  glViewport(1, 2, 3, 4), glScissor(5, 6, 7, 8);
  const auto before = state();
  for (int i = 0; i < 2; ++i) {
    shine(lamp, pointLight(0.3f, 1.2f, -0.7f));
    EXPECT_EQ(state(), before);
  }
  lw_gl_lamp* const lamps[] = {lamp.get()};
  EXPECT_EQ(lw_gl_dynamic_gather(scene.get(), lamps, 1, nullptr), LW_OK);
  EXPECT_EQ(state(), before);
  std::vector<float> visibility(64);
  const float at[3] = {0, 0, 0}, up[3] = {0, 1, 0};
  EXPECT_EQ(lw_gl_lamp_read_visibility(lamp.get(), at, up, visibility.data()), LW_OK);
  lightsOf(lamp, 64);
  EXPECT_EQ(state(), before);
  glDeleteTextures(1, &texture), glDeleteFramebuffers(1, &framebuffer), glDeleteVertexArrays(1, &array);
}

TEST_P(GlDynamic, RefusesWhatCannotBe) {
  const Room bare(box(), 0);
  const Scene scene = upload(bare);
  lw_gl_lamp* lamp = nullptr;
  const lw_gl_lamp_options good = options(true, 64, 0);
  lw_gl_lamp_options shadows = good;
  shadows.shadow_side = 32;
  EXPECT_EQ(lw_gl_lamp_create(scene.get(), &shadows, &lamp), LW_NOT_FOUND);
  EXPECT_THAT(message, testing::HasSubstr("--points"));
  for (const auto& spoil : std::vector<void (*)(lw_gl_lamp_options&)>{[](auto& o) { o.lights = 15; }, [](auto& o) { o.lights = 1025; }, [](auto& o) { o.view_side = 100; }, [](auto& o) { o.shadow_side = 12; },
                                                                      [](auto& o) { o.most_updates = 0; }, [](auto& o) { o.late = 2; }, [](auto& o) { o.size = 4; }}) {
    lw_gl_lamp_options bad = good;
    spoil(bad);
    EXPECT_EQ(lw_gl_lamp_create(scene.get(), &bad, &lamp), LW_INVALID_ARGUMENT);
  }
  const Lamp made = lampOf(scene, good);
  lw_light nowhere = pointLight(NAN, 0, 0);
  EXPECT_EQ(lw_gl_lamp_update(made.get(), &nowhere, nullptr), LW_INVALID_ARGUMENT);
  EXPECT_THAT(message, testing::HasSubstr("position"));
  lw_gl_gathering gathering = LW_GL_GATHERING_INIT;
  gathering.softness = -1;
  lw_gl_lamp* const lamps[] = {made.get()};
  EXPECT_EQ(lw_gl_dynamic_gather(scene.get(), lamps, 1, &gathering), LW_INVALID_ARGUMENT);
  lw_gl_dynamic* other = nullptr;
  lw_gl_config config = LW_GL_CONFIG_INIT;
  EXPECT_EQ(lw_gl_dynamic_create(&config, bare.container, nullptr, &other), LW_INVALID_ARGUMENT);
}

INSTANTIATE_TEST_SUITE_P(Contexts, GlDynamic, testing::Values(test::Api::desktop33, test::Api::embedded30),
                         [](const auto& info) { return info.param == test::Api::desktop33 ? "Core33" : "Es30"; });

}  // namespace
}  // namespace lightwell::bake
