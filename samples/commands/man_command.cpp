#include "samples/commands/call_description.h"
#include "samples/commands/command.h"
#include "samples/output/output.h"
#include "sdf/error.h"
#include "sdf/output_file.h"

namespace limn {
namespace {

void add_options(CLI::App& app, Options& options) {
  add_command_name(app, options);
  add_output(app, options, "folder for the pages of all commands, limn.1, limn-render.1 and so on; default: one page on stdout", false);
}

const CommandDescription& find_command(const std::vector<CommandDescription>& all, const std::string& name) {
  std::vector<std::string> known;
  for (const CommandDescription& one : all) {
    if (one.name == name) return one;
    known.push_back(one.name);
  }
  throw InputError({"", "COMMAND", name, "unknown command", known_names(name, known)});
}

int run(const Options& options) {
  const std::vector<CommandDescription> all = describe_commands();
  const CommandDescription* const chosen = options.kind.empty() ? nullptr : &find_command(all, options.kind);
  if (options.outputs.empty()) {
    print_text(man_page(all, chosen));
    return 0;
  }
  const std::filesystem::path folder = options.outputs.back();
  check_output_folder(folder, options.no_clobber);
  if (chosen == nullptr) write_whole(folder / "limn.1", man_page(all, nullptr));
  for (const CommandDescription& one : all) {
    if (chosen == nullptr || chosen == &one) write_whole(folder / ("limn-" + one.name + ".1"), man_page(all, &one));
  }
  return 0;
}

}  // namespace

Command man_command() {
  return {"man", "prints the manual page of limn or of one command, or writes all of them, for man(1)",
          "  limn man render | man -l -\n  limn man -o man1", add_options, run};
}

}  // namespace limn
