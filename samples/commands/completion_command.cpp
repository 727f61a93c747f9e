#include "samples/commands/call_description.h"
#include "samples/commands/command.h"
#include "samples/output/output.h"

namespace limn {
namespace {

int run(const Options& options) {
  print_text(completion_script(describe_commands(), options.kind));
  return 0;
}

}  // namespace

Command completion_command() {
  return {"completion", "prints a script that completes commands, options and names in bash, zsh or fish",
          "  source <(limn completion bash)\n  limn completion fish > ~/.config/fish/completions/limn.fish", add_shell, run};
}

}  // namespace limn
