#pragma once

#include <string>

namespace limn {

/// SIGINT, SIGTERM and SIGHUP ask running work to stop (ExecutionSettings::cancelled polls `interrupted`). Work that does not listen within
/// a second, and whoever asks twice, is stopped at once: temporary files go, the exit code is 128 + the signal's number. A SIGHUP that the
/// caller wants ignored (nohup) stays ignored.
void install_interrupt_handlers();

/// Stops the program `after_ms` milliseconds from now as a signal would, with exit code 1 and `line` on stderr.
void stop_after(double after_ms, const std::string& line);
/// From now on the program ends at once when memory runs out, wherever that is: temporary files go, `line` on stderr, exit code 1. What is
/// kept for the next picture is given up first.
void end_when_out_of_memory(const std::string& line);
/// From now on std::bad_alloc is thrown when memory runs out only after what is kept for the next picture has been given up.
void go_on_when_out_of_memory();

bool interrupted();
/// 130 after SIGINT, 143 after SIGTERM, 129 after SIGHUP, 0 otherwise.
int interrupt_exit_code();

}  // namespace limn
