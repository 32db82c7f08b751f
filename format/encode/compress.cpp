#include "format/encode/compress.h"

#include <zstd.h>

#include <memory>
#include <stdexcept>
#include <string>

#include "format/decode/endian.h"
#include "format/encode/rans_encode.h"

namespace lightwell::format {
namespace {

constexpr int kChoiceLevel = 3;

struct ContextDeleter {
  void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
};

std::vector<uint8_t> compress(std::span<const uint8_t> data, int level) {
  std::unique_ptr<ZSTD_CCtx, ContextDeleter> context(ZSTD_createCCtx());
  if (!context) throw std::bad_alloc();
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, level);
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_contentSizeFlag, 1);
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_checksumFlag, 0);  // the container has its own
  std::vector<uint8_t> stored(ZSTD_compressBound(data.size()));
  const size_t size = ZSTD_compress2(context.get(), stored.data(), stored.size(), data.data(), data.size());
  if (ZSTD_isError(size)) throw std::runtime_error(std::string("zstd: ") + ZSTD_getErrorName(size));
  stored.resize(size);
  stored.shrink_to_fit();
  return stored;
}

/// The size of the frame of tables, the frame, the streams.
std::vector<uint8_t> compressRans(std::span<const uint8_t> data, int level) {
  const rans::Encoded encoded = rans::encode(data);
  const std::vector<uint8_t> tables = compress(encoded.planes, level);
  std::vector<uint8_t> stored(4);
  storeLittle(stored.data(), uint32_t(tables.size()));
  stored.insert(stored.end(), tables.begin(), tables.end());
  stored.insert(stored.end(), encoded.streams.begin(), encoded.streams.end());
  return stored;
}

std::vector<uint8_t> splitPlanes(std::span<const uint8_t> elements, size_t element_bytes) {
  const size_t count = elements.size() / element_bytes;
  std::vector<uint8_t> planes(elements.size());
  for (size_t k = 0; k < element_bytes; ++k)
    for (size_t i = 0; i < count; ++i) planes[k * count + i] = elements[i * element_bytes + k];
  return planes;
}

template <class Unsigned>
std::vector<uint8_t> differences(std::span<const uint8_t> elements) {
  std::vector<uint8_t> result(elements.size());
  Unsigned previous = 0;
  for (size_t i = 0; i < elements.size(); i += sizeof(Unsigned)) {
    const Unsigned value = loadLittle<Unsigned>(&elements[i]);
    storeLittle(&result[i], Unsigned(value - previous));
    previous = value;
  }
  return result;
}

}  // namespace

std::vector<uint8_t> encodeWith(Codec codec, ElementType element, std::span<const uint8_t> data, int zstd_level) {
  const size_t element_bytes = elementBytes(element);
  if (!codecAllowed(codec, element) || data.size() % element_bytes != 0)
    throw std::invalid_argument("a chunk cannot be stored with this codec");
  switch (codec) {
    case Codec::raw: break;
    case Codec::zstd: return compress(data, zstd_level);
    case Codec::zstd_planes: return compress(splitPlanes(data, element_bytes), zstd_level);
    case Codec::zstd_delta_planes: {
      const std::vector<uint8_t> steps = element_bytes == 1   ? differences<uint8_t>(data)
                                         : element_bytes == 2 ? differences<uint16_t>(data)
                                                              : differences<uint32_t>(data);
      return compress(splitPlanes(steps, element_bytes), zstd_level);
    }
    case Codec::rans: return compressRans(data, zstd_level);
  }
  return {data.begin(), data.end()};
}

Encoded encodeSmallest(ElementType element, std::span<const uint8_t> data, int zstd_level) {
  Encoded best;
  size_t smallest = data.size();
  if (!data.empty())
    for (const Codec codec : {Codec::zstd, Codec::zstd_planes, Codec::zstd_delta_planes, Codec::rans}) {
      if (!codecAllowed(codec, element)) continue;
      std::vector<uint8_t> stored = encodeWith(codec, element, data, kChoiceLevel);
      if (stored.size() >= smallest || (data.size() - 1) / kMaxExpansion >= stored.size()) continue;
      smallest = stored.size();
      best = {codec, std::move(stored)};
    }
  if (best.codec != Codec::raw && zstd_level != kChoiceLevel) {
    best.stored = encodeWith(best.codec, element, data, zstd_level);
    if (best.stored.size() >= data.size()) best.codec = Codec::raw;
  }
  if (best.codec == Codec::raw) best.stored.assign(data.begin(), data.end());
  return best;
}

}  // namespace lightwell::format
