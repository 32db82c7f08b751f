#include "precompute/transport/environment/sky_light.h"

#include <algorithm>

namespace lightwell::transport {
namespace {

constexpr double kPiD = std::numbers::pi;

}  // namespace

SkyLight::SkyLight(const SkyGrid& grid) : width_(grid.width), height_(grid.height), frame_(grid.frame) {
  radiance_rgb_.reserve(grid.size());
  column_end_.reserve(grid.size());
  row_end_.reserve(size_t(height_));
  for (int y = 0; y < height_; ++y) {
    const size_t first = size_t(y) * size_t(width_);
    double row = 0;
    std::vector<double> end;
    end.reserve(size_t(width_));
    for (size_t i = first; i < first + size_t(width_); ++i) {
      Rgb radiance;
      for (size_t c = 0; c < 3; ++c) radiance[int(c)] = float(grid.flux_rgb[i][c] / grid.solid_angle_sr[i]);
      radiance_rgb_.push_back(radiance);
      end.push_back(row += double(luminance(radiance)));
    }
    for (const double sum : end) column_end_.push_back(row > 0 ? float(sum / row) : 1.0f);
    total_ += row * (cosineAbove(y) - cosineAbove(y + 1));
    row_end_.push_back(total_);
  }
}

double SkyLight::cosineAbove(int row) const { return std::cos(kPiD * row / height_); }

float SkyLight::pdf(size_t cell) const {
  // Share of the flux, over the solid angle: luminance, times the columns of a turn, over the sum.
  return total_ > 0 ? float(double(luminance(radiance_rgb_[cell])) * width_ / (2 * kPiD * total_)) : 0.0f;
}

SkyLight::Value SkyLight::at(const Vec3& direction) const {
  const Vec3d d(direction);
  const double theta = std::acos(std::clamp(d.dot(frame_[0]), -1.0, 1.0)), phi = std::atan2(d.dot(frame_[2]), d.dot(frame_[1]));
  const int y = std::min(int(theta / kPiD * height_), height_ - 1);
  const int x = std::clamp(int(std::floor((phi / (2 * kPiD) + 0.5) * width_)), 0, width_ - 1);
  const size_t cell = size_t(y) * size_t(width_) + size_t(x);
  return {radiance_rgb_[cell], pdf(cell)};
}

SkyLight::Sample SkyLight::sample(const Vec2& u) const {
  const double target = double(u.x) * total_;
  const auto row = std::min(std::upper_bound(row_end_.begin(), row_end_.end(), target), row_end_.end() - 1);
  const int y = int(row - row_end_.begin());
  const double row_begin = y > 0 ? row_end_[size_t(y) - 1] : 0.0;
  const double v = std::clamp((target - row_begin) / std::max(*row - row_begin, 1e-300), 0.0, 1.0);

  const auto begin = column_end_.begin() + ptrdiff_t(y) * width_, end = begin + width_;
  const auto column = std::min(std::upper_bound(begin, end, u.y), end - 1);
  const int x = int(column - begin);
  const float column_begin = x > 0 ? *(column - 1) : 0.0f, share = *column - column_begin;
  const double w = share > 0 ? std::clamp(double(u.y - column_begin) / share, 0.0, 1.0) : 0.5;

  const double cosine = cosineAbove(y) + (cosineAbove(y + 1) - cosineAbove(y)) * v, sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  const double phi = ((x + w) / width_ - 0.5) * 2 * kPiD;
  const size_t cell = size_t(y) * size_t(width_) + size_t(x);
  const Vec3d direction = frame_[0] * cosine + (frame_[1] * std::cos(phi) + frame_[2] * std::sin(phi)) * sine;
  return {Vec3(direction.normalized()), radiance_rgb_[cell], pdf(cell)};
}

}  // namespace lightwell::transport
