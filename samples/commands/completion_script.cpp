// Completion for three shells, from one description of the command line.

#include <fmt/format.h>

#include "samples/commands/call_description.h"
#include "sdf/error.h"

namespace limn {
namespace {

using Commands = std::vector<CommandDescription>;

std::string joined(const std::vector<std::string>& words, const char* separator = " ") {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : separator) + word;
  return text;
}

/// `text` with a backslash before each of `signs`.
std::string escaped(const std::string& text, const std::string& signs) {
  std::string out;
  for (const char c : text) {
    if (signs.find(c) != std::string::npos) out += '\\';
    out += c;
  }
  return out;
}

/// In single quotes, as bash and zsh read them.
std::string in_quotes(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

/// The help up to its first semicolon: menus have one line for it.
std::string brief(const std::string& help) { return help.substr(0, help.find(';')); }

std::string choices_of(const CommandDescription& command) {
  return command.arguments.empty() ? std::string() : joined(command.arguments.front().choices);
}

bool takes_files(const CommandDescription& command) { return !command.arguments.empty() && command.arguments.front().takes_file; }

constexpr const char* kBashHead = R"(# bash completion of limn; printed by `limn completion bash`

_limn_files() {
  local file
  while IFS= read -r file; do COMPREPLY+=("$file"); done < <(compgen -f -- "$cur")
  compopt -o filenames 2>/dev/null
}

# The last of several names that commas separate.
_limn_list() {
  local before=
  [[ $cur == *,* ]] && before=${cur%,*},
  COMPREPLY=($(compgen -P "$before" -W "$1" -- "${cur##*,}"))
  compopt -o nospace 2>/dev/null
}

_limn() {
  local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD - 1]}
  COMPREPLY=()
  # bash takes --option=value for three words.
  if [[ $cur == = ]]; then cur=; elif [[ $prev == = ]]; then prev=${COMP_WORDS[COMP_CWORD - 2]}; fi
  if ((COMP_CWORD == 1)); then
)";

std::string bash_values(const CommandDescription& command) {
  std::string text;
  std::vector<std::string> free;
  for (const OptionDescription& option : command.options) {
    if (option.value.empty()) continue;
    if (option.choices.empty() && !option.takes_file) {
      free.insert(free.end(), option.flags.begin(), option.flags.end());
      continue;
    }
    std::string action;
    if (!option.choices.empty())
      action = option.is_list ? fmt::format("_limn_list '{}'; ", joined(option.choices))
                              : fmt::format("COMPREPLY=($(compgen -W '{}' -- \"$cur\")); ", joined(option.choices));
    if (option.takes_file) action += "_limn_files; ";
    text += fmt::format("        {}) {}return ;;\n", joined(option.flags, " | "), action);
  }
  // Numbers and the like: nothing to propose.
  if (!free.empty()) text += fmt::format("        {}) return ;;\n", joined(free, " | "));
  return text.empty() ? text : "      case $prev in\n" + text + "      esac\n";
}

std::string bash_script(const Commands& commands) {
  std::vector<std::string> first;
  for (const CommandDescription& command : commands) first.push_back(command.name);
  for (const OptionDescription& option : program_options()) first.insert(first.end(), option.flags.begin(), option.flags.end());
  std::string text = kBashHead;
  text += fmt::format(
      "    COMPREPLY=($(compgen -W '{}' -- \"$cur\"))\n    return\n  fi\n  local options='' names='' files=''\n  case ${{COMP_WORDS[1]}} "
      "in\n",
      joined(first));
  for (const CommandDescription& command : commands) {
    std::vector<std::string> flags;
    for (const OptionDescription& option : command.options) flags.insert(flags.end(), option.flags.begin(), option.flags.end());
    text += fmt::format("    {})\n{}      options='{}' names='{}' files={}\n      ;;\n", command.name, bash_values(command), joined(flags),
                        choices_of(command), takes_files(command) ? "yes" : "");
  }
  return text +
         "  esac\n"
         "  if [[ $cur == -* ]]; then\n    COMPREPLY=($(compgen -W \"$options\" -- \"$cur\"))\n    return\n  fi\n"
         "  COMPREPLY=($(compgen -W \"$names\" -- \"$cur\"))\n"
         "  [[ $files ]] && _limn_files\n  return 0\n}\n\ncomplete -F _limn limn\n";
}

