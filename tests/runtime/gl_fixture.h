// A context, the library's programs in it, and transports uploaded into it.
#pragma once
#include <gmock/gmock.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/runtime/gl_test.h"
#include "tests/runtime/support.h"
#include "tests/runtime/synthetic_prm.h"

namespace lightwell::test {

/// relrmse of light at entries that are rectangles, against the CPU: GL's arctangents are coarse.
inline constexpr double kRectangleError = 5e-5;

inline constexpr uint32_t kReconstructions[] = {LW_GL_RECONSTRUCT_SHADER, LW_GL_RECONSTRUCT_CPU};

using GlPrm = std::unique_ptr<lw_gl_prm, decltype(&lw_gl_prm_destroy)>;

class GlFixture : public GlTest {
 protected:
  void load(const SyntheticOptions& options) {
    synthetic = makeSyntheticPrm(options);
    container = openMemory(synthetic.container);
    prm = loadPrm(container.get());
  }
  GlPrm upload(uint32_t atlas_format = LW_GL_ATLAS_RGBA32F) {
    lw_gl_prm_options options = LW_GL_PRM_OPTIONS_INIT;
    options.atlas_format = atlas_format;
    options.reconstruct = reconstruct;
    lw_gl_prm* uploaded = nullptr;
    EXPECT_EQ(lw_gl_prm_create(gl, prm.get(), &options, &uploaded), LW_OK) << message;
    return {uploaded, lw_gl_prm_destroy};
  }
  std::vector<float> readAtlas(lw_gl_prm* gl_prm) {
    std::vector<float> atlas(synthetic.source.size() * 4);
    EXPECT_EQ(lw_gl_read_atlas(gl_prm, atlas.data()), LW_OK);
    return atlas;
  }
  std::vector<float> readEntries(lw_gl_prm* gl_prm) {
    std::vector<float> rgb(size_t(synthetic.entries()) * 3);
    EXPECT_EQ(lw_gl_read_entries(gl_prm, rgb.data()), LW_OK);
    return rgb;
  }

  uint32_t reconstruct = LW_GL_RECONSTRUCT_SHADER;  // of what is uploaded
  SyntheticPrm synthetic;
  Container container;
  Prm prm{nullptr, lw_prm_release};
};

inline std::string apiName(const testing::TestParamInfo<Api>& info) { return info.param == Api::desktop33 ? "Core33" : "Es30"; }
#define LW_INSTANTIATE_GL(fixture) \
  INSTANTIATE_TEST_SUITE_P(Contexts, fixture, testing::Values(Api::desktop33, Api::embedded30), apiName)

inline lw_gl_light glPointLight(float x, float y, float z, float candela) {
  lw_gl_light l = LW_GL_LIGHT_INIT;
  l.light.position_m[0] = x, l.light.position_m[1] = y, l.light.position_m[2] = z;
  for (float& i : l.light.intensity_rgb) i = candela;
  return l;
}

}  // namespace lightwell::test
