// How a command ends; docs/cli.md lists them.
#pragma once

namespace lightwell::cli {

enum ExitCode : int {
  kDone = 0,
  kBug = 1,             // an error of this program
  kUsage = 2,           // options that cannot be meant, or a place that cannot be written
  kInputRejected = 3,
  kContainerBad = 4,    // damaged, or too new
  kServerFailed = 5,
  kInterrupted = 130,
};

}  // namespace lightwell::cli
