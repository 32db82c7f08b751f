#include "precompute/transport/environment/exact_environment.h"

#include <algorithm>

#include "precompute/core/parallel.h"

namespace lightwell::transport {
namespace {

constexpr double kPiD = std::numbers::pi;
constexpr int kMaxParts = 16;
constexpr double kPartsPerDeviation = 3;  // a part of a texel is at most this share of the lobe's standard deviation

struct Row {
  int index;
  std::vector<Rgb> radiance_rgb;
};

/// One row's share of one query, the texels cut in parts × parts.
class RowIntegral {
 public:
  RowIntegral(const EnvironmentMap& map, const EnvironmentQuery& query)
      : map_(map), axis_(query.axis), shininess_(query.shininess), least_cosine_(std::pow(1e-9, 1.0 / query.shininess)) {
    const double texel_angle = std::max(kPiD / map.height(), 2 * kPiD / map.width());
    parts_ = std::clamp(int(std::ceil(kPartsPerDeviation * texel_angle * std::sqrt(double(shininess_)))), 1, kMaxParts);
    up_ = axis_.dot(map.direction(0, 0));
    side_x_ = axis_.dot(map.direction(0.5 * map.width(), 0.5 * map.height()));
    side_z_ = axis_.dot(map.direction(0.75 * map.width(), 0.5 * map.height()));
    for (int x = 0; x < map.width() * parts_; ++x) {
      const double phi = ((x + 0.5) / (map.width() * parts_) - 0.5) * 2 * kPiD;
      horizontal_.push_back(side_x_ * std::cos(phi) + side_z_ * std::sin(phi));
    }
  }

  void add(const Row& row, std::array<double, 3>& sum) const {
    const double d_theta = kPiD / (map_.height() * parts_);
    const double horizontal_reach = std::hypot(side_x_, side_z_);
    for (int part = 0; part < parts_; ++part) {
      const double theta = (row.index * parts_ + part + 0.5) * d_theta, cos_theta = std::cos(theta), sin_theta = std::sin(theta);
      if (up_ * cos_theta + horizontal_reach * sin_theta <= least_cosine_) continue;
      const double solid_angle = 2 * kPiD / (map_.width() * parts_) * 2 * sin_theta * std::sin(0.5 * d_theta);
      for (size_t x = 0, fine = 0; x < row.radiance_rgb.size(); ++x) {
        double lobe = 0;
        for (int u = 0; u < parts_; ++u, ++fine) {
          const double cosine = up_ * cos_theta + horizontal_[fine] * sin_theta;
          if (cosine > least_cosine_) lobe += shininess_ == 1 ? cosine : std::exp(shininess_ * std::log(std::min(1.0, cosine)));
        }
        if (lobe > 0)
          for (int c = 0; c < 3; ++c) sum[size_t(c)] += double(row.radiance_rgb[x][c]) * lobe * solid_angle;
      }
    }
  }

 private:
  const EnvironmentMap& map_;
  Vec3d axis_;
  float shininess_;
  double least_cosine_, up_, side_x_, side_z_;
  int parts_;
  std::vector<double> horizontal_;  // what each column adds to the cosine on the map's horizon
};

}  // namespace

std::vector<Rgb> exactAnswers(EnvironmentMap& map, std::span<const EnvironmentQuery> queries, int threads, Diagnostics& diagnostics,
                              const CancelFlag* cancel) {
  constexpr size_t rows_at_once = 64;
  std::vector<std::array<double, 3>> sums(queries.size());
  std::vector<Row> rows;
  const auto flush = [&] {
    parallelFor(queries.size(), 1, threads, cancel, [&](size_t begin, size_t end) {
      for (size_t q = begin; q < end; ++q) {
        const RowIntegral integral(map, queries[q]);
        for (const Row& row : rows) integral.add(row, sums[q]);
      }
    });
    rows.clear();
  };
  map.visitRows(diagnostics, cancel, [&](int row, std::span<const Rgb> radiance_rgb) {
    rows.push_back({row, {radiance_rgb.begin(), radiance_rgb.end()}});
    if (rows.size() == rows_at_once) flush();
  });
  flush();
  std::vector<Rgb> answers;
  for (const auto& sum : sums) answers.push_back({float(sum[0]), float(sum[1]), float(sum[2])});
  return answers;
}

}  // namespace lightwell::transport
