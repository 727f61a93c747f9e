#include "samples/commands/call_description.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>

#include "samples/commands/command.h"
#include "samples/commands/list_kinds.h"

namespace limn {
namespace {

bool is_word(const std::string& text) {
  return !text.empty() &&
         std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::islower(c) || std::isdigit(c) || c == '_'; });
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  size_t start = 0;
  for (size_t end = text.find(separator); end != std::string::npos; end = text.find(separator, start)) {
    parts.push_back(text.substr(start, end - start));
    start = end + 1;
  }
  parts.push_back(text.substr(start));
  return parts;
}

// "outline method (limn list methods)": the kind that the help sends its reader to.
std::string kind_in(const std::string& help) {
  const std::string marker = "(limn list ";
  const size_t start = help.find(marker);
  if (start == std::string::npos) return {};
  const size_t name = start + marker.size();
  return help.substr(name, help.find(')', name) - name);
}

// "catmark|loop", "NAME|FILE.css", "A,B,...|all": lower-case words are values, the others stand for one.
void read_value(const std::string& value, OptionDescription& option) {
  option.is_list = value.starts_with("A,B,") || value == "LIST";
  for (const std::string& part : split(value, '|')) {
    if (is_word(part)) option.choices.push_back(part);
    for (const char* const file : {"FILE", "OUT", "DIR", "DRAWING", "INPUT"}) option.takes_file |= part.starts_with(file);
  }
}

OptionDescription describe(const CLI::Option& option) {
  OptionDescription one;
  one.help = option.get_description();
  one.group = option.get_group();
  one.required = option.get_required();
  if (option.get_positional()) {
    one.flags = {option.get_single_name()};
    read_value(one.flags.front(), one);
  } else {
    for (const std::string& name : option.get_snames()) one.flags.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) one.flags.push_back("--" + name);
    if (option.get_items_expected() > 0) one.value = option.get_type_name();
    read_value(one.value, one);
  }
  const std::string name = one.flags.front();
  if (name == "KIND") one.choices = list_kinds();
  if (name == "SHELL") one.choices = {"bash", "zsh", "fish"};
  if (name == "COMMAND") {
    for (const Command& command : commands()) one.choices.emplace_back(command.name);
  }
  const std::string kind = name == "INPUT" || one.value == "INPUT" ? "scenes" : kind_in(one.help);
  for (std::string& value : names_of_kind(kind)) one.choices.push_back(std::move(value));
  return one;
}

CommandDescription describe(const Command& command) {
  CLI::App app(command.help, command.name);
  Options options;
  command.add_options(app, options);
  CommandDescription description{command.name, command.help, command.examples, {}, {}};
  // What is in no group is in no help.
  for (const CLI::Option* option : app.get_options([](const CLI::Option* one) { return !one->get_group().empty(); }))
    (option->get_positional() ? description.arguments : description.options).push_back(describe(*option));
  return description;
}

}  // namespace

std::vector<CommandDescription> describe_commands() {
  std::vector<CommandDescription> all;
  for (const Command& command : commands()) all.push_back(describe(command));
  return all;
}

std::vector<OptionDescription> program_options() {
  OptionDescription help, version;
  help.flags = {"-h", "--help"};
  help.help = "print the help and exit";
  version.flags = {"--version"};
  version.help = "print the versions of the program and of its libraries and exit";
  return {help, version};
}

}  // namespace limn
