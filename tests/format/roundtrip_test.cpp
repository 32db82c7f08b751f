// What a Writer was given is what a Reader gives back, for every element type, codec and odd shape.
#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "format/decode/checksum.h"
#include "format/encode/compress.h"
#include "format/encode/reader.h"
#include "format/encode/writer.h"
#include "tests/format/forge.h"

namespace lightwell::format {
namespace {

enum class Kind { noise, monotone, runs };

template <class T>
std::vector<T> randomValues(std::mt19937_64& random, size_t count, Kind kind) {
  std::vector<T> values(count);
  uint64_t running = random();
  for (T& value : values) {
    if (kind == Kind::noise) running = random();
    if (kind == Kind::monotone) running += random() % 7;
    if (kind == Kind::runs && random() % 50 == 0) running = random() % 5;
    if constexpr (std::is_floating_point_v<T>) value = T(running % 100000) / T(1000);
    else value = T(running);
  }
  return values;
}

TEST(RoundTrip, RandomStructuredContainers) {
  std::mt19937_64 random(7);
  for (int round = 0; round < 40; ++round) {
    Writer writer({.zstd_level = 1 + round % 12});
    std::vector<std::vector<uint16_t>> shorts;
    std::vector<std::vector<uint32_t>> words;
    std::vector<std::vector<float>> floats;
    std::vector<std::vector<int8_t>> bytes;
    const int chunks = int(random() % 6);
    writer.addSection("one", 1, false);
    writer.addSection("two", 3, false);
    for (int i = 0; i < chunks; ++i) {
      const std::string name = "c" + std::to_string(i);
      const size_t count = random() % 4 == 0 ? random() % 3 : random() % 5000;
      shorts.push_back(randomValues<uint16_t>(random, count, Kind(i % 3)));
      words.push_back(randomValues<uint32_t>(random, count * 3, Kind((i + 1) % 3)));
      floats.push_back(randomValues<float>(random, count, Kind((i + 2) % 3)));
      bytes.push_back(randomValues<int8_t>(random, count, Kind(i % 3)));
      writer.add("one", name, shorts.back());
      writer.add("two", name, words.back(), {count, 3});
      writer.add("one", name + "f", floats.back());
      writer.add("two", name + "b", bytes.back());
    }
    const Reader reader(writer.bytes());
    ASSERT_EQ(reader.view().chunks().size(), size_t(chunks) * 4);
    for (int i = 0; i < chunks; ++i) {
      const std::string name = "c" + std::to_string(i);
      EXPECT_EQ(reader.read<uint16_t>("one", name), shorts[i]);
      EXPECT_EQ(reader.read<uint32_t>("two", name), words[i]);
      EXPECT_EQ(reader.read<float>("one", name + "f"), floats[i]);
      EXPECT_EQ(reader.read<int8_t>("two", name + "b"), bytes[i]);
      const ChunkInfo& info = reader.chunk("two", name);
      EXPECT_EQ(info.rank, 2u);
      EXPECT_EQ(info.shape[0] * info.shape[1], words[i].size());
    }
  }
}

TEST(RoundTrip, EveryCodecOnEveryElementItMayStore) {
  std::mt19937_64 random(11);
  int pairs = 0;
  for (int type = 1; type <= int(ElementType::rgb9e5); ++type)
    for (int c = 1; c <= int(Codec::rans); ++c) {
      const auto element = ElementType(type);
      const auto codec = Codec(c);
      const std::vector<uint8_t> data = randomValues<uint8_t>(random, 1001 * elementBytes(element), Kind::runs);
      if (!codecAllowed(codec, element)) {
        EXPECT_THROW(encodeWith(codec, element, data, 3), std::invalid_argument);
        continue;
      }
      const std::vector<uint8_t> stored = encodeWith(codec, element, data, 3);
      Forge forge;
      forge.section("s");
      forge.chunk("s", "c", element, {1001}, codec, {stored.begin(), stored.end()});
      const std::vector<uint8_t> file = forge.build();
      View view;
      ASSERT_FALSE(view.open(memorySource(file.data(), file.size())));
      // The destination need not be aligned.
      std::vector<uint8_t> decoded(data.size() + 1);
      const Fault fault = view.decode(view.chunks()[0], decoded.data() + 1, data.size());
      ASSERT_FALSE(fault) << fault.what;
      EXPECT_EQ(std::memcmp(decoded.data() + 1, data.data(), data.size()), 0) << type << " " << c;
      ++pairs;
    }
  EXPECT_EQ(pairs, 9 * 2 + 6 + 5 + 3);
}

TEST(RoundTrip, ReaderCallbackAndMemoryAgree) {
  std::mt19937_64 random(3);
  Writer writer;
  writer.addSection("s", 1, false);
  const auto noise = randomValues<uint32_t>(random, 100000, Kind::noise);
  const auto steps = randomValues<uint32_t>(random, 100000, Kind::monotone);
  writer.add("s", "noise", noise);
  writer.add("s", "steps", steps);
  const std::vector<uint8_t> file = writer.bytes();

  Source source;
  source.user = const_cast<std::vector<uint8_t>*>(&file);
  source.bytes = file.size();
  source.read = [](void* user, uint64_t offset, void* destination, size_t bytes) {
    const auto& data = *static_cast<std::vector<uint8_t>*>(user);
    if (offset + bytes > data.size()) return false;
    std::memcpy(destination, data.data() + offset, bytes);
    return true;
  };
  View view;
  ASSERT_FALSE(view.open(source));
  std::vector<uint32_t> values(100000);
  ASSERT_FALSE(view.decode(*view.findChunk("s", "noise"), values.data(), 400000));
  EXPECT_EQ(values, noise);
  EXPECT_EQ(view.findChunk("s", "noise")->codec, Codec::raw);
  ASSERT_FALSE(view.decode(*view.findChunk("s", "steps"), values.data(), 400000));
  EXPECT_EQ(values, steps);
  EXPECT_EQ(view.findChunk("s", "steps")->codec, Codec::zstd_delta_planes);
  EXPECT_FALSE(view.checkStored(*view.findChunk("s", "noise")));
  EXPECT_EQ(view.findChunk("s", "nothing"), nullptr);
  EXPECT_EQ(view.findChunk("t", "noise"), nullptr);
  EXPECT_EQ(view.decode(view.chunks()[0], values.data(), 399999).status, Status::invalid_argument);

  source.read = [](void*, uint64_t, void*, size_t) { return false; };
  EXPECT_EQ(view.open(source).status, Status::io_error);
  EXPECT_FALSE(view.isOpen());
}

TEST(RoundTrip, ChecksumStreamEqualsChecksum) {
  std::vector<uint8_t> data(100000);
  for (size_t i = 0; i < data.size(); ++i) data[i] = uint8_t(i * i >> 3);
  ChecksumStream stream;
  for (size_t at = 0; at < data.size();) {
    const size_t bytes = std::min(data.size() - at, 1 + at * 7 % 5000);
    stream.update(&data[at], bytes);
    at += bytes;
  }
  EXPECT_EQ(stream.digest(), checksum(data.data(), data.size()));
  EXPECT_EQ(checksum(nullptr, 0), 0x2d06800538d394c2u);  // XXH3-64 of nothing, from the algorithm's specification
}

}  // namespace
}  // namespace lightwell::format
