#include "server/store/uploads.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <vector>

namespace lightwell::server {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void failWriting(int error) {
  throw Failure(error == ENOSPC || error == EDQUOT ? FailureId::disk_full : FailureId::internal,
                std::string("the upload cannot be written: ") + std::strerror(error));
}

}  // namespace

Upload::Upload(Uploads& owner, fs::path file, std::string client, std::string sha256, uint64_t size)
    : owner_(owner), file_(std::move(file)), client_(std::move(client)), sha256_(std::move(sha256)), size_(size) {}

Upload::~Upload() {
  if (fd_ >= 0) close(fd_);
  std::lock_guard lock(owner_.mutex_);
  owner_.active_.erase(file_);
}

void Upload::add(std::string_view data) {
  if (data.size() > size_ - received_) throw Failure(FailureId::upload_too_large, "more bytes came than were announced");
  hash_.add(data.data(), data.size());
  while (!data.empty()) {
    const ssize_t written = write(fd_, data.data(), data.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) failWriting(errno);
    data.remove_prefix(size_t(written));
    received_ += uint64_t(written);
  }
}

v1::UploadState Upload::finish() {
  v1::UploadState state;
  state.set_sha256(sha256_);
  state.set_received_bytes(received_);
  if (received_ < size_) return state;
  if (hash_.finish() != sha256_) {
    std::error_code ignored;
    fs::remove(file_, ignored);
    throw Failure(FailureId::hash_mismatch, "the uploaded bytes do not have the SHA-256 " + sha256_);
  }
  try {
    owner_.blobs_.adopt(file_, sha256_);
  } catch (const std::exception& error) {
    throw Failure(FailureId::disk_full, error.what());
  }
  owner_.jobs_.addBlob(sha256_, size_, client_);
  state.set_complete(true);
  return state;
}

Uploads::Uploads(fs::path folder, BlobStore& blobs, JobStore& jobs, const UploadLimits& limits, std::function<bool(uint64_t)> make_room)
    : folder_(std::move(folder)), blobs_(blobs), jobs_(jobs), limits_(limits), make_room_(std::move(make_room)) {
  fs::create_directories(folder_);
}

fs::path Uploads::fileOf(const std::string& client, const std::string& sha256) const {
  return folder_ / (sha256 + "-" + server::sha256(client).substr(0, 16));
}

v1::UploadState Uploads::find(const std::string& client, const std::string& sha256) {
  if (!isSha256(sha256)) throw Failure(FailureId::invalid_request, "a SHA-256 has 64 lower-case hexadecimal digits");
  v1::UploadState state;
  state.set_sha256(sha256);
  std::error_code error;
  if (jobs_.touchBlob(sha256)) {
    state.set_complete(true);
    state.set_received_bytes(blobs_.size(sha256).value_or(0));
  } else if (const uint64_t size = fs::file_size(fileOf(client, sha256), error); !error) {
    state.set_received_bytes(size);
  }
  return state;
}

std::unique_ptr<Upload> Uploads::begin(const std::string& client, const std::string& sha256, uint64_t size, uint64_t offset) {
  if (find(client, sha256).complete()) return nullptr;
  if (size > limits_.max_file_bytes)
    throw Failure(FailureId::upload_too_large, "the file has " + std::to_string(size) + " bytes, more than the limit of " +
                                                   std::to_string(limits_.max_file_bytes));
  if (jobs_.blobBytesOf(client) + size > limits_.max_client_bytes)
    throw Failure(FailureId::quota_exceeded, "your uploads would exceed " + std::to_string(limits_.max_client_bytes) + " bytes");
  if (offset > size) throw Failure(FailureId::invalid_request, "the offset lies behind the end of the file");
  if (!make_room_(size - offset)) throw Failure(FailureId::store_full, "the server's store is full");
  std::error_code error;
  if (const auto space = fs::space(folder_, error); !error && space.available < size - offset)
    throw Failure(FailureId::disk_full, "the server's disk is full");

  const fs::path file = fileOf(client, sha256);
  {
    std::lock_guard lock(mutex_);
    if (!active_.insert(file).second) throw Failure(FailureId::upload_in_use, "another stream is sending this file; ask again");
  }
  std::unique_ptr<Upload> upload(new Upload(*this, file, client, sha256, size));
  upload->fd_ = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (upload->fd_ < 0) failWriting(errno);
  std::vector<char> buffer(1 << 20);
  while (upload->received_ < offset) {
    const size_t wanted = size_t(std::min<uint64_t>(buffer.size(), offset - upload->received_));
    const ssize_t got = read(upload->fd_, buffer.data(), wanted);
    if (got <= 0)
      throw Failure(FailureId::offset_mismatch, "the server has only " + std::to_string(upload->received_) + " bytes of this file");
    upload->hash_.add(buffer.data(), size_t(got));
    upload->received_ += uint64_t(got);
  }
  if (ftruncate(upload->fd_, off_t(offset)) != 0) failWriting(errno);
  return upload;
}

void Uploads::removeStale(double seconds) {
  const auto oldest = fs::file_time_type::clock::now() - std::chrono::duration_cast<fs::file_time_type::duration>(
                                                             std::chrono::duration<double>(seconds));
  std::lock_guard lock(mutex_);
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder_, error))
    if (const auto written = entry.last_write_time(error); !error && written < oldest && !active_.contains(entry.path()))
      fs::remove(entry.path(), error);
}

uint64_t Uploads::partialBytes() const {
  uint64_t bytes = 0;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder_, error))
    if (const uint64_t size = entry.file_size(error); !error) bytes += size;
  return bytes;
}

}  // namespace lightwell::server
