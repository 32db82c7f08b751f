// Who may call: a file of tokens, one a line, "NAME TOKEN" or "TOKEN" alone (named by its place). '#' begins a comment.
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace lightwell::server {

class Tokens {
 public:
  /// No tokens: everybody may call, and is one client named "local".
  Tokens() = default;
  /// Throws std::runtime_error for a file that cannot be read, that others may read, that has no token, or one of less than 16 characters.
  explicit Tokens(const std::filesystem::path& file);

  bool required() const { return required_; }
  /// The client that a token belongs to. Takes the same time whatever the token is like.
  std::optional<std::string> clientOf(std::string_view token) const;
  /// The client behind an Authorization header: Bearer, or Basic with the token as password. None: not allowed.
  std::optional<std::string> authorize(std::string_view header) const;

 private:
  bool required_ = false;
  std::map<std::string, std::string> client_of_hash_;
};

}  // namespace lightwell::server
