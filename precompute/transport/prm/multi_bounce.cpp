#include "precompute/transport/prm/multi_bounce.h"

#include <Eigen/LU>
#include <stdexcept>

namespace lightwell::transport {
namespace {

using Eigen::MatrixXd;
using Eigen::MatrixXf;

/// R: the area-weighted mean of F over each group's clusters.
std::array<MatrixXd, 3> betweenGroups(const EntryClusters& clusters, const GroupRows& rows) {
  std::array<MatrixXd, 3> between;
  for (auto& matrix : between) matrix.setZero(clusters.group_count, clusters.group_count);
  for (uint32_t c = 0; c < clusters.cluster_count; ++c) {
    const uint32_t to = clusters.group_of_cluster[c];
    const double share = double(clusters.area[c]) / clusters.area[clusters.cluster_count + to];
    for (uint32_t i = rows.first[c]; i < rows.first[c + 1]; ++i)
      for (int channel = 0; channel < 3; ++channel) between[channel](to, rows.group[i]) += share * rows.transfer_rgb[i][channel];
  }
  return between;
}

}  // namespace

void GroupRows::append(const EntryClusters& clusters, const GatherRow& gathered) {
  for (size_t i = 0; i < gathered.cluster.size(); ++i) {
    const uint32_t from = clusters.group_of_cluster[gathered.cluster[i]];
    if (group.size() == first.back() || group.back() != from) {  // clusters ascend group by group
      group.push_back(from);
      transfer_rgb.emplace_back(0.0f);
    }
    transfer_rgb.back() += gathered.transfer_rgb[i];
  }
  first.push_back(uint32_t(group.size()));
}

void GroupRows::append(const GroupRows& other) {
  const uint32_t offset = uint32_t(group.size());
  group.insert(group.end(), other.group.begin(), other.group.end());
  transfer_rgb.insert(transfer_rgb.end(), other.transfer_rgb.begin(), other.transfer_rgb.end());
  for (size_t row = 1; row < other.first.size(); ++row) first.push_back(offset + other.first[row]);
}

MatrixXf MultiBounce::received(int channel, const MatrixXf& group_direct) const {
  const MatrixXf group_total_by_light = (group_direct + solution[channel] * group_direct).transpose();
  MatrixXf by_light = MatrixXf::Zero(group_direct.cols(), Eigen::Index(rows.first.size()) - 1);
  for (Eigen::Index c = 0; c < by_light.cols(); ++c)
    for (uint32_t i = rows.first[c]; i < rows.first[c + 1]; ++i) by_light.col(c) += rows.transfer_rgb[i][channel] * group_total_by_light.col(rows.group[i]);
  return by_light.transpose();
}

MatrixXf MultiBounce::onceReflected(int channel, const std::vector<uint32_t>& cluster, const MatrixXf& cluster_response) const {
  MatrixXf once = MatrixXf::Zero(cluster_response.rows(), solution[channel].cols());
  for (size_t l = 0; l < cluster.size(); ++l)
    for (uint32_t i = rows.first[cluster[l]]; i < rows.first[cluster[l] + 1]; ++i)
      once.col(rows.group[i]) += rows.transfer_rgb[i][channel] * cluster_response.col(Eigen::Index(l));
  return once;
}

RowMajorMatrix MultiBounce::allBounces(int channel, const MatrixXf& once_reflected) const { return once_reflected + multiply(once_reflected, solution[channel]); }

MultiBounce solveMultiBounce(const EntryClusters& clusters, GroupRows rows) {
  const std::array<MatrixXd, 3> between = betweenGroups(clusters, rows);
  MultiBounce result{std::move(rows), {}};
  for (int channel = 0; channel < 3; ++channel) {
    if (channel > 0 && between[channel] == between[channel - 1]) {  // grey scenes: one factorisation serves all channels
      result.solution[channel] = result.solution[channel - 1];
      continue;
    }
    const MatrixXd system = MatrixXd::Identity(clusters.group_count, clusters.group_count) - between[channel];
    result.solution[channel] = system.partialPivLu().solve(between[channel]).cast<float>();
    if (!result.solution[channel].allFinite())
      throw std::runtime_error("the multiple-bounce system is singular: some closed part of the scene reflects all light");
  }
  return result;
}

}  // namespace lightwell::transport
