// Making, binding and destroying a sky on the GPU.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "runtime/src/environment.h"
#include "runtime/src/ggx_weights.h"
#include "runtime/src/gl/environment_gl.h"
#include "runtime/src/light.h"

namespace lightwell::runtime::gl {
namespace {

constexpr uint32_t kSmallestMap = 16, kLargestMap = 2048, kLargestSunMap = 4096;

float luminance(const float* rgb) { return 0.2126f * rgb[0] + 0.7152f * rgb[1] + 0.0722f * rgb[2]; }

/// Irradiance coefficients of everything, the suns included, for the polynomials of lwEnvironmentHarmonicIrradiance: bands scaled by π,
/// 2π/3, π/4 (Ramamoorthi and Hanrahan 2001, equation 8), and by the constants of the basis.
void packHarmonics(const lw_environment& e, EnvironmentBlock& block) {
  constexpr double y[9] = {0.28209479177387814, 0.48860251190291992, 0.48860251190291992, 0.48860251190291992, 1.0925484305920792,
                           1.0925484305920792,  0.31539156525252005, 1.0925484305920792,  0.54627421529603959};
  constexpr double band[3] = {3.14159265358979, 2.09439510239320, 0.785398163397448};
  for (uint32_t k = 0; k < 9; ++k)
    for (uint32_t c = 0; c < 3; ++c) {
      double sum = e.header.radiance_sh_rgb[k * 3 + c];
      for (uint32_t i = 0; i < e.header.suns; ++i) {
        const float* d = &e.direction[i * 3];
        const double polynomial[9] = {1,           d[1],        d[2],                   d[0],       double(d[0]) * d[1], double(d[1]) * d[2],
                                      3.0 * d[2] * d[2] - 1, double(d[0]) * d[2], double(d[0]) * d[0] - double(d[1]) * d[1]};
        sum += y[k] * polynomial[k] * e.flux_rgb[i * 3 + c];
      }
      block.harmonic[k][c] = float(sum * y[k] * band[k == 0 ? 0 : k < 4 ? 1 : 2]);
    }
}

/// Makes buffer and textures one after the other.
class Uploader {
 public:
  Uploader(lw_gl_environment& out, const lw_environment& environment, const lw_gl_environment_options& options)
      : out_(out), api_(out.context->api), e_(environment), options_(options) {}

  lw_result upload() {
    const uint32_t most = (uint32_t(api_.max_uniform_block_bytes) - uint32_t(sizeof(EnvironmentBlock))) / sizeof(EnvironmentBlockCell);
    out_.cells = options_.cells ? std::min(options_.cells, e_.header.cells) : e_.header.cells;
    if (out_.cells < e_.header.suns) return fail("cells: fewer than the %u suns", e_.header.suns);
    if (out_.cells > most)
      return out_.host.fail(LW_LIMIT_EXCEEDED, "%u cells do not fit into a uniform block of the context, %u would", out_.cells, most);
    if (const char* reason = setBounds(out_, options_.bounds_min_m, options_.bounds_max_m)) return fail("bounds: %s", reason);
    api_.clearErrors();
    lw_result result = uploadSky();
    if (!result) result = makeDepthMaps();
    if (!result) result = uploadCells();
    if (!result)
      if (const Enum error = api_.GetError(); error != kNoError)
        return out_.host.fail(error == kOutOfMemory ? LW_OUT_OF_MEMORY : LW_GL_FAILED, "uploading the environment: GL error 0x%04x", error);
    return result;
  }

 private:
  template <class... Values>
  lw_result fail(const char* format, Values... values) {
    return out_.host.fail(LW_INVALID_ARGUMENT, format, values...);
  }
  lw_result noMemory() { return out_.host.fail(LW_OUT_OF_MEMORY, "no memory to upload an environment"); }

