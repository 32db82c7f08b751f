// Changes one chunk of a binary glTF, JSON or buffer, and puts the lengths around it right.
#include <cstdint>
#include <cstring>
#include <random>
#include <string>

extern "C" size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t most);

namespace {

constexpr size_t kHeader = 12, kChunkHeader = 8;
constexpr char kJson[] = "JSON", kBinary[] = "BIN";

uint32_t load(const uint8_t* at) {
  uint32_t value;
  std::memcpy(&value, at, 4);
  return value;
}
void append(std::string& text, uint32_t value) { text.append(reinterpret_cast<const char*>(&value), 4); }

std::string mutated(std::string bytes, size_t most) {
  const size_t size = bytes.size();
  bytes.resize(most > size ? most : size);
  bytes.resize(LLVMFuzzerMutate(reinterpret_cast<uint8_t*>(bytes.data()), size, bytes.size()));
  return bytes;
}

/// A number in the JSON becomes another, as a whole: the usual way to lie about counts, offsets and indices.
bool mutateNumber(std::string& json, std::minstd_rand& random) {
  static const char* const kNumbers[] = {"0", "1", "2", "3", "-1", "4", "5", "16", "255", "65535", "65536", "2147483648", "4294967295", "4294967296", "9007199254740992", "1e308", "-1e-308", "0.5",
                                         "5120", "5121", "5122", "5123", "5125", "5126", "33071", "33648", "10497", "null", "true", "[]", "{}", "\"a\"", "1e15", "1e-9"};
  const size_t from = json.empty() ? std::string::npos : json.find_first_of("0123456789", random() % json.size());
  if (from == std::string::npos) return false;
  const size_t to = json.find_first_not_of("0123456789.eE+-", from);
  json.replace(from, (to == std::string::npos ? json.size() : to) - from, kNumbers[random() % std::size(kNumbers)]);
  return true;
}

}  // namespace

extern "C" size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t most, unsigned seed) {
  std::minstd_rand random(seed + 1);
  const bool binary = size > kHeader + kChunkHeader && std::memcmp(data, "glTF", 4) == 0;
  const size_t json_bytes = binary ? load(data + kHeader) : 0;
  if (!binary || json_bytes > size - kHeader - kChunkHeader || random() % 16 == 0) return LLVMFuzzerMutate(data, size, most);
  std::string json(reinterpret_cast<const char*>(data) + kHeader + kChunkHeader, json_bytes);
  const size_t at = kHeader + kChunkHeader + json_bytes + kChunkHeader;
  std::string buffer = at < size ? std::string(reinterpret_cast<const char*>(data) + at, size - at) : "";
  const uint32_t choice = random() % 4;
  if (choice == 0 && !buffer.empty()) buffer = mutated(std::move(buffer), buffer.size() + 16);
  else if (choice != 1 || !mutateNumber(json, random)) json = mutated(std::move(json), json.size() + 64);
  json.resize((json.size() + 3) & ~size_t(3), ' ');
  buffer.resize((buffer.size() + 3) & ~size_t(3), '\0');

  std::string file("glTF");
  append(file, 2);
  append(file, uint32_t(kHeader + kChunkHeader + json.size() + (buffer.empty() ? 0 : kChunkHeader + buffer.size())));
  append(file, uint32_t(json.size()));
  file.append(kJson, 4).append(json);
  if (!buffer.empty()) {
    append(file, uint32_t(buffer.size()));
    file.append(kBinary, 4).append(buffer);
  }
  if (file.size() > most) return LLVMFuzzerMutate(data, size, most);
  std::memcpy(data, file.data(), file.size());
  return file.size();
}
