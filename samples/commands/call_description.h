#pragma once
// The command line as data, read from what the commands declare: man pages and completion are made of it.

#include <string>
#include <vector>

namespace limn {

struct OptionDescription {
  std::vector<std::string> flags{};  ///< "-o", "--output"; of an argument its name, "INPUT".
  std::string value{};               ///< What stands behind it: "WxH"; empty: a switch, or an argument.
  std::string help{};
  std::string group{};                 ///< Heading in the help: "Camera".
  bool required = false;               ///< The call is wrong without it.
  std::vector<std::string> choices{};  ///< Values known beforehand, of the registries or of `value`.
  bool is_list = false;                ///< Several of them, separated by commas.
  bool takes_file = false;             ///< A path, too.
};

struct CommandDescription {
  std::string name{}, help{};
  std::string examples{};                      ///< Calls, a line each.
  std::vector<OptionDescription> arguments{};  ///< Without flags, in order.
  std::vector<OptionDescription> options{};    ///< In the order of the help.
};

/// Every command with all that its help shows.
std::vector<CommandDescription> describe_commands();
/// Of the program itself: --help and --version.
std::vector<OptionDescription> program_options();

/// The page of a command in the macros man(7), or of the program where `command` is null.
std::string man_page(const std::vector<CommandDescription>& commands, const CommandDescription* command);

/// For `shell`: bash, zsh or fish. Throws InputError where it is another one.
std::string completion_script(const std::vector<CommandDescription>& commands, const std::string& shell);

}  // namespace limn
