// Damaged containers in the runtime: every byte changed, every length, several bytes, values changed behind sound checksums. What fuzz/runtime.cpp demands of any bytes holds for each:
// documented results, finite numbers, memory within the limit and released; it ends the program where that does not hold. Here, besides, the damage is found: on opening when it is in the
// header or the directory, else by whatever reads the damaged chunk.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <random>

#include "format/encode/verify.h"
#include "lightwell/lightwell.h"
#include "tests/format/forge.h"
#include "tests/format/golden_files.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

namespace lightwell::format {
namespace {

/// A fresh allocation of exactly that size: a sanitizer sees any read past it.
void use(const std::vector<uint8_t>& bytes) {
  const std::vector<uint8_t> exact(bytes.begin(), bytes.end());
  LLVMFuzzerTestOneInput(exact.data(), exact.size());
}

lw_result opened(const std::vector<uint8_t>& bytes) {
  constexpr uint8_t kNothing = 0;  // a null pointer would be the caller's mistake
  lw_container* container = nullptr;
  const lw_result result = lw_open_memory(bytes.empty() ? &kNothing : bytes.data(), bytes.size(), nullptr, &container);
  EXPECT_EQ(result == LW_OK, container != nullptr);
  lw_close(container);
  return result;
}

/// What opening may answer to bytes that are no sound container (lightwell.h).
bool isRefusal(lw_result result) {
  switch (result) {
    case LW_TRUNCATED: case LW_BAD_MAGIC: case LW_TOO_NEW: case LW_BAD_HEADER: case LW_BAD_CHECKSUM: case LW_BAD_DIRECTORY: case LW_BAD_CHUNK: case LW_TRAILING_BYTES:
    case LW_LIMIT_EXCEEDED: return true;
    default: return false;
  }
}

/// Whether every chunk of an opened file decodes, as the runtime's loaders decode them.
bool allChunksDecode(const std::vector<uint8_t>& bytes) {
  View view;
  if (view.open(memorySource(bytes.data(), bytes.size()))) return false;
  std::vector<uint8_t> decoded;
  for (const ChunkInfo& chunk : view.chunks()) {
    decoded.resize(size_t(chunk.raw_bytes));
    if (chunk.decodable ? bool(view.decode(chunk, decoded.data(), decoded.size())) : bool(view.checkStored(chunk))) return false;
  }
  return true;
}

class RuntimeDamage : public testing::TestWithParam<GoldenFile> {
 protected:
  void SetUp() override {
    View view;
    ASSERT_FALSE(view.open(memorySource(bytes_.data(), bytes_.size())));
    directory_end_ = kHeaderBytes + size_t(view.directoryBytes());
    ASSERT_EQ(opened(bytes_), LW_OK);
    ASSERT_TRUE(allChunksDecode(bytes_));
  }
  /// `at`: the first byte that was changed.
  void expectFound(const std::vector<uint8_t>& damaged, size_t at) const {
    const lw_result result = opened(damaged);
    if (at < directory_end_) EXPECT_TRUE(isRefusal(result)) << "byte " << at << ": " << lw_result_name(result);
    else EXPECT_TRUE(isRefusal(result) || (result == LW_OK && !allChunksDecode(damaged))) << "byte " << at << ": " << lw_result_name(result);
  }

  size_t directory_end_ = 0;
  std::vector<uint8_t> bytes_ = GetParam().bytes;
};

/// One bit of every byte, another in each; with LIGHTWELL_DAMAGE=all all eight.
TEST_P(RuntimeDamage, ChangedBytes) {
  use(bytes_);
  const bool all = std::getenv("LIGHTWELL_DAMAGE");
  for (size_t i = 0; i < bytes_.size(); ++i)
    for (size_t bit = all ? 0 : i % 8; bit < 8; bit += all ? 1 : 8) {
      bytes_[i] ^= uint8_t(1 << bit);
      use(bytes_);
      expectFound(bytes_, i);
      bytes_[i] ^= uint8_t(1 << bit);
    }
}

TEST_P(RuntimeDamage, Truncations) {
  for (size_t size = 0; size < bytes_.size(); ++size) {
    const std::vector<uint8_t> part(bytes_.begin(), bytes_.begin() + ptrdiff_t(size));
    EXPECT_TRUE(isRefusal(opened(part))) << size;
    use(part);
  }
}

TEST_P(RuntimeDamage, SeveralBytes) {
  std::mt19937 random(11);
  for (int i = 0; i < 300; ++i) {
    std::vector<uint8_t> damaged = bytes_;
    const size_t from = random() % damaged.size(), count = 1 + random() % 64;
    for (size_t k = from; k < std::min(damaged.size(), from + count); ++k) damaged[k] = uint8_t(random());
    use(damaged);
    if (damaged != bytes_) expectFound(damaged, from);
  }
}

/// A forger's file: the directory is changed, and all sums are right.
TEST_P(RuntimeDamage, ChangedDirectoryBehindSoundChecksums) {
  std::mt19937 random(13);
  for (size_t i = kHeaderBytes; i < directory_end_; ++i) {
    std::vector<uint8_t> forged = bytes_;
    forged[i] = uint8_t(random());
    fixChecksums(forged);
    use(forged);
    const lw_result result = opened(forged);
    EXPECT_TRUE(result == LW_OK || isRefusal(result)) << "byte " << i << ": " << lw_result_name(result);
  }
}

std::vector<GoldenFile> validFiles() {
  std::vector<GoldenFile> files;
  for (GoldenFile& golden : goldenFiles())
    if (golden.path.starts_with("valid/")) files.push_back(std::move(golden));
  return files;
}

INSTANTIATE_TEST_SUITE_P(Golden, RuntimeDamage, testing::ValuesIn(validFiles()),
                         [](const auto& info) { return info.param.path.substr(6, info.param.path.size() - 10); });

}  // namespace
}  // namespace lightwell::format
