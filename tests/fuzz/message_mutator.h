// Changes protobuf messages field by field, so that what comes out is still a message.
#pragma once
#include <google/protobuf/message.h>

#include <cstdint>
#include <random>
#include <string>

namespace lightwell::fuzz {

using Random = std::minstd_rand;

/// Mostly the bounds of things; sometimes any bits.
uint64_t oddNumber(Random& random);
double oddReal(Random& random);
/// `bytes` as libFuzzer changes them, at most `most` long.
std::string mutatedBytes(std::string bytes, size_t most);

/// Changes one field of the message or of one inside it: another value, gone, one element more, less, twice or elsewhere.
void mutateMessage(google::protobuf::Message& message, Random& random);

}  // namespace lightwell::fuzz
