#include "runtime/src/prm_links.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "runtime/src/prm.h"
#include "runtime/src/prm_links_sum.h"

namespace lightwell::runtime {
namespace {

struct Eight {
  static void add(float* sum, const int8_t* coefficient, const float* light) {
    for (int i = 0; i < 8; ++i) sum[i] += float(coefficient[i]) * light[i];
  }
};

}  // namespace

bool PrmLinks::load(const Host& host, const StoredLinks& stored) {
  const size_t links = stored.block_first_link[stored.blocks];
  uint64_t coefficients = 0, scales = 0;
  stride_ = (size_t(stored.max_rank) * 3 + 7) / 8 * 8;
  Array<uint64_t> next_coefficient;  // [wavelets]
  Array<uint32_t> next_link;         // [wavelets]
  Array<double> map_power, power;    // [max_rank], [wavelets]
  if (!numbers_.allocate(host, stored.blocks) || !first_scale_.allocate(host, stored.blocks) || !first_link_.allocate(host, stored.wavelets + 1) ||
      !first_coefficient_.allocate(host, stored.wavelets) || !power_.allocate(host, stored.wavelets) || !link_block_.allocate(host, links) ||
      !next_coefficient.allocate(host, stored.wavelets) || !next_link.allocate(host, stored.wavelets) || !map_power.allocate(host, stored.max_rank) ||
      !power.allocate(host, stored.wavelets))
    return false;
  std::memset(first_link_.data(), 0, first_link_.bytes());
  std::memset(next_coefficient.data(), 0, next_coefficient.bytes());
  for (size_t b = 0; b < stored.blocks; ++b) {
    numbers_[b] = uint16_t(stored.block_rank[b] * 3);
    first_scale_[b] = uint32_t(scales);
    scales += numbers_[b];
    for (size_t l = stored.block_first_link[b]; l < stored.block_first_link[b + 1]; ++l) {
      ++first_link_[stored.link_wavelet[l] + 1];
      next_coefficient[stored.link_wavelet[l]] += numbers_[b];
    }
  }
  for (size_t w = 0; w < stored.wavelets; ++w) {
    first_link_[w + 1] += first_link_[w];
    next_link[w] = first_link_[w];
    first_coefficient_[w] = coefficients;
    coefficients += next_coefficient[w];
    next_coefficient[w] = first_coefficient_[w];
  }
  // The sums' vectors end up to a stride after a link's own coefficients.
  if (!scale_.allocate(host, scales) || !coefficient_.allocate(host, coefficients + stride_)) return false;
  std::memcpy(scale_.data(), stored.scale, scales * sizeof(float));
  std::memset(&coefficient_[coefficients], 0, stride_);
  std::memset(power.data(), 0, power.bytes());
  const int8_t *basis = stored.basis, *from = stored.coefficient;
  for (size_t b = 0; b < stored.blocks; ++b) {
    const size_t rank = stored.block_rank[b], first = stored.block_first_link[b], count = stored.block_first_link[b + 1] - first;
    for (size_t k = 0; k < rank; ++k) map_power[k] = 0;
    for (size_t t = stored.block_first_texel[b]; t < stored.block_first_texel[b + 1]; ++t)
      for (size_t k = 0; k < rank; ++k, ++basis) map_power[k] += double(basisValue(*basis) * basisValue(*basis));
    const float* block_scale = scale(b);
    for (size_t l = 0; l < count; ++l) {
      const uint32_t wavelet = stored.link_wavelet[first + l];
      int8_t* to = &coefficient_[next_coefficient[wavelet]];
      for (size_t k = 0; k < rank; ++k, to += 3) {
        const int8_t* green = from + k * 3 * count + l;
        to[0] = int8_t(uint8_t(uint8_t(green[0]) + uint8_t(green[count])));
        to[1] = green[0];
        to[2] = int8_t(uint8_t(uint8_t(green[0]) + uint8_t(green[2 * count])));
        for (int c = 0; c < 3; ++c) {
          const double amount = double(to[c]) * double(block_scale[k * 3 + size_t(c)]);
          power[wavelet] += amount * amount * map_power[k];
        }
      }
      next_coefficient[wavelet] += numbers_[b];
      link_block_[next_link[wavelet]++] = uint32_t(b);
    }
    from += count * rank * 3;
  }
  double most = 0;
  for (size_t w = 0; w < stored.wavelets; ++w) {
    const uint32_t count = first_link_[w + 1] - first_link_[w];
    if (count) power[w] /= count;
    most = std::max(most, power[w]);
  }
  for (size_t w = 0; w < stored.wavelets; ++w) power_[w] = most > 0 ? float(power[w] / most) : 0.0f;
  return true;
}

LinkArrays PrmLinks::arrays() const {
  return {power_.size(), stride_, power_.data(), first_link_.data(), first_coefficient_.data(), link_block_.data(), numbers_.data(), coefficient_.data()};
}

void PrmLinks::leaveOut(const LinkArrays& links, float tolerance, LinkChange& change) const {
  float largest = 0;
  for (size_t i = 0; i < links.wavelets * 3; ++i) largest = std::max({largest, std::fabs(change.wavelet_rgb[i]), std::fabs(change.applied_rgb[i])});
  const float scale = 1.0f / largest;  // squares of very bright and very dim light stay in range
  if (!(tolerance > 0) || !std::isfinite(scale) || scale == 0) return;
  // Changes by their squares, a bin for each half octave: left out from the smallest on, as long as their sum allows.
  constexpr int kBitsBelow = 22;
  constexpr size_t kBins = size_t(1) << (31 - kBitsBelow);
  double bin[kBins] = {}, all = 0;
  for (size_t w = 0; w < links.wavelets; ++w) {
    const float *to = change.wavelet_rgb + w * 3, *from = change.applied_rgb + w * 3;
    if (to[0] == 0 && to[1] == 0 && to[2] == 0 && from[0] == 0 && from[1] == 0 && from[2] == 0) continue;
    const double count = links.first_link[w + 1] - links.first_link[w];
    all += double(squared(to[0], to[1], to[2], scale) * links.power[w]) * count;
    const float square = squared(to[0] - from[0], to[1] - from[1], to[2] - from[2], scale) * links.power[w];
    bin[std::bit_cast<uint32_t>(square) >> kBitsBelow] += double(square) * count;
  }
  const double most = double(tolerance) * double(tolerance) * all;
  double left_out = 0;
  uint32_t b = 0;
  while (b + 1 < kBins && (left_out += bin[b]) <= most) ++b;
  change.least = std::bit_cast<float>(b << kBitsBelow);
  change.scale = scale;
}

size_t PrmLinks::update(const float* wavelet_rgb, float tolerance, float* applied_rgb, float* sums, uint8_t* touched) const {
  const LinkArrays links = arrays();
  LinkChange change{wavelet_rgb, applied_rgb, sums, touched, 0, 0};
  leaveOut(links, tolerance, change);
  size_t read = 0;
  return addChangesAvx2(links, change, read) ? read : addChanges<Eight>(links, change);
}

}  // namespace lightwell::runtime
