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

/// Links wavelet by wavelet, in the order of the blocks within each.
struct LinkArrays {
  size_t wavelets, stride;            // stride: floats from one block's sums to the next one's
  const float* power;                 // [wavelets]: what a unit of it adds to the texels' squares, per link; the largest is 1
  const uint32_t* first_link;         // [wavelets + 1]
  const uint64_t* first_coefficient;  // [wavelets]
  const uint32_t* link_block;         // [links]
  const uint16_t* numbers;            // [blocks]: 3 × rank, the coefficients of a link
  const int8_t* coefficient;          // per link [rank][3]; readable up to a stride after the last
};

/// What sums are to be brought to.
struct LinkChange {
  const float* wavelet_rgb;  // [wavelets][3]
  float* applied_rgb;        // [wavelets][3]: what the sums stand for
  float* sums;               // [blocks][stride]
  uint8_t* touched;          // [blocks], set to 1 where a sum changes
  float least, scale;        // changes whose square, of light times `scale`, times power is less stay out
};

/// Returns whether the machine could; `read`: receives the number of links.
bool addChangesAvx2(const LinkArrays& links, const LinkChange& change, size_t& read);

class PrmLinks {
 public:
  /// False when there is no memory.
  bool load(const Host& host, const StoredLinks& stored);

  /// Floats from one block's sums to the next one's; those after the block's own 3 × rank are left-overs.
  size_t stride() const { return stride_; }
  size_t blocks() const { return numbers_.size(); }
  /// Amount of the basis maps of a block per unit of its sums: [rank][3].
  const float* scale(size_t block) const { return &scale_[first_scale_[block]]; }

  /// Brings `sums`, [blocks][stride], from the light `applied_rgb` to the light `wavelet_rgb`, both [wavelets][3]. Changes so small that all of them together
  /// are below `tolerance` of the light's root mean square are left for later; `applied_rgb` receives what the sums stand for now.
  /// `touched`: [blocks], receives 1 where a sum changed. Returns how many links were read.
  size_t update(const float* wavelet_rgb, float tolerance, float* applied_rgb, float* sums, uint8_t* touched) const;

 private:
  LinkArrays arrays() const;
  void leaveOut(const LinkArrays& links, float tolerance, LinkChange& change) const;

  size_t stride_ = 0;
  Array<uint16_t> numbers_;             // [blocks]
  Array<uint32_t> first_scale_;         // [blocks]
  Array<float> scale_;                  // per block [rank][3]
  Array<float> power_;                  // these as in LinkArrays
  Array<uint32_t> first_link_;
  Array<uint64_t> first_coefficient_;
  Array<uint32_t> link_block_;
  Array<int8_t> coefficient_;
};

}  // namespace lightwell::runtime
