#include "format/encode/strict_message.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>

#include <climits>

#include "format/decode/wire.h"

namespace lightwell::format {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;

/// No message of the schema holds one of its own kind: its depth bounds the recursion.
bool keepsTheRules(const Descriptor& type, std::string_view bytes);

/// One occurrence, which `reader` is at. Sets the reader's failure, or returns false for a message inside that has one.
bool check(WireReader& reader, const FieldDescriptor& field) {
  uint32_t number = 0;
  uint64_t large = 0;
  float single = 0;
  double real = 0;
  bool flag = false;
  std::string_view text;
  switch (field.type()) {
    case FieldDescriptor::TYPE_MESSAGE: {
      if (!field.is_repeated()) reader.read(text);
      else text = reader.bytes();
      return keepsTheRules(*field.message_type(), text);
    }
    case FieldDescriptor::TYPE_STRING:
    case FieldDescriptor::TYPE_BYTES: field.is_repeated() ? void(reader.bytes()) : reader.read(text); break;
    case FieldDescriptor::TYPE_UINT32:
    case FieldDescriptor::TYPE_ENUM: field.is_repeated() ? reader.skipNumbers(WireType::varint) : reader.read(number); break;
    case FieldDescriptor::TYPE_UINT64: field.is_repeated() ? reader.skipNumbers(WireType::varint) : reader.read(large); break;
    case FieldDescriptor::TYPE_FIXED64: reader.readFixed64(large); break;
    case FieldDescriptor::TYPE_BOOL: reader.read(flag); break;
    case FieldDescriptor::TYPE_FLOAT: field.is_repeated() ? reader.skipNumbers(WireType::fixed32) : reader.read(single); break;
    case FieldDescriptor::TYPE_DOUBLE: field.is_repeated() ? reader.skipNumbers(WireType::fixed64) : reader.read(real); break;
    default: return false;  // the schema has no others
  }
  return true;
}

bool keepsTheRules(const Descriptor& type, std::string_view bytes) {
  WireReader reader(bytes);
  while (reader.next()) {
    const FieldDescriptor* field = reader.field() <= uint32_t(INT_MAX) ? type.FindFieldByNumber(int(reader.field())) : nullptr;
    if (field && !check(reader, *field)) return false;
  }
  return reader.ok();
}

}  // namespace

bool parseStrictly(std::string_view bytes, google::protobuf::Message& message) {
  return bytes.size() <= size_t(INT_MAX) && message.ParseFromArray(bytes.data(), int(bytes.size())) && keepsTheRules(*message.GetDescriptor(), bytes);
}

}  // namespace lightwell::format
