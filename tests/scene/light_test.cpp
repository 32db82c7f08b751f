// Punctual lights: photometry, placement, units, LIGHTS.json.
#include <gmock/gmock.h>

#include <cmath>

#include "precompute/core/error.h"
#include "tests/scene/gltf_builder.h"

namespace lightwell::scene {
namespace {

using testing::HasSubstr;

class Lights : public SceneTest {
 protected:
  /// The scene of a triangle and one light on a node.
  static GltfBuilder lit(const Json& light, const Json& node = Json::object()) {
    GltfBuilder b;
    b.useExtension("KHR_lights_punctual");
    b.show(b.triangle());
    Json placed = node;
    placed["extensions"]["KHR_lights_punctual"]["light"] = 0;
    b.json["extensions"]["KHR_lights_punctual"]["lights"] = {light};
    b.json["scenes"][0]["nodes"].push_back(b.add("nodes", placed));
    return b;
  }
  /// Irradiance at a world point with a normal.
  static Rgb irradiance(const Scene& scene, const Vec3d& point_m, const Vec3& normal) {
    Vec3 to_light;
    float distance;
    return lightIrradiance(scene.lights.at(0), Vec3((point_m - scene.origin_m) / scene.metres_per_unit), normal, to_light, distance);
  }
  std::filesystem::path lightsJson(const Json& json) {
    writeBytes(folder / "lights.json", json.dump());
    return folder / "lights.json";
  }
  std::string lightsError(const Json& json) {
    Scene scene;
    try {
      replaceLights(scene, lightsJson(json), diagnostics);
    } catch (const InputError& e) {
      return e.place + ": " + e.reason;
    }
    ADD_FAILURE() << "LIGHTS.json should have been refused";
    return "";
  }
};

TEST_F(Lights, OneCandelaGivesOneLuxAtOneMetre) {
  for (const double scale : {1e-4, 1.0, 1e6}) {  // whatever the internal unit
    GltfBuilder b = lit({{"type", "point"}, {"intensity", 3}, {"color", {1, 0.5, 0}}}, {{"translation", {0, 0, 5}}});
    b.json["nodes"][0]["scale"] = {scale, scale, scale};
    const Scene scene = load(b);
    const Rgb at_one_metre = irradiance(scene, {0, 0, 4}, {0, 0, 1});
    if (scale < 1e5) {  // at 10^6 m a metre is lost in the position's rounding
      EXPECT_NEAR(at_one_metre.x, 3, 3e-3);
      EXPECT_NEAR(at_one_metre.y, 1.5, 2e-3);
    }
    EXPECT_NEAR(irradiance(scene, Vec3d(0, 0, 5 - scale * 10), {0, 0, 1}).x * scale * scale, 0.03, 3e-4);
  }
}

TEST_F(Lights, IrradianceFollowsTheCosineAndVanishesBehind) {
  const Scene scene = load(lit({{"type", "point"}, {"intensity", 1}}, {{"translation", {0, 0, 2}}}));
  EXPECT_NEAR(irradiance(scene, {0, 0, 0}, {0, 0, 1}).x, 0.25, 1e-5);
  EXPECT_NEAR(irradiance(scene, {0, 0, 0}, Vec3(0, std::sqrt(0.75f), 0.5f)).x, 0.125, 1e-5);
  EXPECT_EQ(irradiance(scene, {0, 0, 0}, {0, 0, -1}).x, 0);
  EXPECT_EQ(irradiance(scene, {0, 0, 0}, {1, 0, 0}).x, 0);
  // On the light itself: finite.
  EXPECT_TRUE(std::isfinite(irradiance(scene, {0, 0, 2}, {0, 0, 1}).x));
}

TEST_F(Lights, DirectionalLightShinesAlongMinusZOfItsNode) {
  // A quarter turn about x takes −z to +y.
  const Scene scene =
      load(lit({{"type", "directional"}, {"intensity", 1000}}, {{"rotation", {std::sqrt(0.5), 0, 0, std::sqrt(0.5)}}, {"scale", {9, 9, 9}}}));
  EXPECT_LT((scene.lights[0].direction - Vec3(0, 1, 0)).length(), 1e-6);
  Vec3 to_light;
  float distance;
  EXPECT_NEAR(lightIrradiance(scene.lights[0], Vec3(0), {0, -1, 0}, to_light, distance).x, 1000, 1e-3);
  EXPECT_LT((to_light - Vec3(0, -1, 0)).length(), 1e-6);
  EXPECT_TRUE(std::isinf(distance));
}

TEST_F(Lights, SpotHasAFullCoreASmoothEdgeAndNothingOutside) {
  const double inner = 0.2, outer = 0.6;
  const Scene scene =
      load(lit({{"type", "spot"}, {"intensity", 4}, {"spot", {{"innerConeAngle", inner}, {"outerConeAngle", outer}}}}, {{"translation", {0, 0, 2}}}));
  const auto intensity = [&](double angle) {  // E r² / cos
    const Vec3d point(2 * std::tan(angle), 0, 0);
    return irradiance(scene, point, {0, 0, 1}).x * (4 + point.length2()) / std::cos(angle);
  };
  EXPECT_NEAR(intensity(0), 4, 1e-4);
  EXPECT_NEAR(intensity(0.19), 4, 1e-3);
  const double middle = (std::cos(0.4) - std::cos(outer)) / (std::cos(inner) - std::cos(outer));
  EXPECT_NEAR(intensity(0.4), 4 * middle * middle, 1e-3);
  EXPECT_EQ(intensity(0.61), 0);
}

TEST_F(Lights, RangeIsAWindowOnTheInverseSquare) {
  const Scene scene = load(lit({{"type", "point"}, {"intensity", 1}, {"range", 4}}, {{"translation", {0, 0, 2}}}));
  EXPECT_NEAR(irradiance(scene, {0, 0, 0}, {0, 0, 1}).x, 0.25 * (1 - std::pow(0.5, 4)), 1e-5);
  EXPECT_EQ(irradiance(scene, {0, 0, -2.1}, {0, 0, 1}).x, 0);
}

TEST_F(Lights, OneBlenderLampIsTheSameLightInEveryExportMode) {
  const double watts = 40, four_pi = 4 * M_PI;
  const auto intensity = [&](const char* type, double value, LightUnits units) {
    Json light = {{"type", type}, {"intensity", value}, {"spot", Json::object()}};
    const Scene scene = load(lit(light), units);
    const double unit = scene.lights[0].type == LightType::directional ? 1 : scene.metres_per_unit;
    return scene.lights[0].intensity.x * unit * unit;
  };
  for (const char* type : {"point", "spot"}) {
    const double candela = 683 * watts / four_pi;
    EXPECT_NEAR(intensity(type, candela, LightUnits::spec), candela, 1e-3);
    EXPECT_NEAR(intensity(type, watts / four_pi, LightUnits::unitless), candela, 1e-3);
    EXPECT_NEAR(intensity(type, watts, LightUnits::raw), candela, 1e-3);
  }
  EXPECT_NEAR(intensity("directional", 683 * 5, LightUnits::spec), 683 * 5, 1e-3);
  EXPECT_NEAR(intensity("directional", 5, LightUnits::unitless), 683 * 5, 1e-3);
  EXPECT_NEAR(intensity("directional", 5, LightUnits::raw), 683 * 5, 1e-3);
}

TEST_F(Lights, BrokenLightsAreRepairedAndImplausibleOnesReported) {
  EXPECT_EQ(load(lit({{"type", "point"}, {"intensity", -5}})).lights[0].intensity, Rgb(0));
  EXPECT_TRUE(warned("extensions.KHR_lights_punctual.lights[0]", "negative"));
  load(lit({{"type", "point"}, {"intensity", 1e9}}));
  EXPECT_TRUE(warned("extensions.KHR_lights_punctual.lights[0]", "1e+09 cd, which is implausible"));
  EXPECT_EQ(load(lit({{"type", "point"}, {"range", 0}})).lights[0].range, 0);
  EXPECT_TRUE(warned("lights[0].range", "not positive"));
  for (const auto& [inner, outer] : {std::pair{0.7, 0.3}, {-1.0, 0.5}, {0.1, 3.0}, {0.5, 0.5}, {0.0, 0.0}}) {
    const Scene scene = load(lit({{"type", "spot"}, {"spot", {{"innerConeAngle", inner}, {"outerConeAngle", outer}}}}));
    const Light& light = scene.lights[0];
    EXPECT_GE(light.inner_cone_angle, 0);
    EXPECT_LT(light.inner_cone_angle, light.outer_cone_angle);
    EXPECT_LE(light.outer_cone_angle, kPi / 2 + 1e-6f);
    EXPECT_TRUE(warned("lights[0].spot", "cone"));
  }
  EXPECT_TRUE(load(lit({{"type", "directional"}}, {{"scale", {0, 0, 0}}})).lights.empty());
  EXPECT_TRUE(warned("nodes[1]", "no direction"));
}

TEST_F(Lights, UnknownTypesAreRefused) {
  EXPECT_THAT(errorOf(lit({{"type", "area"}})), HasSubstr("extensions.KHR_lights_punctual.lights[0].type: is \"area\""));
  EXPECT_THAT(errorOf(lit({{"type", "spot"}})), HasSubstr("lights[0]: has no \"spot\""));
  EXPECT_THAT(errorOf(lit({{"type", "point"}, {"intensity", "bright"}})), HasSubstr("lights[0].intensity: is not a number"));
}

TEST_F(Lights, LightsJsonReplacesTheScenesLights) {
  Scene scene = load(lit({{"type", "point"}, {"intensity", 1}}));
  const size_t warnings_of_import = diagnostics.warnings().size();
  replaceLights(scene,
                lightsJson({{"lights",
                             {{{"type", "point"}, {"position", {0, 0, 3}}, {"color", {1, 0.5, 0.25}}, {"intensity", 18}},
                              {{"type", "spot"}, {"position", {0, 0, 1}}, {"direction", {0, 0, -2}}, {"intensity", 1}, {"outerConeAngle", 0.5}},
                              {{"type", "directional"}, {"direction", {0, -3, 0}}, {"intensity", 7}}}}}),
                diagnostics);
  ASSERT_EQ(scene.lights.size(), 3u);
  const Rgb irradiance_rgb = irradiance(scene, {0, 0, 0}, {0, 0, 1});
  EXPECT_NEAR(irradiance_rgb.x, 2, 1e-4);
  EXPECT_NEAR(irradiance_rgb.y, 1, 1e-4);
  EXPECT_NEAR(irradiance_rgb.z, 0.5, 1e-4);
  EXPECT_EQ(scene.lights[1].direction, Vec3(0, 0, -1));
  EXPECT_FLOAT_EQ(scene.lights[1].outer_cone_angle, 0.5f);
  EXPECT_EQ(scene.lights[2].intensity, Rgb(7));
  EXPECT_EQ(diagnostics.warnings().size(), warnings_of_import);
}

TEST_F(Lights, LightsJsonIsCheckedStrictly) {
  const Json good = {{"type", "point"}, {"position", {0, 0, 0}}, {"intensity", 1}};
  const auto with = [&](const char* key, const Json& value) {
    Json light = good;
    light[key] = value;
    return Json{{"lights", {good, good, light}}};
  };
  EXPECT_THAT(lightsError(with("position", {0, 0})), HasSubstr("lights[2].position: has 2 elements instead of 3"));
  EXPECT_THAT(lightsError(with("position", {0, 0, "1"})), HasSubstr("lights[2].position[2]: is not a number"));
  EXPECT_THAT(lightsError(with("type", "sun")), HasSubstr("lights[2].type: is \"sun\""));
  EXPECT_THAT(lightsError(with("type", "spot")), HasSubstr("lights[2]: has no \"direction\""));
  EXPECT_THAT(lightsError(with("intensity", -1)), HasSubstr("lights[2].intensity: is negative"));
  EXPECT_THAT(lightsError(with("color", {1, -1, 1})), HasSubstr("lights[2].color: is negative"));
  EXPECT_THAT(lightsError({{"lights", {{{"type", "directional"}, {"direction", {0, 0, 0}}, {"intensity", 1}}}}}),
              HasSubstr("lights[0].direction: has no direction"));
  EXPECT_THAT(lightsError(Json::object()), HasSubstr("has no \"lights\""));
  EXPECT_THAT(lightsError({{"lights", 3}}), HasSubstr("lights: is not an array"));
  Scene scene;
  replaceLights(scene, lightsJson(with("brightness", 3)), diagnostics);
  EXPECT_TRUE(warned("lights[2].brightness", "is not a key"));
}

}  // namespace
}  // namespace lightwell::scene
