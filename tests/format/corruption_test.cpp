// Damage anywhere in a file is found: every byte, every length, header, directory, chunks and padding alike.
#include <gtest/gtest.h>

#include <cstdlib>
#include <random>
#include <set>

#include "format/encode/verify.h"
#include "tests/format/content.h"
#include "tests/format/golden_files.h"

namespace lightwell::format {
namespace {

bool sound(const std::vector<uint8_t>& file) { return isSound(verify(memorySource(file.data(), file.size()))); }

class Damage : public testing::TestWithParam<std::string> {
 protected:
  std::vector<uint8_t> file() const {
    for (GoldenFile& golden : goldenFiles())
      if (golden.path == GetParam()) return std::move(golden.bytes);
    return {};
  }
};

/// Every bit of every byte; with LIGHTWELL_DAMAGE=all every other value of it.
TEST_P(Damage, EveryChangedByteIsFound) {
  std::vector<uint8_t> bytes = file();
  ASSERT_FALSE(bytes.empty());
  ASSERT_TRUE(sound(bytes));
  const bool all = std::getenv("LIGHTWELL_DAMAGE");
  for (size_t i = 0; i < bytes.size(); ++i)
    for (int change = 1; change < 256; change = all ? change + 1 : change * 2) {
      bytes[i] ^= uint8_t(change);
      ASSERT_FALSE(sound(bytes)) << "byte " << i << " xor " << change;
      bytes[i] ^= uint8_t(change);
    }
}

TEST_P(Damage, SeveralChangedBytesAreFound) {
  const std::vector<uint8_t> bytes = file();
  std::mt19937 random(7);
  for (int i = 0; i < 2000; ++i) {
    std::vector<uint8_t> damaged = bytes;
    const size_t from = random() % damaged.size(), count = 1 + random() % 64;
    for (size_t k = from; k < std::min(damaged.size(), from + count); ++k) damaged[k] = uint8_t(random());
    ASSERT_TRUE(damaged == bytes || !sound(damaged)) << i;
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

std::vector<std::string> validFiles() {
  std::vector<std::string> paths;
  for (const GoldenFile& golden : goldenFiles())
    if (golden.path.starts_with("valid/")) paths.push_back(golden.path);
  return paths;
}

INSTANTIATE_TEST_SUITE_P(Golden, Damage, testing::ValuesIn(validFiles()),
                         [](const auto& info) { return info.param.substr(6, info.param.size() - 10); });

/// So that the files above hold every section that there is.
TEST(Damage, IsDoneToEverySection) {
  std::set<std::string> sections;
  for (const std::string& path : validFiles())
    for (const GoldenFile& golden : goldenFiles())
      if (golden.path == path) {
        View view;
        ASSERT_FALSE(view.open(memorySource(golden.bytes.data(), golden.bytes.size())));
        for (const SectionInfo& section : view.sections())
          if (section.known) sections.insert(std::string(section.type));
      }
  for (const KnownSection& known : kKnownSections) EXPECT_TRUE(sections.contains(known.type)) << known.type;
}

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
