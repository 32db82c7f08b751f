// CAM.json and LIGHTS.json: what they mean, and what is refused with which words.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "render/camera_json.h"
#include "render/error.h"
#include "render/lights_json.h"

namespace lightwell::render {
namespace {

using testing::HasSubstr;
const double kOrigin[3] = {10, 0, -5};

TEST(CameraFile, DefaultsAreDocumented) {
  const View view = parseCamera(R"({"eye": [1, 2, 3], "target": [1, 2, -7]})", "cam.json");
  EXPECT_EQ(view.eye_m, (std::array<double, 3>{1, 2, 3}));
  EXPECT_EQ(view.forward, (Float3{0, 0, -1}));
  EXPECT_EQ(view.up, (Float3{0, 1, 0}));
  EXPECT_FLOAT_EQ(view.vertical_fov_rad, 1.0471976f);
  EXPECT_EQ(view.width, 1280);
  EXPECT_EQ(view.height, 720);
  EXPECT_FALSE(view.exposure_ev.has_value());
  EXPECT_EQ(view.part, LightPart::full);
  EXPECT_FALSE(view.lighting_only);
}

TEST(CameraFile, EveryKeyIsRead) {
  const View view = parseCamera(R"({"eye": [0, 0, 0], "direction": [0, 0, 5], "up": [2, 0, 0], "vertical_fov_deg": 90, "width": 64,
    "height": 32, "exposure": -2.5, "mode": "indirect", "surface": "lighting", "background": [1, 2, 3], "lamps": true})", "cam.json");
  EXPECT_EQ(view.forward, (Float3{0, 0, 1}));
  EXPECT_EQ(view.up, (Float3{1, 0, 0}));
  EXPECT_FLOAT_EQ(view.vertical_fov_rad, 1.5707964f);
  EXPECT_EQ(view.width, 64);
  EXPECT_EQ(view.height, 32);
  EXPECT_EQ(view.exposure_ev, -2.5f);
  EXPECT_EQ(view.part, LightPart::indirect);
  EXPECT_TRUE(view.lighting_only);
  EXPECT_TRUE(view.show_lamps);
  EXPECT_EQ(view.background_radiance_rgb, (Float3{1, 2, 3}));
}

TEST(CameraFile, TargetsNearAFarEyeKeepTheirDirection) {
  const View view = parseCamera(R"({"eye": [1e8, 0, 0], "target": [100000000.5, 0.5, 0]})", "cam.json");
  EXPECT_NEAR(view.forward[0], std::sqrt(0.5), 1e-6);
}

struct Refused {
  const char* json;
  const char* place;
  const char* reason;
};
class RefusedCamera : public testing::TestWithParam<Refused> {};
TEST_P(RefusedCamera, NamesFilePlaceAndReason) {
  try {
    parseCamera(GetParam().json, "cam.json");
    FAIL() << "was accepted";
  } catch (const FileError& error) {
    EXPECT_EQ(error.file, "cam.json");
    EXPECT_EQ(error.place, GetParam().place);
    EXPECT_THAT(error.reason, HasSubstr(GetParam().reason));
  }
}
INSTANTIATE_TEST_SUITE_P(
    Files, RefusedCamera,
    testing::Values(Refused{"", "", "is not JSON"}, Refused{"[1]", "", "must be an object"}, Refused{"{}", "eye", "is missing"},
                    Refused{R"({"eye": [0, 0, 0]})", "target", "either"},
                    Refused{R"({"eye": [0, 0, 0], "target": [1, 0, 0], "direction": [1, 0, 0]})", "target", "either"},
                    Refused{R"({"eye": [0, 0, 0], "target": [0, 0, 0]})", "target", "where the eye is"},
                    Refused{R"({"eye": [0, 0], "target": [1, 0, 0]})", "eye", "three numbers"},
                    Refused{R"({"eye": [0, 0, "a"], "target": [1, 0, 0]})", "eye", "must be a number"},
                    Refused{R"({"eye": [0, 0, 1e300], "target": [1, 0, 0]})", "eye", "must lie in"},
                    Refused{R"({"eye": [0, 0, 1e999], "target": [1, 0, 0]})", "", "is not JSON"},
                    Refused{R"({"eye": [0, 0, 0], "direction": [0, 2, 0]})", "up", "parallel"},
                    Refused{R"({"eye": [0, 0, 0], "direction": [0, 0, 0]})", "direction", "no direction"},
                    Refused{R"({"eye": [0, 0, 0], "direction": [1, 0, 0], "width": 0})", "width", "must lie in"},
                    Refused{R"({"eye": [0, 0, 0], "direction": [1, 0, 0], "width": 100000})", "width", "must lie in"},
                    Refused{R"({"eye": [0, 0, 0], "direction": [1, 0, 0], "height": 1.5})", "height", "whole"},
                    Refused{R"({"eye": [0, 0, 0], "direction": [1, 0, 0], "vertical_fov_deg": 180})", "vertical_fov_deg", "must lie in"},
                    Refused{R"({"eye": [0, 0, 0], "direction": [1, 0, 0], "exposure": "bright"})", "exposure", "must be a number"},
                    Refused{R"({"eye": [0, 0, 0], "direction": [1, 0, 0], "mode": "all"})", "mode", "direct, indirect, full"},
                    Refused{R"({"eye": [0, 0, 0], "direction": [1, 0, 0], "mode": 3})", "mode", "must be a string"},
                    Refused{R"({"eye": [0, 0, 0], "direction": [1, 0, 0], "background": [0, -1, 0]})", "background", "must lie in"},
                    Refused{R"({"eye": [0, 0, 0], "direction": [1, 0, 0], "lamps": 1})", "lamps", "true or false"},
                    Refused{R"({"eye": [0, 0, 0], "direction": [1, 0, 0], "fov": 60})", "fov", "not a known key"}));

TEST(CameraFile, HostileNestingIsRefused) {
  EXPECT_THROW(parseCamera(std::string(200000, '['), "cam.json"), FileError);
  EXPECT_THROW(parseCamera(R"({"eye":)" + std::string(200000, '[') + std::string(200000, ']') + "}", "cam.json"), FileError);
}

TEST(CameraFile, MissingFilesAreNamed) {
  try {
    readCamera("/nowhere/cam.json");
    FAIL();
  } catch (const FileError& error) {
    EXPECT_EQ(error.file, "/nowhere/cam.json");
  }
}

TEST(LightsFile, PositionsBecomeRelativeToTheOrigin) {
  const auto lights = parseLights(R"({"lights": [
    {"type": "point", "position": [11, 2, -5], "color": [1, 0.5, 0], "intensity": 100},
    {"type": "spot", "position": [10, 0, 0], "direction": [0, -3, 0], "intensity": 5, "innerConeAngle": 0.1, "outerConeAngle": 0.2,
     "range": 4},
    {"type": "directional", "direction": [1, 0, 0], "intensity": 1000}]})", "lights.json", kOrigin);
  ASSERT_EQ(lights.size(), 3u);
  EXPECT_EQ(lights[0].type, uint32_t(LW_LIGHT_POINT));
  EXPECT_EQ(lights[0].position_m[0], 1);
  EXPECT_EQ(lights[0].position_m[2], 0);
  EXPECT_EQ(lights[0].intensity_rgb[1], 50);
  EXPECT_EQ(lights[1].type, uint32_t(LW_LIGHT_SPOT));
  EXPECT_EQ(lights[1].direction[1], -1);
  EXPECT_FLOAT_EQ(lights[1].outer_cone_angle_rad, 0.2f);
  EXPECT_EQ(lights[1].range_m, 4);
  EXPECT_EQ(lights[2].type, uint32_t(LW_LIGHT_DIRECTIONAL));
  EXPECT_EQ(lights[2].intensity_rgb[2], 1000);
  EXPECT_TRUE(parseLights(R"({"lights": []})", "lights.json", kOrigin).empty());
}

TEST(LightsFile, RefusalsNameTheLight) {
  for (const auto& [json, place] :
       {std::pair{R"({"lights": [{"type": "point"}]})", "lights[0].position"}, {R"({"lights": [{"type": "area"}]})", "lights[0].type"},
        {R"({"lights": [{"type": "point", "position": [0, 0, 0], "intensity": -1}]})", "lights[0].intensity"},
        {R"({"lights": [{"type": "directional", "direction": [0, 0, 0]}]})", "lights[0].direction"},
        {R"({"lights": [{"type": "spot", "position": [0, 0, 0], "direction": [0, 1, 0], "innerConeAngle": 0.8}]})",
         "lights[0].outerConeAngle"},
        {R"({"lights": [5]})", "lights[0]"}, {R"({"lights": 5})", "lights"}, {R"({})", "lights"}}) {
    try {
      parseLights(json, "lights.json", kOrigin);
      FAIL() << json;
    } catch (const FileError& error) {
      EXPECT_EQ(error.place, place) << json;
    }
  }
}

}  // namespace
}  // namespace lightwell::render
