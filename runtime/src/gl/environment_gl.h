// A sky on the GPU: its cells in a uniform block, its prefiltered picture, and a depth map for each cell.
#pragma once
#include "runtime/src/gl/context.h"
#include "runtime/src/gl/texture.h"

namespace lightwell::runtime::gl {

inline constexpr uint32_t kSkyLevels = 16, kGgxRows = 38;
inline constexpr int32_t kMapMargin = 2;  // texels around a map's picture where nothing is drawn: beside the bounds all is lit

/// The uniform block LwEnvironment (environment_shader.cpp), layout std140; the cells follow it.
struct EnvironmentBlock {
  struct Level {
    float x, y, cells, log_shininess;  // the logarithm in the last level only
  };
  int32_t cells = 0, suns = 0, levels = 0, unused = 0;
  int32_t technique = 0, taps = 0, unused2[2] = {};
  struct Maps {
    int32_t in_row, texels, first_row, unused;
  };
  Maps sun_maps = {}, cell_maps = {};
  float scale_rgb[3] = {1, 1, 1}, margin = 0;
  float center_m[3] = {}, sky_scale = 1;
  float extent_m[3] = {}, least_extent_m = 0;
  float depth_texel[2] = {}, sky_texel[2] = {};
  float harmonic[9][4] = {};
  Level level[kSkyLevels] = {};
  float ggx[kGgxRows][4] = {};
};
static_assert(sizeof(EnvironmentBlock) == (8 + 9 + kSkyLevels + kGgxRows) * 16);

struct EnvironmentBlockCell {
  float direction[3], spread;
  float flux_rgb[3], solid_angle_sr;
  float covariance[3], unused;
};
static_assert(sizeof(EnvironmentBlockCell) == 48);

/// When a cell's depth map was drawn.
struct DepthMapAge {
  float power = 0;     // luminance of the cell's flux
  uint32_t calls = 0;  // of lw_gl_environment_refresh since
  bool drawn = false;
};

/// The picture of a sky: mean radiance under normalised Phong lobes, levels side by side in six layers.
struct SkyPicture {
  Array<uint32_t> texels;  // RGB9E5 [6][height][width]
  int32_t width = 0, height = 0;
  uint32_t levels = 0;
  EnvironmentBlock::Level level[kSkyLevels] = {};
  float scale = 1;         // radiance = scale × texel
};

}  // namespace lightwell::runtime::gl

struct lw_gl_environment {
  using Name = lightwell::runtime::gl::Name;

  lightwell::runtime::Host host;
  lw_gl* context = nullptr;
  uint32_t cells = 0;
  uint64_t texture_bytes = 0;
  Name buffer = 0;            // EnvironmentBlock and the cells
  Name sky = 0;               // RGB9E5 GL_TEXTURE_2D_ARRAY
  Name depth = 0, framebuffer = 0;
  lightwell::runtime::gl::EnvironmentBlock block;
  lightwell::runtime::Array<float> direction;  // [cells][3]
  lightwell::runtime::Array<lightwell::runtime::gl::DepthMapAge> age;
};

namespace lightwell::runtime::gl {

/// Integrates the sky into its picture. False when there is no memory.
bool makeSkyPicture(const Host& host, const lw_environment& environment, SkyPicture& picture);

/// Where cell `i`'s map lies in the depth atlas, and its side.
struct MapPlace {
  int32_t x, y, texels;
};
MapPlace mapPlace(const lw_gl_environment& environment, uint32_t cell);
/// Marks all maps as not drawn, and makes them so that nothing is hidden. Inside of a StateGuard.
void clearDepthMaps(lw_gl_environment& environment);
/// Sets the bounds that the maps are fitted to; null, or what is wrong with them.
const char* setBounds(lw_gl_environment& environment, const float* bounds_min_m, const float* bounds_max_m);
/// Sends the block, without the cells, to the GPU. Inside of a BufferGuard.
void uploadBlock(const lw_gl_environment& environment);

/// Saves and restores the binding of uniform buffers.
class BufferGuard {
 public:
  explicit BufferGuard(const Api& api) : api_(api) { api.GetIntegerv(kUniformBufferBinding, &buffer_); }
  ~BufferGuard() { api_.BindBuffer(kUniformBuffer, Name(buffer_)); }
  BufferGuard(const BufferGuard&) = delete;
  BufferGuard& operator=(const BufferGuard&) = delete;

 private:
  const Api& api_;
  int32_t buffer_ = 0;
};

}  // namespace lightwell::runtime::gl
