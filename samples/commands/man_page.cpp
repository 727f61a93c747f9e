// Man pages, in the macros man(7) as groff and mandoc read them.

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "samples/commands/call_description.h"
#include "sdf/version.h"

namespace limn {
namespace {

/// Of the last change to what the pages say beside the options. mandoc wants a date, and equal calls give equal bytes.
constexpr const char* kDate = "2026-11-24";

constexpr const char* kExitStatus =
    ".SH EXIT STATUS\n.TP\n0\ndone\n.TP\n1\nit ran and the answer is bad, or the machine failed\n.TP\n2\n"
    "the call or an input file is wrong\n.TP\n130\ninterrupted (143 by SIGTERM, 129 by SIGHUP)\n";

/// What roff prints as `c`. `typed`: in what a user types, whose signs must not be made typographic ones.
std::string roff(char c, bool typed) {
  if (c == '\\') return "\\e";
  if (!typed) return std::string(1, c);
  if (c == '-') return "\\-";
  if (c == '\'') return "\\(aq";
  if (c == '~') return "\\(ti";
  if (c == '^') return "\\(ha";
  return std::string(1, c);
}

std::string roff(const std::string& text, bool typed = false) {
  // A line that starts with one of these is a request.
  std::string out = text.starts_with('.') || text.starts_with('\'') ? "\\&" : "";
  for (const char c : text) out += roff(c, typed);
  return out;
}

std::string bold(const std::string& text) { return "\\fB" + roff(text, true) + "\\fR"; }
std::string italic(const std::string& text) { return "\\fI" + roff(text, true) + "\\fR"; }

std::string entry(const OptionDescription& option, bool is_argument) {
  std::string head;
  for (const std::string& flag : option.flags) {
    if (!head.empty()) head += ", ";
    head += is_argument ? italic(flag) : bold(flag);
  }
  if (!option.value.empty()) head += " " + italic(option.value);
  return ".TP\n" + head + "\n" + roff(option.help) + "\n";
}

std::string options_by_group(const std::vector<OptionDescription>& options) {
  std::vector<std::string> groups;
  for (const OptionDescription& option : options) {
    if (std::find(groups.begin(), groups.end(), option.group) == groups.end()) groups.push_back(option.group);
  }
  std::string text;
  for (const std::string& group : groups) {
    if (group != "Options") text += fmt::format(".SS \"{}\"\n", roff(group));
    for (const OptionDescription& option : options) text += option.group == group ? entry(option, false) : std::string();
  }
  return text;
}

std::string title(const std::string& name) {
  std::string upper = name;
  for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return fmt::format(".TH {} 1 \"{}\" \"limn {}\" \"limn manual\"\n.SH NAME\n", roff(upper, true), kDate, kVersion);
}

std::string calls(const std::string& examples) {
  std::string text = ".SH EXAMPLES\n.nf\n", line;
  for (const char c : examples + "\n") {
    if (c != '\n') {
      line += c;
      continue;
    }
    if (const size_t start = line.find_first_not_of(' '); start != std::string::npos) text += roff(line.substr(start), true) + "\n";
    line.clear();
  }
  return text + ".fi\n";
}

std::string synopsis(const CommandDescription& command) {
  std::string text = bold("limn " + command.name) + " [" + italic("OPTION") + "]...";
  for (const OptionDescription& option : command.options) {
    if (option.required) text += " " + bold(option.flags.back()) + " " + italic(option.value);
  }
  for (const OptionDescription& argument : command.arguments)
    text += argument.required ? " " + italic(argument.flags.front()) : " [" + italic(argument.flags.front()) + "]";
  return text + "\n";
}

std::string page_of(const CommandDescription& command) {
  std::string text = title("limn-" + command.name) + roff("limn-" + command.name, true) + " \\- " + roff(command.help) + "\n";
  text += ".SH SYNOPSIS\n" + synopsis(command);
  text += ".SH DESCRIPTION\n" + bold("limn " + command.name) + " " + roff(command.help) + ".\n";
  for (const OptionDescription& argument : command.arguments) text += entry(argument, true);
  text += ".SH OPTIONS\n" + options_by_group(command.options);
  return text + kExitStatus + calls(command.examples) + ".SH SEE ALSO\n.BR limn (1)\n";
}

std::string page_of_all(const std::vector<CommandDescription>& commands) {
  std::string text = title("limn") + "limn \\- draws the border of implicit surfaces and says how far that border can be trusted\n";
  text += ".SH SYNOPSIS\n" + bold("limn") + " " + italic("COMMAND") + " [" + italic("OPTION") + "]... [" + italic("INPUT") + "]\n";
  text +=
      ".SH DESCRIPTION\n"
      "limn renders a surface in every representation (a formula, a grid of distances, a subdivision cage, triangles) with one ray "
      "marcher,\n"
      "draws its outline by any of a dozen methods, and measures each result against the border of the smooth surface.\n"
      ".SH COMMANDS\n";
  for (const CommandDescription& command : commands) text += ".TP\n" + bold(command.name) + "\n" + roff(command.help) + "\n";
  text += ".SH OPTIONS\n";
  for (const OptionDescription& option : program_options()) text += entry(option, false);
  text += kExitStatus;
  text += ".SH ENVIRONMENT\n.TP\n.B LIMN_HELPERS\nfolder of the helper programs and modules, where they are not where limn was installed\n";
  text += calls("limn demo\nlimn render teacup -o teacup.png\nlimn compare machined_part");
  text += ".SH SEE ALSO\n";
  for (size_t i = 0; i < commands.size(); ++i)
    text += fmt::format(".BR {} (1){}\n", roff("limn-" + commands[i].name, true), i + 1 < commands.size() ? "," : "");
  return text;
}

}  // namespace

std::string man_page(const std::vector<CommandDescription>& commands, const CommandDescription* command) {
  return command == nullptr ? page_of_all(commands) : page_of(*command);
}

}  // namespace limn
