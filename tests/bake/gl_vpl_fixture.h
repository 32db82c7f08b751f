// Light maps drawn on OpenGL, and their values by slot.
#pragma once
#include "lightwell/lightwell_gl_vpl.h"
#include "tests/bake/lit_room.h"
#include "tests/runtime/gl_fixture.h"

namespace lightwell::bake {

using GlVpl = std::unique_ptr<lw_gl_vpl, decltype(&lw_gl_vpl_destroy)>;

class GlVplTest : public test::GlTest {
 protected:
  /// In floats, each covered texel with its own value.
  GlVpl create(const LitRoom& room, lw_gl_vpl_options options) {
    lw_gl_vpl* vpl = nullptr;
    options.atlas_format = LW_GL_ATLAS_RGBA32F;
    options.fill = 0;
    EXPECT_EQ(lw_gl_vpl_create(gl, room.container, room.virtual_lights, &options, &vpl), LW_OK) << message;
    return {vpl, lw_gl_vpl_destroy};
  }
  /// Draws all that is left; returns how many lights that were.
  size_t finish(lw_gl_vpl* vpl) {
    size_t drawn = 0;
    for (lw_gl_vpl_progress progress{0, 1, 0}; progress.lights_left > 0; drawn += progress.lights_drawn) EXPECT_EQ(lw_gl_vpl_step(vpl, 1000, &progress), LW_OK) << message;
    return drawn;
  }
  std::vector<Vec3d> read(const LitRoom& room, lw_gl_vpl* vpl) {
    const auto& slot_of = room.p.atlas.texel_slot;
    std::vector<float> rgba(slot_of.size() * 4);
    EXPECT_EQ(lw_gl_vpl_read(vpl, rgba.data()), LW_OK) << message;
    std::vector<Vec3d> values;
    for (size_t texel = 0; texel < slot_of.size(); ++texel) {
      EXPECT_EQ(rgba[texel * 4 + 3], slot_of[texel] == kNone ? 0 : 1) << "texel " << texel;
      if (slot_of[texel] == kNone) continue;
      values.emplace_back(rgba[texel * 4], rgba[texel * 4 + 1], rgba[texel * 4 + 2]);
      EXPECT_TRUE(values.back().x >= 0 && values.back().x < 1e30) << "texel " << texel;
    }
    return values;
  }
  std::vector<Vec3d> draw(const LitRoom& room, const lw_gl_vpl_options& options) {
    const GlVpl vpl = create(room, options);
    finish(vpl.get());
    return read(room, vpl.get());
  }
};

/// rms(a − b) / rms(b) over the slots that count.
template <class Counts>
double relativeError(const std::vector<Vec3d>& a, const std::vector<Vec3d>& b, Counts counts) {
  double difference = 0, square = 0;
  for (size_t i = 0; i < b.size(); ++i)
    if (counts(i)) difference += (a[i] - b[i]).length2(), square += b[i].length2();
  return std::sqrt(difference / square);
}
inline double relativeError(const std::vector<Vec3d>& a, const std::vector<Vec3d>& b) {
  return relativeError(a, b, [](size_t) { return true; });
}
inline double meanOf(const std::vector<Vec3d>& values) {
  double sum = 0;
  for (const Vec3d& v : values) sum += v.x;
  return sum / double(values.size());
}

}  // namespace lightwell::bake
