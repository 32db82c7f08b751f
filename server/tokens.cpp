#include "server/tokens.h"

#include <sys/stat.h>

#include <fstream>
#include <sstream>
#include <stdexcept>

#include "server/store/sha256.h"

namespace lightwell::server {
namespace {

/// RFC 4648; empty for what is not base64.
std::string base64Decode(std::string_view text) {
  std::string bytes;
  uint32_t bits = 0, count = 0;
  for (const char c : text) {
    if (c == '=') break;
    static constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const size_t digit = kDigits.find(c);
    if (digit == std::string_view::npos) return {};
    bits = bits << 6 | uint32_t(digit);
    if ((count += 6) >= 8) bytes += char(bits >> (count -= 8) & 0xff);
  }
  return bytes;
}

}  // namespace

Tokens::Tokens(const std::filesystem::path& file) : required_(true) {
  const auto refuse = [&](const std::string& reason) { throw std::runtime_error("the token file " + file.string() + ": " + reason); };
  struct stat status;
  if (stat(file.c_str(), &status) != 0) refuse("cannot be read");
  if (status.st_mode & (S_IRWXG | S_IRWXO) & ~S_IRGRP) refuse("others may read or change it; chmod 600 (or 640) it");
  std::ifstream in(file);
  if (!in) refuse("cannot be read");
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    std::istringstream words(line.substr(0, line.find('#')));
    std::string first, second, more;
    if (!(words >> first)) continue;
    if (words >> more, !more.empty()) second = more, more.clear(), words >> more;
    if (!more.empty()) refuse("line " + std::to_string(number) + " has more than a name and a token");
    const std::string token = second.empty() ? first : second;
    const std::string name = second.empty() ? "client" + std::to_string(number) : first;
    if (token.size() < 16) refuse("the token of line " + std::to_string(number) + " is shorter than 16 characters");
    client_of_hash_[sha256(token)] = name;
  }
  if (client_of_hash_.empty()) refuse("there is no token in it");
}

std::optional<std::string> Tokens::clientOf(std::string_view token) const {
  // Hashes are compared, not tokens: how long that takes tells nothing about any token.
  const auto found = client_of_hash_.find(sha256(token));
  return found == client_of_hash_.end() ? std::nullopt : std::optional(found->second);
}

std::optional<std::string> Tokens::authorize(std::string_view header) const {
  if (!required_) return "local";
  if (header.starts_with("Bearer ")) return clientOf(header.substr(7));
  if (header.starts_with("Basic ")) {
    const std::string pair = base64Decode(header.substr(6));
    if (const size_t colon = pair.find(':'); colon != std::string::npos) return clientOf(std::string_view(pair).substr(colon + 1));
  }
  return std::nullopt;
}

}  // namespace lightwell::server
