// Changes one call of a sequence: a field of its request, its place, or adds and removes calls.
#include <cstring>

#include "tests/fuzz/call.h"
#include "tests/fuzz/message_mutator.h"

extern "C" size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t most);

extern "C" size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t most, unsigned seed) {
  using namespace lightwell::fuzz;
  Random random(seed + 1);
  if (random() % 16 == 0) return LLVMFuzzerMutate(data, size, most);
  Feed feed(data, size);
  std::vector<Call> calls = callsOf(feed, 64);
  const uint32_t choice = random() % 8;
  if (calls.empty() || choice == 0) calls.insert(calls.begin() + ptrdiff_t(random() % (calls.size() + 1)), {Method(random() % kMethods), ""});
  Call& call = calls[random() % calls.size()];
  if (choice == 1) {
    calls.erase(calls.begin() + (&call - calls.data()));
  } else if (choice == 2) {
    std::swap(call, calls[random() % calls.size()]);
  } else if (choice == 3) {
    calls.push_back(Call(call));
  } else {
    const auto request = requestOf(call.method);
    if (!request->ParseFromString(call.request)) request->Clear();
    for (uint32_t n = 1 + random() % 3; n > 0; --n) mutateMessage(*request, random);
    call.request = request->SerializeAsString();
  }
  std::string bytes;
  for (const Call& c : calls) {
    if (c.request.size() > 0xffff) continue;
    bytes += char(c.method);
    bytes += char(c.request.size() & 0xff);
    bytes += char(c.request.size() >> 8);
    bytes += c.request;
  }
  if (bytes.size() > most) return LLVMFuzzerMutate(data, size, most);
  std::memcpy(data, bytes.data(), bytes.size());
  return bytes.size();
}
