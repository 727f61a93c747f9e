#pragma once

namespace limn {

/// SIGINT, SIGTERM and SIGHUP ask running work to stop (ExecutionSettings::cancelled polls `interrupted`). Work that does not listen within a
/// second, and whoever asks twice, is stopped at once: temporary files go, the exit code is 128 + the signal's number. A SIGHUP that the
/// caller wants ignored (nohup) stays ignored.
void install_interrupt_handlers();

bool interrupted();
/// 130 after SIGINT, 143 after SIGTERM, 129 after SIGHUP, 0 otherwise.
int interrupt_exit_code();

}  // namespace limn
