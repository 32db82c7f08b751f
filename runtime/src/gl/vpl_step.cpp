// What is to be drawn, how much of it fits into a frame, and what is shown meanwhile.
#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "runtime/src/gl/vpl_gl.h"

namespace lightwell::runtime::gl {
namespace {

/// So many changes of sources in a shared layer are added to each other; then all of it is drawn again, from darkness. Each leaves a rounding of about 1e-7 of what was there.
constexpr uint32_t kMostChanges = 64;

double nowMs() {
  timespec now{};
#ifdef CLOCK_MONOTONIC
  clock_gettime(CLOCK_MONOTONIC, &now);
#else
  timespec_get(&now, TIME_UTC);
#endif
  return 1e3 * double(now.tv_sec) + 1e-6 * double(now.tv_nsec);
}

bool isScaled(const VplSource& source) { return std::memcmp(source.scale_rgb, source.drawn_rgb, sizeof source.scale_rgb) != 0; }

/// Plans a layer's change: which lights are drawn with which factor.
class Planner {
 public:
  Planner(lw_gl_vpl& vpl, uint32_t layer) : vpl_(vpl), layer_(layer), shared_(isShared(vpl, layer)), from_dark_(!shared_ || vpl.changes[layer] >= kMostChanges) {}

  bool isNeeded() const {
    bool needed = vpl_.changes[layer_] == kNeverDrawn;
    eachSource([&](const VplSource& source) { needed |= source.moved || (shared_ && isScaled(source)); });
    return needed;
  }
  /// How many draws it takes.
  uint32_t count() {
    draws_ = 0, to_ = nullptr;
    plan();
    return draws_;
  }
  lw_result start() {
    VplJob& job = vpl_.job;
    if (!job.draws.allocate(vpl_.host, count())) return vpl_.host.fail(LW_OUT_OF_MEMORY, "no memory for %u virtual lights", draws_);
    job.layer = layer_, job.drawn = job.order = 0;
    job.power = job.power_drawn = 0;
    draws_ = 0, to_ = job.draws.data();
    plan();
    for (const VplDraw& draw : job.draws) job.power += powerOf(draw);
    job.active = true;
    prepareSpare();
    vpl_.changes[layer_] = from_dark_ ? 0 : vpl_.changes[layer_] + 1;
    return LW_OK;
  }
  static double powerOf(const VplDraw& draw) {
    double power = 1e-30;  // dark lights count, too
    for (int k = 0; k < 3; ++k) power += double(draw.piece->flux_rgb[k]) * double(std::abs(draw.factor_rgb[k]));
    return power;
  }

 private:
  template <class Visit>
  void eachSource(Visit visit) const {
    for (uint32_t s = layer_; s < vpl_.sources.size() && (s == layer_ || shared_); ++s) visit(vpl_.sources[s]);
  }

  /// Takes over what is wanted when there is where to write the draws to; else only counts them.
  void plan() {
    constexpr float kWhole[3] = {1, 1, 1};
    eachSource([&](VplSource& source) {
      const float* wanted_rgb = shared_ ? source.scale_rgb : kWhole;
      if (from_dark_) {
        addAll(source.moved ? source.next_pieces : source.pieces, wanted_rgb);
      } else if (source.moved) {
        const float gone_rgb[3] = {-source.drawn_rgb[0], -source.drawn_rgb[1], -source.drawn_rgb[2]};
        addAll(source.pieces, gone_rgb);
        addAll(source.next_pieces, wanted_rgb);
      } else if (isScaled(source)) {
        float change_rgb[3];
        for (int k = 0; k < 3; ++k) change_rgb[k] = wanted_rgb[k] - source.drawn_rgb[k];
        addAll(source.pieces, change_rgb);
      }
      if (!to_) return;
      if (source.moved) {
        std::swap(source.old_pieces, source.pieces);
        std::swap(source.pieces, source.next_pieces);
        source.moved = false;
      }
      std::memcpy(source.drawn_rgb, wanted_rgb, sizeof source.drawn_rgb);
    });
  }
  void addAll(const Array<LightPiece>& pieces, const float* factor_rgb) {
    for (const LightPiece& piece : pieces) {
      if (to_) to_[draws_] = {&piece, {factor_rgb[0], factor_rgb[1], factor_rgb[2]}};
      ++draws_;
    }
  }

  /// Darkness, or what the layer has.
  void prepareSpare() {
    constexpr float kDark[4] = {};
    const Api& api = vpl_.context->api;
    api.BindFramebuffer(kDrawFramebuffer, vpl_.layer_framebuffer[vpl_.texture_layer[vpl_.layers]]);
    if (from_dark_) return api.ClearBufferfv(kColor, 0, kDark);
    api.BindFramebuffer(kReadFramebuffer, vpl_.layer_framebuffer[vpl_.texture_layer[layer_]]);
    api.BlitFramebuffer(0, 0, vpl_.layer_width, vpl_.layer_height, 0, 0, vpl_.layer_width, vpl_.layer_height, kColorBufferBit, kNearest);
  }

