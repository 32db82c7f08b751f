#include "precompute/scene/gltf/files.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <system_error>

#include "precompute/core/error.h"

namespace lightwell::scene::gltf {
namespace fs = std::filesystem;
namespace {

int hexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

/// RFC 3986 section 2.1; a '%' without two hexadecimal digits stands for itself.
std::string percentDecode(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%' && i + 2 < text.size() && hexDigit(text[i + 1]) >= 0 && hexDigit(text[i + 2]) >= 0) {
      result.push_back(char(hexDigit(text[i + 1]) * 16 + hexDigit(text[i + 2])));
      i += 2;
    } else {
      result.push_back(text[i]);
    }
  }
  return result;
}

/// RFC 4648, the URL-safe alphabet too. Padding may be left out; anything after it, and any other character, is refused.
bool base64Decode(std::string_view text, std::vector<uint8_t>& bytes) {
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  bytes.clear();
  bytes.reserve(text.size() / 4 * 3 + 2);
  uint32_t accumulator = 0;
  int bits = 0;
  for (const char c : text) {
    uint32_t digit;
    if (c >= 'A' && c <= 'Z') digit = uint32_t(c - 'A');
    else if (c >= 'a' && c <= 'z') digit = uint32_t(c - 'a') + 26;
    else if (c >= '0' && c <= '9') digit = uint32_t(c - '0') + 52;
    else if (c == '+' || c == '-') digit = 62;
    else if (c == '/' || c == '_') digit = 63;
    else return false;
    accumulator = (accumulator << 6) | digit;
    bits += 6;
    if (bits >= 8) {
      bits -= 8;
      bytes.push_back(uint8_t(accumulator >> bits));
    }
  }
  return bits < 6;  // six bits left over: a lone digit
}

std::vector<uint8_t> decodeDataUri(const JsonValue& uri) {
  const std::string_view text = uri.string();
  const size_t comma = text.find(',');
  if (comma == std::string_view::npos) uri.fail("is a data URI without a comma");
  const std::string_view header = text.substr(0, comma), payload = text.substr(comma + 1);
  if (header.ends_with(";base64")) {
    std::vector<uint8_t> bytes;
    const bool decoded = payload.find('%') == std::string_view::npos ? base64Decode(payload, bytes)
                                                                      : base64Decode(percentDecode(payload), bytes);
    if (!decoded) uri.fail("is not valid base64");
    return bytes;
  }
  const std::string decoded = percentDecode(payload);
  return {decoded.begin(), decoded.end()};
}

bool hasScheme(std::string_view uri) {
  const size_t colon = uri.find(':');
  if (colon == std::string_view::npos || colon == 0) return false;
  return std::all_of(uri.begin(), uri.begin() + ptrdiff_t(colon),
                     [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '+' || c == '-' || c == '.'; });
}

bool isInside(const fs::path& folder, const fs::path& file) {
  const auto mismatch = std::mismatch(folder.begin(), folder.end(), file.begin(), file.end());
  return mismatch.first == folder.end();
}

/// `relative` in normal form; empty when it is absolute or leaves the folder.
fs::path insideFolder(const std::string& relative) {
  const fs::path path(relative);
  if (path.is_absolute() || relative.starts_with('\\') || relative.find('\0') != std::string::npos) return {};
  const fs::path normal = path.lexically_normal();
  return !normal.empty() && *normal.begin() == ".." ? fs::path() : normal;
}

/// Where `relative` leads, every symbolic link resolved; empty when there is nothing. Fails when that is outside the folder.
fs::path resolve(const fs::path& folder, const std::string& relative, const JsonValue& uri) {
  const fs::path normal = insideFolder(relative);
  if (normal.empty()) uri.fail("\"" + uri.string() + "\" leaves the scene's folder");
  std::error_code error;
  const fs::path root = fs::canonical(folder, error);
  if (error) uri.fail("the scene's folder cannot be resolved: " + error.message());
  const fs::path target = fs::canonical(root / normal, error);
  if (error) return {};
  if (!isInside(root, target)) uri.fail("\"" + uri.string() + "\" leaves the scene's folder through a symbolic link");
  return target;
}

/// Likewise, in a table: the name under which it is there.
fs::path resolve(const fs::path& folder, const FileTable& table, const std::string& relative, const JsonValue& uri) {
  const fs::path normal = insideFolder(relative);
  if (normal.empty()) uri.fail("\"" + uri.string() + "\" leaves the scene's folder");
  const fs::path name = (folder / normal).lexically_normal();
  return table.contains(name.generic_string()) ? name : fs::path();
}

}  // namespace

std::vector<uint8_t> readFile(const fs::path& name, uint64_t max_bytes, const FileTable* table) {
  const auto reject = [&](const std::string& reason) { throw InputError(name.string(), "", reason); };
  fs::path file = name;
  if (table) {
    const auto found = table->find(name.lexically_normal().generic_string());
    if (found == table->end()) reject("no such file");
    file = found->second;
  }
  std::error_code error;
  const auto status = fs::status(file, error);
  if (error || !fs::exists(status)) reject("no such file");
  if (!fs::is_regular_file(status)) reject("not a regular file");
  const uint64_t size = fs::file_size(file, error);
  if (error) reject(error.message());
  if (size > max_bytes) reject("has " + std::to_string(size) + " bytes, more than the limit of " + std::to_string(max_bytes));
  std::ifstream stream(file, std::ios::binary);
  std::vector<uint8_t> bytes(size);
  if (!stream || !stream.read(reinterpret_cast<char*>(bytes.data()), std::streamsize(size))) reject("cannot be read");
  return bytes;
}

std::vector<uint8_t> readUri(const fs::path& folder, const JsonValue& uri, uint64_t max_bytes, const FileTable* table) {
  const std::string& text = uri.string();
  if (text.starts_with("data:")) return decodeDataUri(uri);
  if (hasScheme(text)) uri.fail("\"" + text + "\" is not a file of the scene's folder");
  const auto find = [&](const std::string& relative) {
    return table ? resolve(folder, *table, relative, uri) : resolve(folder, relative, uri);
  };
  fs::path target = find(percentDecode(text));
  if (target.empty() && text.find('%') != std::string::npos) target = find(text);  // written without encoding
  if (target.empty()) uri.fail("\"" + text + "\" does not exist");
  try {
    return readFile(target, max_bytes, table);
  } catch (const InputError& e) {
    uri.fail("\"" + text + "\": " + e.reason);
  }
}

std::string relativeName(std::string_view uri) {
  if (uri.starts_with("data:") || hasScheme(uri)) return {};
  return insideFolder(percentDecode(uri)).generic_string();
}

}  // namespace lightwell::scene::gltf
