#pragma once
// The options that commands have in common. Each command adds the groups that mean something to it and no others.

#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "raymarch/frames.h"
#include "samples/parse.h"
#include "subdiv/refine.h"

namespace CLI {
class App;
}

namespace limn {

/// `limn study` and `limn merge` only: the axes of a sweep (empty: the study's own choice) and how it is run.
struct StudyOptions {
  std::vector<int> levels, voxels;  ///< Rising.
  std::vector<NormalKind> normals;
  std::vector<std::string> gradients;
  std::vector<double> thresholds;  ///< Of every method that has one; rising.
  std::optional<int> views;
  bool flicker = false;
  bool fresh = false;                        ///< What an earlier study left in the folder goes.
  std::optional<std::int64_t> max_bytes;     ///< Of one model; from --max-memory.
  int shard = 1, shards = 1;                 ///< Part `shard` of `shards`, from 1.
  std::vector<std::filesystem::path> parts;  ///< Folders to merge.
  std::vector<std::string> cases;            ///< Of `limn stability`: names or files; empty: all.
  std::optional<std::uint64_t> seed;         ///< Of its random parameters.
  std::optional<int> draws;                  ///< Of them, for each case.
};

/// `limn plan`, and `limn render --tolerance`.
struct PlanOptions {
  std::optional<double> tolerance_px;
  bool silhouette = false;  ///< Only it has to be right.
  std::optional<double> budget_ms;
  std::optional<std::int64_t> budget_bytes;
};

/// The command line as given; nothing here is a default of the models (an unset value leaves the scene file or the library to choose).
struct Options {
  std::string input;
  std::string kind;  ///< `limn list` only.

  std::vector<std::filesystem::path> outputs;
  bool no_clobber = false;
  bool no_timings = false;
  bool json = false;
  bool quiet = false;
  bool verbose = false;
  bool no_progress = false;
  int threads = 0;                         ///< 0: all.
  std::optional<std::int64_t> max_memory;  ///< Bytes, of the whole program.
  std::optional<double> max_time_ms;       ///< Of the whole call.

  std::optional<glm::ivec2> size_px;
  std::optional<glm::dvec3> eye, target, up;  ///< World.
  std::optional<double> fov_deg;              ///< Vertical.
  std::optional<double> ortho_height;         ///< World.
  int views = 1;
  FramePath frames{.frames = 1};  ///< `limn render` only.

  std::vector<std::string> surfaces;
  std::optional<int> voxels;                ///< Along the longest side.
  std::optional<double> voxel_size;         ///< World.
  std::optional<double> half_width_voxels;  ///< Of the narrow band.
  std::optional<std::string> gradient;
  std::optional<int> level;
  bool level_for_view = false;  ///< --level auto; `level` is unset then.
  std::optional<Scheme> scheme;
  std::optional<NormalKind> normals;
  std::optional<double> smooth_angle_deg;  ///< Of meshes drawn as they are.
  bool refined = false;                    ///< `limn export` only: refined instead of limit positions.
  std::vector<std::string> grids;          ///< Of a volume, by name; "all" for all of its level sets.

  std::vector<std::string> methods;           ///< Of one picture, in order.
  std::vector<std::string> compared_methods;  ///< `limn compare` only: each makes pictures of its own.
  std::vector<KeyValue> sets;
  int samples = 1;
  std::optional<glm::dvec3> background;  ///< Linear.

  StudyOptions study;
  PlanOptions plan;
};

struct SurfaceOptionNeeds {
  bool surface = true;      ///< --surface
  bool repeatable = false;  ///< --surface may be given several times.
  bool views = false;       ///< --level auto: there are pictures to refine for.
  bool swept = false;       ///< Resolution, normals and gradients are axes (add_study), not settings.
};

void add_input(CLI::App& app, Options& options);
void add_output(CLI::App& app, Options& options, const std::string& what, bool repeatable);
/// --refined
void add_refined(CLI::App& app, Options& options);
void add_json(CLI::App& app, Options& options);
void add_camera(CLI::App& app, Options& options, bool with_views, const std::string& default_size = "1280x720");
/// --frames, --path-step and --seed; excludes --views.
void add_frames(CLI::App& app, Options& options);
void add_surface(CLI::App& app, Options& options, const SurfaceOptionNeeds& needs);
void add_grid(CLI::App& app, Options& options);
void add_border(CLI::App& app, Options& options, bool compared = false);
/// --threads, --quiet and so on, with add_limits.
void add_execution(CLI::App& app, Options& options);
/// --max-memory and --max-time.
void add_limits(CLI::App& app, Options& options);
/// What `limn study` sweeps, how it is shared out and where it starts again; the folders of `limn merge`.
void add_study(CLI::App& app, Options& options);
void add_parts(CLI::App& app, Options& options);
/// Which cases `limn stability` runs, with what random parameters, on which surfaces.
void add_stability(CLI::App& app, Options& options);
/// --tolerance, --metric and --budget.
void add_plan(CLI::App& app, Options& options);

}  // namespace limn