  lw_gl_vpl& vpl_;
  uint32_t layer_;
  bool shared_, from_dark_;
  uint32_t draws_ = 0;
  VplDraw* to_ = nullptr;
};

/// The next layer that is to change, from the one after the last on; the number of layers: none.
uint32_t nextLayer(lw_gl_vpl& vpl) {
  for (uint32_t i = 1; i <= vpl.layers; ++i)
    if (const uint32_t layer = (vpl.job.layer + i) % vpl.layers; Planner(vpl, layer).isNeeded()) return layer;
  return vpl.layers;
}

void finishJob(lw_gl_vpl& vpl) {
  VplJob& job = vpl.job;
  std::swap(vpl.texture_layer[job.layer], vpl.texture_layer[vpl.layers]);
  job.active = false;
  vpl.shown_is_old = true;
}

/// Begins changes until there is something to draw. Those without draws (a source that is gone) are complete at once.
lw_result beginNext(lw_gl_vpl& vpl) {
  while (!vpl.job.active) {
    const uint32_t layer = nextLayer(vpl);
    if (layer == vpl.layers) return LW_OK;
    if (const lw_result result = Planner(vpl, layer).start()) return result;
    if (vpl.job.draws.empty()) finishJob(vpl);
  }
  return LW_OK;
}

void drawNext(lw_gl_vpl& vpl, const SumGuard& sum) {
  VplJob& job = vpl.job;
  const VplDraw& draw = job.draws[nextSpread(job.order, uint32_t(job.draws.size()))];
  drawPiece(vpl, draw, vpl.layer_framebuffer[vpl.texture_layer[vpl.layers]], sum);
  job.power_drawn += Planner::powerOf(draw);
  vpl.shown_is_old = true;
  if (++job.drawn == job.draws.size()) finishJob(vpl);
}

/// A layer in change fades from what it was to what it is going to be by the power that has been drawn: what is there of the new solution is about that share of it.
void show(lw_gl_vpl& vpl) {
  if (!vpl.shown_is_old) return;
  const Api& api = vpl.context->api;
  float weight[kMostVplLayers + 1][4] = {};
  const auto weigh = [&](uint32_t layer, const float* scale_rgb, float share) {
    for (int k = 0; k < 3; ++k) weight[vpl.texture_layer[layer]][k] = scale_rgb[k] * share;
  };
  constexpr float kWhole[3] = {1, 1, 1};
  for (uint32_t layer = 0; layer < vpl.layers; ++layer) {
    const bool shared = isShared(vpl, layer), in_change = vpl.job.active && vpl.job.layer == layer;
    const float* scale_rgb = shared || vpl.sources.empty() ? kWhole : vpl.sources[layer].scale_rgb;
    const float done = in_change ? float(std::min(vpl.job.power_drawn / vpl.job.power, 1.0)) : 0.0f;
    weigh(layer, scale_rgb, 1 - done);
    // What is drawn onto a copy of the old solution is a whole one at any time; from darkness it has but its share.
    if (in_change) weigh(vpl.layers, scale_rgb, vpl.changes[layer] > 0 ? done : 1);
  }
  const Program& program = vpl.show;
  api.UseProgram(program.name);
  api.Uniform4fv(program.uniform[vpl_show_uniform::weights], int32_t(kMostVplLayers) + 1, weight[0]);
  api.Uniform1i(program.uniform[vpl_show_uniform::layers], int32_t(vpl.layers) + 1);
  api.Uniform1f(program.uniform[vpl_show_uniform::max], vpl.max_value);
  api.ActiveTexture(kTexture0);
  api.BindTexture(kTexture2dArray, vpl.layer_texture);
  api.ActiveTexture(kTexture0 + 1);
  api.BindTexture(kTexture2d, vpl.shown);
  api.BindFramebuffer(kDrawFramebuffer, vpl.atlas.framebuffer);
  api.Viewport(0, 0, vpl.atlas.width, vpl.atlas.height);
  api.DrawArrays(kTriangles, 0, 3);
  vpl.shown_is_old = false;
}

uint32_t lightsLeft(lw_gl_vpl& vpl) {
  size_t left = vpl.job.active ? vpl.job.draws.size() - vpl.job.drawn : 0;
  for (uint32_t layer = 0; layer < vpl.layers; ++layer)
    if (Planner planner(vpl, layer); planner.isNeeded()) left += planner.count();
  return uint32_t(std::min<size_t>(left, UINT32_MAX));
}

/// Draws as many lights as are predicted to fit, waits, learns what they took, and goes on while another one fits.
lw_result drawWithin(lw_gl_vpl& vpl, double budget_ms, double begin_ms, uint32_t& drawn) {
  const Api& api = vpl.context->api;
  const SumGuard sum(api);
  if (!vpl.job.active)
    if (const lw_result result = beginNext(vpl); result || !vpl.job.active) return result;
  for (double before_ms = begin_ms;;) {
    const double left_ms = budget_ms - (before_ms - begin_ms);
    if (drawn > 0 && !(vpl.light_ms <= left_ms)) return LW_OK;
    const double fitting = vpl.light_ms > 0 && budget_ms > 0 ? std::floor(left_ms / vpl.light_ms) : 1;
    const auto batch = uint32_t(std::clamp(fitting, 1.0, 1e6));
    uint32_t count = 0;
    for (; count < batch && vpl.job.active; ++count) {
      drawNext(vpl, sum);
      if (const lw_result result = vpl.job.active ? LW_OK : beginNext(vpl)) return result;
    }
    api.Finish();
    const double now_ms = nowMs(), light_ms = (now_ms - before_ms) / count;
    // Rises at once and falls slowly: a light that takes longer than the last ones is the one that breaks a budget.
    vpl.light_ms = std::max(light_ms, 0.8 * vpl.light_ms + 0.2 * light_ms);
    before_ms = now_ms;
    drawn += count;
    if (!vpl.job.active || budget_ms == 0) return LW_OK;
  }
}

bool isScale(const float* rgb) {
  for (int k = 0; k < 3; ++k)
    if (!(rgb[k] >= 0 && rgb[k] <= 1e12f)) return false;
  return true;
}

lw_result checkSource(const lw_gl_vpl& vpl, uint32_t source) {
  return source < vpl.sources.size() ? LW_OK : vpl.host.fail(LW_NOT_FOUND, "there is no source %u; there are %zu", source, vpl.sources.size());
}

}  // namespace
}  // namespace lightwell::runtime::gl

