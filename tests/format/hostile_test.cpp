// Files made to hurt: bombs, limits, failing memory, directories that lie. The answer is always a Fault.
#include <gtest/gtest.h>

#define ZSTD_STATIC_LINKING_ONLY
#include <zstd.h>

#include <cstdlib>
#include <random>

#include "format/decode/view.h"
#include "format/encode/compress.h"
#include "format/encode/verify.h"
#include "tests/format/content.h"
#include "tests/format/forge.h"

namespace lightwell::format {
namespace {

/// Counts what is allocated and may fail the n-th allocation.
struct CountingAllocator {
  size_t live = 0, calls = 0, largest = 0, fail_at = ~size_t(0);
  Allocator get() {
    return {[](void* user, size_t bytes) -> void* {
              auto& self = *static_cast<CountingAllocator*>(user);
              if (self.calls++ == self.fail_at) return nullptr;
              ++self.live;
              self.largest = std::max(self.largest, bytes);
              return std::malloc(bytes);
            },
            [](void* user, void* memory) {
              --static_cast<CountingAllocator*>(user)->live;
              std::free(memory);
            },
            this};
  }
};

/// The same bytes behind a callback, so that stored bytes must be copied.
struct CallbackSource {
  const std::vector<uint8_t>& bytes;
  Source get() {
    return {[](void* user, uint64_t offset, void* destination, size_t size) {
              const auto& data = static_cast<CallbackSource*>(user)->bytes;
              if (offset > data.size() || size > data.size() - offset) return false;
              std::copy_n(data.begin() + ptrdiff_t(offset), size, static_cast<uint8_t*>(destination));
              return true;
            },
            this, bytes.size()};
  }
};

Status openStatus(const std::vector<uint8_t>& file, const Limits& limits = {}) {
  View view;
  return view.open(memorySource(file.data(), file.size()), {.limits = limits}).status;
}

std::string zstdFrame(const std::string& data, bool content_size = true) {
  ZSTD_CCtx* context = ZSTD_createCCtx();
  ZSTD_CCtx_setParameter(context, ZSTD_c_contentSizeFlag, content_size);
  std::string stored(ZSTD_compressBound(data.size()), '\0');
  stored.resize(ZSTD_compress2(context, stored.data(), stored.size(), data.data(), data.size()));
  ZSTD_freeCCtx(context);
  return stored;
}

Status decodeStatus(const std::string& frame, uint64_t raw_bytes) {
  Forge forge;
  forge.section("s");
  forge.chunk("s", "c", ElementType::bytes, {raw_bytes}, Codec::zstd, frame);
  const std::vector<uint8_t> file = forge.build();
  View view;
  if (const Fault fault = view.open(memorySource(file.data(), file.size()))) return fault.status;
  std::vector<uint8_t> decoded(raw_bytes + 1, 0xcd);
  const Status status = view.decode(view.chunks()[0], decoded.data(), raw_bytes).status;
  EXPECT_EQ(decoded.back(), 0xcd) << "written past the destination";
  return status;
}

TEST(Hostile, ZstdBombs) {
  const std::string frame = zstdFrame(std::string(1 << 20, 'x'));
  EXPECT_EQ(decodeStatus(frame, 1 << 20), Status::ok);
  EXPECT_EQ(decodeStatus(frame, (1 << 20) - 1), Status::bad_chunk);
  EXPECT_EQ(decodeStatus(frame, 1024), Status::bad_chunk);
  EXPECT_EQ(decodeStatus(zstdFrame(std::string(1 << 20, 'x'), false), 1 << 20), Status::bad_chunk) << "no content size";
  EXPECT_EQ(decodeStatus(frame + "x", 1 << 20), Status::bad_chunk);
  EXPECT_EQ(decodeStatus(frame + frame, 2 << 20), Status::bad_chunk);
  const std::string skippable("\x50\x2a\x4d\x18\x04\0\0\0abcd", 12);
  EXPECT_EQ(decodeStatus(frame + skippable, 1 << 20), Status::bad_chunk);
  EXPECT_EQ(decodeStatus(frame + zstdFrame(""), 1 << 20), Status::bad_chunk);
  EXPECT_EQ(decodeStatus(skippable, 4), Status::bad_chunk);
  // A header that declares more than its blocks hold, and one that declares less.
  std::string lying = zstdFrame(std::string(200, 'x'));
  ASSERT_EQ(uint8_t(lying[5]), 200);
  lying[5] = char(201);
  EXPECT_EQ(decodeStatus(lying, 201), Status::bad_chunk);
  lying[5] = char(199);
  EXPECT_EQ(decodeStatus(lying, 199), Status::bad_chunk);
}

TEST(Hostile, ImpossibleExpansionIsRefusedOnOpen) {
  const auto open = [](uint64_t elements, size_t stored_bytes) {
    Forge forge;
    forge.section("s");
    forge.chunk("s", "c", ElementType::u8, {elements}, Codec::zstd, std::string(stored_bytes, '\0'));
    return openStatus(forge.build());
  };
  EXPECT_EQ(open(kMaxExpansion * 10, 10), Status::ok);
  EXPECT_EQ(open(kMaxExpansion * 10 + 1, 10), Status::bad_chunk);
  EXPECT_EQ(open(0, 10), Status::bad_chunk) << "an empty chunk is stored raw";
}

TEST(Hostile, LimitsHoldBeforeAnythingIsAllocated) {
  const std::vector<uint8_t> file = toWriter(panesContent()).bytes();
  uint64_t decoded = 0;
  {
    View view;
    ASSERT_FALSE(view.open(memorySource(file.data(), file.size())));
    for (const ChunkInfo& chunk : view.chunks()) decoded += chunk.raw_bytes;
  }
  EXPECT_EQ(openStatus(file, {.decoded_bytes = decoded}), Status::ok);
  EXPECT_EQ(openStatus(file, {.decoded_bytes = decoded - 1}), Status::limit_exceeded);
  EXPECT_EQ(openStatus(file, {.sections = 5}), Status::ok);
  EXPECT_EQ(openStatus(file, {.sections = 4}), Status::limit_exceeded);
  EXPECT_EQ(openStatus(file, {.chunks = 3}), Status::limit_exceeded);
  EXPECT_EQ(openStatus(file, {.file_bytes = file.size()}), Status::ok);
  EXPECT_EQ(openStatus(file, {.file_bytes = file.size() - 1}), Status::limit_exceeded);
  EXPECT_EQ(openStatus(file, {.directory_bytes = 64}), Status::limit_exceeded);

  // 2 GiB and more in 64 KiB + 2 bytes of stored zeros.
  Forge bomb;
  bomb.section("s");
  bomb.chunk("s", "a", ElementType::u32, {uint64_t(1) << 28}, Codec::zstd, std::string(1 << 15, '\0'));
  bomb.chunk("s", "b", ElementType::u32, {uint64_t(1) << 28}, Codec::zstd, std::string(1 << 15, '\0'));
  EXPECT_EQ(openStatus(bomb.build()), Status::ok);
  bomb.chunk("s", "c", ElementType::u8, {1}, Codec::raw, "x");
  EXPECT_EQ(openStatus(bomb.build()), Status::limit_exceeded);

  std::string many;
  for (int i = 0; i < 70000; ++i) many += std::string("\x12\x00", 2);
  CountingAllocator counting;
  const std::vector<uint8_t> crowd = assemble(many, "");
  View view;
  EXPECT_EQ(view.open(memorySource(crowd.data(), crowd.size()), {.allocator = counting.get()}).status, Status::limit_exceeded);
  EXPECT_LE(counting.largest, many.size() + kAlignment);
}

TEST(Hostile, EveryFailingAllocationIsReportedAndNothingLeaks) {
  const std::vector<uint8_t> file = toWriter(localBasesContent()).bytes();
  size_t failures = 0;
  for (size_t n = 0;; ++n) {
    CountingAllocator counting;
    counting.fail_at = n;
    bool failed = false;
    {
      CallbackSource source{file};
      View view;
      const auto check = [&](const Fault& fault) {
        if (!fault) return;
        EXPECT_EQ(fault.status, Status::out_of_memory) << fault.what;
        failed = true;
      };
      check(view.open(source.get(), {.allocator = counting.get()}));
      for (const ChunkInfo& chunk : view.chunks()) {
        std::vector<uint8_t> decoded(chunk.raw_bytes);
        check(view.decode(chunk, decoded.data(), decoded.size()));
        check(view.checkStored(chunk));
      }
    }
    EXPECT_EQ(counting.live, 0u);
    if (!failed) break;
    ++failures;
  }
  EXPECT_GT(failures, 20u);
}

TEST(Hostile, TemporaryMemoryIsAsDocumented) {
  Writer writer;
  writer.addSection("s", 1, false);
  std::vector<uint32_t> steps(250000);
  for (uint32_t i = 0; i < steps.size(); ++i) steps[i] = i * 3 + i % 7;
  writer.add("s", "c", steps);
  const std::vector<uint8_t> file = writer.bytes();
  CountingAllocator counting;
  CallbackSource source{file};
  View view;
  ASSERT_FALSE(view.open(source.get(), {.allocator = counting.get()}));
  std::vector<uint32_t> decoded(steps.size());
  ASSERT_FALSE(view.decode(view.chunks()[0], decoded.data(), decoded.size() * 4));
  EXPECT_EQ(decoded, steps);
  EXPECT_LE(counting.largest, steps.size() * 4);
  EXPECT_LE(ZSTD_estimateDCtxSize(), 160000u);
}

TEST(Hostile, DamagedDirectoriesWithRightChecksums) {
  std::mt19937_64 random(17);
  const std::vector<uint8_t> good = toWriter(localBasesContent()).bytes();
  const uint64_t directory_bytes = good[32] | uint64_t(good[33]) << 8;
  int opened = 0;
  for (int i = 0; i < 20000; ++i) {
    std::vector<uint8_t> file = good;
    for (uint64_t edits = 1 + random() % 4; edits > 0; --edits)
      file[64 + random() % directory_bytes] = uint8_t(random() % 3 ? random() % 32 : random());
    fixChecksums(file);
    View view;
    if (view.open(memorySource(file.data(), file.size()))) continue;
    ++opened;
    for (const ChunkInfo& chunk : view.chunks()) {
      std::vector<uint8_t> decoded(chunk.raw_bytes);
      (void)view.decode(chunk, decoded.data(), decoded.size());
      EXPECT_LE(chunk.offset + chunk.stored_bytes, file.size());
    }
  }
  EXPECT_GT(opened, 20);
}

TEST(Hostile, DamagedChunksWithRightChecksums) {
  std::mt19937_64 random(19);
  std::vector<uint16_t> values(3000);
  for (size_t i = 0; i < values.size(); ++i) values[i] = uint16_t(i * i >> 4);
  const auto* bytes = reinterpret_cast<const uint8_t*>(values.data());
  int intact = 0;
  for (int i = 0; i < 5000; ++i) {
    std::vector<uint8_t> stored = encodeWith(Codec(2 + i % 3), ElementType::u16, {bytes, values.size() * 2}, 1);
    for (uint64_t edits = 1 + random() % 3; edits > 0; --edits) stored[random() % stored.size()] = uint8_t(random());
    Forge forge;
    forge.section("s");
    forge.chunk("s", "c", ElementType::u16, {values.size()}, Codec(2 + i % 3), {stored.begin(), stored.end()});
    const std::vector<uint8_t> file = forge.build();
    View view;
    ASSERT_FALSE(view.open(memorySource(file.data(), file.size())));
    std::vector<uint16_t> decoded(values.size());
    const Fault fault = view.decode(view.chunks()[0], decoded.data(), decoded.size() * 2);
    EXPECT_TRUE(fault.status == Status::ok || fault.status == Status::bad_chunk) << fault.what;
    intact += fault.status == Status::ok;
  }
  EXPECT_LT(intact, 5000);
}

TEST(Hostile, DamagedValuesNeverBreakVerify) {
  // Every value of every known chunk may be anything: verify must come to an end, whatever it finds.
  std::mt19937_64 random(23);
  for (int i = 0; i < 3000; ++i) {
    Content content = i % 2 ? localBasesContent() : panesContent();
    const auto spoil = [&](auto& values) {
      if (random() % 6) return;
      using T = typename std::decay_t<decltype(values)>::value_type;
      for (auto& value : values) {
        if constexpr (std::is_floating_point_v<T>) value = random() % 2 ? std::bit_cast<float>(uint32_t(random())) : value;
        else value = random() % 2 ? T(random() % 3 ? random() % 8 : random()) : value;
      }
    };
    spoil(content.position), spoil(content.normal), spoil(content.lightmap_uv), spoil(content.index), spoil(content.triangle_flags);
    spoil(content.triangle_alpha), spoil(content.source), spoil(content.coverage), spoil(content.albedo);
    spoil(content.entry_position), spoil(content.entry_weight), spoil(content.cluster_first_entry), spoil(content.texel);
    spoil(content.block_first_texel), spoil(content.block_first_link), spoil(content.link_wavelet), spoil(content.block_rank);
    spoil(content.entry_rectangle), spoil(content.tree_first_leaves), spoil(content.tree_first_share), spoil(content.wavelet_unit);
    spoil(content.basis), spoil(content.coefficient), spoil(content.coefficient_scale);
    if (random() % 5 == 0) content.prm.set_max_rank(uint32_t(random()));
    if (i % 2 && random() % 5 == 0) content.prm.set_clusters(uint32_t(random() % 3 ? random() % 8 : random()));
    if (random() % 5 == 0) content.atlas.set_width(uint32_t(random() % 8));
    const std::vector<uint8_t> file = toWriter(content).bytes();
    EXPECT_LE(verify(memorySource(file.data(), file.size())).size(), 100u);
  }
}

}  // namespace
}  // namespace lightwell::format
