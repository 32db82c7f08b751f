// A context with the library's programs in it.
#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/runtime/gl_context.h"

namespace lightwell::test {

class GlTest : public testing::TestWithParam<Api> {
 protected:
  GlTest() : context(GetParam()) {}
  void SetUp() override {
    ASSERT_TRUE(context.good()) << "no surfaceless EGL context";
    lw_gl_config config = LW_GL_CONFIG_INIT;
    config.loader = GlContext::load;
    config.message = [](void* user, lw_result, const char* text) { *static_cast<std::string*>(user) = text; };
    config.message_user = &message;
    ASSERT_EQ(lw_gl_create(&config, &gl), LW_OK) << message;
  }
  /// What was made with `gl` is gone by then.
  void TearDown() override {
    EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
    lw_gl_destroy(gl);
  }

  GlContext context;
  std::string message;
  lw_gl* gl = nullptr;
};

/// rms(a − b) over rms(b).
inline double relrmse(const std::vector<float>& a, const std::vector<float>& b) {
  double difference = 0, square = 0;
  for (size_t i = 0; i < b.size(); ++i) difference += std::pow(double(a[i]) - double(b[i]), 2), square += std::pow(double(b[i]), 2);
  return square > 0 ? std::sqrt(difference / square) : std::sqrt(difference);
}

}  // namespace lightwell::test
