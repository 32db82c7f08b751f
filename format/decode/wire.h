// A bounded reader of protobuf's wire format (https://protobuf.dev/programming-guides/encoding), for hostile bytes. It allocates nothing
// and never reads outside the message. Unknown fields are skipped; groups, which proto3 does not have, are errors.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace lightwell::format {

enum class WireType : uint8_t { varint = 0, fixed64 = 1, bytes = 2, fixed32 = 5 };

/// Walks over the fields of one message:
///   WireReader reader(message, size);
///   while (reader.next()) switch (reader.field()) { case 1: reader.read(width); break; … }
///   return reader.ok();
/// read() is for singular fields: a wrong wire type, a value out of the type's range, or a second occurrence makes ok() false and ends the
/// walk. append() is for repeated numbers, packed or not.
class WireReader {
 public:
  WireReader(const uint8_t* message, size_t bytes) : cursor_(message), end_(message + bytes) {}
  explicit WireReader(std::string_view message) : WireReader(reinterpret_cast<const uint8_t*>(message.data()), message.size()) {}

  /// To the next field. False at the end and after any error.
  bool next();
  bool ok() const { return ok_; }
  uint32_t field() const { return field_; }

  void read(uint32_t& value);
  void read(uint64_t& value);
  void readFixed64(uint64_t& value);
  void read(bool& value);
  void read(float& value);
  void read(double& value);
  void read(std::string_view& value);
  /// A submessage or string of a repeated field: any number of occurrences.
  std::string_view bytes();

  /// Numbers of a repeated field, packed or not, unread.
  void skipNumbers(WireType element);
  void append(uint64_t* values, uint32_t capacity, uint32_t& count);
  void append(float* values, uint32_t capacity, uint32_t& count);
  void append(double* values, uint32_t capacity, uint32_t& count);

 private:
  bool fail() { return ok_ = false; }
  bool expect(WireType type) { return type_ == type || fail(); }
  bool first();  // false when a singular field occurs again
  static bool varint(const uint8_t*& cursor, const uint8_t* end, uint64_t& value);
  template <class Number>
  void appendFixed(Number* values, uint32_t capacity, uint32_t& count, WireType type);

  const uint8_t* cursor_;
  const uint8_t* end_;
  bool ok_ = true;
  uint32_t field_ = 0;
  WireType type_ = WireType::varint;
  uint64_t number_ = 0;      // varint, fixed32, fixed64
  std::string_view bytes_;   // bytes
  uint64_t seen_ = 0;        // singular fields 1 to 63 read so far
};

}  // namespace lightwell::format
