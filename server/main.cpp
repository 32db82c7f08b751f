// lightwelld: the bake service.
#include <pthread.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <thread>

#include "server/daemon.h"
#include "server/store/sqlite.h"

namespace lightwell::server {
namespace {

constexpr unsigned kShutdownLimit_s = 5;
constexpr rlim_t kDescriptors = 65536;

int run(int argc, char** argv) {
  // Before any thread is made: all of them leave these signals to sigwait().
  sigset_t ending;
  sigemptyset(&ending);
  for (const int number : {SIGTERM, SIGINT, SIGHUP}) sigaddset(&ending, number);
  pthread_sigmask(SIG_BLOCK, &ending, nullptr);
  signal(SIGPIPE, SIG_IGN);
  // Every connection is a descriptor.
  rlimit files{};
  getrlimit(RLIMIT_NOFILE, &files);
  files.rlim_cur = std::min<rlim_t>(files.rlim_max, kDescriptors);
  setrlimit(RLIMIT_NOFILE, &files);
  try {
    const auto options = parseOptions(argc, argv, LIGHTWELL_VERSION);
    if (!options) return 0;
    const Log log(options->log_level, options->log_json);
    Daemon daemon(*options, log);
    int number = 0;
    sigwait(&ending, &number);
    log(LogLevel::info, "ending", {{"signal", std::to_string(number)}});
    alarm(kShutdownLimit_s);  // everything of value is on disk at any time: rather end hard than late
    return 0;
  } catch (const UsageError& error) {
    std::fprintf(stderr, "lightwelld: %s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "lightwelld: %s\n", error.what());
    return 1;
  }
}

}  // namespace
}  // namespace lightwell::server

int main(int argc, char** argv) { return lightwell::server::run(argc, argv); }
