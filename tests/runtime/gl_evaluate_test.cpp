// The GL evaluator against the plain double-precision sum and against the CPU.
#include "format/decode/pixel.h"
#include "tests/runtime/gl_fixture.h"
#include "tests/runtime/rectangle_entries.h"

namespace lightwell::test {
namespace {

class GlEvaluate : public GlFixture {};
LW_INSTANTIATE_GL(GlEvaluate);

/// Local bases, reconstructed on either side.
class GlReconstruct : public GlFixture {};
LW_INSTANTIATE_GL(GlReconstruct);

TEST_P(GlEvaluate, AgreesWithThePlainSumInEveryLayout) {
  for (const Layout layout : {Layout::panes_rgb9e5, Layout::panes_half, Layout::local_bases}) {
    SyntheticOptions options;
    options.layout = layout;
    load(options);
    const auto irradiance = randomIrradiance(options.clusters, 8);
    for (const uint32_t variant : {0u, 1u, 2u, 3u}) {
      const uint32_t format = variant & 1 ? LW_GL_ATLAS_RGBA16F : LW_GL_ATLAS_RGBA32F;
      reconstruct = kReconstructions[variant >> 1];
      const GlPrm gl_prm = upload(format);
      ASSERT_EQ(lw_gl_upload_cluster_irradiance(gl_prm.get(), irradiance.data()), LW_OK);
      for (const uint32_t shown : {0u, 1u, 2u, 3u, 4u, 5u, 6u, 7u}) {
        const uint32_t emitters = shown & 3, fill = shown >> 2;
        lw_prm_options evaluate = LW_PRM_OPTIONS_INIT;
        evaluate.emitters = emitters;
        evaluate.fill = fill;
        ASSERT_EQ(lw_gl_evaluate(gl_prm.get(), &evaluate), LW_OK);
        const auto atlas = readAtlas(gl_prm.get());
        const auto expected = synthetic.evaluate(irradiance, emitters, 0, true, fill != 0);
        EXPECT_LT(relrmse(atlas, expected), format == LW_GL_ATLAS_RGBA32F ? 1e-5 : 1e-3) << int(layout);
        for (size_t i = 3; i < atlas.size(); i += 4) ASSERT_EQ(atlas[i], float(expected[i]));
      }
    }
  }
}

TEST_P(GlEvaluate, RanksTheBrightestAsTheCpuDoes) {
  for (const Layout layout : {Layout::panes_rgb9e5, Layout::panes_half}) {
    SyntheticOptions options;
    options.layout = layout;
    load(options);
    const GlPrm gl_prm = upload();
    std::vector<uint32_t> scratch(lw_prm_scratch_bytes(prm.get()) / 4);
    std::vector<float> cpu(synthetic.source.size() * 4);
    for (uint32_t seed = 0; seed < 5; ++seed) {
      const auto irradiance = randomIrradiance(options.clusters, seed);
      ASSERT_EQ(lw_gl_upload_cluster_irradiance(gl_prm.get(), irradiance.data()), LW_OK);
      for (const uint32_t brightest : {1u, 7u, 16u, 39u, 40u, 100u})
        for (const uint32_t keep : {0u, 1u}) {
          lw_prm_options evaluate = LW_PRM_OPTIONS_INIT;
          evaluate.brightest = brightest;
          evaluate.keep_energy = keep;
          ASSERT_EQ(lw_gl_evaluate(gl_prm.get(), &evaluate), LW_OK);
          ASSERT_EQ(lw_prm_evaluate(prm.get(), irradiance.data(), &evaluate, scratch.data(), scratch.size() * 4, cpu.data()), LW_OK);
          EXPECT_LT(relrmse(readAtlas(gl_prm.get()), cpu), 1e-5) << brightest;
        }
    }
  }
}

TEST_P(GlEvaluate, FollowsLightsFromTheEntriesToTheAtlas) {
  for (const Layout layout : {Layout::panes_rgb9e5, Layout::local_bases}) {
    SyntheticOptions options;
    options.layout = layout;
    load(options);
    const GlPrm gl_prm = upload();
    std::vector<lw_gl_light> lights;
    std::vector<lw_light> plain;
    for (int i = 0; i < 37; ++i) {  // more than two batches, of all types
      lw_gl_light l = glPointLight(std::sin(float(i)) * 3, std::cos(float(i) * 1.3f) * 3, std::sin(float(i) * 0.7f) * 3, float(i + 1));
      l.light.type = uint32_t(LW_LIGHT_POINT + i % 3);
      l.light.range_m = i % 4 ? 0.0f : 5.0f;
      l.light.inner_cone_angle_rad = 0.3f;
      l.light.outer_cone_angle_rad = 1.2f;
      l.light.intensity_rgb[1] *= 0.5f;
      lights.push_back(l);
      plain.push_back(l.light);
    }
    std::vector<float> entries(size_t(synthetic.entries()) * 3), clusters(size_t(options.clusters) * 3), gl_clusters(clusters.size());
    for (const size_t count : {size_t(0), size_t(1), size_t(37), size_t(3)}) {
      ASSERT_EQ(lw_prm_entry_irradiance(prm.get(), plain.data(), uint32_t(count), nullptr, nullptr, entries.data()), LW_OK);
      ASSERT_EQ(lw_prm_cluster_irradiance(prm.get(), entries.data(), clusters.data()), LW_OK);
      ASSERT_EQ(lw_gl_update_entries(gl_prm.get(), lights.data(), uint32_t(count)), LW_OK);
      const auto gl_entries = readEntries(gl_prm.get());
      ASSERT_EQ(lw_gl_read_clusters(gl_prm.get(), gl_clusters.data()), LW_OK);
      if (!count) {
        for (const float v : gl_entries) ASSERT_EQ(v, 0.0f);
        for (const float v : gl_clusters) ASSERT_EQ(v, 0.0f);
        continue;
      }
      const double most = layout == Layout::local_bases ? kRectangleError : 1e-5;
      EXPECT_LT(relrmse(gl_entries, entries), most);
      EXPECT_LT(relrmse(gl_clusters, clusters), most);
      ASSERT_EQ(lw_gl_evaluate(gl_prm.get(), nullptr), LW_OK);
      EXPECT_LT(relrmse(readAtlas(gl_prm.get()), synthetic.evaluate(clusters)), 0.002);
    }
  }
}

TEST_P(GlEvaluate, AveragesLightOverRectanglesAsTheCpuDoes) {
  for (const auto& normal : kRectangleNormals) {
    const RectangleEntries rectangle(normal);
    load(rectangle.options());
    const GlPrm gl_prm = upload();
    std::vector<float> cpu(size_t(synthetic.entries()) * 3);
    for (const auto& [u, v, height] : RectangleEntries::lightPlaces(40)) {
      const auto p = rectangle.at(u, v, height);
      const lw_gl_light light = glPointLight(p[0], p[1], p[2], 1);
      ASSERT_EQ(lw_gl_update_entries(gl_prm.get(), &light, 1), LW_OK);
      ASSERT_EQ(lw_prm_entry_irradiance(prm.get(), &light.light, 1, nullptr, nullptr, cpu.data()), LW_OK);
      const auto entries = readEntries(gl_prm.get());
      for (size_t e = 0; e < 5; ++e) ASSERT_NEAR(entries[e * 3], cpu[e * 3], 1e-3f * cpu[e * 3]) << e << " at " << height;
      EXPECT_NEAR(entries[0], RectangleEntries::meanIrradiance(u, v, height), 3e-3 * entries[0]);
    }
  }
}

TEST_P(GlReconstruct, SumsAtTheirLimits) {
  for (const uint32_t side : kReconstructions) {
    SCOPED_TRACE(side);
    reconstruct = side;
    for (const SyntheticOptions& options : extremeLocalBases()) {
      load(options);
      const GlPrm gl_prm = upload();
      std::vector<float> irradiance(size_t(options.clusters) * 3);
      for (size_t i = 0; i < irradiance.size(); ++i) irradiance[i] = 0.5f + float(i);
      ASSERT_EQ(lw_gl_upload_cluster_irradiance(gl_prm.get(), irradiance.data()), LW_OK);
      ASSERT_EQ(lw_gl_evaluate(gl_prm.get(), nullptr), LW_OK);
      EXPECT_LT(relrmse(readAtlas(gl_prm.get()), synthetic.evaluate(irradiance)), 1e-5) << options.clusters << " clusters, " << options.blocks << " blocks";
    }
  }
}

/// Amounts of blocks are summed from what was updated last, on whichever side.
TEST_P(GlReconstruct, FollowsWhicheverLightCameLast) {
  for (const uint32_t side : kReconstructions) {
    SCOPED_TRACE(side);
    reconstruct = side;
    SyntheticOptions options;
    options.layout = Layout::local_bases;
    load(options);
    const GlPrm gl_prm = upload();
    prm.reset();  // what is on OpenGL needs it no longer
    std::vector<float> clusters(size_t(options.clusters) * 3);
    const lw_gl_light light = glPointLight(0.5f, 2, -0.5f, 20);
    const double most = 3 * lw_prm_options LW_PRM_OPTIONS_INIT.tolerance;  // each side leaves something out
    for (const int round : {0, 1}) {
      const auto irradiance = randomIrradiance(options.clusters, 20 + uint32_t(round));
      ASSERT_EQ(lw_gl_upload_cluster_irradiance(gl_prm.get(), irradiance.data()), LW_OK);
      for (int repeated = 0; repeated < 2; ++repeated) {
        ASSERT_EQ(lw_gl_evaluate(gl_prm.get(), nullptr), LW_OK);
        EXPECT_LT(relrmse(readAtlas(gl_prm.get()), synthetic.evaluate(irradiance)), most);
      }
      ASSERT_EQ(lw_gl_update_entries(gl_prm.get(), &light, 1), LW_OK);
      ASSERT_EQ(lw_gl_evaluate(gl_prm.get(), nullptr), LW_OK);
      ASSERT_EQ(lw_gl_read_clusters(gl_prm.get(), clusters.data()), LW_OK);
      EXPECT_LT(relrmse(readAtlas(gl_prm.get()), synthetic.evaluate(clusters)), most);
    }
  }
}

/// Sums that are kept from frame to frame do not drift, forget no block, and hold a dim light after a bright one.
TEST_P(GlReconstruct, FollowsSmallChangesForLong) {
  for (const uint32_t side : kReconstructions) {
    SCOPED_TRACE(side);
    reconstruct = side;
    SyntheticOptions options;
    options.layout = Layout::local_bases;
    options.clusters = 300, options.blocks = 60;
    load(options);
    const GlPrm gl_prm = upload();
    auto irradiance = randomIrradiance(options.clusters, 5);
    const auto check = [&](int frame) {
      ASSERT_EQ(lw_gl_upload_cluster_irradiance(gl_prm.get(), irradiance.data()), LW_OK);
      ASSERT_EQ(lw_gl_evaluate(gl_prm.get(), nullptr), LW_OK);
      if (frame % 10 == 0) { ASSERT_LT(relrmse(readAtlas(gl_prm.get()), synthetic.evaluate(irradiance)), 0.001) << "frame " << frame; }
    };
    for (int frame = 0; frame < 200; ++frame) {
      for (int k = 0; k < 3; ++k) irradiance[size_t(frame * 7 % 300 * 3 + k)] = 0.1f * float(frame % 23);
      check(frame);
    }
    for (const float factor : {1e7f, 1e-7f, 1e-7f, 1e7f}) {
      for (float& e : irradiance) e *= factor;
      check(0);
    }
    std::fill(irradiance.begin(), irradiance.end(), 0.0f);
    lw_prm_options dark = LW_PRM_OPTIONS_INIT;
    dark.emitters = LW_EMITTERS_OFF;
    ASSERT_EQ(lw_gl_upload_cluster_irradiance(gl_prm.get(), irradiance.data()), LW_OK);
    ASSERT_EQ(lw_gl_evaluate(gl_prm.get(), &dark), LW_OK);
    const auto atlas = readAtlas(gl_prm.get());
    for (size_t i = 0; i < atlas.size(); ++i) ASSERT_TRUE(i % 4 == 3 || atlas[i] == 0.0f);
  }
}

/// What the CPU uploads is the nearest half of each value, at most the greatest.
TEST_P(GlReconstruct, RoundsToTheNearestHalf) {
  SyntheticOptions options;
  options.layout = Layout::local_bases;
  load(options);
  reconstruct = LW_GL_RECONSTRUCT_CPU;
  const GlPrm gl_prm = upload(LW_GL_ATLAS_RGBA16F);
  std::vector<uint32_t> scratch(lw_prm_scratch_bytes(prm.get()) / 4);
  std::vector<float> cpu(synthetic.source.size() * 4);
  const auto irradiance = randomIrradiance(options.clusters, 2);
  size_t subnormal = 0, above = 0;
  for (const float factor : {1.0f, 1e-7f, 1e7f}) {
    auto scaled = irradiance;
    for (float& e : scaled) e *= factor;
    lw_prm_options evaluate = LW_PRM_OPTIONS_INIT;
    evaluate.tolerance = 0, evaluate.emitters = LW_EMITTERS_OFF;
    ASSERT_EQ(lw_prm_evaluate(prm.get(), scaled.data(), &evaluate, scratch.data(), scratch.size() * 4, cpu.data()), LW_OK);
    ASSERT_EQ(lw_gl_upload_cluster_irradiance(gl_prm.get(), scaled.data()), LW_OK);
    ASSERT_EQ(lw_gl_evaluate(gl_prm.get(), &evaluate), LW_OK);
    const auto atlas = readAtlas(gl_prm.get());
    for (size_t i = 0; i < atlas.size(); ++i) {
      ASSERT_EQ(atlas[i], format::unpackHalf(format::packHalf(std::min(cpu[i], 65504.0f)))) << cpu[i];
      subnormal += atlas[i] > 0 && atlas[i] < 0x1p-14f;
      above += cpu[i] > 65504.0f;
    }
  }
  EXPECT_GT(subnormal, 100u);
  EXPECT_GT(above, 100u);
}

TEST_P(GlReconstruct, MakesItsOwnAtlasOnly) {
  SyntheticOptions options;
  options.layout = Layout::local_bases;
  load(options);
  GLuint texture = 0;
  glGenTextures(1, &texture);
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, 64, 64, 0, GL_RGBA, GL_FLOAT, nullptr);
  lw_gl_prm_options gl_options = LW_GL_PRM_OPTIONS_INIT;
  gl_options.atlas_format = LW_GL_ATLAS_RGBA32F, gl_options.atlas_texture = texture;
  const auto irradiance = randomIrradiance(options.clusters, 8);
  for (const uint32_t side : {LW_GL_RECONSTRUCT_AUTO, LW_GL_RECONSTRUCT_SHADER}) {
    gl_options.reconstruct = side;
    lw_gl_prm* gl_prm = nullptr;
    ASSERT_EQ(lw_gl_prm_create(gl, prm.get(), &gl_options, &gl_prm), LW_OK);
    ASSERT_EQ(lw_gl_upload_cluster_irradiance(gl_prm, irradiance.data()), LW_OK);
    ASSERT_EQ(lw_gl_evaluate(gl_prm, nullptr), LW_OK);
    EXPECT_LT(relrmse(readAtlas(gl_prm), synthetic.evaluate(irradiance)), 1e-3);
    lw_gl_prm_destroy(gl_prm);
  }
  lw_gl_prm* gl_prm = nullptr;
  gl_options.reconstruct = LW_GL_RECONSTRUCT_CPU;
  EXPECT_EQ(lw_gl_prm_create(gl, prm.get(), &gl_options, &gl_prm), LW_INVALID_ARGUMENT);
  gl_options.atlas_texture = 0, gl_options.reconstruct = 3;
  EXPECT_EQ(lw_gl_prm_create(gl, prm.get(), &gl_options, &gl_prm), LW_INVALID_ARGUMENT);
  EXPECT_EQ(gl_prm, nullptr);
  glDeleteTextures(1, &texture);
}

/// Lists longer than a row and than a layer of a texture (2048 and 2048²) keep their order.
TEST_P(GlEvaluate, HandlesLongLists) {
  SyntheticOptions options;
  options.width = 150;
  options.height = 140;
  options.clusters = 600;  // 600 panes of about 8,400 texels: 5 million values
  options.emitters = false;
  load(options);
  const auto irradiance = randomIrradiance(options.clusters, 3);
  const GlPrm gl_prm = upload();
  ASSERT_EQ(lw_gl_upload_cluster_irradiance(gl_prm.get(), irradiance.data()), LW_OK);
  ASSERT_EQ(lw_gl_evaluate(gl_prm.get(), nullptr), LW_OK);
  EXPECT_LT(relrmse(readAtlas(gl_prm.get()), synthetic.evaluate(irradiance)), 1e-5);
  EXPECT_GT(lw_gl_prm_texture_bytes(gl_prm.get()), uint64_t(2048) * 2048 * 4);
}

TEST_P(GlEvaluate, WritesIntoTheCallersTexture) {
  load({});
  GLuint texture = 0;
  glGenTextures(1, &texture);
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, 64, 64, 0, GL_RGBA, GL_FLOAT, nullptr);
  lw_gl_prm_options options = LW_GL_PRM_OPTIONS_INIT;
  options.atlas_format = LW_GL_ATLAS_RGBA32F;
  options.atlas_texture = texture;
  lw_gl_prm* gl_prm = nullptr;
  ASSERT_EQ(lw_gl_prm_create(gl, prm.get(), &options, &gl_prm), LW_OK);
  EXPECT_EQ(lw_gl_prm_atlas_texture(gl_prm), texture);
  const auto irradiance = randomIrradiance(synthetic.options.clusters, 8);
  ASSERT_EQ(lw_gl_upload_cluster_irradiance(gl_prm, irradiance.data()), LW_OK);
  ASSERT_EQ(lw_gl_evaluate(gl_prm, nullptr), LW_OK);
  EXPECT_LT(relrmse(readAtlas(gl_prm), synthetic.evaluate(irradiance)), 1e-5);
  lw_gl_prm_destroy(gl_prm);
  EXPECT_TRUE(glIsTexture(texture));
  glDeleteTextures(1, &texture);
}

