#include "format/encode/rans_encode.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "format/decode/endian.h"
#include "format/decode/rans.h"

namespace lightwell::format::rans {
namespace {

using Counts = std::array<uint64_t, kSymbols>;
using Frequencies = std::array<uint32_t, kSymbols>;

/// The context of every byte.
std::vector<uint8_t> contextsOf(std::span<const uint8_t> data) {
  std::vector<uint8_t> contexts(data.size());
  for (size_t part = 0; part < kParts; ++part) {
    const size_t begin = partBegin(data.size(), part), end = partBegin(data.size(), part + 1);
    uint32_t sum = 0;
    for (size_t i = begin; i < end; ++i) {
      contexts[i] = uint8_t(contextOf(sum));
      sum += sizeOf(data[i]);
      if (i - begin >= kWindow) sum -= sizeOf(data[i - kWindow]);
    }
  }
  return contexts;
}

/// Counts scaled to a sum of kScale, none that was not 0 to 0; all 0 if all are.
Frequencies scaled(const Counts& counts) {
  Frequencies frequencies{};
  const uint64_t total = std::accumulate(counts.begin(), counts.end(), uint64_t(0));
  if (total == 0) return frequencies;
  int64_t rest = kScale;
  for (size_t s = 0; s < kSymbols; ++s) {
    if (counts[s]) frequencies[s] = uint32_t(std::max<uint64_t>(1, (counts[s] * kScale + total / 2) / total));
    rest -= frequencies[s];
  }
  // What is too much or too little goes to where it is felt least: the largest.
  while (rest != 0) {
    auto& largest = *std::max_element(frequencies.begin(), frequencies.end());
    const int64_t change = rest > 0 ? rest : std::max<int64_t>(rest, -std::max<int64_t>(1, int64_t(largest) / 8));
    largest = uint32_t(int64_t(largest) + change);
    rest -= change;
  }
  return frequencies;
}

template <class Unsigned>
void append(std::vector<uint8_t>& bytes, Unsigned value) {
  bytes.resize(bytes.size() + sizeof(Unsigned));
  storeLittle(&bytes[bytes.size() - sizeof(Unsigned)], value);
}

}  // namespace

Encoded encode(std::span<const uint8_t> data) {
  const std::vector<uint8_t> contexts = contextsOf(data);
  std::array<Counts, kContexts> counts{};
  for (size_t i = 0; i < data.size(); ++i) ++counts[contexts[i]][data[i]];
  Encoded encoded;
  encoded.planes.resize(kTableBytes);
  std::array<Frequencies, kContexts> frequencies, first;  // first: of the frequencies before
  for (size_t c = 0; c < kContexts; ++c) {
    frequencies[c] = scaled(counts[c]);
    std::exclusive_scan(frequencies[c].begin(), frequencies[c].end(), first[c].begin(), 0u);
    for (size_t s = 0; s < kSymbols; ++s) {
      encoded.planes[c * kSymbols + s] = uint8_t(frequencies[c][s]);
      encoded.planes[kTableBytes / 2 + c * kSymbols + s] = uint8_t(frequencies[c][s] >> 8);
    }
  }
  // The last byte is encoded first: a decoder undoes the steps in turn.
  std::array<std::vector<uint16_t>, kParts> words;
  std::array<uint32_t, kParts> states;
  for (size_t part = 0; part < kParts; ++part) {
    uint32_t state = kLeastState;
    for (size_t i = partBegin(data.size(), part + 1); i-- > partBegin(data.size(), part);) {
      const uint32_t frequency = frequencies[contexts[i]][data[i]];
      if (state >= uint64_t(frequency) << (32 - kScaleBits)) {
        words[part].push_back(uint16_t(state));
        state >>= 16;
      }
      state = (state / frequency << kScaleBits) + state % frequency + first[contexts[i]][data[i]];
    }
    states[part] = state;
  }
  for (size_t part = 0; part < kParts; ++part) append(encoded.streams, uint32_t(4 + words[part].size() * 2));
  for (size_t part = 0; part < kParts; ++part) {
    append(encoded.streams, states[part]);
    for (size_t i = words[part].size(); i-- > 0;) append(encoded.streams, words[part][i]);
  }
  return encoded;
}

}  // namespace lightwell::format::rans
