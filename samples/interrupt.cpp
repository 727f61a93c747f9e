#include "samples/interrupt.h"

#include <signal.h>
#include <unistd.h>

#include <atomic>

#include "sdf/output_file.h"

namespace limn {
namespace {

// A handler can reach nothing but namespace-scope state; this one number is all that is shared with it.
std::atomic<int> caught_signal{0};
static_assert(std::atomic<int>::is_always_lock_free);

constexpr unsigned kPatienceSeconds = 1;

void stop_now() {
  remove_temporary_files();
  _exit(128 + caught_signal.load());
}

void on_interrupt(int signal_number) {
  if (caught_signal.exchange(signal_number) != 0) stop_now();
  alarm(kPatienceSeconds);
}

void on_alarm(int) { stop_now(); }

}  // namespace

void install_interrupt_handlers() {
  struct sigaction action = {};
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  action.sa_handler = on_interrupt;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  struct sigaction hangup = {};
  sigaction(SIGHUP, nullptr, &hangup);
  if (hangup.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);
  action.sa_handler = on_alarm;
  sigaction(SIGALRM, &action, nullptr);
}

bool interrupted() { return caught_signal.load(std::memory_order_relaxed) != 0; }

int interrupt_exit_code() {
  const int signal_number = caught_signal.load();
  return signal_number == 0 ? 0 : 128 + signal_number;
}

}  // namespace limn
