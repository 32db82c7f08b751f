#include "format/decode/wire.h"

#include <bit>
#include <type_traits>

#include "format/decode/endian.h"

namespace lightwell::format {

bool WireReader::varint(const uint8_t*& cursor, const uint8_t* end, uint64_t& value) {
  value = 0;
  for (int shift = 0; shift < 64; shift += 7) {
    if (cursor == end) return false;
    const uint8_t byte = *cursor++;
    if (shift == 63 && byte > 1) return false;
    value |= uint64_t(byte & 0x7f) << shift;
    if (!(byte & 0x80)) return true;
  }
  return false;
}

bool WireReader::next() {
  if (!ok_ || cursor_ == end_) return false;
  uint64_t tag;
  if (!varint(cursor_, end_, tag) || tag > UINT32_MAX || tag >> 3 == 0) return fail();
  field_ = uint32_t(tag >> 3);
  type_ = WireType(tag & 7);
  switch (type_) {
    case WireType::varint: return varint(cursor_, end_, number_) || fail();
    case WireType::fixed64:
    case WireType::fixed32: {
      const size_t size = type_ == WireType::fixed64 ? 8 : 4;
      if (size_t(end_ - cursor_) < size) return fail();
      number_ = size == 8 ? loadLittle<uint64_t>(cursor_) : loadLittle<uint32_t>(cursor_);
      cursor_ += size;
      return true;
    }
    case WireType::bytes: {
      uint64_t size;
      if (!varint(cursor_, end_, size) || size > uint64_t(end_ - cursor_)) return fail();
      bytes_ = {reinterpret_cast<const char*>(cursor_), size_t(size)};
      cursor_ += size;
      return true;
    }
  }
  return fail();
}

bool WireReader::first() {
  if (field_ >= 64) return true;
  const uint64_t bit = uint64_t(1) << field_;
  if (seen_ & bit) return fail();
  seen_ |= bit;
  return true;
}

void WireReader::read(uint64_t& value) {
  if (expect(WireType::varint) && first()) value = number_;
}
void WireReader::read(uint32_t& value) {
  if (!expect(WireType::varint) || !first()) return;
  if (number_ > UINT32_MAX) fail();
  else value = uint32_t(number_);
}
void WireReader::readFixed64(uint64_t& value) {
  if (expect(WireType::fixed64) && first()) value = number_;
}
void WireReader::read(bool& value) {
  if (!expect(WireType::varint) || !first()) return;
  if (number_ > 1) fail();
  else value = number_ != 0;
}
void WireReader::read(float& value) {
  if (expect(WireType::fixed32) && first()) value = std::bit_cast<float>(uint32_t(number_));
}
void WireReader::read(double& value) {
  if (expect(WireType::fixed64) && first()) value = std::bit_cast<double>(number_);
}
void WireReader::read(std::string_view& value) {
  if (expect(WireType::bytes) && first()) value = bytes_;
}
std::string_view WireReader::bytes() { return expect(WireType::bytes) ? bytes_ : std::string_view(); }

void WireReader::skipNumbers(WireType element) {
  if (type_ == element || !expect(WireType::bytes)) return;
  if (element != WireType::varint) {
    if (bytes_.size() % (element == WireType::fixed64 ? 8 : 4) != 0) fail();
    return;
  }
  const auto* cursor = reinterpret_cast<const uint8_t*>(bytes_.data());
  const uint8_t* end = cursor + bytes_.size();
  for (uint64_t number; cursor != end;)
    if (!varint(cursor, end, number)) return void(fail());
}

void WireReader::append(uint64_t* values, uint32_t capacity, uint32_t& count) {
  const auto* cursor = reinterpret_cast<const uint8_t*>(bytes_.data());
  const uint8_t* end = cursor + bytes_.size();
  if (type_ == WireType::varint) {
    if (count == capacity) fail();
    else values[count++] = number_;
    return;
  }
  if (!expect(WireType::bytes)) return;
  while (cursor != end) {
    if (count == capacity || !varint(cursor, end, values[count])) {
      fail();
      return;
    }
    ++count;
  }
}

template <class Number>
void WireReader::appendFixed(Number* values, uint32_t capacity, uint32_t& count, WireType type) {
  using Bits = std::conditional_t<sizeof(Number) == 8, uint64_t, uint32_t>;
  if (type_ == type) {
    if (count == capacity) fail();
    else values[count++] = std::bit_cast<Number>(Bits(number_));
    return;
  }
  if (!expect(WireType::bytes)) return;
  const size_t added = bytes_.size() / sizeof(Number);
  if (bytes_.size() % sizeof(Number) != 0 || added > capacity - count) {
    fail();
    return;
  }
  for (size_t i = 0; i < added; ++i)
    values[count++] = std::bit_cast<Number>(loadLittle<Bits>(reinterpret_cast<const uint8_t*>(bytes_.data()) + i * sizeof(Number)));
}
void WireReader::append(float* values, uint32_t capacity, uint32_t& count) { appendFixed(values, capacity, count, WireType::fixed32); }
void WireReader::append(double* values, uint32_t capacity, uint32_t& count) { appendFixed(values, capacity, count, WireType::fixed64); }

}  // namespace lightwell::format
