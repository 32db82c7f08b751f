#include "precompute/transport/prm/multi_bounce.h"

#include <stdexcept>

#include "precompute/transport/prm/linear_system.h"

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

std::array<MatrixXf, 3> MultiBounce::onceReflected(const std::vector<uint32_t>& cluster, const std::array<MatrixXf, 3>& cluster_response) const {
  // The sparse transposed of F times the responses, by rows of the listed clusters: [group][any].
  std::array<MatrixXf, 3> once;
  const size_t groups = size_t(solution[0].cols());
  SparseRows to_group;
  std::vector<uint32_t> next(groups + 1, 0);
  for (const uint32_t c : cluster)
    for (uint32_t i = rows.first[c]; i < rows.first[c + 1]; ++i) ++next[rows.group[i] + 1];
  for (size_t g = 0; g < groups; ++g) next[g + 1] += next[g];
  to_group.first = next;
  to_group.column.resize(next.back());
  to_group.value.resize(next.back());
  for (int channel = 0; channel < 3; ++channel) {
    std::copy(to_group.first.begin(), to_group.first.end(), next.begin());
    for (size_t l = 0; l < cluster.size(); ++l)
      for (uint32_t i = rows.first[cluster[l]]; i < rows.first[cluster[l] + 1]; ++i) {
        const uint32_t at = next[rows.group[i]]++;
        to_group.column[at] = uint32_t(l);
        to_group.value[at] = rows.transfer_rgb[i][channel];
      }
    const Eigen::Index responses = cluster_response[channel].rows(), padded = (responses + 7) / 8 * 8;  // whole vectors
    RowMajorMatrix by_cluster = RowMajorMatrix::Zero(Eigen::Index(cluster.size()), padded), by_group(Eigen::Index(groups), padded);
    by_cluster.leftCols(responses) = cluster_response[channel].transpose();
    multiply(to_group, by_cluster, by_group);
    once[channel] = by_group.leftCols(responses).transpose();
  }
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
    // The norm of R bounds the condition by 2 / (1 - norm): single precision leaves an error of a few millionths where that is small, and is twice as fast.
    constexpr double kMostForSingle = 0.95;
    const MatrixXd system = MatrixXd::Identity(clusters.group_count, clusters.group_count) - between[channel];
    if (between[channel].rowwise().sum().maxCoeff() <= kMostForSingle) result.solution[channel] = solve(MatrixXf(system.cast<float>()), MatrixXf(between[channel].cast<float>()));
    else result.solution[channel] = solve(system, between[channel]).cast<float>();
    if (!result.solution[channel].allFinite())
      throw std::runtime_error("the multiple-bounce system is singular: some closed part of the scene reflects all light");
  }
  return result;
}

}  // namespace lightwell::transport
