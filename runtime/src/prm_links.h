// The links of local bases: from light on the clusters to the amounts of the blocks' basis maps. The inner loop of a frame on the CPU.
//
// Links are kept wavelet by wavelet: most wavelets of most lights are zero or too small to be seen, and none of their links is read then.
#pragma once
#include "runtime/src/host.h"

namespace lightwell::runtime {

/// Links as a container has them, block by block, and checked.
struct StoredLinks {
  size_t blocks, wavelets;
  uint32_t max_rank;
  const uint8_t* block_rank;          // [blocks], none above max_rank
  const uint32_t* block_first_texel;  // [blocks + 1]
  const int8_t* basis;                // per block [texel][rank]
  const uint32_t* block_first_link;   // [blocks + 1]
  const uint32_t* link_wavelet;       // [links]
  const float* scale;                 // per block [rank][3]
  const int8_t* coefficient;          // per block [rank][G, R - G, B - G][link]
};

/// Links cut into pieces of eight numbers, [rank][3] of a block one after the other, wavelet by wavelet. Pieces of zeros, which are many, are left out.
struct LinkArrays {
  size_t wavelets;
  const float* power;                 // [wavelets]: what a unit of it adds to the texels' squares, per piece; the largest is 1
  const uint32_t* first_piece;        // [wavelets + 1]
  const uint32_t* place;              // [pieces]: index of a piece in the sums; the two highest bits: the channel of its first number
  const int8_t* coefficient;          // [pieces][8]
};

inline constexpr int kChannelShift = 30;

/// What sums are to be brought to, and room to find out what that takes.
struct LinkChange {
  const float* wavelet_rgb;  // [wavelets][3]
  float* applied_rgb;        // [wavelets][3]: what the sums stand for
  float* sums;               // [blocks][stride]
  uint8_t* touched;          // [blocks][stride / 8], set to 1 where a sum changes
  float* power;              // [wavelets]: of the change, per piece; left behind
  float* cost;               // [wavelets]: of the change, over all its pieces; left behind
  uint32_t* chosen;          // [wavelets]: those whose pieces are read; left behind
};

/// Brings the sums to the light; see PrmLinks::update. Returns whether the machine could; `read`: receives the number of pieces.
bool addChangesAvx2(const LinkArrays& links, const LinkChange& change, float tolerance, size_t& read);

class PrmLinks {
 public:
  /// False when there is no memory.
  bool load(const Host& host, const StoredLinks& stored);

  /// Floats from one block's sums to the next one's, a multiple of eight.
  size_t stride() const { return stride_; }
  size_t blocks() const { return first_scale_.size(); }
  /// Amount of the basis maps of a block per unit of its sums: [rank][3].
  const float* scale(size_t block) const { return &scale_[first_scale_[block]]; }

  /// Brings the sums from the light that they stand for to `change.wavelet_rgb`. Changes so small that all of them together are below `tolerance` of the light's root mean square
  /// are left for later. Returns how many pieces were read.
  size_t update(const LinkChange& change, float tolerance) const;

 private:
  LinkArrays arrays() const;

  size_t stride_ = 0;
  Array<uint32_t> first_scale_;         // [blocks]
  Array<float> scale_;                  // per block [rank][3]
  Array<float> power_;                  // these as in LinkArrays
  Array<uint32_t> first_piece_;
  Array<uint32_t> place_;
  Array<int8_t> coefficient_;
};

}  // namespace lightwell::runtime