  lw_result uploadSky() {
    SkyPicture picture;
    if (!makeSkyPicture(out_.host, e_, picture)) return noMemory();
    if (std::max(picture.width, picture.height) > api_.max_texture_size)
      return out_.host.fail(LW_LIMIT_EXCEEDED, "the sky's picture of %d x %d texels is larger than the context's textures", picture.width,
                            picture.height);
    api_.ActiveTexture(kTexture0);
    api_.GenTextures(1, &out_.sky);
    api_.BindTexture(kTexture2dArray, out_.sky);
    for (const Enum filter : {kTextureMinFilter, kTextureMagFilter}) api_.TexParameteri(kTexture2dArray, filter, int32_t(kLinear));
    for (const Enum wrap : {kTextureWrapS, kTextureWrapT}) api_.TexParameteri(kTexture2dArray, wrap, int32_t(kClampToEdge));
    api_.TexParameteri(kTexture2dArray, kTextureMaxLevel, 0);
    api_.TexImage3D(kTexture2dArray, 0, int32_t(kRgb9e5), picture.width, picture.height, 6, 0, kRgb, kUnsignedInt5999Rev,
                    picture.texels.data());
    out_.texture_bytes += picture.texels.bytes();
    std::memcpy(out_.block.level, picture.level, sizeof picture.level);
    out_.block.levels = int32_t(picture.levels);
    out_.block.sky_scale = picture.scale;
    out_.block.sky_texel[0] = 1 / float(picture.width);
    out_.block.sky_texel[1] = 1 / float(picture.height);
    return LW_OK;
  }

  lw_result makeDepthMaps() {
    const uint32_t texels = options_.map_texels, sun_texels = options_.sun_map_texels;
    if (texels < kSmallestMap || texels > kLargestMap) return fail("map_texels: not between %u and %u", kSmallestMap, kLargestMap);
    if (sun_texels < kSmallestMap || sun_texels > kLargestSunMap)
      return fail("sun_map_texels: not between %u and %u", kSmallestMap, kLargestSunMap);
    // About square: rows of the suns' maps, below them rows of the others'.
    const uint32_t suns = e_.header.suns, others = out_.cells - suns;
    const double area = double(suns) * sun_texels * sun_texels + double(others) * texels * texels;
    const auto columns = [&](uint32_t side) { return std::max(1u, uint32_t(std::ceil(std::sqrt(area) / side))); };
    const uint32_t in_row = std::min(columns(texels), std::max(1u, others)), suns_in_row = std::min(columns(sun_texels), std::max(1u, suns));
    const uint32_t sun_rows = (suns + suns_in_row - 1) / suns_in_row, rows = (others + in_row - 1) / in_row;
    const uint64_t wide = std::max(uint64_t(in_row) * texels, uint64_t(suns ? suns_in_row : 0) * sun_texels);
    const uint64_t high = uint64_t(sun_rows) * sun_texels + uint64_t(rows) * texels;
    if (std::max(wide, high) > uint64_t(api_.max_texture_size))
      return out_.host.fail(LW_LIMIT_EXCEEDED, "the depth maps of %u cells take %llu x %llu texels, more than the context's textures have",
                            out_.cells, static_cast<unsigned long long>(wide), static_cast<unsigned long long>(high));
    const int32_t width = int32_t(wide), height = int32_t(high);
    out_.block.suns = int32_t(suns);
    out_.block.sun_maps = {int32_t(suns_in_row), int32_t(sun_texels), 0, 0};
    out_.block.cell_maps = {int32_t(in_row), int32_t(texels), int32_t(sun_rows * sun_texels), 0};
    out_.block.margin = float(kMapMargin);
    out_.block.depth_texel[0] = 1 / float(width);
    out_.block.depth_texel[1] = 1 / float(height);
    out_.depth = createPicture(api_, {kDepthComponent16, kDepthComponent, kUnsignedShort, 2}, width, height, kNearest, nullptr,
                               out_.texture_bytes);
    api_.GenFramebuffers(1, &out_.framebuffer);
    api_.BindFramebuffer(kDrawFramebuffer, out_.framebuffer);
    api_.BindFramebuffer(kReadFramebuffer, out_.framebuffer);
    api_.FramebufferTexture2D(kDrawFramebuffer, kDepthAttachment, kTexture2d, out_.depth, 0);
    constexpr Enum kNone = 0;
    api_.DrawBuffers(1, &kNone);
    api_.ReadBuffer(kNone);
    if (const Enum status = api_.CheckFramebufferStatus(kDrawFramebuffer); status != kFramebufferComplete)
      return out_.host.fail(LW_GL_FAILED, "the framebuffer of the depth maps is incomplete (0x%04x)", status);
    if (!out_.age.allocate(out_.host, out_.cells) || !out_.direction.allocate(out_.host, size_t(out_.cells) * 3)) return noMemory();
    std::memcpy(out_.direction.data(), e_.direction.data(), out_.direction.bytes());
    float total = 0;
    for (uint32_t i = 0; i < out_.cells; ++i) total += luminance(&e_.flux_rgb[i * 3]);
    const float least = total > 0 ? 1e-3f * total / float(out_.cells) : 1.0f;  // dark cells have their turn too
    for (uint32_t i = 0; i < out_.cells; ++i) out_.age[i] = {std::max(luminance(&e_.flux_rgb[i * 3]), least), 0, false};
    clearDepthMaps(out_);
    return LW_OK;
  }

