#include <fmt/format.h>

#include "samples/commands/command.h"
#include "samples/commands/common.h"
#include "samples/commands/options_parts.h"
#include "samples/experiment/no_effect.h"
#include "samples/experiment/thread_settings.h"
#include "samples/plan/plan_job.h"
#include "samples/spec/flags.h"
#include "sdf/error.h"

namespace limn {
namespace {

void add_options(CLI::App& app, Options& options) {
  add_input(app, options);
  add_plan(app, options);
  add_camera(app, options, true);
  add_surface(app, options, {.surface = true, .repeatable = true, .swept = true});
  add_switch(app, {"--local", "", "try models that are fine where the border of these views runs and coarse elsewhere, too", kSurface},
             options.local.asked);
  add_methods(app, options);
  add_json(app, options);
  add_reference(app, options);
  add_execution(app, options);
}

[[noreturn]] void refuse(const std::string& option, const std::string& why) {
  throw InputError({"", option, "", "has no effect: " + why, ""});
}

// A plan measures silhouettes and the level curves of N.V that `rim` inks; it reads that method's threshold and draws nothing.
void refuse_unread(const Options& options, const SceneInput& input) {
  for (const std::string& method : options.spec.border.methods) {
    if (method != "rim") refuse("--method " + method, "a plan measures the border of rim; leave it out");
  }
  for (const ParameterSetting& set : options.spec.border.parameters) {
    if (set.key != "threshold" && set.key != "rim.threshold")
      refuse("--set " + set.key, "a plan reads no parameter but rim's threshold; leave it out");
    if (options.plan.silhouette) refuse("--set " + set.key, "a silhouette has no threshold; leave it out, or --metric silhouette");
  }
  refuse_eye_of_views(options.spec.camera, options.spec.views);
  refuse_unplanned(options.spec, input);
}

int run(const Options& options) {
  const ThreadLimit threads(options.spec.threads);
  ProgressBar bar(wants_progress(options.quiet, options.no_progress));
  if (!options.plan.tolerance_px) throw InputError({"", "--tolerance", "", "missing", "a number of pixels, such as --tolerance 0.5"});
  input_kind(options.spec.input);
  const SceneInput input = load(options);
  refuse_unread(options, input);
  WarningNeeds needs{.surfaces = options.spec.surfaces, .methods = {"rim"}};
  if (needs.surfaces.empty()) {
    for (const SurfaceDescriptor& kind : surface_kinds()) needs.surfaces.push_back(kind.about.name);
  }
  const std::vector<std::string> warnings = warn_of_input(options, input.scene, {}, needs);
  const PlanJob job = plan_for(options.spec, options.plan, input, bar, options.local.asked);
  if (options.json) {
    Json document = plan_json(job);
    document["warnings"] = warnings;
    print_json(document);
  } else if (!options.quiet) {
    std::string text;
    for (const std::string& sentence : plan_sentences(job.answer, job.settings)) text += in_flags(sentence) + "\n";
    print_text(text);
  }
  if (!job.answer.doubt.empty())
    print_warnings(options, {fmt::format("no model can be called right to {} px: {}", job.settings.tolerance_px, job.answer.doubt)});
  return job.answer.chosen && job.answer.doubt.empty() ? 0 : 1;
}

}  // namespace

Command plan_command() {
  return {"plan", "finds the cheapest model whose border is right to a tolerance: the least that will do",
          "  limn plan teacup --tolerance 0.5\n"
          "  limn plan gyroid --tolerance 1 --metric silhouette --views 4 --budget 64M",
          add_options, run};
}

}  // namespace limn
