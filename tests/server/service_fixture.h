// A folder, a daemon, and small scenes.
#pragma once
#include <gtest/gtest.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "server/store/sha256.h"
#include "tests/cli/process.h"
#include "tests/cli/scenes.h"
#include "tests/server/daemon_process.h"

namespace lightwell::test {

class ServiceTest : public FolderTest {
 protected:
  static std::string digest(const std::string& bytes) { return server::sha256(bytes); }
  void startDaemon(std::vector<std::string> more = {}, bool test_worker = false) {
    daemon_ = std::make_unique<DaemonProcess>(folder_ / "data", std::move(more), test_worker);
  }
  void TearDown() override {
    daemon_.reset();
  }
  /// A room in a file of that name; `albedo` makes rooms differ.
  std::string scene(const std::string& name, double albedo = 0.5) const {
    writeFile(path(name), roomGltf({.albedo = albedo, .lamp_candela = 10}));
    return path(name);
  }
  /// `lightwell COMMAND … --server …`
  Finished client(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin() + 1, {"--server", daemon_->address()});
    return lightwell(arguments);
  }
  std::vector<std::string> submitArguments(const std::string& scene_file, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"submit", "--server", daemon_->address(), scene_file, "--lightmap-size", "24", "--quality", "draft"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  /// Submits without waiting; the job's id.
  std::string submit(const std::string& scene_file, const std::vector<std::string>& more = {}) const {
    return submitted(submitArguments(scene_file, more));
  }
  /// The same with these options of a bake alone.
  std::string submitAs(const std::string& scene_file, const std::vector<std::string>& bake_options) const {
    std::vector<std::string> words{"submit", "--server", daemon_->address(), scene_file};
    words.insert(words.end(), bake_options.begin(), bake_options.end());
    return submitted(std::move(words));
  }
  std::string submitted(std::vector<std::string> words) const {
    words.push_back("--json");
    const Finished finished = lightwell(words);
    EXPECT_EQ(finished.exit_code, 0) << finished.err;
    const auto document = nlohmann::json::parse(finished.out, nullptr, false);
    return document.is_object() ? document.value("job", "") : "";
  }
  nlohmann::json watch(const std::string& job) const {
    return nlohmann::json::parse(client({"watch", job, "--json"}).out, nullptr, false);
  }
  /// The SHA-256 of the container that lightwell bake makes of the same.
  std::string bake(const std::string& scene_file, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> options{"--lightmap-size", "24", "--quality", "draft"};
    options.insert(options.end(), more.begin(), more.end());
    return bakeAs(scene_file, options);
  }
  std::string bakeAs(const std::string& scene_file, const std::vector<std::string>& options) const {
    std::vector<std::string> words{"bake", scene_file, "-o", path("plain.lwc")};
    words.insert(words.end(), options.begin(), options.end());
    EXPECT_EQ(lightwell(words).exit_code, 0);
    return digest(readFile(path("plain.lwc")));
  }
  std::unique_ptr<DaemonProcess> daemon_;
};

/// A number from the environment, for the long forms of tests.
inline int scaled(const char* variable, int short_form) {
  const char* text = std::getenv(variable);
  return text ? std::atoi(text) : short_form;
}

}  // namespace lightwell::test
