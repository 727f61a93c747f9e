#include "samples/output/interrupt.h"

#include <signal.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <new>

#include "sdf/large_pages.h"
#include "sdf/output_file.h"
#include "sdf/output_together.h"

namespace limn {
namespace {

// A handler can reach nothing but namespace-scope state, and may not allocate: what it is to do is all here.
std::atomic<int> caught_signal{0};
static_assert(std::atomic<int>::is_always_lock_free);
char time_line[256] = "", memory_line[256] = "";
std::atomic<bool> time_line_said{false}, out_of_memory{false};

constexpr unsigned kPatienceSeconds = 1;

void keep_line(const std::string& line, char (&kept)[256]) {
  const std::string whole = "limn: " + line.substr(0, sizeof kept - 8) + "\n";
  std::memcpy(kept, whole.c_str(), whole.size() + 1);
}

void say(const char* line) { [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, line, std::strlen(line)); }

void say_once(const char* line, std::atomic<bool>& said) {
  if (!said.exchange(true)) say(line);
}

// The alarm's own number stands for the end of the time.
int exit_code_of(int signal_number) { return signal_number == SIGALRM ? 1 : 128 + signal_number; }

void stop_now() {
  // Half of the files would be old ones.
  if (outputs_are_being_replaced()) {
    alarm(kPatienceSeconds);
    return;
  }
  remove_temporary_files();
  if (caught_signal.load() == SIGALRM) say_once(time_line, time_line_said);
  _exit(exit_code_of(caught_signal.load()));
}

void on_out_of_memory() {
  if (LargePages::release()) return;
  // Where memory ends, it ends for several threads at once: one says so and ends the program, and the others must not end it before.
  if (out_of_memory.exchange(true))
    for (;;) ::pause();
  say(memory_line);
  remove_temporary_files();
  _exit(1);
}

void on_interrupt(int signal_number) {
  if (caught_signal.exchange(signal_number) != 0) stop_now();
  alarm(kPatienceSeconds);
}

void on_alarm(int) {
  int none = 0;
  if (caught_signal.compare_exchange_strong(none, SIGALRM))
    alarm(kPatienceSeconds);
  else
    stop_now();
}

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

void stop_after(double after_ms, const std::string& line) {
  keep_line(line, time_line);
  const double seconds = std::min(1e8, std::max(1e-3, after_ms / 1e3));
  itimerval timer = {};
  timer.it_value.tv_sec = static_cast<time_t>(seconds);
  timer.it_value.tv_usec = static_cast<suseconds_t>(1e6 * (seconds - std::floor(seconds)));
  setitimer(ITIMER_REAL, &timer, nullptr);
}

void end_when_out_of_memory(const std::string& line) {
  keep_line(line, memory_line);
  LargePages::release();  // makes what it needs, which the handler must not have to
  std::set_new_handler(on_out_of_memory);
}

void go_on_when_out_of_memory() {
  LargePages::release();
  std::set_new_handler([] {
    if (!LargePages::release()) throw std::bad_alloc();
  });
}

bool interrupted() { return caught_signal.load(std::memory_order_relaxed) != 0; }

int interrupt_exit_code() {
  const int signal_number = caught_signal.load();
  if (signal_number == SIGALRM) say_once(time_line, time_line_said);
  return signal_number == 0 ? 0 : exit_code_of(signal_number);
}

}  // namespace limn
