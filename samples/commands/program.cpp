#include "samples/commands/program.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "samples/commands/command.h"
#include "samples/commands/versions.h"
#include "samples/experiment/limits.h"
#include "samples/output/output.h"
#include "samples/spec/flags.h"
#include "sdf/size_error.h"

namespace limn {
namespace {

constexpr const char* kAbout = "limn draws the border of implicit surfaces and says how far that border can be trusted.";
constexpr const char* kFooter =
    "limn COMMAND --help explains a command; limn list KIND names what there is to choose from.\n"
    "Exit codes: 0 done; 1 it ran and the answer is bad; 2 the call or an input file is wrong; 130 interrupted.";

void print(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
    throw MachineError("cannot write to standard output");
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.emplace_back("--" + name);
    for (const std::string& name : option->get_snames()) names.emplace_back("-" + name);
  }
  return names;
}

std::vector<std::string> command_names() {
  std::vector<std::string> names;
  for (const Command& command : commands()) names.emplace_back(command.name);
  return names;
}

// What stands on the command line and nobody takes: a misspelt command, a misspelt option or a second input.
[[noreturn]] void refuse_extra(const CLI::App& app, const std::string& extra) {
  const auto chosen = app.get_subcommands();
  if (extra.starts_with("-") && extra.size() > 1) {
    const std::string name = extra.substr(0, extra.find('='));
    const std::vector<std::string> known = option_names(chosen.empty() ? app : *chosen.front());
    const std::string near = nearest_name(name, known);
    const std::string command = chosen.empty() ? std::string() : chosen.front()->get_name() + " ";
    throw InputError({"", name, "",
                      "unknown option" + (near.empty() ? "" : "; did you mean '" + near + "'?") + " (limn " + command + "--help lists all)",
                      ""});
  }
  if (chosen.empty()) throw InputError({"", extra, "", "unknown command", known_names(extra, command_names())});
  const CLI::App& command = *chosen.front();
  const auto positional = command.get_options([](const CLI::Option* option) { return option->get_positional(); });
  LIMN_CHECK(!positional.empty());
  throw InputError(
      {"", extra, "", "unexpected argument; limn " + command.get_name() + " takes one " + positional.front()->get_single_name(), ""});
}

// CLI11's own complaints that are left: missing values, missing arguments, options that exclude each other.
[[noreturn]] void refuse(const CLI::App& app, const CLI::ParseError& error) {
  const auto chosen = app.get_subcommands();
  const std::string command = chosen.empty() ? std::string() : chosen.front()->get_name() + " ";
  throw InputError({"", "", "", std::string(error.what()) + " (limn " + command + "--help shows the usage)", ""});
}

// What is refused deep down, where nobody knows of files, is said of the file that was given.
int run_on_input(const Command& command, const Options& options) {
  try {
    return command.run(options);
  } catch (const InputError& error) {
    InputFault fault = error.fault();
    // Whose limit it is nobody below knows.
    const bool too_large = options.spec.limits.max_memory && dynamic_cast<const SizeError*>(&error) != nullptr;
    if (too_large) fault.problem += "; max_memory allows " + bytes_text(static_cast<double>(*options.spec.limits.max_memory)) + " in all";
    std::error_code ignored;
    const bool of_call = !fault.file.empty() || is_of_specification(fault);
    if (too_large && of_call) throw InputError(fault);
    if (of_call || options.spec.input.empty() || !std::filesystem::is_regular_file(options.spec.input, ignored)) throw;
    fault.file = options.spec.input;
    throw InputError(fault);
  }
}

}  // namespace

int run_program(int argc, const char* const* argv) {
  CLI::App app(kAbout, "limn");
  app.footer(kFooter);
  app.get_formatter()->column_width(34);
  app.set_version_flag("--version", version_text());
  app.require_subcommand(0, 1);
  app.allow_extras();

  Options options;
  for (const Command& command : commands()) {
    CLI::App* sub = app.add_subcommand(command.name, command.help);
    sub->footer(std::string("For example:\n") + command.examples);
    sub->allow_extras();
    command.add_options(*sub, options);
  }

  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForVersion& version) {
    print(std::string(version.what()) + "\n");
    return 0;
  } catch (const CLI::Success&) {
    print(app.help());
    return 0;
  } catch (const CLI::ParseError& error) {
    if (const auto extras = app.remaining(true); !extras.empty()) refuse_extra(app, extras.front());
    refuse(app, error);
  }
  if (const auto extras = app.remaining(true); !extras.empty()) refuse_extra(app, extras.front());
  if (app.get_subcommands().empty()) {
    print(app.help());
    return 0;
  }
  const std::string name = app.get_subcommands().front()->get_name();
  for (const Command& command : commands()) {
    if (command.name != name) continue;
    hold_limits(options.spec.limits, command.goes_on_without_memory);
    const int code = run_on_input(command, options);
    if (std::fflush(stdout) != 0) throw MachineError("cannot write to standard output");
    return code;
  }
  return 2;
}

}  // namespace limn
