// Linear fixed points x = M x + b, whose plain iteration would take as long as the albedo is near 1.
#pragma once
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <deque>

namespace lightwell::transport {

struct FixedPoint {
  Eigen::VectorXd x;
  uint32_t sweeps = 0;
  double residual = 0;  // rms of what another sweep would change, each value's change over the value
};

/// Iterates x ← sweep(x) from 0 with Anderson's acceleration over the last eight sweeps (Anderson 1965; Walker, Ni, "Anderson Acceleration for Fixed-Point
/// Iterations", 2011) until the residual is at most `tolerance`, or after `most_sweeps`.
template <class Sweep>
FixedPoint solveFixedPoint(Eigen::Index size, const Sweep& sweep, double tolerance, uint32_t most_sweeps) {
  constexpr size_t kHistory = 8;
  constexpr double kDark = 1e-200;
  FixedPoint result;
  result.x = Eigen::VectorXd::Zero(size);
  std::deque<Eigen::VectorXd> f_change, g_change;
  Eigen::VectorXd last_g, last_f;
  // Relative to each value, so that rooms which light does not go between are solved alike, however much brighter one is.
  while (result.sweeps < most_sweeps) {
    const Eigen::VectorXd g = sweep(result.x), f = g - result.x;
    ++result.sweeps;
    const Eigen::VectorXd weight = g.unaryExpr([](double value) { return std::abs(value) > kDark ? 1 / std::abs(value) : 0.0; });
    result.residual = std::sqrt(f.cwiseProduct(weight).squaredNorm() / double(std::max<Eigen::Index>(size, 1)));
    if (last_g.size() > 0) {
      f_change.push_back(f - last_f);
      g_change.push_back(g - last_g);
      if (f_change.size() > kHistory) f_change.pop_front(), g_change.pop_front();
    }
    last_g = g, last_f = f;
    result.x = g;
    if (result.residual <= tolerance) break;
    if (f_change.empty()) continue;
    Eigen::MatrixXd differences(size, Eigen::Index(f_change.size()));
    for (size_t i = 0; i < f_change.size(); ++i) differences.col(Eigen::Index(i)) = f_change[i].cwiseProduct(weight);
    const Eigen::VectorXd gamma = differences.colPivHouseholderQr().solve(f.cwiseProduct(weight));
    for (size_t i = 0; i < f_change.size(); ++i) result.x -= gamma[Eigen::Index(i)] * g_change[i];
  }
  return result;
}

}  // namespace lightwell::transport
