#include "server/rpc/requests.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "precompute/plan/plan.h"
#include "server/failure.h"
#include "server/store/sha256.h"

namespace lightwell::server {
namespace {

[[noreturn]] void refuse(const std::string& reason) { throw Failure(FailureId::invalid_request, reason); }

void checkText(const std::string& what, const std::string& text, size_t most) {
  if (text.size() > most) refuse(what + " has more than " + std::to_string(most) + " bytes");
  if (std::any_of(text.begin(), text.end(), [](char c) { return uint8_t(c) < 0x20 || c == 0x7f; }))
    refuse(what + " has control characters");
}

/// Names are never used as file names; but the importer compares them with what the scene asks for, which is in normal form.
void checkName(const std::string& name) {
  checkText("a file's name", name, kMaxNameBytes);
  const std::filesystem::path path(name);
  if (name.empty() || path.is_absolute() || path.lexically_normal().generic_string() != name || *path.begin() == ".." || path == ".")
    refuse("\"" + name + "\" is not a relative file name in normal form");
}

void checkAmount(const char* what, double value) {
  if (!std::isfinite(value) || value < 0) refuse(std::string(what) + " is negative or not a number");
}

}  // namespace

void checkSpec(v1::JobSpec& spec) {
  if (spec.files_size() == 0) refuse("a job needs at least one file");
  if (size_t(spec.files_size()) > kMostFilesPerJob) refuse("a job has at most " + std::to_string(kMostFilesPerJob) + " files");
  std::set<std::string> names;
  for (const auto& file : spec.files()) {
    checkName(file.name());
    if (!isSha256(file.sha256())) refuse("\"" + file.name() + "\": a SHA-256 has 64 lower-case hexadecimal digits");
    if (!names.insert(file.name()).second) refuse("\"" + file.name() + "\" is there twice");
  }
  if (spec.scene().empty() && spec.environment().empty()) refuse("a job needs a scene or an environment");
  for (const auto& [what, name] : {std::pair("scene", spec.scene()), {"lights", spec.lights()}, {"environment", spec.environment()}})
    if (!name.empty() && !names.contains(name)) refuse(std::string(what) + ": \"" + name + "\" is none of the files");
  checkAmount("time_limit_s", spec.time_limit_s());
  checkAmount("target_error", spec.target_error());
  checkAmount("limits.wall_s", spec.limits().wall_s());
  if (spec.priority() < -10 || spec.priority() > 10) refuse("priority lies outside -10 to 10");
  checkText("the label", spec.label(), kMaxLabelBytes);
  try {
    const plan::Settings settings = plan::settingsFromJson(spec.settings_json().empty() ? "{}" : spec.settings_json());
    plan::checkPrm(settings);
    plan::checkVirtualLights(settings);
    plan::checkEnvironment(settings);
    spec.set_settings_json(plan::canonicalJson(settings));
  } catch (const UsageError& error) {
    throw Failure(FailureId::invalid_settings, error.what());
  }
  std::sort(spec.mutable_files()->begin(), spec.mutable_files()->end(),
            [](const v1::SceneFile& a, const v1::SceneFile& b) { return a.name() < b.name(); });
}

std::string requestKey(const v1::JobSpec& spec, const std::string& version) {
  v1::JobSpec same = spec;
  same.clear_priority();
  same.clear_threads();
  same.clear_label();
  same.clear_limits();
  return sha256(version + '\n' + same.SerializeAsString());
}

}  // namespace lightwell::server
