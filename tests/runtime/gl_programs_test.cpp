// A context compiles what it meets, once, and nothing else.
#include "tests/runtime/gl_fixture.h"

namespace lightwell::test {
namespace {

class GlPrograms : public GlFixture {
 protected:
  void SetUp() override {
    GlFixture::SetUp();
    linked = 0;
    lw_gl_config config = LW_GL_CONFIG_INIT;
    config.loader = [](void* user, const char* name) {
      const lw_gl_proc function = GlContext::load(user, name);
      if (std::string(name) != "glLinkProgram") return function;
      link = reinterpret_cast<void (*)(GLuint)>(function);
      return reinterpret_cast<lw_gl_proc>(+[](GLuint program) {
        ++linked;
        link(program);
      });
    };
    lw_gl_destroy(gl);
    ASSERT_EQ(lw_gl_create(&config, &gl), LW_OK);
  }
  /// How many programs `act` has linked.
  template <class Act>
  static int newIn(Act act) {
    const int before = linked;
    act();
    return linked - before;
  }

  static inline int linked = 0;
  static inline void (*link)(GLuint) = nullptr;
};
LW_INSTANTIATE_GL(GlPrograms);

TEST_P(GlPrograms, AreCompiledForWhatIsThere) {
  EXPECT_EQ(linked, 0) << "a context alone needs none";
  SyntheticOptions options;
  options.layout = Layout::local_bases;
  load(options);
  GlPrm bases{nullptr, lw_gl_prm_destroy}, again{nullptr, lw_gl_prm_destroy}, panes{nullptr, lw_gl_prm_destroy};
  EXPECT_EQ(newIn([&] { bases = upload(); }), synthetic.entries() == options.clusters ? 1 : 2) << "reconstruction, and averages where clusters have several entries";
  EXPECT_EQ(newIn([&] { again = upload(); }), 0);

  lw_gl_light light = glPointLight(0, 2, 0, 10);
  const auto update = [&] { EXPECT_EQ(lw_gl_update_entries(bases.get(), &light, 1), LW_OK) << message; };
  EXPECT_EQ(newIn(update), 1);
  EXPECT_EQ(newIn(update), 0);
  ASSERT_EQ(lw_gl_create_visibility(bases.get(), &light.shadow_texture), LW_OK);
  light.shadow = LW_GL_SHADOW_VISIBILITY;
  EXPECT_EQ(newIn(update), 1);
  EXPECT_EQ(newIn([&] { EXPECT_EQ(lw_gl_prepare_shadow(gl, LW_GL_SHADOW_CUBE), LW_OK); }), 1);
  EXPECT_EQ(newIn([&] { EXPECT_EQ(lw_gl_prepare_shadow(gl, LW_GL_SHADOW_CUBE), LW_OK); }), 0);
  EXPECT_EQ(newIn([&] { EXPECT_EQ(lw_gl_update_entries(bases.get(), nullptr, 0), LW_OK); }), 0) << "as a light without a shadow";
  EXPECT_EQ(lw_gl_prepare_shadow(gl, 4), LW_INVALID_ARGUMENT);
  EXPECT_EQ(lw_gl_prepare_shadow(nullptr, 0), LW_INVALID_ARGUMENT);
  lw_gl_destroy_visibility(bases.get(), light.shadow_texture);

  options.layout = Layout::panes_rgb9e5;
  load(options);
  EXPECT_GE(newIn([&] { panes = upload(); }), 3) << "rank, selection, panes";
}

}  // namespace
}  // namespace lightwell::test