using namespace lightwell::runtime;

lw_result lw_gl_vpl_step(lw_gl_vpl* vpl, double budget_ms, lw_gl_vpl_progress* progress) {
  if (!vpl) return LW_INVALID_ARGUMENT;
  if (!(budget_ms >= 0 && budget_ms <= 1e9)) return vpl->host.fail(LW_INVALID_ARGUMENT, "a budget of %g ms", budget_ms);
  uint32_t drawn = 0;
  double begin_ms = gl::nowMs();
  lw_result result = LW_OK;
  const bool is_needed = vpl->job.active || gl::nextLayer(*vpl) < vpl->layers;
  if (is_needed || vpl->shown_is_old) {
    const gl::Api& api = vpl->context->api;
    const gl::StateGuard guard(api);
    const gl::DepthStateGuard depth_guard(api);
    api.Disable(gl::kDepthTest);
    api.Disable(gl::kStencilTest);
    api.Disable(gl::kPolygonOffsetFill);
    api.DepthFunc(gl::kGreater);
    api.DepthMask(1);
    api.BindVertexArray(vpl->context->vertex_array);
    if (is_needed) {
      api.Finish();
      begin_ms = gl::nowMs();
      result = gl::drawWithin(*vpl, budget_ms, begin_ms, drawn);
    }
    gl::show(*vpl);
  }
  if (progress) *progress = {drawn, gl::lightsLeft(*vpl), gl::nowMs() - begin_ms};
  return result;
}

lw_result lw_gl_vpl_set_source_scale(lw_gl_vpl* vpl, uint32_t source, const float rgb[3]) {
  if (!vpl || !rgb) return LW_INVALID_ARGUMENT;
  if (const lw_result result = gl::checkSource(*vpl, source)) return result;
  if (!gl::isScale(rgb)) return vpl->host.fail(LW_INVALID_ARGUMENT, "the scale of source %u is not 0 to 1e12", source);
  std::memcpy(vpl->sources[source].scale_rgb, rgb, sizeof vpl->sources[source].scale_rgb);
  vpl->shown_is_old = true;
  return LW_OK;
}

lw_result lw_gl_vpl_set_source_lights(lw_gl_vpl* vpl, uint32_t source, const lw_virtual_light* lights, uint32_t count) {
  if (!vpl || (count > 0 && !lights)) return LW_INVALID_ARGUMENT;
  if (const lw_result result = gl::checkSource(*vpl, source)) return result;
  Array<LightPiece> pieces;
  if (const lw_result result = gl::takeLights(*vpl, lights, count, pieces)) return result;
  vpl->sources[source].next_pieces = std::move(pieces);
  vpl->sources[source].moved = true;
  return LW_OK;
}

lw_result lw_gl_vpl_redraw(lw_gl_vpl* vpl) {
  if (!vpl) return LW_INVALID_ARGUMENT;
  vpl->job.active = false;
  std::fill(vpl->changes, vpl->changes + vpl->layers, gl::kNeverDrawn);
  vpl->shown_is_old = true;
  return LW_OK;
}
