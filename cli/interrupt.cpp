#include "cli/interrupt.h"

#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>

#include "cli/exit_codes.h"

namespace lightwell::cli {
namespace {

constexpr auto kGrace = std::chrono::milliseconds(700);

sigset_t watchedSignals() {
  sigset_t set;
  sigemptyset(&set);
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGUSR1}) sigaddset(&set, number);  // SIGUSR1 wakes our own thread
  return set;
}

}  // namespace

Interrupt::Interrupt() {
  const sigset_t set = watchedSignals();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  thread_ = std::thread([this] { wait(); });
}

Interrupt::~Interrupt() {
  {
    std::lock_guard lock(mutex_);
    done_ = true;
  }
  ended_.notify_all();
  pthread_kill(thread_.native_handle(), SIGUSR1);
  thread_.join();
}

void Interrupt::wait() {
  const sigset_t set = watchedSignals();
  int number = 0;
  do {
    sigwait(&set, &number);
    std::lock_guard lock(mutex_);
    if (done_) return;
  } while (number == SIGUSR1);
  flag_.cancel();
  std::unique_lock lock(mutex_);
  if (ended_.wait_for(lock, kGrace, [this] { return done_; })) return;
  std::lock_guard no_output(output_);
  std::fputs("\ninterrupted\n", stderr);
  std::fflush(stderr);
  _exit(kInterrupted);
}

Interrupt::OutputGuard::OutputGuard(Interrupt& interrupt) : lock_(interrupt.output_) { interrupt.flag_.check(); }

}  // namespace lightwell::cli
