#include "precompute/transport/prm/multi_bounce.h"

#include <stdexcept>

#include "precompute/transport/prm/linear_system.h"

namespace lightwell::transport {
namespace {

using Eigen::MatrixXd;
using Eigen::MatrixXf;

/// R: the area-weighted mean over each group's clusters of what they receive from groups.
std::array<MatrixXd, 3> betweenGroups(const EntryClusters& clusters, const ClusterRows& rows) {
  std::array<MatrixXd, 3> between;
  for (auto& matrix : between) matrix.setZero(clusters.group_count, clusters.group_count);
  for (uint32_t c = 0; c < clusters.cluster_count; ++c) {
    const uint32_t to = clusters.group_of_cluster[c];
    const double share = double(clusters.area[c]) / clusters.area[clusters.cluster_count + to];
    for (uint32_t i = rows.first[c]; i < rows.first[c + 1]; ++i)
      for (int channel = 0; channel < 3; ++channel) between[channel](to, clusters.group_of_cluster[rows.cluster[i]]) += share * rows.transfer_rgb[i][channel];
  }
  return between;
}

}  // namespace

void ClusterRows::append(const GatherRow& row) {
  cluster.insert(cluster.end(), row.cluster.begin(), row.cluster.end());
  transfer_rgb.insert(transfer_rgb.end(), row.transfer_rgb.begin(), row.transfer_rgb.end());
  first.push_back(uint32_t(cluster.size()));
}

void ClusterRows::append(const ClusterRows& other) {
  const uint32_t offset = uint32_t(cluster.size());
  cluster.insert(cluster.end(), other.cluster.begin(), other.cluster.end());
  transfer_rgb.insert(transfer_rgb.end(), other.transfer_rgb.begin(), other.transfer_rgb.end());
  for (size_t row = 1; row < other.first.size(); ++row) first.push_back(offset + other.first[row]);
}

RowMajorMatrix MultiBounce::received(int channel, const EntryClusters& clusters, const RowMajorMatrix& direct) const {
  MatrixXf group_direct = MatrixXf::Zero(clusters.group_count, direct.cols());
  for (uint32_t c = 0; c < clusters.cluster_count; ++c) {
    const uint32_t group = clusters.group_of_cluster[c];
    group_direct.row(group) += direct.row(c) * (clusters.area[c] / clusters.area[clusters.cluster_count + group]);
  }
  const RowMajorMatrix group_indirect = solution[channel] * group_direct;
  RowMajorMatrix total = direct, received(direct.rows(), direct.cols());
  for (uint32_t c = 0; c < clusters.cluster_count; ++c) total.row(c) += group_indirect.row(clusters.group_of_cluster[c]);
  SparseRows transport{rows.first, rows.cluster, {}};
  transport.value.reserve(rows.transfer_rgb.size());
  for (const Rgb& transfer_rgb : rows.transfer_rgb) transport.value.push_back(transfer_rgb[channel]);
  multiply(transport, total, received);
  return received;
}

std::array<MatrixXf, 3> MultiBounce::onceReflected(const std::vector<uint32_t>& cluster, const std::array<MatrixXf, 3>& cluster_response,
                                                   const std::vector<uint32_t>& place_of_cluster, uint32_t places) const {
  // The sparse transposed of F times the responses, by rows of the listed clusters: [place][any].
  std::array<MatrixXf, 3> once;
  SparseRows to_place;
  std::vector<uint32_t> next(size_t(places) + 1, 0);
  for (const uint32_t c : cluster)
    for (uint32_t i = rows.first[c]; i < rows.first[c + 1]; ++i) ++next[place_of_cluster[rows.cluster[i]] + 1];
  for (size_t p = 0; p < places; ++p) next[p + 1] += next[p];
  to_place.first = next;
  to_place.column.resize(next.back());
  to_place.value.resize(next.back());
  for (int channel = 0; channel < 3; ++channel) {
    std::copy(to_place.first.begin(), to_place.first.end(), next.begin());
    for (size_t l = 0; l < cluster.size(); ++l)
      for (uint32_t i = rows.first[cluster[l]]; i < rows.first[cluster[l] + 1]; ++i) {
        const uint32_t at = next[place_of_cluster[rows.cluster[i]]]++;
        to_place.column[at] = uint32_t(l);
        to_place.value[at] = rows.transfer_rgb[i][channel];
      }
    const Eigen::Index responses = cluster_response[channel].rows(), padded = (responses + 7) / 8 * 8;  // whole vectors
    RowMajorMatrix by_cluster = RowMajorMatrix::Zero(Eigen::Index(cluster.size()), padded), by_place(Eigen::Index(places), padded);
    by_cluster.leftCols(responses) = cluster_response[channel].transpose();
    multiply(to_place, by_cluster, by_place);
    once[channel] = by_place.leftCols(responses).transpose();
  }
  return once;
}

RowMajorMatrix MultiBounce::furtherReflected(int channel, const MatrixXf& once_reflected) const { return multiply(once_reflected, solution[channel]); }

MultiBounce solveMultiBounce(const EntryClusters& clusters, ClusterRows rows) {
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