TEST_P(GlEvaluate, RunsOnTheLeastVersions) {
  GLint major = 0, minor = 0;
  glGetIntegerv(GL_MAJOR_VERSION, &major);
  glGetIntegerv(GL_MINOR_VERSION, &minor);
  EXPECT_EQ(major * 10 + minor, GetParam() == Api::desktop33 ? 33 : 30);
}

TEST_P(GlEvaluate, RejectsWrongArguments) {
  load({});
  const GlPrm gl_prm = upload();
  lw_gl_light light = glPointLight(0, 0, 0, 1);
  light.shadow = LW_GL_SHADOW_CUBE;
  EXPECT_EQ(lw_gl_update_entries(gl_prm.get(), &light, 1), LW_INVALID_ARGUMENT);
  EXPECT_THAT(message, testing::HasSubstr("light 0"));
  light.shadow_texture = 1;
  light.near_m = 0;
  EXPECT_EQ(lw_gl_update_entries(gl_prm.get(), &light, 1), LW_INVALID_ARGUMENT);
  light = glPointLight(0, 0, 0, -1);
  EXPECT_EQ(lw_gl_update_entries(gl_prm.get(), &light, 1), LW_INVALID_ARGUMENT);
  EXPECT_EQ(lw_gl_update_coefficients(gl_prm.get()), LW_INVALID_ARGUMENT);
  EXPECT_EQ(lw_gl_evaluate(nullptr, nullptr), LW_INVALID_ARGUMENT);
  lw_gl_config config = LW_GL_CONFIG_INIT;
  config.loader = [](void*, const char*) -> lw_gl_proc { return nullptr; };
  lw_gl* other = nullptr;
  EXPECT_EQ(lw_gl_create(&config, &other), LW_GL_UNSUPPORTED);
  EXPECT_EQ(other, nullptr);
}

}  // namespace
}  // namespace lightwell::test
