// Sweeps, and sweeps that learn from those before (Anderson, "Iterative Procedures for Nonlinear Integral Equations", 1965; Walker, Ni, "Anderson
// Acceleration for Fixed-Point Iterations", 2011): in closed rooms plain ones gain only a factor of the albedo each.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "runtime/src/radiosity.h"

namespace lightwell::runtime {
namespace {

constexpr uint32_t kHistory = 8;

void sweep(lw_radiosity_state& state, const Float4* irradiance, Float4* result) {
  patchRadiosity(state, irradiance, state.node.data());
  averageNodes(*state.radiosity, state.node.data());
  gather(state, state.node.data(), result);
}

/// The weights γ that make |f − Σ γ_j Δf_j| least, from the products of the Δf with one another and with f, by Cholesky's method. Directions that
/// those before them contain but for rounding are left out.
void leastSquares(uint32_t count, const double (*gram)[kHistory], const double* right, double* gamma) {
  double factor[kHistory][kHistory] = {}, y[kHistory] = {};
  bool used[kHistory] = {};
  for (uint32_t i = 0; i < count; ++i) {
    for (uint32_t j = 0; j <= i; ++j) {
      if (j < i && !used[j]) continue;
      double sum = gram[i][j];
      for (uint32_t k = 0; k < j; ++k) sum -= factor[i][k] * factor[j][k];
      if (j < i) factor[i][j] = sum / factor[j][j];
      else if ((used[i] = sum > 1e-13 * gram[i][i])) factor[i][i] = std::sqrt(sum);
    }
    if (!used[i]) {
      std::fill_n(factor[i], kHistory, 0.0);
      continue;
    }
    y[i] = right[i];
    for (uint32_t k = 0; k < i; ++k) y[i] -= factor[i][k] * y[k];
    y[i] /= factor[i][i];
  }
  for (uint32_t i = count; i-- > 0;) {
    gamma[i] = 0;
    if (!used[i]) continue;
    double sum = y[i];
    for (uint32_t k = i + 1; k < count; ++k) sum -= factor[k][i] * gamma[k];
    gamma[i] = sum / factor[i][i];
  }
}

/// The history of one solution. Channels are systems of their own that share the sweeps.
class Accelerator {
 public:
  /// False when there is no memory.
  bool allocate(const Host& host, size_t patches) {
    bool enough = g_.allocate(host, patches) && last_g_.allocate(host, patches) && last_f_.allocate(host, patches);
    for (uint32_t i = 0; i < kHistory; ++i) enough = enough && f_change_[i].allocate(host, patches) && g_change_[i].allocate(host, patches);
    return enough;
  }

  Float4* next() { return g_.data(); }

  /// Given x and what a sweep made of it (in next()), puts the next x in its place. Returns rms(f) / rms(g), the greatest of the channels.
  double advance(Float4* x) {
    const size_t patches = g_.size();
    double f2[3] = {}, g2[3] = {};
    const uint32_t slot = steps_ > 0 ? (steps_ - 1) % kHistory : 0;
    for (size_t i = 0; i < patches; ++i)
      for (int k = 0; k < 4; ++k) {
        const float g = g_[i].v[k], f = g - x[i].v[k];
        if (steps_ > 0) {
          f_change_[slot][i].v[k] = f - last_f_[i].v[k];
          g_change_[slot][i].v[k] = g - last_g_[i].v[k];
        }
        last_f_[i].v[k] = f;
        last_g_[i].v[k] = g;
        if (k < 3) f2[k] += double(f) * f, g2[k] += double(g) * g;
      }
    double residual = 0;
    for (int k = 0; k < 3; ++k)
      if (g2[k] > 0) residual = std::max(residual, std::sqrt(f2[k] / g2[k]));
    if (steps_ > 0) updateGram(slot);
    ++steps_;
    combine(x);
    return residual;
  }

  void forget() { steps_ = 0; }

 private:
  void updateGram(uint32_t slot) {
    const uint32_t count = std::min(steps_, kHistory);
    for (uint32_t j = 0; j < count; ++j) {
      double product[3] = {};
      for (size_t i = 0; i < g_.size(); ++i)
        for (int k = 0; k < 3; ++k) product[k] += double(f_change_[slot][i].v[k]) * double(f_change_[j][i].v[k]);
      for (int k = 0; k < 3; ++k) gram_[k][slot][j] = gram_[k][j][slot] = product[k];
    }
  }

