#include "samples/options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <functional>

#include "raymarch/border.h"
#include "raymarch/surface.h"
#include "sdf/error.h"

namespace limn {
namespace {

constexpr const char* kCamera = "Camera";
constexpr const char* kSurface = "Surface";
constexpr const char* kBorder = "Border";
constexpr const char* kOutput = "Output";
constexpr const char* kExecution = "Execution (never changes a pixel)";

struct OptionText {
  const char* flags;
  const char* value;  ///< What stands behind it in the help: "WxH".
  const char* help;
  const char* group;
};

// One argument, handed to `read` as text, so that every complaint is ours: one line that says what would be right.
CLI::Option* add(CLI::App& app, const OptionText& text, std::function<void(const std::string&)> read) {
  CLI::Option* option = app.add_option_function<std::string>(text.flags, std::move(read), text.help);
  option->type_name(text.value)->group(text.group)->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
  return option;
}

CLI::Option* add_repeatable(CLI::App& app, const OptionText& text, std::function<void(const std::string&)> read) {
  auto each = [read = std::move(read)](const std::vector<std::string>& values) {
    for (const std::string& value : values) read(value);
  };
  CLI::Option* option = app.add_option_function<std::vector<std::string>>(text.flags, std::move(each), text.help);
  option->type_name(text.value)->group(text.group)->type_size(1)->expected(1)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  return option;
}

// "a,b,c"; empty names are kept, so that they are complained about.
std::vector<std::string> names_of(const std::string& text) {
  std::vector<std::string> names;
  for (size_t at = 0; at <= text.size();) {
    const size_t comma = std::min(text.find(',', at), text.size());
    names.push_back(text.substr(at, comma - at));
    at = comma + 1;
  }
  return names;
}

void add_unless_there(const std::string& name, std::vector<std::string>& names) {
  if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
}

void read_compared_methods(const std::string& text, Options& options) {
  if (text == "all") {
    for (const BorderMethod& method : border_methods()) add_unless_there(method.about.name, options.compared_methods);
    return;
  }
  for (const std::string& name : names_of(text)) {
    find_border_method(name, "", "--methods");
    add_unless_there(name, options.compared_methods);
  }
}

void read_compared_surfaces(const std::string& text, Options& options) {
  for (const std::string& name : names_of(text)) {
    find_surface(name, "", "--surfaces");
    add_unless_there(name, options.surfaces);
  }
}

void add_switch(CLI::App& app, const OptionText& text, bool& target) { app.add_flag(text.flags, target, text.help)->group(text.group); }

}  // namespace

void add_input(CLI::App& app, Options& options) {
  app.add_option("INPUT", options.input,
                 "scene file (.toml), mesh (.obj .ply .stl .off .gltf .glb), volume (.vdb) or built-in scene (limn list scenes). "
                 "A mesh is drawn as it is; --level, --scheme or crease tags in the file make it a subdivision cage")
      ->type_name("")
      ->required();
}

void add_output(CLI::App& app, Options& options, const std::string& what, bool repeatable) {
  const OptionText text{"-o,--output", "OUT", what.c_str(), kOutput};
  const auto read = [&options](const std::string& value) {
    if (value.empty()) throw InputError({"", "--output", "nothing", "no file name", "a path would be right"});
    options.outputs.emplace_back(value);
  };
  if (repeatable)
    add_repeatable(app, text, read);
  else
    add(app, text, read);
  add_switch(app, {"--no-clobber", "", "refuse to replace files that exist", kOutput}, options.no_clobber);
}

void add_json(CLI::App& app, Options& options) {
  add_switch(app, {"--json", "", "one JSON document on stdout and nothing else there", kOutput}, options.json);
}

void add_camera(CLI::App& app, Options& options, bool with_views) {
  add(app, {"--size", "WxH", "picture in pixels, 1..16384 each; default 1280x720", kCamera},
      [&options](const std::string& text) { options.size_px = parse_size("--size", text); });
  add(app, {"--eye", "X,Y,Z", "where the camera stands, world units; default: framed", kCamera},
      [&options](const std::string& text) { options.eye = parse_vector3("--eye", text); });
  add(app, {"--target", "X,Y,Z", "what it looks at, world units; default: the middle of what is drawn", kCamera},
      [&options](const std::string& text) { options.target = parse_vector3("--target", text); });
  add(app, {"--up", "X,Y,Z", "what is up in the picture; default 0,1,0", kCamera},
      [&options](const std::string& text) { options.up = parse_vector3("--up", text); });
  auto* fov = add(app, {"--fov", "DEG", "vertical field of view, degrees, above 0 and below 180; default 35", kCamera},
                  [&options](const std::string& text) { options.fov_deg = parse_number("--fov", text); });
  auto* ortho = add(app, {"--ortho", "HEIGHT", "orthographic, the picture's height in world units; default: perspective", kCamera},
                    [&options](const std::string& text) { options.ortho_height = parse_number("--ortho", text); });
  fov->excludes(ortho);
  if (!with_views) return;
  add(app, {"--views", "N", "N pictures from directions spread evenly on the sphere, 1..10000; default 1: the camera's own", kCamera},
      [&options](const std::string& text) { options.views = parse_integer("--views", text, 1, 10'000); });
}

void add_grid(CLI::App& app, Options& options) {
  add(app, {"--grid", "NAME", "which grid of a .vdb; default: the only level set in it", kSurface},
      [&options](const std::string& text) { options.grid = text; });
}

void add_surface(CLI::App& app, Options& options, const SurfaceOptionNeeds& needs) {
  const auto surface = [&options](const std::string& text) {
    find_surface(text, "", "--surface");
    options.surfaces.push_back(text);
  };
  if (needs.surface && needs.repeatable) {
    add_repeatable(app, {"--surface", "NAME", "only this representation (limn list surfaces), repeatable; default: all", kSurface},
                   surface);
    add_repeatable(app, {"--surfaces", "A,B,...", "the same for several", kSurface},
                   [&options](const std::string& text) { read_compared_surfaces(text, options); });
  } else if (needs.surface)
    add(app, {"--surface", "NAME", "representation (limn list surfaces); default: what the input is by itself", kSurface}, surface);
  auto* voxels = add(app, {"--voxels", "N", "voxels along the longest side, 4..8192; default 256", kSurface},
                     [&options](const std::string& text) { options.voxels = parse_integer("--voxels", text, 4, 8192); });
  auto* voxel_size =
      add(app, {"--voxel-size", "H", "side of a voxel, world units; instead of --voxels", kSurface}, [&options](const std::string& text) {
        options.voxel_size = parse_number_above("--voxel-size", text, 0.0, false, "a length above 0 in world units would be right");
      });
  voxels->excludes(voxel_size);
  add(app, {"--half-width", "VOXELS", "half width of the narrow band, voxels, at least 1.8; default: what the gradient needs", kSurface},
      [&options](const std::string& text) {
        options.half_width_voxels = parse_number_above("--half-width", text, 1.8, true, "at least 1.8 voxels would be right");
      });
  add(app, {"--gradient", "NAME", "how normals are read from a level set (limn list gradients); default central", kSurface},
      [&options](const std::string& text) {
        find_gradient(text, "", "--gradient");
        options.gradient = text;
      });
  add(app, {"--level", "N", "refinements of a cage or a tessellation, 0..8; default 3", kSurface},
      [&options](const std::string& text) { options.level = parse_integer("--level", text, 0, 8); });
  add(app, {"--scheme", "NAME", "catmark, loop or bilinear; default: the scene's, else catmark", kSurface},
      [&options](const std::string& text) { options.scheme = parse_scheme(text, "", "--scheme"); });
  add(app, {"--normals", "NAME", "flat, vertex or limit; default: limit where there is a limit surface, else vertex", kSurface},
      [&options](const std::string& text) { options.normals = parse_normals(text, "", "--normals"); });
  add_grid(app, options);
}

void add_border(CLI::App& app, Options& options, bool compared) {
  auto* method =
      add_repeatable(app, {"--method", "NAME", "outline method (limn list methods), repeatable, the last on top; default rim", kBorder},
                     [&options](const std::string& text) {
                       find_border_method(text, "", "--method");
                       options.methods.push_back(text);
                     });
  if (compared) {
    add_repeatable(
        app, {"--methods", "A,B,...|all", "a picture of every model by each of these methods, as a matrix; default: one method", kBorder},
        [&options](const std::string& text) { read_compared_methods(text, options); })
        ->excludes(method);
  }
  add_repeatable(
      app,
      {"--set", "KEY=VALUE", "a parameter of the methods, such as threshold=0.4; METHOD.KEY=VALUE for one of several; repeatable", kBorder},
      [&options](const std::string& text) { options.sets.push_back(parse_key_value("--set", text)); });
  add(app, {"--samples", "N", "rays a pixel, 1..1024; default 1", kBorder},
      [&options](const std::string& text) { options.samples = parse_integer("--samples", text, 1, 1024); });
  add(app, {"--background", "R,G,B", "linear colour behind everything; default: transparent (compare: white)", kBorder},
      [&options](const std::string& text) {
        const glm::dvec3 color = parse_vector3("--background", text);
        if (glm::any(glm::lessThan(color, glm::dvec3(0.0))))
          throw InputError({"", "--background", text, "out of range", "three numbers from 0 up would be right"});
        options.background = color;
      });
}

void add_execution(CLI::App& app, Options& options) {
  add_switch(app, {"-q,--quiet", "", "nothing but errors on stderr, nothing but --json on stdout", kExecution}, options.quiet);
  add_switch(app, {"-v,--verbose", "", "timings and sizes on stderr", kExecution}, options.verbose);
  add_switch(app, {"--no-progress", "", "no progress bar (there is none unless stderr is a terminal)", kExecution}, options.no_progress);
  add(app, {"--threads", "N", "threads, 0..1024; default 0: all", kExecution},
      [&options](const std::string& text) { options.threads = parse_integer("--threads", text, 0, 1024); });
}

}  // namespace limn
