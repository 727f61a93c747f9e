#pragma once
// The options that commands have in common. Each command adds the groups that mean something to it and no others.

#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "samples/parse.h"
#include "subdiv/refine.h"

namespace CLI {
class App;
}

namespace limn {

/// The command line as given; nothing here is a default of the models (an unset value leaves the scene file or the library to choose).
struct Options {
  std::string input;
  std::string kind;  ///< `limn list` only.

  std::vector<std::filesystem::path> outputs;
  bool no_clobber = false;
  bool json = false;
  bool quiet = false;
  bool verbose = false;
  bool no_progress = false;
  int threads = 0;  ///< 0: all.

  std::optional<glm::ivec2> size_px;
  std::optional<glm::dvec3> eye, target, up;  ///< World.
  std::optional<double> fov_deg;              ///< Vertical.
  std::optional<double> ortho_height;         ///< World.
  int views = 1;

  std::vector<std::string> surfaces;
  std::optional<int> voxels;                ///< Along the longest side.
  std::optional<double> voxel_size;         ///< World.
  std::optional<double> half_width_voxels;  ///< Of the narrow band.
  std::optional<std::string> gradient;
  std::optional<int> level;
  std::optional<Scheme> scheme;
  std::optional<NormalKind> normals;
  std::string grid;

  std::vector<std::string> methods;           ///< Of one picture, in order.
  std::vector<std::string> compared_methods;  ///< `limn compare` only: each makes pictures of its own.
  std::vector<KeyValue> sets;
  int samples = 1;
  std::optional<glm::dvec3> background;  ///< Linear.
};

struct SurfaceOptionNeeds {
  bool surface = true;      ///< --surface
  bool repeatable = false;  ///< --surface may be given several times.
};

void add_input(CLI::App& app, Options& options);
void add_output(CLI::App& app, Options& options, const std::string& what, bool repeatable);
void add_json(CLI::App& app, Options& options);
void add_camera(CLI::App& app, Options& options, bool with_views);
void add_surface(CLI::App& app, Options& options, const SurfaceOptionNeeds& needs);
void add_grid(CLI::App& app, Options& options);
void add_border(CLI::App& app, Options& options, bool compared = false);
void add_execution(CLI::App& app, Options& options);

}  // namespace limn
