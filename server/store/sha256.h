// SHA-256: the names of uploads and containers. A client can compute it, and cannot make two files of one name.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace lightwell::server {

class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(Sha256&&) noexcept;
  Sha256& operator=(Sha256&&) noexcept;
  void add(const void* data, size_t size);
  /// 64 lower-case hexadecimal digits. Once.
  std::string finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

std::string sha256(std::string_view bytes);
/// Whether `text` is a name that finish() could give.
bool isSha256(std::string_view text);

}  // namespace lightwell::server
