// The codec RANS: round trips of odd and extreme data, how near it comes to the entropy, and what damage does.
#include "format/decode/rans.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>

#include "format/encode/compress.h"
#include "format/encode/rans_encode.h"

namespace lightwell::format {
namespace {

using Bytes = std::vector<uint8_t>;

/// Nothing where the coding is damaged.
Bytes decoded(const rans::Encoded& coding, size_t count) {
  auto slots = std::make_unique<uint32_t[]>(rans::kSlots);
  uint32_t used;
  Bytes out(count);
  if (!rans::makeSlots(coding.planes.data(), slots.get(), used)) return {};
  if (!rans::decode(coding.streams.data(), coding.streams.size(), slots.get(), used, out.data(), count)) return {};
  return out;
}

/// Two-sided geometric numbers whose scale wanders, as coefficients of a map's blocks do.
Bytes laplace(size_t count, double& bits) {
  std::mt19937_64 random(5);
  Bytes data(count);
  bits = 0;
  double share = 0.5;
  for (size_t i = 0; i < count; ++i) {
    if (i % 500 == 0) share = std::uniform_real_distribution(0.05, 0.8)(random);  // of each next size
    const int size = std::min(100, int(std::geometric_distribution<int>(1 - share)(random)));
    const bool negative = random() % 2;
    data[i] = uint8_t(int8_t(negative ? -size : size));
    bits -= std::log2((1 - share) * std::pow(share, size)) - (size > 0 ? 1 : 0);
  }
  return data;
}

TEST(Rans, ContextsAreHalfOctaves) {
  EXPECT_EQ(rans::contextOf(0), 0u);
  EXPECT_EQ(rans::contextOf(1), 1u);
  for (uint32_t sum = 1; sum < 128 * rans::kWindow; ++sum) {
    const uint32_t step = rans::contextOf(sum + 1) - rans::contextOf(sum);
    EXPECT_LE(step, 1u) << sum;
    const bool begins = std::has_single_bit(sum + 1) || (std::has_single_bit((sum + 1) / 3) && (sum + 1) % 3 == 0);  // 2ᵏ, 3 · 2ᵏ
    EXPECT_EQ(step == 1, begins) << sum;
  }
  EXPECT_EQ(rans::contextOf(128 * rans::kWindow), rans::kContexts - 1);
}

TEST(Rans, GivesBackWhatItGot) {
  std::mt19937_64 random(3);
  for (size_t count = 1; count < 150; ++count) {
    Bytes data(count);
    for (auto& value : data) value = uint8_t(random() % (count % 3 == 0 ? 256 : 3));
    EXPECT_EQ(decoded(rans::encode(data), count), data) << count;
  }
  for (const uint8_t value : {0, 1, 127, 128, 255}) {
    const Bytes data(10007, value);
    const auto coding = rans::encode(data);
    EXPECT_EQ(decoded(coding, data.size()), data) << int(value);
    EXPECT_LT(coding.streams.size(), 200u);
  }
  Bytes rare(100000, 0);  // a symbol far less often than its frequency can say
  rare[77777] = 200;
  EXPECT_EQ(decoded(rans::encode(rare), rare.size()), rare);
  Bytes all(65536);
  for (size_t i = 0; i < all.size(); ++i) all[i] = uint8_t(random());
  EXPECT_EQ(decoded(rans::encode(all), all.size()), all);
}

TEST(Rans, ComesNearTheEntropyWhereZstdDoesNot) {
  double bits;
  const Bytes data = laplace(1 << 20, bits);
  const double ideal = bits / 8, stored = double(encodeWith(Codec::rans, ElementType::i8, data, 9).size());
  EXPECT_LT(stored, 1.04 * ideal);  // sixteen neighbours tell the scale roughly
  EXPECT_GT(stored, 0.99 * ideal);
  EXPECT_GT(double(encodeWith(Codec::zstd, ElementType::i8, data, 9).size()), 1.12 * ideal);
  EXPECT_EQ(encodeSmallest(ElementType::i8, data, 9).codec, Codec::rans);
}

TEST(Rans, EveryChangedBitOfAStreamIsFoundOrChangesNothingElse) {
  double bits;
  const Bytes data = laplace(3000, bits);
  const auto coding = rans::encode(data);
  size_t found = 0;
  for (size_t bit = 0; bit < coding.streams.size() * 8; ++bit) {
    auto damaged = coding;
    damaged.streams[bit / 8] ^= uint8_t(1u << bit % 8);
    const Bytes out = decoded(damaged, data.size());
    EXPECT_NE(out, data);
    found += out.empty();
  }
  EXPECT_GT(found, coding.streams.size() * 8 * 99 / 100);  // the last state and the ends of the streams tell
}

TEST(Rans, RefusesStreamsThatAreCutOrTooLong) {
  double bits;
  const Bytes data = laplace(3000, bits);
  const auto coding = rans::encode(data);
  for (size_t size = 0; size < coding.streams.size(); ++size) {
    auto cut = coding;
    cut.streams.resize(size);
    cut.streams.shrink_to_fit();
    EXPECT_TRUE(decoded(cut, data.size()).empty()) << size;
  }
  auto longer = coding;
  longer.streams.push_back(0);
  EXPECT_TRUE(decoded(longer, data.size()).empty());
  EXPECT_TRUE(decoded(coding, data.size() - 1).empty());
  EXPECT_TRUE(decoded(coding, data.size() + 4).empty());
}

}  // namespace
}  // namespace lightwell::format