  void combine(Float4* x) {
    const uint32_t count = std::min(steps_ - 1, kHistory);
    double gamma[3][kHistory] = {}, right[3][kHistory] = {};
    for (uint32_t j = 0; j < count; ++j)
      for (size_t i = 0; i < g_.size(); ++i)
        for (int k = 0; k < 3; ++k) right[k][j] += double(f_change_[j][i].v[k]) * double(last_f_[i].v[k]);
    // The newest first, which is what a direction that depends on others is judged against.
    uint32_t order[kHistory];
    for (uint32_t j = 0; j < count; ++j) order[j] = (steps_ - 2 + kHistory - j) % kHistory;
    for (int k = 0; k < 3; ++k) {
      double gram[kHistory][kHistory], b[kHistory], solution[kHistory];
      for (uint32_t i = 0; i < count; ++i) {
        b[i] = right[k][order[i]];
        for (uint32_t j = 0; j < count; ++j) gram[i][j] = gram_[k][order[i]][order[j]];
      }
      leastSquares(count, gram, b, solution);
      for (uint32_t i = 0; i < count; ++i) gamma[k][order[i]] = solution[i];
    }
    std::memcpy(x, g_.data(), g_.bytes());
    for (uint32_t j = 0; j < count; ++j) {
      const float w[4] = {float(gamma[0][j]), float(gamma[1][j]), float(gamma[2][j]), 0};
      for (size_t i = 0; i < g_.size(); ++i)
        for (int k = 0; k < 4; ++k) x[i].v[k] -= w[k] * g_change_[j][i].v[k];
    }
  }

  Array<Float4> g_, last_g_, last_f_, f_change_[kHistory], g_change_[kHistory];
  double gram_[3][kHistory][kHistory] = {};
  uint32_t steps_ = 0;
};

bool isFinite(const Array<Float4>& values) {
  float sum = 0;
  for (const Float4& v : values)
    for (int k = 0; k < 3; ++k) sum += 0.0f * v.v[k];
  return sum == 0.0f;
}

}  // namespace
}  // namespace lightwell::runtime

using namespace lightwell::runtime;

lw_result lw_radiosity_step(lw_radiosity_state* state, uint32_t sweeps) {
  if (!state) return LW_INVALID_ARGUMENT;
  for (uint32_t i = 0; i < sweeps; ++i) sweep(*state, state->irradiance.data(), state->irradiance.data());
  return LW_OK;
}

lw_result lw_radiosity_solve(lw_radiosity_state* state, double tolerance, uint32_t most_sweeps, lw_radiosity_report* report) {
  if (!state) return LW_INVALID_ARGUMENT;
  if (!(tolerance > 0)) return state->host.fail(LW_INVALID_ARGUMENT, "the tolerance is not positive");
  Accelerator accelerator;
  if (!accelerator.allocate(state->host, state->radiosity->patches())) return state->host.fail(LW_OUT_OF_MEMORY, "no memory for the solver's history");
  Float4* x = state->irradiance.data();
  lw_radiosity_report result = {0, 0};
  double best = INFINITY;
  uint32_t since_best = 0;
  while (result.sweeps < most_sweeps) {
    sweep(*state, x, accelerator.next());
    ++result.sweeps;
    result.residual = accelerator.advance(x);
    if (!isFinite(state->irradiance)) {
      std::memcpy(x, accelerator.next(), state->irradiance.bytes());
      accelerator.forget();
    }
    since_best = result.residual < 0.9 * best ? 0 : since_best + 1;
    best = std::min(best, result.residual);
    // What is left is rounding once twice the history has brought nothing more.
    if (result.residual <= tolerance || since_best > 2 * kHistory) break;
  }
  for (Float4& v : state->irradiance)
    for (float& e : v.v) e = e > 0 ? std::min(e, kMostRadiosity) : 0.0f;
  if (report) *report = result;
  return LW_OK;
}
