#pragma once

namespace limn {

/// The whole program behind main: parses the call, runs the command, returns the exit code. Throws InputError, MachineError, Cancelled.
int run_program(int argc, const char* const* argv);

}  // namespace limn
