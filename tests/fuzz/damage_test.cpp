// Damaged containers in the runtime: every byte changed, every length, several bytes, values changed behind sound checksums. What fuzz/runtime.cpp demands of any bytes holds for each.
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

bool opens(const std::vector<uint8_t>& bytes) {
  lw_container* container = nullptr;
  const lw_result result = lw_open_memory(bytes.data(), bytes.size(), nullptr, &container);
  lw_close(container);
  return result == LW_OK;
}

class RuntimeDamage : public testing::TestWithParam<GoldenFile> {
 protected:
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
      bytes_[i] ^= uint8_t(1 << bit);
    }
}

TEST_P(RuntimeDamage, Truncations) {
  for (size_t size = 0; size < bytes_.size(); ++size) {
    const std::vector<uint8_t> part(bytes_.begin(), bytes_.begin() + ptrdiff_t(size));
    EXPECT_FALSE(opens(part)) << size;
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
  }
}

/// A forger's file: the directory is changed, and all sums are right.
TEST_P(RuntimeDamage, ChangedDirectoryBehindSoundChecksums) {
  View view;
  ASSERT_FALSE(view.open(memorySource(bytes_.data(), bytes_.size())));
  const size_t end = kHeaderBytes + size_t(view.directoryBytes());
  std::mt19937 random(13);
  for (size_t i = kHeaderBytes; i < end; ++i) {
    std::vector<uint8_t> forged = bytes_;
    forged[i] = uint8_t(random());
    fixChecksums(forged);
    use(forged);
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
