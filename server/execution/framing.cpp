#include "server/execution/framing.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace lightwell::server {

bool writeMessage(int fd, const google::protobuf::MessageLite& message) {
  std::string bytes(4, '\0');
  message.AppendToString(&bytes);
  const auto size = uint32_t(bytes.size() - 4);
  for (int i = 0; i < 4; ++i) bytes[size_t(i)] = char(size >> (8 * i));
  for (size_t sent = 0; sent < bytes.size();) {
    const ssize_t written = write(fd, bytes.data() + sent, bytes.size() - sent);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    sent += size_t(written);
  }
  return true;
}

bool MessageReader::readSome(int fd) {
  char bytes[1 << 16];
  ssize_t got;
  do got = read(fd, bytes, sizeof bytes);
  while (got < 0 && errno == EINTR);
  if (got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return true;
  if (got <= 0) return false;
  buffer_.append(bytes, size_t(got));
  return true;
}

bool MessageReader::next(google::protobuf::MessageLite& message) {
  if (damaged_ || buffer_.size() < 4) return false;
  uint32_t size = 0;
  for (int i = 0; i < 4; ++i) size |= uint32_t(uint8_t(buffer_[size_t(i)])) << (8 * i);
  if (size > kMaxMessageBytes) damaged_ = true;
  if (damaged_ || buffer_.size() - 4 < size) return false;
  damaged_ = !message.ParseFromArray(buffer_.data() + 4, int(size));
  buffer_.erase(0, 4 + size_t(size));
  return !damaged_;
}

bool MessageReader::readMessage(int fd, google::protobuf::MessageLite& message) {
  while (!next(message))
    if (damaged_ || !readSome(fd)) return false;
  return true;
}

}  // namespace lightwell::server