  lw_result uploadCells() {
    EnvironmentBlock& block = out_.block;
    block.cells = int32_t(out_.cells);
    packHarmonics(e_, block);
    static_assert(kGgxRows == runtime::kGgxRows);
    std::memcpy(block.ggx, kGgxWeight, sizeof block.ggx);
    // Fewer cells than there are carry the light of all.
    float scale[3];
    for (size_t c = 0; c < 3; ++c) {
      double all = 0, used = 0;
      for (size_t i = e_.header.suns; i < e_.header.cells; ++i) {
        all += e_.flux_rgb[i * 3 + c];
        if (i < out_.cells) used += e_.flux_rgb[i * 3 + c];
      }
      scale[c] = used > 0 ? float(all / used) : 1.0f;
    }
    Array<EnvironmentBlockCell> cells;
    const size_t capacity = (size_t(api_.max_uniform_block_bytes) - sizeof block) / sizeof(EnvironmentBlockCell);
    if (!cells.allocate(out_.host, std::min(capacity, size_t(kMostCells)))) return noMemory();
    std::memset(cells.data(), 0, cells.bytes());
    for (size_t i = 0; i < out_.cells; ++i) {
      EnvironmentBlockCell& cell = cells[i];
      for (size_t c = 0; c < 3; ++c) {
        cell.direction[c] = e_.direction[i * 3 + c];
        cell.flux_rgb[c] = e_.flux_rgb[i * 3 + c] * (i < e_.header.suns ? 1.0f : scale[c]);
        cell.covariance[c] = e_.covariance[i * 3 + c];
      }
      cell.spread = e_.spread[i];
      cell.solid_angle_sr = e_.solid_angle_sr[i];
    }
    api_.GenBuffers(1, &out_.buffer);
    const BufferGuard guard(api_);
    api_.BindBuffer(kUniformBuffer, out_.buffer);
    api_.BufferData(kUniformBuffer, ptrdiff_t(sizeof block + cells.bytes()), nullptr, kStaticDraw);
    api_.BufferSubData(kUniformBuffer, 0, sizeof block, &block);
    api_.BufferSubData(kUniformBuffer, sizeof block, ptrdiff_t(cells.bytes()), cells.data());
    return LW_OK;
  }

  static constexpr uint32_t kMostCells = 4096;
  lw_gl_environment& out_;
  const Api& api_;
  const lw_environment& e_;
  const lw_gl_environment_options& options_;
};

}  // namespace

void uploadBlock(const lw_gl_environment& environment) {
  const Api& api = environment.context->api;
  api.BindBuffer(kUniformBuffer, environment.buffer);
  api.BufferSubData(kUniformBuffer, 0, sizeof environment.block, &environment.block);
}

}  // namespace lightwell::runtime::gl

using namespace lightwell::runtime;
using namespace lightwell::runtime::gl;

