// What is finished, on disk after each measurement: a report that was interrupted goes on from there.
#pragma once
#include <filesystem>
#include <optional>

#include "cli/report/result.h"

namespace lightwell::report {

class Ledger {
 public:
  /// Reads FOLDER/finished.json, if it is of the same scene and settings (`key`) and not `fresh`; what cannot be read counts as nothing.
  Ledger(const std::filesystem::path& folder, std::string key, bool fresh);

  std::optional<Reference> reference;
  std::vector<SkyAnswer> sky, shadowed_sky;
  std::vector<LampAnswer> live_lamps;
  std::optional<RayRate> rays;
  /// A finished bake whose container and maps are still there; null without one.
  const Baked* find(const std::string& key) const;
  void add(const Baked& baked);
  /// Throws std::runtime_error naming the file.
  void save() const;

 private:
  std::filesystem::path folder_;
  std::string key_;
  std::vector<Baked> bakes_;
};

}  // namespace lightwell::report
