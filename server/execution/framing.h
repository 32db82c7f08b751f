// Messages over a pipe, each after its length (32 bits, little endian).
#pragma once
#include <google/protobuf/message_lite.h>

#include <cstdint>
#include <string>

namespace lightwell::server {

/// Writes all of it. False with errno set, also for EPIPE (SIGPIPE must be ignored).
bool writeMessage(int fd, const google::protobuf::MessageLite& message);

/// Gathers bytes and takes messages out of them.
class MessageReader {
 public:
  /// Reads what is there, up to 64 KiB. False at the end of the stream or after an error.
  bool readSome(int fd);
  /// Blocks until a message is complete; false at the end of the stream or when it makes no sense.
  bool readMessage(int fd, google::protobuf::MessageLite& message);
  /// The next complete message; false when there is none (yet), or when it makes no sense: then damaged() is true.
  bool next(google::protobuf::MessageLite& message);
  bool damaged() const { return damaged_; }

 private:
  static constexpr uint32_t kMaxMessageBytes = 64u << 20;
  std::string buffer_;
  bool damaged_ = false;
};

}  // namespace lightwell::server
