#pragma once
// A subcommand is one file here and one line in commands/all_commands.cpp.

#include <span>

#include "samples/commands/options.h"

namespace limn {

struct Command {
  const char* name;
  const char* help;      ///< One line.
  const char* examples;  ///< One or more whole calls, each on a line of its own.
  void (*add_options)(CLI::App& app, Options& options);
  /// The exit code: 0 done, 1 it ran and the answer is bad. Throws InputError, MachineError, Cancelled.
  int (*run)(const Options& options);
  /// It catches std::bad_alloc, records what did not fit, and goes on; otherwise the program ends where memory runs out.
  bool goes_on_without_memory = false;
};

std::span<const Command> commands();

}  // namespace limn
