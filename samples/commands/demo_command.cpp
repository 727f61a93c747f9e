#include <fmt/format.h>

#include "samples/commands/command.h"
#include "samples/commands/demo_calls.h"
#include "samples/commands/program.h"
#include "samples/output/held_folder.h"
#include "samples/output/interrupt.h"
#include "samples/output/output.h"
#include "samples/output/progress.h"
#include "sdf/error.h"
#include "sdf/output_file.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

void add_options(CLI::App& app, Options& options) {
  add_demo(app, options);
  add_output(app, options, "folder for index.html, pictures and reports; default limn-out/demo", false);
  add_no_timings(app, options);
  add_execution(app, options);
}

std::vector<std::string> whole_call(const DemoCall& call, const fs::path& folder, const Options& options) {
  std::vector<std::string> whole = {"limn"};
  for (const std::string& argument : call.arguments)
    whole.push_back(argument.starts_with("$OUT/") ? (folder / argument.substr(5)).string() : argument);
  for (std::string argument : {std::string("-q"), std::string("-o"), (folder / call.output).string(), std::string("--threads"),
                               std::to_string(options.spec.threads)})
    whole.push_back(std::move(argument));
  if (options.no_clobber) whole.emplace_back("--no-clobber");
  if (options.no_timings && call.arguments.front() == "compare") whole.emplace_back("--no-timings");
  return whole;
}

// A limit of the whole call holds for its parts, too: it is the process that is limited.
void draw(const DemoCall& call, const fs::path& folder, const Options& options) {
  if (interrupted()) throw Cancelled{};
  const std::vector<std::string> whole = whole_call(call, folder, options);
  std::vector<const char*> argv;
  argv.reserve(whole.size());
  for (const std::string& argument : whole) argv.push_back(argument.c_str());
  if (run_program(static_cast<int>(argv.size()), argv.data()) != 0) throw MachineError("the demo stopped at: " + shell_text(call));
}

int run(const Options& options) {
  ProgressBar bar(wants_progress(options.quiet, options.no_progress));
  const fs::path folder = options.outputs.empty() ? fs::path("limn-out/demo") : options.outputs.back();
  check_output_folder(folder, options.no_clobber);
  const HeldFolder held(folder);
  const fs::path page = folder / "index.html";
  check_output_file(page, options.no_clobber, {".html"});

  const auto& size = options.spec.camera.size_px;
  write_whole(folder / "still_life.toml", still_life_text());
  const std::vector<DemoCall> calls = demo_calls(size ? fmt::format("{}x{}", size->x, size->y) : std::string());
  std::string section;
  for (size_t i = 0; i < calls.size(); ++i) {
    if (calls[i].section != section && !options.quiet) {
      section = calls[i].section;
      bar.clear();
      print_text("Drawing: " + section + "\n");
    }
    if (const auto progress = bar.stage(calls[i].caption)) progress(static_cast<double>(i) / static_cast<double>(calls.size()));
    draw(calls[i], folder, options);
  }
  bar.clear();
  // Last: a page that is there shows pictures that are there.
  write_whole(page, demo_page(calls));
  if (!options.quiet) print_text(page.string() + "\n");
  return 0;
}

}  // namespace

Command demo_command() {
  return {"demo", "draws a gallery, draws and compares the built-in scenes, and writes a page that leads to all of it",
          "  limn demo\n  limn demo -o tour", add_options, run};
}

}  // namespace limn
