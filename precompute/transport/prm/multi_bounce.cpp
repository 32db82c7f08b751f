#include "precompute/transport/prm/multi_bounce.h"

#include <Eigen/LU>
#include <stdexcept>

namespace lightwell::transport {

void addGroupRow(const EntryClusters& clusters, const GatherRow& gathered, uint32_t row, ChannelMatrices& matrices) {
  for (size_t i = 0; i < gathered.cluster.size(); ++i) {
    const uint32_t group = clusters.group_of_cluster[gathered.cluster[i]];
    for (int channel = 0; channel < 3; ++channel) matrices[channel](row, group) += gathered.transfer_rgb[i][channel];
  }
}

ChannelMatrices solveMultiBounce(const ChannelMatrices& one_bounce) {
  ChannelMatrices solution;
  for (int channel = 0; channel < 3; ++channel) {
    const auto& r = one_bounce[channel];
    if (channel > 0 && r == one_bounce[channel - 1]) {  // grey scenes: one factorisation serves all channels
      solution[channel] = solution[channel - 1];
      continue;
    }
    const Eigen::MatrixXd bounce = r.cast<double>();
    const Eigen::MatrixXd system = Eigen::MatrixXd::Identity(r.rows(), r.cols()) - bounce;
    solution[channel] = system.partialPivLu().solve(bounce).cast<float>();
    if (!solution[channel].allFinite()) throw std::runtime_error("the multiple-bounce system is singular: some closed part of the scene reflects all light");
  }
  return solution;
}

}  // namespace lightwell::transport
