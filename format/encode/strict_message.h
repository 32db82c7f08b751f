// Messages as docs/format.md, section 7, has them: narrower than what protobuf reads.
#pragma once
#include <string_view>

namespace google::protobuf {
class Message;
}

namespace lightwell::format {

/// Parses; false for what is no message of this type, or not by the rules: a known field with another wire type, a singular field that occurs twice, a number beyond the range of its type, a group.
/// Protobuf itself would take the last of two, the lowest bits, and skip the rest.
bool parseStrictly(std::string_view bytes, google::protobuf::Message& message);

}  // namespace lightwell::format
