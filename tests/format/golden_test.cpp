// The committed golden files: valid ones stay readable for ever, invalid ones are refused with the status in their name.
#include <gtest/gtest.h>
#include <zstd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>

#include "format/encode/reader.h"
#include "format/encode/verify.h"
#include "tests/format/golden_files.h"

namespace lightwell::format {
namespace {

namespace fs = std::filesystem;

std::map<std::string, std::vector<uint8_t>> committed(const char* kind) {
  std::map<std::string, std::vector<uint8_t>> files;
  for (const auto& entry : fs::directory_iterator(fs::path(GOLDEN_FOLDER) / kind)) {
    std::ifstream stream(entry.path(), std::ios::binary);
    files[std::string(kind) + "/" + entry.path().filename().string()] = {std::istreambuf_iterator<char>(stream), {}};
  }
  return files;
}

TEST(Golden, ValidFilesAreSound) {
  const auto files = committed("valid");
  ASSERT_GE(files.size(), 9u);
  for (const auto& [name, bytes] : files) {
    const auto issues = verify(memorySource(bytes.data(), bytes.size()));
    EXPECT_TRUE(isSound(issues)) << name << ": " << issues[0].place << ": " << issues[0].message;
  }
}

TEST(Golden, InvalidFilesAreRefusedAsTheirNamesSay) {
  const auto files = committed("invalid");
  ASSERT_GE(files.size(), 40u);
  for (const auto& [name, bytes] : files) {
    const std::string wanted = fs::path(name).filename().string();
    const auto issues = verify(memorySource(bytes.data(), bytes.size()));
    ASSERT_FALSE(isSound(issues)) << name;
    EXPECT_EQ(statusName(issues[0].status), wanted.substr(0, wanted.find('.'))) << name << ": " << issues[0].message;
    EXPECT_FALSE(issues[0].message.empty()) << name;
    EXPECT_LE(issues[0].offset, uint64_t(1) << 62) << name;
  }
}

/// released/VERSION holds the valid files as that version wrote them.
TEST(Golden, FilesOfEveryReleaseDecodeForEver) {
  const fs::path releases = fs::path(GOLDEN_FOLDER) / "released";
  if (!fs::is_directory(releases)) GTEST_SKIP() << "no version of the format was released yet";
  for (const auto& release : fs::directory_iterator(releases)) {
    const auto files = committed(("released/" + release.path().filename().string()).c_str());
    ASSERT_FALSE(files.empty()) << release.path();
    for (const auto& [name, bytes] : files) {
      const auto issues = verify(memorySource(bytes.data(), bytes.size()));
      EXPECT_TRUE(isSound(issues)) << name << ": " << issues[0].place << ": " << issues[0].message;
    }
  }
}

/// Compressed bytes differ between versions of zstd; what they hold does not.
TEST(Golden, WriterStillWritesTheValidFiles) {
  const auto files = committed("valid");
  for (const GoldenFile& golden : goldenFiles()) {
    if (!golden.path.starts_with("valid/")) continue;
    ASSERT_TRUE(files.contains(golden.path)) << golden.path;
    if (ZSTD_versionNumber() == 10504) {
      EXPECT_EQ(files.at(golden.path), golden.bytes) << golden.path;
    }
    const Reader is(golden.bytes), was(files.at(golden.path));
    ASSERT_EQ(is.view().chunks().size(), was.view().chunks().size()) << golden.path;
    for (size_t i = 0; i < is.view().chunks().size(); ++i) {
      const ChunkInfo &a = is.view().chunks()[i], &b = was.view().chunks()[i];
      EXPECT_EQ(a.section, b.section);
      EXPECT_EQ(a.name, b.name);
      ASSERT_EQ(a.raw_bytes, b.raw_bytes);
      if (!a.decodable) continue;
      std::vector<uint8_t> is_bytes(a.raw_bytes), was_bytes(b.raw_bytes);
      EXPECT_FALSE(is.view().decode(a, is_bytes.data(), is_bytes.size()));
      EXPECT_FALSE(was.view().decode(b, was_bytes.data(), was_bytes.size()));
      EXPECT_EQ(is_bytes, was_bytes) << golden.path << " " << a.name;
    }
  }
}

}  // namespace
}  // namespace lightwell::format
