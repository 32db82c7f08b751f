#include "precompute/transport/radiosity/solve.h"

#include "precompute/transport/fixed_point.h"

namespace lightwell::transport {
namespace {

using Vector = Eigen::VectorXd;  // one channel

/// How much of what each set of gates lets pass counts.
std::vector<double> setFactors(const GateSets& sets, std::span<const float> gate_open) {
  std::vector<double> factors(sets.count(), 1.0);
  for (uint32_t set = 0; set < sets.count(); ++set)
    for (const GateEntry entry : sets[set]) {
      const double open = gate_open.empty() ? 0.0 : double(gate_open[entry / 2]);
      factors[set] *= isClosed(entry) ? 1 - open : open;
    }
  return factors;
}

/// One channel of the system.
class Channel {
 public:
  Channel(const RadiosityLinks& links, const PatchTree& tree, const std::vector<double>& set_factor, int channel)
      : links_(links), tree_(tree), set_factor_(set_factor), channel_(channel) {}

  Vector gather(const Vector& radiosity) const {
    Vector node(tree_.nodeCount());
    node.head(radiosity.size()) = radiosity;
    for (uint32_t i = uint32_t(radiosity.size()); i < tree_.nodeCount(); ++i) {
      const uint32_t index = i - uint32_t(radiosity.size());
      double sum = 0, area = 0;
      for (uint32_t child = tree_.first_child[index]; child < tree_.first_child[index + 1]; ++child) {
        sum += node[child] * tree_.area[child];
        area += tree_.area[child];
      }
      node[i] = sum / area;
    }
    Vector irradiance(links_.rows());
    for (uint32_t row = 0; row < links_.rows(); ++row) {
      double sum = 0;
      for (uint32_t l = links_.first[row]; l < links_.first[row + 1]; ++l) {
        const double passes = links_.set.empty() ? 1.0 : set_factor_[links_.set[l]];
        sum += passes * linkWeight(links_.code[l]) * node[links_.node[l]];
      }
      irradiance[row] = sum * links_.row_scale[row];
    }
    return irradiance;
  }

  Vector of(std::span<const Rgb> colors) const {
    Vector values(Eigen::Index(colors.size()));
    for (size_t i = 0; i < colors.size(); ++i) values[Eigen::Index(i)] = colors[i][channel_];
    return values;
  }

 private:
  const RadiosityLinks& links_;
  const PatchTree& tree_;
  const std::vector<double>& set_factor_;
  int channel_;
};

}  // namespace

RadiositySolution solveRadiosity(const RadiosityLinks& links, const PatchTree& tree, std::span<const Rgb> albedo_rgb, std::span<const Rgb> direct_rgb,
                                 std::span<const Rgb> emitted_rgb, double tolerance, uint32_t most_sweeps,
                                 std::span<const float> gate_open) {
  RadiositySolution solution;
  const std::vector<double> set_factor = setFactors(links.sets, gate_open);
  solution.irradiance_rgb.assign(links.rows(), Rgb(0.0f));
  for (int c = 0; c < 3; ++c) {
    const Channel channel(links, tree, set_factor, c);
    const Vector albedo = channel.of(albedo_rgb), source = albedo.cwiseProduct(channel.of(direct_rgb)) + channel.of(emitted_rgb);
    const FixedPoint fixed = solveFixedPoint(Eigen::Index(links.rows()), [&](const Vector& x) { return channel.gather(albedo.cwiseProduct(x) + source); }, tolerance,
                                             most_sweeps);
    solution.sweeps = std::max(solution.sweeps, fixed.sweeps);
    solution.residual = std::max(solution.residual, fixed.residual);
    for (uint32_t i = 0; i < links.rows(); ++i) solution.irradiance_rgb[i][c] = float(fixed.x[i]);
  }
  return solution;
}

}  // namespace lightwell::transport
