// Running the built command as a user does.
#pragma once
#include <gtest/gtest.h>
#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.h"

namespace lightwell::test {

struct Finished {
  int exit_code = -1;  // -1: killed by a signal
  std::string out, err;
};

/// `lightwell ARGUMENTS…`, waited for.
Finished lightwell(const std::vector<std::string>& arguments);

/// The same started in the background, to be signalled.
class Background {
 public:
  explicit Background(const std::vector<std::string>& arguments);
  ~Background();  // kills it if it still runs
  /// What stands on stderr so far.
  std::string errors() const;
  /// Waits until `condition` holds or the program ends; false when neither happens within a minute.
  bool waitFor(const std::function<bool()>& condition);
  void signal(int number);
  Finished wait();

 private:
  TemporaryFolder folder_;
  pid_t pid_ = -1;
};

std::string readFile(const std::filesystem::path& file);
void writeFile(const std::filesystem::path& file, const std::string& content);

/// A test with a folder of its own.
class FolderTest : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  /// Names of all files and folders in it, sorted.
  std::vector<std::string> listing() const;

 private:
  TemporaryFolder temporary_;

 protected:
  const std::filesystem::path folder_ = temporary_.path();
};

}  // namespace lightwell::test
