// Links as a container has them, block by block, into pieces wavelet by wavelet.
#include <algorithm>
#include <cstring>

#include "runtime/src/prm.h"

namespace lightwell::runtime {
namespace {

constexpr size_t kPiece = 8;

/// Calls visit(block, wavelet, numbers) for every link; `numbers`: [rank][3] and zeros up to the stride.
template <class Visit>
void forEachLink(const StoredLinks& stored, int8_t* numbers, size_t stride, Visit visit) {
  const int8_t* from = stored.coefficient;
  for (size_t b = 0; b < stored.blocks; ++b) {
    const size_t rank = stored.block_rank[b], first = stored.block_first_link[b], count = stored.block_first_link[b + 1] - first;
    std::memset(numbers, 0, stride);
    for (size_t l = 0; l < count; ++l) {
      for (size_t k = 0; k < rank; ++k) {
        const int8_t* green = from + k * 3 * count + l;
        int8_t* to = numbers + k * 3;
        to[0] = int8_t(uint8_t(uint8_t(green[0]) + uint8_t(green[count])));
        to[1] = green[0];
        to[2] = int8_t(uint8_t(uint8_t(green[0]) + uint8_t(green[2 * count])));
      }
      visit(b, stored.link_wavelet[first + l], numbers);
    }
    from += count * rank * 3;
  }
}

/// Calls visit(piece, numbers) for the pieces that are not zero.
template <class Visit>
void forEachPiece(const int8_t* numbers, size_t stride, Visit visit) {
  for (size_t p = 0; p < stride / kPiece; ++p) {
    uint64_t bits;
    std::memcpy(&bits, numbers + p * kPiece, kPiece);
    if (bits) visit(p, numbers + p * kPiece);
  }
}

}  // namespace

bool PrmLinks::load(const Host& host, const StoredLinks& stored) {
  stride_ = (size_t(stored.max_rank) * 3 + kPiece - 1) / kPiece * kPiece;
  Array<int8_t> numbers;      // [stride]
  Array<uint32_t> next;       // [wavelets]
  Array<double> map_power, power;  // of the maps of all blocks, [wavelets]
  size_t scales = 0;
  if (!first_scale_.allocate(host, stored.blocks)) return false;
  for (size_t b = 0; b < stored.blocks; ++b) {
    first_scale_[b] = uint32_t(scales);
    scales += size_t(stored.block_rank[b]) * 3;
  }
  if (!first_piece_.allocate(host, stored.wavelets + 1) || !power_.allocate(host, stored.wavelets) || !next.allocate(host, stored.wavelets) || !numbers.allocate(host, stride_) ||
      !scale_.allocate(host, scales) || !map_power.allocate(host, scales / 3) || !power.allocate(host, stored.wavelets))
    return false;
  std::memcpy(scale_.data(), stored.scale, scales * sizeof(float));
  const int8_t* basis = stored.basis;
  for (size_t b = 0; b < stored.blocks; ++b) {
    const size_t rank = stored.block_rank[b];
    double* of_block = map_power.data() + first_scale_[b] / 3;
    std::fill_n(of_block, rank, 0.0);
    for (size_t t = stored.block_first_texel[b]; t < stored.block_first_texel[b + 1]; ++t)
      for (size_t k = 0; k < rank; ++k, ++basis) of_block[k] += double(basisValue(*basis) * basisValue(*basis));
  }

  std::memset(first_piece_.data(), 0, first_piece_.bytes());
  forEachLink(stored, numbers.data(), stride_, [&](size_t, uint32_t w, const int8_t* link) { forEachPiece(link, stride_, [&](size_t, const int8_t*) { ++first_piece_[w + 1]; }); });
  for (size_t w = 0; w < stored.wavelets; ++w) {
    first_piece_[w + 1] += first_piece_[w];
    next[w] = first_piece_[w];
    power[w] = 0;
  }
  const size_t pieces = first_piece_[stored.wavelets];
  if (!place_.allocate(host, pieces) || !coefficient_.allocate(host, pieces * kPiece)) return false;
  forEachLink(stored, numbers.data(), stride_, [&](size_t b, uint32_t w, const int8_t* link) {
    const float* block_scale = scale(b);
    for (size_t i = 0; i < size_t(stored.block_rank[b]) * 3; ++i) {
      const double amount = double(link[i]) * double(block_scale[i]);
      power[w] += amount * amount * map_power[(first_scale_[b] + i) / 3];
    }
    forEachPiece(link, stride_, [&](size_t p, const int8_t* piece) {
      place_[next[w]] = uint32_t(b * (stride_ / kPiece) + p) | uint32_t(p * kPiece % 3) << kChannelShift;
      std::memcpy(&coefficient_[size_t(next[w]++) * kPiece], piece, kPiece);
    });
  });
  double most = 0;
  for (size_t w = 0; w < stored.wavelets; ++w) {
    const uint32_t count = first_piece_[w + 1] - first_piece_[w];
    if (count) power[w] /= count;
    most = std::max(most, power[w]);
  }
  for (size_t w = 0; w < stored.wavelets; ++w) power_[w] = most > 0 ? float(power[w] / most) : 0.0f;
  return true;
}

}  // namespace lightwell::runtime
