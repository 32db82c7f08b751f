// All parts of a running lightwelld, from its folder to its ports.
#pragma once
#include <memory>

#include "server/log.h"
#include "server/options.h"

namespace lightwell::server {

class Daemon {
 public:
  /// Serves when it returns. Throws UsageError for a folder that cannot be used (or is, by another lightwelld) and for ports that are taken,
  /// StoreError for a damaged store.
  Daemon(const Options& options, const Log& log);
  /// Ends all streams and workers, within a few seconds; what was running is queued again, on disk.
  ~Daemon();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace lightwell::server
