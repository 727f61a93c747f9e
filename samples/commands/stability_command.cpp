#include "samples/commands/command.h"
#include "samples/commands/stability_run.h"
#include "samples/experiment/thread_settings.h"

namespace limn {
namespace {

void add_options(CLI::App& app, Options& options) {
  add_stability(app, options);
  add_output(app, options, "folder for results.json, report.html, table.md and pictures; default limn-out/study/stability", false);
  add_json(app, options);
  add_execution(app, options);
}

int run(const Options& options) {
  const ThreadLimit threads(options.spec.threads);
  ProgressBar bar(wants_progress(options.quiet, options.no_progress));
  return study_stability(options, bar);
}

}  // namespace

Command stability_command() {
  return {"stability",
          "runs cases that are known to make outline methods fail: what holds, what is off by how much, as a page; exit code 1 where a "
          "method fails and nothing says so",
          "  limn stability\n"
          "  limn stability --case cube_faces --seed 7 --draws 20\n"
          "  limn stability --method sobel\n"
          "  limn stability --case mine.toml --surface mesh --json",
          add_options,
          run,
          true};
}

}  // namespace limn
