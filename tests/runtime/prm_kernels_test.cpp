// The inner loops of local bases: what machines with and without AVX2 run gives the same.
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "format/decode/pixel.h"
#include "runtime/src/prm_links_sum.h"
#include "runtime/src/prm_tile.h"

namespace lightwell::runtime {
namespace {

struct PlainEight {
  static void add(float* sum, const int8_t* coefficient, const float* light) {
    for (int i = 0; i < 8; ++i) sum[i] += float(coefficient[i]) * light[i];
  }
};

/// Links of three wavelets for each of some blocks, three pieces a block, and light on them.
struct Sums {
  static constexpr size_t kWavelets = 60, kBlocks = 11, kPieces = 3;
  std::vector<float> power, wavelet_rgb, applied_rgb = std::vector<float>(kWavelets * 3), sums = std::vector<float>(kBlocks * kPieces * 8);
  std::vector<float> change_power = std::vector<float>(kWavelets), cost = std::vector<float>(kWavelets);
  std::vector<uint32_t> first_piece = {0}, place, chosen = std::vector<uint32_t>(kWavelets);
  std::vector<uint8_t> touched = std::vector<uint8_t>(kBlocks * kPieces);
  std::vector<int8_t> coefficient;

  Sums() {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> uniform(0, 1);
    for (size_t w = 0; w < kWavelets; ++w) {
      power.push_back(uniform(random));
      for (int k = 0; k < 3; ++k) wavelet_rgb.push_back(w % 4 ? std::pow(uniform(random), 12.0f) - 0.1f * float(w % 2) : 0);
      for (size_t b = 0; b < kBlocks; ++b) {
        const uint32_t piece = uint32_t(random() % kPieces);
        if (random() % 3 == 0) continue;
        place.push_back((uint32_t(b * kPieces) + piece) | uint32_t(piece * 8 % 3) << kChannelShift);
        for (int i = 0; i < 8; ++i) coefficient.push_back(int8_t(random()));
      }
      first_piece.push_back(uint32_t(place.size()));
    }
  }
  LinkArrays links() const { return {kWavelets, power.data(), first_piece.data(), place.data(), coefficient.data()}; }
  LinkChange change() { return {wavelet_rgb.data(), applied_rgb.data(), sums.data(), touched.data(), change_power.data(), cost.data(), chosen.data()}; }
  /// Sum over all links, as docs/format.md has it: numbers are [rank][channel].
  std::vector<float> all() const {
    std::vector<float> result(sums.size());
    for (size_t w = 0; w < kWavelets; ++w)
      for (size_t p = first_piece[w]; p < first_piece[w + 1]; ++p)
        for (size_t i = 0; i < 8; ++i) {
          const size_t at = size_t(place[p] & ((1u << kChannelShift) - 1)) * 8 + i;
          result[at] += float(coefficient[p * 8 + i]) * wavelet_rgb[w * 3 + at % (kPieces * 8) % 3];
        }
    return result;
  }
};

TEST(PrmKernels, SumPiecesWithAndWithoutAvx2) {
  for (const float tolerance : {0.0f, 0.05f}) {
    Sums plain, wide;
    const size_t read = addChanges<PlainEight>(plain.links(), plain.change(), tolerance);
    size_t read_wide = read;
    if (addChangesAvx2(wide.links(), wide.change(), tolerance, read_wide)) {
      EXPECT_EQ(read_wide, read);
      EXPECT_EQ(wide.touched, plain.touched);
      for (size_t i = 0; i < plain.sums.size(); ++i) EXPECT_NEAR(wide.sums[i], plain.sums[i], 1e-3f);
    }
    const auto all = plain.all();
    double difference = 0, square = 0;
    for (size_t i = 0; i < all.size(); ++i) difference += std::pow(double(plain.sums[i] - all[i]), 2), square += double(all[i]) * all[i];
    EXPECT_LE(std::sqrt(difference / square), tolerance > 0 ? 0.2 : 1e-5);
    if (tolerance > 0) { EXPECT_LT(read, plain.place.size() * 3 / 4); }
    EXPECT_EQ(addChanges<PlainEight>(plain.links(), plain.change(), tolerance), 0u);  // all that was asked for is there
  }
}

/// What is left out, weighed by power, stays within the share that may be.
TEST(PrmKernels, LeaveOutNoMoreThanTheTolerance) {
  for (const float tolerance : {0.001f, 0.01f, 0.1f, 1.0f}) {
    Sums s;
    const size_t chosen = chooseChanges(s.links(), s.change(), tolerance);
    std::vector<char> is_chosen(Sums::kWavelets);
    for (size_t i = 0; i < chosen; ++i) is_chosen[s.chosen[i]] = 1;
    double all = 0, left_out = 0, least_chosen = 1e30, most_left = 0;
    for (size_t w = 0; w < Sums::kWavelets; ++w) {
      const double power = double(squared(s.wavelet_rgb[w * 3], s.wavelet_rgb[w * 3 + 1], s.wavelet_rgb[w * 3 + 2], 1)) * s.power[w];
      const double cost = power * (s.first_piece[w + 1] - s.first_piece[w]);
      all += cost;
      if (is_chosen[w]) least_chosen = std::min(least_chosen, power);
      else left_out += cost, most_left = std::max(most_left, power);
    }
    EXPECT_LE(left_out, double(tolerance) * tolerance * all * 1.001) << tolerance;
    EXPECT_LE(most_left, least_chosen * 1.001) << tolerance;
  }
}

TEST(PrmKernels, MakeTexelsWithAndWithoutAvx2) {
  std::mt19937 random(8);
  std::uniform_real_distribution<float> uniform(-1, 3);
  for (const uint32_t rank : {0u, 1u, 3u, 8u, 9u, 255u}) {
    std::vector<Float4> amount(std::max(rank, 1u));
    for (Float4& a : amount) a = Float4{uniform(random), uniform(random), uniform(random), 0};
    constexpr uint32_t kCount = 67;
    std::vector<int8_t> basis(size_t(kCount) * rank);
    for (int8_t& b : basis) b = int8_t(random());
    if (rank > 0) basis[0] = -128;
    std::vector<float> plain(kCount * 4, -1), wide(kCount * 4, -1);
    reconstructTile(amount.data(), rank, basis.data(), kCount, plain.data());
    for (uint32_t t = 0; t < kCount; ++t)
      for (int c = 0; c < 3; ++c) {
        double sum = 0;
        for (uint32_t k = 0; k < rank; ++k) sum += double(amount[k][c]) * std::max<int>(basis[t * rank + k], -127);
        EXPECT_NEAR(plain[t * 4 + size_t(c)], std::max(0.0, sum), 0.02) << rank;
      }
    if (!reconstructTileAvx2(amount.data(), rank, basis.data(), kCount, wide.data())) continue;
    for (size_t i = 0; i < plain.size(); ++i) EXPECT_NEAR(wide[i], plain[i], 0.02f) << rank;
  }
}

TEST(PrmKernels, PackTheNearestHalf) {
  std::vector<float> values = {0, 1, 0x1p-24f, 0x1p-25f, 0x1.8p-25f, 0x1p-14f, 0x1.ffcp-15f, 65504, 65520, 1e30f, 3.4e38f, 1e-30f, 0x1.002p0f, 0x1.006p0f, 0x1.0021p0f};
  std::mt19937 random(9);
  while (values.size() % 4 || values.size() < 4000) values.push_back(std::exp2(std::uniform_real_distribution<float>(-26, 17)(random)));
  std::vector<uint16_t> plain(values.size()), wide(values.size());
  packTile(values.data(), uint32_t(values.size() / 4), plain.data());
  for (size_t i = 0; i < values.size(); ++i) ASSERT_EQ(plain[i], format::packHalf(std::min(values[i], 65504.0f))) << values[i];
  if (packTileAvx2(values.data(), uint32_t(values.size() / 4), wide.data())) { EXPECT_EQ(wide, plain); }
}

/// What is no number shows nothing; what is beyond floats the greatest of them.
TEST(PrmKernels, StayFinite) {
  const Float4 amount[] = {Float4{NAN, INFINITY, -INFINITY, 0}};
  const int8_t basis[] = {127};
  float texel[4];
  reconstructTile(amount, 1, basis, 1, texel);
  EXPECT_EQ(texel[0], 0.0f);
  EXPECT_EQ(texel[1], FLT_MAX);
  EXPECT_EQ(texel[2], 0.0f);
  EXPECT_EQ(texel[3], 1.0f);
}

}  // namespace
}  // namespace lightwell::runtime