lw_result lw_gl_environment_create(lw_gl* gl, const lw_environment* environment, const lw_gl_environment_options* options,
                                   lw_gl_environment** out) {
  if (!gl || !environment || !options || options->size < sizeof(lw_gl_environment_options) || !out) return LW_INVALID_ARGUMENT;
  lw_gl_environment* made = createHandle<lw_gl_environment>(gl->host);
  if (!made) return gl->host.fail(LW_OUT_OF_MEMORY, "no memory for the handle of an environment");
  made->context = gl;
  lw_result result;
  {
    const StateGuard guard(gl->api);
    result = Uploader(*made, *environment, *options).upload();
    gl->api.clearErrors();
  }
  if (result) {
    lw_gl_environment_destroy(made);
    return result;
  }
  *out = made;
  return LW_OK;
}

void lw_gl_environment_destroy(lw_gl_environment* environment) {
  if (!environment) return;
  const Api& api = environment->context->api;
  if (environment->framebuffer) api.DeleteFramebuffers(1, &environment->framebuffer);
  for (const Name* texture : {&environment->depth, &environment->sky})
    if (*texture) api.DeleteTextures(1, texture);
  if (environment->buffer) api.DeleteBuffers(1, &environment->buffer);
  destroyHandle(environment);
}

uint64_t lw_gl_environment_texture_bytes(const lw_gl_environment* environment) { return environment ? environment->texture_bytes : 0; }
uint32_t lw_gl_environment_cells(const lw_gl_environment* environment) { return environment ? environment->cells : 0; }

lw_result lw_gl_bind_environment(lw_gl_environment* environment, uint32_t program, uint32_t first_unit, uint32_t binding,
                                 const lw_gl_environment_shading* given) {
  if (!environment || !program) return LW_INVALID_ARGUMENT;
  lw_gl_environment_shading shading = LW_GL_ENVIRONMENT_SHADING_INIT;
  if (given) {
    if (given->size < sizeof shading) return environment->host.fail(LW_INVALID_ARGUMENT, "lw_gl_environment_shading: its size is wrong");
    shading = *given;
  }
  bool good = shading.technique <= LW_ENVIRONMENT_UNSHADOWED && (shading.filter_taps == 1 || shading.filter_taps == 4);
  for (const float v : shading.scale_rgb) good &= v >= 0 && v <= kMaxIrradiance;
  if (!good) return environment->host.fail(LW_INVALID_ARGUMENT, "lw_gl_environment_shading: a value is out of range");
  const Api& api = environment->context->api;
  const uint32_t index = api.GetUniformBlockIndex(program, "LwEnvironment");
  if (index == kInvalidIndex) return LW_NOT_FOUND;
  int32_t block_bytes = 0;
  api.GetActiveUniformBlockiv(program, index, kUniformBlockDataSize, &block_bytes);
  const uint64_t needed = sizeof(EnvironmentBlock) + uint64_t(environment->cells) * sizeof(EnvironmentBlockCell);
  if (uint64_t(block_bytes) < needed)
    return environment->host.fail(LW_LIMIT_EXCEEDED, "the program's LW_ENVIRONMENT_CELLS is less than %u", environment->cells);

  EnvironmentBlock& block = environment->block;
  block.technique = int32_t(shading.technique);
  block.taps = int32_t(shading.filter_taps);
  std::memcpy(block.scale_rgb, shading.scale_rgb, sizeof block.scale_rgb);
  int32_t program_before = 0, active = 0;
  api.GetIntegerv(kCurrentProgram, &program_before);
  api.GetIntegerv(kActiveTexture, &active);
  {
    const BufferGuard guard(api);
    uploadBlock(*environment);
    api.BindBufferBase(kUniformBuffer, binding, environment->buffer);
  }
  api.UniformBlockBinding(program, index, binding);
  api.UseProgram(program);
  const struct {
    const char* name;
    Enum target;
    Name texture;
  } units[] = {{"lw_sky", kTexture2dArray, environment->sky}, {"lw_depth", kTexture2d, environment->depth}};
  for (uint32_t u = 0; u < 2; ++u) {
    const int32_t location = api.GetUniformLocation(program, units[u].name);
    if (location >= 0) api.Uniform1i(location, int32_t(first_unit + u));
    api.ActiveTexture(kTexture0 + first_unit + u);
    api.BindTexture(units[u].target, units[u].texture);
    api.BindSampler(first_unit + u, 0);
  }
  api.ActiveTexture(Enum(active));
  api.UseProgram(Name(program_before));
  return LW_OK;
}