std::string zsh_action(const OptionDescription& option) {
  if (option.choices.empty()) return option.takes_file ? "_files" : " ";
  const std::string names = joined(option.choices);
  if (option.is_list) return "_sequence compadd - " + names;
  return option.takes_file ? "{compadd " + names + "; _files}" : "(" + names + ")";
}

std::string zsh_option(const OptionDescription& option) {
  const std::string help = "[" + escaped(brief(option.help), "[]:\\") + "]";
  const std::string value = option.value.empty() ? "" : ":" + escaped(option.value, ":\\") + ":" + zsh_action(option);
  std::string text;
  for (const std::string& flag : option.flags) {
    // Values stand behind a long option's equals sign, too.
    const char* const joint = option.value.empty() ? "" : flag.starts_with("--") ? "=" : "+";
    text += fmt::format("        {} \\\n", in_quotes(fmt::format("*{}{}{}{}", flag, joint, help, value)));
  }
  return text;
}

std::string zsh_script(const Commands& commands) {
  std::string text = "#compdef limn\n# zsh completion of limn; printed by `limn completion zsh`\n\n_limn() {\n  local -a commands=(\n";
  for (const CommandDescription& command : commands)
    text += "    " + in_quotes(command.name + ":" + escaped(brief(command.help), ":\\")) + "\n";
  text += "  )\n  if ((CURRENT == 2)); then\n    _describe command commands\n    compadd -";
  for (const OptionDescription& option : program_options()) text += " " + joined(option.flags);
  text += "\n    return\n  fi\n  local command=$words[2]\n  shift words\n  ((CURRENT--))\n  case $command in\n";
  for (const CommandDescription& command : commands) {
    text += fmt::format("    {})\n      _arguments \\\n", command.name);
    for (const OptionDescription& option : command.options) text += zsh_option(option);
    std::string arguments = "*: : ";
    for (const OptionDescription& argument : command.arguments) arguments = "*:" + argument.flags.front() + ":" + zsh_action(argument);
    text += "        " + in_quotes(arguments) + "\n      ;;\n";
  }
  return text + "  esac\n}\n\nif [[ $funcstack[1] == _limn ]]; then _limn \"$@\"; else compdef _limn limn; fi\n";
}

std::string fish_flags(const OptionDescription& option) {
  std::string text;
  for (const std::string& flag : option.flags) text += flag.starts_with("--") ? " -l " + flag.substr(2) : " -s " + flag.substr(1);
  return text;
}

std::string fish_script(const Commands& commands) {
  const auto quote = [](const std::string& text) { return "'" + escaped(text, "'\\") + "'"; };
  std::string text = "# fish completion of limn; printed by `limn completion fish`\n";
  for (const OptionDescription& option : program_options())
    text += fmt::format("complete -c limn -n __fish_use_subcommand -f{} -d {}\n", fish_flags(option), quote(option.help));
  for (const CommandDescription& command : commands) {
    text += fmt::format("\ncomplete -c limn -n __fish_use_subcommand -f -a {} -d {}\n", command.name, quote(brief(command.help)));
    const std::string start = fmt::format("complete -c limn -n '__fish_seen_subcommand_from {}'", command.name);
    for (const OptionDescription& option : command.options) {
      text += start + fish_flags(option);
      if (!option.value.empty()) text += option.takes_file ? " -r -F" : " -x";
      // Several names, separated by commas.
      if (!option.choices.empty())
        text += " -a " + quote(option.is_list ? "(__fish_append , " + joined(option.choices) + ")" : joined(option.choices));
      text += fmt::format(" -d {}\n", quote(brief(option.help)));
    }
    text += start + (takes_files(command) ? " -F" : " -f");
    if (const std::string names = choices_of(command); !names.empty()) text += " -a " + quote(names);
    text += "\n";
  }
  return text;
}

}  // namespace

std::string completion_script(const Commands& commands, const std::string& shell) {
  if (shell == "bash") return bash_script(commands);
  if (shell == "zsh") return zsh_script(commands);
  if (shell == "fish") return fish_script(commands);
  throw InputError({"", "SHELL", shell, "there is no completion for it", known_names(shell, {"bash", "zsh", "fish"})});
}

}  // namespace limn
