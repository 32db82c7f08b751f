// A disk of a few megabytes that a daemon of its own sees in a folder, to be filled.
#pragma once
#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace lightwell::test {

/// A tmpfs in a mount namespace of its own; gone with it. Needs util-linux and either root or user namespaces.
class SmallDisk {
 public:
  /// `folder` exists.
  SmallDisk(const std::filesystem::path& folder, uint64_t bytes);
  ~SmallDisk();
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;

  /// Whether this machine let us make it.
  bool exists() const { return exists_; }
  /// What a command is started with to see the disk in its folder.
  std::vector<std::string> launcher() const;
  /// Writes a file that leaves at most `bytes` of room.
  void fill(uint64_t bytes = 0) const;
  void makeRoom() const;

 private:
  std::filesystem::path seenFromHere() const;
  const std::filesystem::path folder_;
  bool exists_ = false;
  pid_t holder_ = -1;
};

}  // namespace lightwell::test
