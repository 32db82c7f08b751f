// A sequence of calls to the service as bytes: for each its method, the length of the request (16 bits, little endian) and the request as protobuf has it.
#pragma once
#include <google/protobuf/message.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "lightwell/v1/service.pb.h"
#include "tests/fuzz/feed.h"

namespace lightwell::fuzz {

enum class Method : uint8_t { info, find_uploads, upload, submit, get, list, watch, cancel, remove, download, run };
inline constexpr uint8_t kMethods = 11;

struct Call {
  Method method;
  std::string request;
};

inline std::vector<Call> callsOf(Feed& feed, size_t most) {
  std::vector<Call> calls;
  while (!feed.empty() && calls.size() < most) {
    const auto method = Method(feed.take<uint8_t>() % kMethods);
    calls.push_back({method, feed.bytes(feed.take<uint16_t>())});
  }
  return calls;
}

/// An empty request of the method; of `run`, which is no call but what a worker would do with the next job, its ending.
inline std::unique_ptr<google::protobuf::Message> requestOf(Method method) {
  switch (method) {
    case Method::info: return std::make_unique<v1::GetServerInfoRequest>();
    case Method::find_uploads: return std::make_unique<v1::FindUploadsRequest>();
    case Method::upload: return std::make_unique<v1::UploadRequest>();
    case Method::submit: return std::make_unique<v1::SubmitJobRequest>();
    case Method::get: return std::make_unique<v1::GetJobRequest>();
    case Method::list: return std::make_unique<v1::ListJobsRequest>();
    case Method::watch: return std::make_unique<v1::WatchJobRequest>();
    case Method::cancel: return std::make_unique<v1::CancelJobRequest>();
    case Method::remove: return std::make_unique<v1::DeleteJobRequest>();
    case Method::download: return std::make_unique<v1::DownloadResultRequest>();
    case Method::run: return std::make_unique<v1::Job>();
  }
  return nullptr;
}

}  // namespace lightwell::fuzz
