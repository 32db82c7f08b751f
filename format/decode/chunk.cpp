// View::decode: stored bytes → checksum → zstd → planes → differences; or → tables → RANS.
#define ZSTD_STATIC_LINKING_ONLY  // a decompression context in memory of the caller's allocator
#include <zstd.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "format/decode/checksum.h"
#include "format/decode/endian.h"
#include "format/decode/rans.h"
#include "format/decode/view.h"

namespace lightwell::format {
namespace {

Fault chunkFault(const ChunkInfo& chunk, Status status, const char* reason) {
  return makeFault(status, chunk.offset, "%.*s/%.*s: %s", int(chunk.section.size()), chunk.section.data(), int(chunk.name.size()),
                   chunk.name.data(), reason);
}

/// Memory of the View's allocator for the time of a call.
struct Scratch {
  const Allocator& allocator;
  void* memory = nullptr;
  uint8_t* allocate(size_t bytes) { return static_cast<uint8_t*>(memory = format::allocate(allocator, bytes)); }
  ~Scratch() { release(allocator, memory); }
};

/// Puts together element i from its bytes planes[k * count + i], in the host's order.
template <class Unsigned>
Unsigned joinPlanes(const uint8_t* planes, size_t count, size_t i) {
  Unsigned value = 0;
  for (size_t k = 0; k < sizeof(Unsigned); ++k) value = Unsigned(value | Unsigned(planes[k * count + i]) << (8 * k));
  return value;
}

/// `elements` need not be aligned.
template <class Unsigned>
void decodePlanes(const uint8_t* __restrict planes, uint8_t* __restrict elements, size_t count) {
  for (size_t i = 0; i < count; ++i) {
    const Unsigned value = joinPlanes<Unsigned>(planes, count, i);
    std::memcpy(elements + i * sizeof(Unsigned), &value, sizeof(Unsigned));
  }
}

/// The same, each element the sum of itself and all before it, modulo 2^bits. One-byte elements may be decoded in place.
template <class Unsigned>
void decodeDeltaPlanes(const uint8_t* planes, uint8_t* elements, size_t count) {
  constexpr size_t kBlock = 1024;  // joining is done in blocks because it can be vectorised and summing cannot
  Unsigned block[kBlock], sum = 0;
  for (size_t begin = 0; begin < count; begin += kBlock) {
    const size_t size = std::min(kBlock, count - begin);
    for (size_t i = 0; i < size; ++i) block[i] = joinPlanes<Unsigned>(planes, count, begin + i);
    for (size_t i = 0; i < size; ++i) block[i] = sum = Unsigned(sum + block[i]);
    std::memcpy(elements + begin * sizeof(Unsigned), block, size * sizeof(Unsigned));
  }
}

void decodeElements(Codec codec, size_t element_bytes, const uint8_t* planes, uint8_t* elements, size_t count) {
  const bool delta = codec == Codec::zstd_delta_planes;
  if (element_bytes == 1) decodeDeltaPlanes<uint8_t>(planes, elements, count);
  else if (element_bytes == 2) (delta ? decodeDeltaPlanes<uint16_t> : decodePlanes<uint16_t>)(planes, elements, count);
  else (delta ? decodeDeltaPlanes<uint32_t> : decodePlanes<uint32_t>)(planes, elements, count);
}

void toHostOrder(uint8_t* elements, size_t bytes, size_t element_bytes) {
  if constexpr (std::endian::native == std::endian::big)
    for (size_t i = 0; i < bytes; i += element_bytes) std::reverse(elements + i, elements + i + element_bytes);
}

/// A zstd context in memory of the View's allocator.
struct Decompressor {
  explicit Decompressor(const Allocator& allocator) : memory{allocator} {
    const size_t bytes = ZSTD_estimateDCtxSize();
    if (void* scratch = memory.allocate(bytes)) context = ZSTD_initStaticDCtx(scratch, bytes), misaligned = !context;
  }
  Scratch memory;
  ZSTD_DCtx* context = nullptr;
  bool misaligned = false;
};

/// The stored bytes must be exactly one zstd frame without dictionary that declares exactly `raw_bytes`.
bool isSingleFrame(const uint8_t* stored, size_t stored_bytes, size_t raw_bytes) {
  return stored_bytes >= 4 && loadLittle<uint32_t>(stored) == ZSTD_MAGICNUMBER &&
         ZSTD_getFrameContentSize(stored, stored_bytes) == raw_bytes &&
         ZSTD_getDictID_fromFrame(stored, stored_bytes) == 0 &&
         ZSTD_findFrameCompressedSize(stored, stored_bytes) == stored_bytes;
}

}  // namespace

Fault View::decode(const ChunkInfo& chunk, void* destination, size_t bytes) const {
  if (!chunk.decodable) return chunkFault(chunk, Status::too_new, "codec or element type of a later version");
  if (!isOpen() || bytes != chunk.raw_bytes || (bytes > 0 && !destination))
    return chunkFault(chunk, Status::invalid_argument, "the destination has not the decoded size");
  auto* out = static_cast<uint8_t*>(destination);
  const size_t stored_bytes = size_t(chunk.stored_bytes);

  // Stored bytes: in place when the file lies in memory, straight to the destination when they need no decoding.
  const bool in_place = source_.memory != nullptr, direct = !in_place && chunk.codec == Codec::raw;
  Scratch stored_scratch{allocator_};
  const uint8_t* stored = in_place ? source_.memory + chunk.offset : out;
  if (!in_place && !direct && !(stored = stored_scratch.allocate(stored_bytes)))
    return chunkFault(chunk, Status::out_of_memory, "no memory for the stored bytes");
  if (!in_place && stored_bytes > 0 && !source_.read(source_.user, chunk.offset, const_cast<uint8_t*>(stored), stored_bytes))
    return chunkFault(chunk, Status::io_error, "cannot be read");
  if (checksum(stored, stored_bytes) != chunk.checksum) return chunkFault(chunk, Status::bad_checksum, "checksum differs");
  if (const Fault fault = checkPadding(chunk)) return fault;

  const size_t element_bytes = elementBytes(chunk.element);
  if (chunk.codec == Codec::raw) {
    if (in_place && bytes > 0) std::memcpy(out, stored, bytes);
    toHostOrder(out, bytes, element_bytes);
    return {};
  }
  Decompressor zstd(allocator_);
  if (zstd.misaligned) return chunkFault(chunk, Status::invalid_argument, "the allocator's memory is not aligned");
  if (!zstd.context) return chunkFault(chunk, Status::out_of_memory, "no memory to decompress");
  if (chunk.codec == Codec::rans) {
    const size_t frame_bytes = stored_bytes >= 4 ? loadLittle<uint32_t>(stored) : 0;
    if (stored_bytes < 4 || frame_bytes > stored_bytes - 4 || !isSingleFrame(stored + 4, frame_bytes, rans::kTableBytes))
      return chunkFault(chunk, Status::bad_chunk, "its tables are not one zstd frame of their size");
    Scratch plane_scratch{allocator_}, slot_scratch{allocator_};
    uint8_t* planes = plane_scratch.allocate(rans::kTableBytes);
    auto* slots = reinterpret_cast<uint32_t*>(slot_scratch.allocate(rans::kSlots * sizeof(uint32_t)));
    if (!planes || !slots) return chunkFault(chunk, Status::out_of_memory, "no memory for its tables");
    uint32_t used;
    if (ZSTD_decompressDCtx(zstd.context, planes, rans::kTableBytes, stored + 4, frame_bytes) != rans::kTableBytes || !rans::makeSlots(planes, slots, used))
      return chunkFault(chunk, Status::bad_chunk, "its tables are damaged");
    const uint8_t* streams = stored + 4 + frame_bytes;
    return rans::decode(streams, stored_bytes - 4 - frame_bytes, slots, used, out, bytes) ? Fault{} : chunkFault(chunk, Status::bad_chunk, "its streams are damaged");
  }
  if (!isSingleFrame(stored, stored_bytes, bytes))
    return chunkFault(chunk, Status::bad_chunk, "not one zstd frame of the size that the shape gives");
  Scratch plane_scratch{allocator_};
  uint8_t* unpacked = element_bytes > 1 && chunk.codec != Codec::zstd ? plane_scratch.allocate(bytes) : out;
  if (!unpacked) return chunkFault(chunk, Status::out_of_memory, "no memory to decompress");
  if (ZSTD_decompressDCtx(zstd.context, unpacked, bytes, stored, stored_bytes) != bytes)
    return chunkFault(chunk, Status::bad_chunk, "zstd cannot decompress it");
  if (chunk.codec == Codec::zstd) toHostOrder(out, bytes, element_bytes);
  else decodeElements(chunk.codec, element_bytes, unpacked, out, bytes / element_bytes);
  return {};
}

Fault View::checkStored(const ChunkInfo& chunk) const {
  if (!isOpen()) return chunkFault(chunk, Status::invalid_argument, "no file is open");
  ChecksumStream stream;
  if (source_.memory) {
    stream.update(source_.memory + chunk.offset, size_t(chunk.stored_bytes));
  } else {
    constexpr size_t kPiece = size_t(64) << 10;
    Scratch scratch{allocator_};
    uint8_t* piece = scratch.allocate(kPiece);
    if (!piece) return chunkFault(chunk, Status::out_of_memory, "no memory to read it");
    for (uint64_t done = 0; done < chunk.stored_bytes;) {
      const size_t bytes = size_t(std::min<uint64_t>(kPiece, chunk.stored_bytes - done));
      if (!source_.read(source_.user, chunk.offset + done, piece, bytes)) return chunkFault(chunk, Status::io_error, "cannot be read");
      stream.update(piece, bytes);
      done += bytes;
    }
  }
  if (stream.digest() != chunk.checksum) return chunkFault(chunk, Status::bad_checksum, "checksum differs");
  return checkPadding(chunk);
}

Fault View::checkPadding(const ChunkInfo& chunk) const {
  const uint64_t end = chunk.offset + chunk.stored_bytes;
  const size_t padding = size_t(std::min(alignUp(end), source_.bytes) - end);
  uint8_t bytes[kAlignment] = {};
  if (padding == 0) return {};
  if (source_.memory) std::memcpy(bytes, source_.memory + end, padding);
  else if (!source_.read(source_.user, end, bytes, padding)) return chunkFault(chunk, Status::io_error, "its padding cannot be read");
  for (size_t i = 0; i < padding; ++i)
    if (bytes[i] != 0) return makeFault(Status::trailing_bytes, end + i, "%.*s/%.*s: the padding after it is not zero",
                                        int(chunk.section.size()), chunk.section.data(), int(chunk.name.size()), chunk.name.data());
  return {};
}

}  // namespace lightwell::format
