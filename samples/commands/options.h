#pragma once
// The options that commands have in common. Each command adds the groups that mean something to it and no others.

#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "raymarch/frames.h"
#include "samples/compare/compare_limits.h"
#include "samples/judge/drawing_file.h"
#include "samples/judge/judge_report.h"
#include "samples/lines/drawing.h"
#include "samples/spec/spec.h"

namespace CLI {
class App;
}

namespace limn {

/// How `limn study` shares out its cells and starts, and what `limn merge` joins.
struct StudyRunOptions {
  bool fresh = false;                          ///< What an earlier study left in the folder goes.
  int shard = 1, shards = 1;                   ///< Part `shard` of `shards`, from 1.
  std::vector<std::filesystem::path> parts{};  ///< Folders to merge.
};

/// A model that is fine where the border of the call's pictures runs and coarse elsewhere.
struct LocalOptions {
  bool asked = false;
  std::optional<double> tolerance_px{};  ///< Unset: a plan chooses it.
};

struct StabilityOptions {
  std::vector<std::string> cases{};     ///< Names or files; empty: all.
  std::optional<std::uint64_t> seed{};  ///< Of random parameters.
  std::optional<int> draws{};           ///< Of them, for each case.
};

/// What `limn info` prints of what limn computes with, in place of its report.
struct DumpOptions {
  std::string what{};          ///< program, tape or bricks; empty: the report.
  std::optional<int> brick{};  ///< The values of this one in place of the list.
};

/// What `limn contours` draws.
struct LineOptions {
  LineSettings lines{};
  DrawingSettings drawing{.style = built_in_style("plain")};
  bool hidden = false;
  std::optional<std::pair<int, int>> layers{};  ///< In front of what is drawn.
  bool strict = false;                          ///< Conflicts of the certificate, and changes that nothing explains, are a failure.
  std::optional<double> turn_deg{};             ///< Over all frames, about the target; unset: the camera wanders.
  bool animate = false;                         ///< One SVG of all frames.
  double frames_per_second = 24.0;              ///< Of that.
};

/// What `limn judge` compares, and what it lets pass.
struct JudgeOptions {
  std::filesystem::path drawing{}, junit{};
  LineSettings lines{};
  JudgeSettings settings{};
  JudgeLimits limits{};
  InkChoice ink{};
};

/// The command line as given: what it asks of the experiment, and where the answer goes.
struct Options {
  ExperimentSpec spec{};
  SweepSpec sweep{};
  PlanSpec plan{};
  LocalOptions local{};
  bool metric_given = false;  ///< --metric, whatever its value.
  StabilityOptions stability{};
  StudyRunOptions study{};
  FramePath frames{.frames = 1};  ///< `limn render` and `limn contours`.
  int turntable = 0;              ///< `limn render` only: frames of one turn; 0: none.
  bool samples_given = false;     ///< --samples is on the command line.
  bool animate = false;           ///< `limn render` only: all frames in one picture.
  bool transparent = false;       ///< `limn render` only: no ground behind pictures.
  bool ink_only = false;          ///< `limn render` only: nothing but the ink.
  bool refined = false;           ///< `limn export` only: refined instead of limit positions.
  std::string kind{};             ///< `limn list`: of what; `limn completion`: for which shell; `limn man`: of which command.
  DumpOptions dump{};             ///< `limn info` only.
  LineOptions lines{};            ///< `limn contours` only.
  JudgeOptions judge{};           ///< `limn judge` only.
  CompareLimits compare{};        ///< `limn compare` only.

  std::vector<std::filesystem::path> outputs{};
  bool no_clobber = false;
  bool no_timings = false;
  bool json = false;
  bool quiet = false;
  bool verbose = false;
  bool no_progress = false;
};

struct SurfaceOptionNeeds {
  bool surface = true;      ///< --surface
  bool repeatable = false;  ///< --surface may be given several times.
  bool views = false;       ///< --level auto: there are pictures to refine for.
  bool swept = false;       ///< Resolution, normals and gradients are axes (add_study), not settings.
};

void add_input(CLI::App& app, Options& options);
void add_output(CLI::App& app, Options& options, const std::string& what, bool repeatable);
/// What `limn list` lists.
void add_kind(CLI::App& app, Options& options);
/// What `limn completion` and `limn man` write.
void add_shell(CLI::App& app, Options& options);
void add_command_name(CLI::App& app, Options& options);
/// --no-timings
void add_no_timings(CLI::App& app, Options& options);
/// --refined
void add_refined(CLI::App& app, Options& options);
/// --reference
void add_reference(CLI::App& app, Options& options);
void add_json(CLI::App& app, Options& options);
/// --dump and --brick; excludes --json, which is added before.
void add_dump(CLI::App& app, Options& options);
void add_camera(CLI::App& app, Options& options, bool with_views, const std::string& default_size = "1280x720");
/// --frames, with this help, --path-step and --seed; excludes --views.
void add_frames(CLI::App& app, Options& options, const char* help);
/// --turntable; excludes --views and --frames, which are added before.
void add_turntable(CLI::App& app, Options& options);
/// These, --turn, --animate and --fps.
void add_line_frames(CLI::App& app, Options& options);
void add_surface(CLI::App& app, Options& options, const SurfaceOptionNeeds& needs);
void add_grid(CLI::App& app, Options& options);
void add_border(CLI::App& app, Options& options, bool compared = false);
/// --look, --shading, --ink-only, --transparent; of `limn render`, whose --samples and --background they go with.
void add_look(CLI::App& app, Options& options);
/// --threads, --quiet and so on, with add_limits.
void add_execution(CLI::App& app, Options& options);
/// --max-memory and --max-time.
void add_limits(CLI::App& app, Options& options);
/// What `limn study` sweeps, how it is shared out and where it starts again; the folders of `limn merge`.
void add_study(CLI::App& app, Options& options);
void add_parts(CLI::App& app, Options& options);
/// Which cases `limn stability` runs, with what random parameters, on which surfaces.
void add_stability(CLI::App& app, Options& options);
/// What the lines are those of: the surface itself, or a model of it (--surface), read by --scheme and --grid.
void add_line_surface(CLI::App& app, Options& options);
/// Which lines `limn contours` draws, and how.
void add_lines(CLI::App& app, Options& options);
/// DRAWING and --against, what of them is compared, and the limits.
void add_judge(CLI::App& app, Options& options);
/// --size of every picture of `limn demo`.
void add_demo(CLI::App& app, Options& options);
/// What `limn compare` lets pass.
void add_compare_limits(CLI::App& app, Options& options);
/// --tolerance, --metric and --budget.
void add_plan(CLI::App& app, Options& options);
/// --local; `metric`: --metric too, which add_plan has itself.
void add_local(CLI::App& app, Options& options, bool metric);

}  // namespace limn
