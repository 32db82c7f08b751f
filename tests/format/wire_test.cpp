// The wire reader: terminates on anything, and accepts nothing that the protobuf library refuses.
#include <google/protobuf/stubs/logging.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "format/decode/headers.h"
#include "format/decode/wire.h"
#include "format/encode/strict_message.h"
#include "lightwell/v1/container.pb.h"

namespace lightwell::format {
namespace {

/// The fields of a chunk, read with every kind of accessor.
bool readChunk(const std::string& message, v1::Chunk& chunk) {
  WireReader reader(message);
  std::string_view section, name;
  uint32_t element = 0, codec = 0, rank = 0;
  uint64_t shape[8], offset = 0, stored = 0, sum = 0;
  while (reader.next()) switch (reader.field()) {
      case 1: reader.read(section); break;
      case 2: reader.read(name); break;
      case 3: reader.read(element); break;
      case 4: reader.append(shape, 8, rank); break;
      case 5: reader.read(codec); break;
      case 6: reader.read(offset); break;
      case 7: reader.read(stored); break;
      case 8: reader.readFixed64(sum); break;
    }
  if (!reader.ok()) return false;
  chunk.set_section(std::string(section));
  chunk.set_name(std::string(name));
  chunk.set_element(v1::ElementType(element));
  chunk.mutable_shape()->Add(shape, shape + rank);
  chunk.set_codec(v1::Codec(codec));
  chunk.set_offset(offset);
  chunk.set_stored_bytes(stored);
  chunk.set_checksum(sum);
  return true;
}

v1::Chunk sample() {
  v1::Chunk chunk;
  chunk.set_section("prm");
  chunk.set_name("pane");
  chunk.set_element(v1::ELEMENT_TYPE_RGB9E5);
  chunk.add_shape(256);
  chunk.add_shape(70000);
  chunk.set_codec(v1::CODEC_ZSTD_PLANES);
  chunk.set_offset(uint64_t(1) << 40);
  chunk.set_stored_bytes(12345678);
  chunk.set_checksum(0xfedcba9876543210u);
  return chunk;
}

TEST(Wire, AgreesWithProtobuf) {
  v1::Chunk chunk;
  ASSERT_TRUE(readChunk(sample().SerializeAsString(), chunk));
  EXPECT_EQ(chunk.SerializeAsString(), sample().SerializeAsString());
}

TEST(Wire, PackedAndUnpackedNumbersAreTheSame) {
  v1::Chunk chunk;
  ASSERT_TRUE(readChunk(std::string("\x20\x05\x22\x02\x06\x07\x20\x08", 8), chunk));
  ASSERT_EQ(chunk.shape_size(), 4);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(chunk.shape(i), uint64_t(5 + i));
}

TEST(Wire, RefusesWhatItMust) {
  v1::Chunk chunk;
  const auto refused = [&](std::string bytes) { return !readChunk(bytes, chunk); };
  EXPECT_TRUE(refused({"\x08\x01", 2})) << "a number where a string belongs";
  EXPECT_TRUE(refused({"\x30\x01\x30\x01", 4})) << "a singular field twice";
  EXPECT_TRUE(refused({"\x30\xff\xff\xff\xff\xff\xff\xff\xff\xff\x02", 11})) << "a varint of more than 64 bits";
  EXPECT_TRUE(refused({"\x18\x80\x80\x80\x80\x10", 6})) << "an enum of more than 32 bits";
  EXPECT_TRUE(refused({"\x30", 1})) << "a field without its value";
  EXPECT_TRUE(refused({"\x41\x00\x00", 3})) << "a fixed64 that is cut";
  EXPECT_TRUE(refused({"\x0a\xff\xff\xff\xff\xff\xff\xff\xff\xff\x01", 11})) << "a string of 2^64 - 1 bytes";
  EXPECT_TRUE(refused({"\x22\x01\x80", 3})) << "a packed varint that is cut";
  EXPECT_TRUE(refused({"\x22\x09\x01\x01\x01\x01\x01\x01\x01\x01\x01", 11})) << "more numbers than there is room for";
  EXPECT_TRUE(refused({"\x07", 1})) << "wire type 7";
  EXPECT_FALSE(refused({"\x7a\x01x\xa5\x06" "1234", 9})) << "unknown fields are skipped";
}

TEST(Wire, RandomDamageNeverDisagreesWithProtobuf) {
  std::mt19937_64 random(5);
  const std::string good = sample().SerializeAsString();
  int accepted = 0;
  for (int i = 0; i < 200000; ++i) {
    std::string bytes = good;
    for (uint64_t edits = 1 + random() % 3; edits > 0; --edits) switch (random() % 4) {
        case 0: bytes[random() % bytes.size()] = char(random()); break;
        case 1: bytes.insert(random() % bytes.size(), 1, char(random())); break;
        case 2: if (bytes.size() > 1) bytes.erase(random() % bytes.size(), 1); break;
        case 3: bytes.resize(1 + random() % bytes.size()); break;
      }
    v1::Chunk ours, theirs;
    if (!readChunk(bytes, ours)) continue;
    ++accepted;
    // The library checks UTF-8 besides, which the alphabet of names makes superfluous for us.
    const auto ascii = [](const std::string& text) {
      return std::all_of(text.begin(), text.end(), [](char c) { return uint8_t(c) < 128; });
    };
    if (!ascii(ours.section()) || !ascii(ours.name())) continue;
    ASSERT_TRUE(theirs.ParseFromString(bytes));
    theirs.DiscardUnknownFields();
    EXPECT_EQ(ours.SerializeAsString(), theirs.SerializeAsString());
  }
  EXPECT_GT(accepted, 1000);
}

TEST(Wire, TerminatesOnNoise) {
  std::mt19937_64 random(6);
  int refused = 0;
  for (int i = 0; i < 200000; ++i) {
    std::string bytes(random() % 40, '\0');
    for (char& c : bytes) c = char(random() % 4 ? random() % 80 : random());
    v1::Chunk chunk;
    refused += !readChunk(bytes, chunk);
  }
  EXPECT_GT(refused, 0);
  EXPECT_LT(refused, 200000);  // the empty message is sound
}

/// Bytes of fields: each a tag (number << 3 | wire type) and what follows.
std::string bytesOf(std::initializer_list<int> values) {
  std::string bytes;
  for (const int value : values) bytes += char(value);
  return bytes;
}

TEST(StrictMessages, TakeNothingThatTheRuntimeRefuses) {
  v1::AtlasHeader atlas;
  EXPECT_TRUE(parseStrictly(bytesOf({0x08, 4, 0x10, 4}), atlas));
  EXPECT_TRUE(parseStrictly(bytesOf({0x08, 4, 0x78, 1, 0x78, 2}), atlas)) << "what a later version adds is skipped";
  EXPECT_FALSE(parseStrictly(bytesOf({0x08, 4, 0x10, 4, 0x10, 4}), atlas)) << "a field twice";
  EXPECT_FALSE(parseStrictly(bytesOf({0x0d, 0, 0, 0, 0}), atlas)) << "another wire type";
  EXPECT_FALSE(parseStrictly(bytesOf({0x08, 0x80, 0x80, 0x80, 0x80, 0x10}), atlas)) << "a width of 2^32";
  EXPECT_FALSE(parseStrictly(bytesOf({0x7b, 0x7c}), atlas)) << "a group";
  EXPECT_FALSE(parseStrictly(bytesOf({0x08}), atlas)) << "cut";
  v1::SceneHeader scene;
  EXPECT_TRUE(parseStrictly(bytesOf({0x22, 2, 0x08, 1, 0x22, 0}), scene)) << "lights are repeated";
  EXPECT_FALSE(parseStrictly(bytesOf({0x22, 4, 0x08, 1, 0x08, 1}), scene)) << "a light's type twice";
  EXPECT_FALSE(parseStrictly(bytesOf({0x22, 5, 0x18, 1, 0x08, 1, 0x18}), scene)) << "a light's position as whole numbers";
  EXPECT_FALSE(parseStrictly(bytesOf({0x0a, 3, 0, 0, 0}), scene)) << "three bytes of a double";
}

/// Whatever is done to a header: what is taken, the runtime's reader takes, too.
TEST(StrictMessages, AgreeWithTheReaderOfTheRuntime) {
  v1::SceneHeader scene;
  for (int i = 0; i < 3; ++i) scene.add_origin(i), scene.add_bounds_min(float(i)), scene.add_bounds_max(float(i));
  v1::Light& light = *scene.add_lights();
  light.set_type(v1::LIGHT_TYPE_SPOT), light.set_range(2), light.set_inner_cone_angle(0.1f);
  for (int i = 0; i < 3; ++i) light.add_position(1), light.add_direction(0), light.add_intensity(3);
  const std::string good = scene.SerializeAsString();
  std::mt19937_64 random(7);
  int taken = 0;
  for (int i = 0; i < 200000; ++i) {
    std::string bytes = good;
    for (uint64_t edits = 1 + random() % 2; edits > 0; --edits) {
      const size_t at = random() % bytes.size(), count = 1 + random() % std::min<size_t>(6, bytes.size() - at);
      if (random() % 2) bytes.insert(at, bytes.substr(at, count));
      else bytes[at] = char(random() % 64);
    }
    v1::SceneHeader theirs;
    const google::protobuf::LogSilencer silencer;
    if (!parseStrictly(bytes, theirs) || theirs.origin_size() != 3 || theirs.bounds_min_size() != 3 || theirs.bounds_max_size() != 3) continue;
    if (std::any_of(theirs.lights().begin(), theirs.lights().end(), [](const v1::Light& l) { return l.position_size() != 3 || l.direction_size() != 3 || l.intensity_size() != 3; })) continue;
    ++taken;
    SceneHeader header;
    ASSERT_TRUE(parseSceneHeader(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size(), header, nullptr, 0)) << theirs.ShortDebugString();
  }
  EXPECT_GT(taken, 1000);
}

}  // namespace
}  // namespace lightwell::format
