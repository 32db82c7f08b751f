// Damage anywhere in a file is found: every bit, every length, header, directory, chunks and padding alike.
#include <gtest/gtest.h>

#include "format/encode/verify.h"
#include "tests/format/content.h"
#include "tests/format/golden_files.h"

namespace lightwell::format {
namespace {

bool sound(const std::vector<uint8_t>& file) { return isSound(verify(memorySource(file.data(), file.size()))); }

class Damage : public testing::TestWithParam<const char*> {
 protected:
  std::vector<uint8_t> file() const {
    for (GoldenFile& golden : goldenFiles())
      if (golden.path == GetParam()) return std::move(golden.bytes);
    return {};
  }
};

TEST_P(Damage, EveryBitIsFound) {
  std::vector<uint8_t> bytes = file();
  ASSERT_FALSE(bytes.empty());
  ASSERT_TRUE(sound(bytes));
  for (size_t i = 0; i < bytes.size(); ++i)
    for (int bit = 0; bit < 8; ++bit) {
      bytes[i] ^= uint8_t(1 << bit);
      ASSERT_FALSE(sound(bytes)) << "byte " << i << " bit " << bit;
      bytes[i] ^= uint8_t(1 << bit);
    }
}

TEST_P(Damage, EveryTruncationIsFound) {
  const std::vector<uint8_t> bytes = file();
  for (size_t size = 0; size < bytes.size(); ++size) {
    // A fresh allocation of exactly that size: a sanitizer sees any read past it.
    const std::vector<uint8_t> part(bytes.begin(), bytes.begin() + ptrdiff_t(size));
    const auto issues = verify(memorySource(part.data(), part.size()));
    ASSERT_FALSE(isSound(issues)) << size;
    EXPECT_EQ(issues[0].status, Status::truncated) << size;
  }
}

TEST_P(Damage, EveryExtensionIsFound) {
  std::vector<uint8_t> bytes = file();
  for (int i = 0; i < 40; ++i) {
    bytes.push_back(0);
    const auto issues = verify(memorySource(bytes.data(), bytes.size()));
    ASSERT_EQ(issues.size(), 1u);
    EXPECT_EQ(issues[0].status, Status::trailing_bytes);
  }
}

INSTANTIATE_TEST_SUITE_P(Golden, Damage,
                         testing::Values("valid/empty.lwc", "valid/every_codec.lwc", "valid/panes.lwc", "valid/local_bases.lwc",
                                         "valid/later_optional.lwc"),
                         [](const auto& info) {
                           const std::string path = info.param;
                           return path.substr(6, path.size() - 10);
                         });

TEST(Damage, EveryValueOfEveryByteOfASmallFile) {
  Writer writer;
  writer.addSection("s", 1, false);
  writer.add("s", "c", std::vector<uint32_t>(9, 5));
  writer.add("s", "d", std::vector<uint8_t>{1, 2, 3});
  std::vector<uint8_t> bytes = writer.bytes();
  for (uint8_t& byte : bytes) {
    const uint8_t right = byte;
    for (int value = 0; value < 256; ++value) {
      if (value == right) continue;
      byte = uint8_t(value);
      ASSERT_FALSE(sound(bytes)) << "byte " << &byte - bytes.data() << " as " << value;
    }
    byte = right;
  }
  EXPECT_TRUE(sound(bytes));
}

}  // namespace
}  // namespace lightwell::format
