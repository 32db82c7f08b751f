#include "tests/fuzz/message_mutator.h"

#include <cmath>
#include <limits>

extern "C" size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t most);

namespace lightwell::fuzz {
namespace {
using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;

constexpr size_t kMostString = 256;
constexpr int kMostElements = 64;

/// Sets a singular field, or element `index` of a repeated one (index −1: a new one).
void setValue(Message& message, const FieldDescriptor& field, int index, Random& random) {
  const Reflection& r = *message.GetReflection();
  const auto put = [&](auto set, auto change, auto add, auto value) {
    if (!field.is_repeated()) (r.*set)(&message, &field, value);
    else if (index < 0) (r.*add)(&message, &field, value);
    else (r.*change)(&message, &field, index, value);
  };
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_INT32: return put(&Reflection::SetInt32, &Reflection::SetRepeatedInt32, &Reflection::AddInt32, int32_t(oddNumber(random)));
    case FieldDescriptor::CPPTYPE_INT64: return put(&Reflection::SetInt64, &Reflection::SetRepeatedInt64, &Reflection::AddInt64, int64_t(oddNumber(random)));
    case FieldDescriptor::CPPTYPE_UINT32: return put(&Reflection::SetUInt32, &Reflection::SetRepeatedUInt32, &Reflection::AddUInt32, uint32_t(oddNumber(random)));
    case FieldDescriptor::CPPTYPE_UINT64: return put(&Reflection::SetUInt64, &Reflection::SetRepeatedUInt64, &Reflection::AddUInt64, oddNumber(random));
    case FieldDescriptor::CPPTYPE_DOUBLE: return put(&Reflection::SetDouble, &Reflection::SetRepeatedDouble, &Reflection::AddDouble, oddReal(random));
    case FieldDescriptor::CPPTYPE_FLOAT: return put(&Reflection::SetFloat, &Reflection::SetRepeatedFloat, &Reflection::AddFloat, float(oddReal(random)));
    case FieldDescriptor::CPPTYPE_BOOL: return put(&Reflection::SetBool, &Reflection::SetRepeatedBool, &Reflection::AddBool, bool(random() & 1));
    case FieldDescriptor::CPPTYPE_ENUM:
      return put(&Reflection::SetEnumValue, &Reflection::SetRepeatedEnumValue, &Reflection::AddEnumValue, int(random() % 8 ? random() % 12 : oddNumber(random)));
    case FieldDescriptor::CPPTYPE_STRING: {
      const std::string old = !field.is_repeated() ? r.GetString(message, &field) : index >= 0 ? r.GetRepeatedString(message, &field, index) : "";
      std::string value = mutatedBytes(old, kMostString);
      if (field.type() == FieldDescriptor::TYPE_STRING)  // protobuf's text is UTF-8; what is not comes from changed bytes of whole messages
        for (char& c : value) c = char(c & 0x7f);
      if (!field.is_repeated()) r.SetString(&message, &field, value);
      else if (index < 0) r.AddString(&message, &field, value);
      else r.SetRepeatedString(&message, &field, index, value);
      return;
    }
    case FieldDescriptor::CPPTYPE_MESSAGE:
      return mutateMessage(!field.is_repeated() ? *r.MutableMessage(&message, &field)
                           : index < 0          ? *r.AddMessage(&message, &field)
                                                : *r.MutableRepeatedMessage(&message, &field, index), random);
  }
}

}  // namespace

uint64_t oddNumber(Random& random) {
  switch (random() % 6) {
    case 0: return random() % 16;
    case 1: return (uint64_t(1) << random() % 64) + random() % 3 - 1;
    case 2: return ~uint64_t(0) - random() % 3;
    case 3: return random() % 70000;
    case 4: return random();
    default: return uint64_t(random()) << 32 | random();
  }
}

double oddReal(Random& random) {
  constexpr double kOdd[] = {0, -0.0, 1, -1, 0.5, 1e-45, 1e-38, 1e-20, 1e20, 3.4e38, -3.4e38, 1e300, std::numeric_limits<double>::infinity(),
                             -std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN(), 65504, 1e-300, 255, 0.999, 1.0001};
  return random() % 4 ? kOdd[random() % std::size(kOdd)] : std::ldexp(double(random()) / 1e9 - 1, int(random() % 80) - 40);
}

std::string mutatedBytes(std::string bytes, size_t most) {
  const size_t size = std::min(bytes.size(), most);
  bytes.resize(most);
  bytes.resize(LLVMFuzzerMutate(reinterpret_cast<uint8_t*>(bytes.data()), size, most));
  return bytes;
}

void mutateMessage(Message& message, Random& random) {
  const auto& type = *message.GetDescriptor();
  if (type.field_count() == 0) return;
  const FieldDescriptor& field = *type.field(int(random() % uint32_t(type.field_count())));
  const Reflection& r = *message.GetReflection();
  if (!field.is_repeated()) {
    if (random() % 16 == 0) return r.ClearField(&message, &field);
    return setValue(message, field, 0, random);
  }
  const int count = r.FieldSize(message, &field);
  if (count == 0) return setValue(message, field, -1, random);
  const int index = int(random() % uint32_t(count));
  switch (random() % 8) {
    case 0: return r.RemoveLast(&message, &field);
    case 1: return r.SwapElements(&message, &field, index, int(random() % uint32_t(count)));
    case 2:
      if (count < kMostElements) setValue(message, field, -1, random);
      return;
    default: return setValue(message, field, index, random);
  }
}

}  // namespace lightwell::fuzz
