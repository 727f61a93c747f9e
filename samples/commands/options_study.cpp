// What studies sweep, which cases of stability run, and what a plan may choose.

#include <CLI/CLI.hpp>
#include <tuple>

#include "raymarch/border.h"
#include "raymarch/surface.h"
#include "samples/commands/options_parts.h"
#include "samples/spec/parse.h"

namespace limn {
namespace {

constexpr const char* kSweep = "Sweep (a list: 2,4,6; a range: 2..6)";
constexpr const char* kStudy = "Study";
constexpr const char* kStability = "Cases";
constexpr const char* kHidden = "";  ///< In no help.
constexpr const char* kPlan = "Plan";

}  // namespace

void add_parts(CLI::App& app, Options& options) {
  app.add_option("DIR", options.study.parts, "folders that hold parts of one study: a part itself, or a folder of parts")
      ->type_name("")
      ->required();
}

void add_study(CLI::App& app, Options& options) {
  SweepSpec& sweep = options.sweep;
  StudyRunOptions& run = options.study;
  const auto level = [](const std::string& text) { return parse_integer("--levels", text, 0, 8); };
  add(app, {"--levels", "LIST", "refinements of a cage or a tessellation, 0..8; default 0..5, fewer where they would be large", kSweep},
      [&sweep, level](const std::string& text) { sweep.levels = parse_integers(text, level, [](int value) { return value + 1; }); });
  const auto voxels = [](const std::string& text) { return parse_integer("--voxels", text, 4, 8192); };
  add(app, {"--voxels", "LIST", "voxels along the longest side, 4..8192; a range doubles; default 16..256", kSweep},
      [&sweep, voxels](const std::string& text) { sweep.voxels = parse_integers(text, voxels, [](int value) { return 2 * value; }); });
  add(app, {"--normals", "LIST", "normals of meshes (limn list normals); default flat,vertex,limit, as far as there are any", kSweep},
      [&sweep](const std::string& text) {
        for (const std::string& name : parse_names(text)) add_unless_there(parse_normals(name, "", "--normals"), sweep.normals);
      });
  add(app, {"--gradients", "LIST", "gradients of level sets (limn list gradients); default all that the band is wide enough for", kSweep},
      [&sweep](const std::string& text) {
        for (const std::string& name : parse_names(text)) {
          find_gradient(name, "", "--gradients");
          add_unless_there(name, sweep.gradients);
        }
      });
  add(app, {"--methods", "A,B,...|all", "outline methods (limn list methods); default rim", kSweep},
      [&options](const std::string& text) { read_compared_methods(text, options); });
  add(app, {"--thresholds", "LIST", "of the rim, and of every other method that has a threshold; default the method's own", kSweep},
      [&sweep](const std::string& text) { sweep.thresholds = parse_thresholds("--thresholds", text); });
  add(app, {"--local", "LIST", "tolerances of local models for the study's views together, px, such as 1,0.5,0.25; default none", kSweep},
      [&sweep](const std::string& text) { sweep.local_px = parse_tolerances("--local", text); });
  add(app, {"--views", "N", "directions spread evenly on the sphere, 1..10000; 1: the camera's own; default 4", kSweep},
      [&sweep](const std::string& text) { sweep.views = parse_integer("--views", text, 1, 10'000); });
  add_repeatable(app, {"--set", "KEY=VALUE", "a parameter of the methods; METHOD.KEY=VALUE for one of several; repeatable", kSweep},
                 [&options](const std::string& text) { options.spec.border.parameters.push_back(parse_key_value("--set", text)); });
  add_switch(app,
             {"--flicker", "", "measure flicker too, under four moves of the camera by less than a pixel: five times the tracing", kStudy},
             sweep.flicker);
  add(app, {"--shard", "I/N", "do only part I of N, into OUT/part-I-of-N; limn merge joins the parts", kStudy},
      [&run](const std::string& text) { std::tie(run.shard, run.shards) = parse_shard("--shard", text); });
  add_switch(app, {"--fresh", "", "start over: what an earlier study left in the folder goes; default: go on where it stopped", kStudy},
             run.fresh);
  add_cases(app, options, kHidden);
}

void add_cases(CLI::App& app, Options& options, const char* group) {
  StabilityOptions& stability = options.stability;
  add_repeatable(app, {"--case", "NAME|FILE", "only this case, or one more from a file (.toml); repeatable", group},
                 [&stability](const std::string& text) { stability.cases.push_back(text); });
  add(app, {"--seed", "N", "where the cases' random parameters start; default 1", group}, [&stability](const std::string& text) {
    stability.seed = static_cast<std::uint64_t>(parse_integer("--seed", text, 0, 2'000'000'000));
  });
  add(app, {"--draws", "N", "draws of each case's random parameters, 1..10000; default: the case's own", group},
      [&stability](const std::string& text) { stability.draws = parse_integer("--draws", text, 1, 10'000); });
}

void add_stability(CLI::App& app, Options& options) {
  add_cases(app, options, kStability);
  add_repeatable(
      app,
      {"--method,--methods", "A,B,...", "only cells of these outline methods (limn list methods), repeatable; default: all", kStability},
      [&options](const std::string& text) { read_compared_methods(text, options); });
  add_compared_surfaces(app, options);
}

namespace {

CLI::Option* add_metric(CLI::App& app, Options& options) {
  return add(app,
             {"--metric", "border|silhouette",
              "what has to be right: border (the rim's ink, inside and outside) or silhouette; default border", kPlan},
             [&options](const std::string& text) {
               options.plan.silhouette = parse_plan_metric("--metric", text);
               options.metric_given = true;
             });
}

}  // namespace

void add_local(CLI::App& app, Options& options, bool metric) {
  CLI::Option* local =
      app.add_option_function<std::vector<std::string>>(
             "--local",
             [&options](const std::vector<std::string>& texts) {
               options.local.asked = true;
               if (!texts.empty() && !texts.back().empty())
                 options.local.tolerance_px = parse_number_above("--local", texts.back(), 0.0, false, "a number of pixels above 0");
             },
             "a mesh or level set that is fine where the border of these pictures runs and coarse elsewhere: the border within PX pixels")
          ->type_name("PX")
          ->group(kSurface)
          ->expected(0, 1);
  if (metric) add_metric(app, options)->needs(local);
}

void add_plan(CLI::App& app, Options& options) {
  PlanSpec& plan = options.plan;
  auto* tolerance =
      add(app,
          {"--tolerance", "PX",
           "how far the border may lie from the true one, pixels, above 0: 95 % of it lies within; picks the cheapest model", kPlan},
          [&plan](const std::string& text) {
            plan.tolerance_px = parse_number_above("--tolerance", text, 0.0, false, "a number of pixels above 0");
          });
  CLI::Option* metric = add_metric(app, options);
  // `limn render --local PX` reads it, too.
  if (!app.get_option_no_throw("--local")) metric->needs(tolerance);
  add_repeatable(
      app, {"--budget", "SIZE|TIME", "what the model may take: memory such as 64M, or time to build and trace such as 200ms or 2s", kPlan},
      [&plan](const std::string& text) {
        if (text.empty() || text.back() != 's')
          plan.budget_bytes = parse_bytes("--budget", text, kLeastBudget);
        else
          plan.budget_ms = parse_milliseconds("--budget", text);
      })
      ->needs(tolerance);
}

}  // namespace limn
