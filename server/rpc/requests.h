// Whether a request makes sense: everything a client wrote is checked here before it goes further.
#pragma once
#include <string>

#include "lightwell/v1/service.pb.h"

namespace lightwell::server {

inline constexpr size_t kMostFilesPerJob = 4096, kMaxNameBytes = 512, kMaxLabelBytes = 200, kMaxIdempotencyKeyBytes = 100;
inline constexpr uint32_t kMaxPageSize = 200, kDefaultPageSize = 50;
inline constexpr size_t kMaxUploadMessageBytes = 1 << 20, kMaxMessageBytes = 4 << 20;

/// Puts `spec` into normal form: canonical settings, files sorted by name. Throws Failure: invalid_request, invalid_settings.
void checkSpec(v1::JobSpec& spec);

/// The same for every job that must give the same container: version, files, settings and limits, but not priority, threads or label.
/// `spec` is in normal form.
std::string requestKey(const v1::JobSpec& spec, const std::string& version);

}  // namespace lightwell::server
