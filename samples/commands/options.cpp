#include "samples/commands/options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <functional>
#include <tuple>

#include "raymarch/border.h"
#include "raymarch/look.h"
#include "raymarch/surface.h"
#include "samples/commands/options_parts.h"
#include "samples/spec/flags.h"
#include "samples/spec/parse.h"
#include "samples/spec/parse_color.h"
#include "samples/spec/surface_setting.h"
#include "sdf/error.h"

namespace limn {
namespace {

constexpr const char* kBorder = "Border";
constexpr const char* kSweep = "Sweep (a list: 2,4,6; a range: 2..6)";
constexpr const char* kStudy = "Study";
constexpr const char* kStability = "Cases";
constexpr const char* kHidden = "";  ///< In no help.
constexpr const char* kPlan = "Plan";
constexpr const char* kExecution = "Execution (never changes a pixel)";
constexpr const char* kLimits = "Limits (estimates are within a factor of two; predicted overruns exit with 2, actual ones with 1)";

CLI::Option* add_repeatable(CLI::App& app, const OptionText& text, std::function<void(const std::string&)> read) {
  const auto each = [read = std::move(read)](const std::vector<std::string>& values) {
    for (const std::string& value : values) read(value);
  };
  CLI::Option* option = app.add_option_function<std::vector<std::string>>(text.flags, each, text.help);
  option->type_name(text.value)->group(text.group)->type_size(1)->expected(1)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  return option;
}

void read_compared_methods(const std::string& text, Options& options) {
  if (text == "all") {
    for (const BorderMethod& method : border_methods()) add_unless_there(method.about.name, options.spec.border.columns);
    return;
  }
  for (const std::string& name : parse_names(text)) {
    find_border_method(name, "", "--methods");
    add_unless_there(name, options.spec.border.columns);
  }
}

void read_compared_surfaces(const std::string& text, Options& options) {
  for (const std::string& name : parse_names(text)) {
    find_surface(name, "", "--surfaces");
    add_unless_there(name, options.spec.surfaces);
  }
}

void add_compared_surfaces(CLI::App& app, Options& options) {
  const auto surface = [&options](const std::string& text) {
    find_surface(text, "", "--surface");
    options.spec.surfaces.push_back(text);
  };
  add_repeatable(app, {"--surface", "NAME", "only this representation (limn list surfaces), repeatable; default: all", kSurface}, surface);
  add_repeatable(app, {"--surfaces", "A,B,...", "several of them (limn list surfaces)", kSurface},
                 [&options](const std::string& text) { read_compared_surfaces(text, options); });
}

}  // namespace

CLI::Option* add(CLI::App& app, const OptionText& text, const std::function<void(const std::string&)>& read) {
  CLI::Option* option = app.add_option_function<std::string>(text.flags, read, text.help);
  option->type_name(text.value)->group(text.group)->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
  return option;
}

void add_switch(CLI::App& app, const OptionText& text, bool& target) { app.add_flag(text.flags, target, text.help)->group(text.group); }

CLI::Option* add_setting(CLI::App& app, Options& options, const char* name) {
  const SurfaceSetting& setting = surface_setting(name);
  const std::string flag = flag_of(name);
  return add(app, {flag.c_str(), setting.option_value, setting.option_help, kSurface},
             [&options, &setting, flag](const std::string& text) { ask(setting, text, flag, options.spec.surface); });
}

void add_input(CLI::App& app, Options& options) {
  app.add_option("INPUT", options.spec.input,
                 "scene file (.toml), mesh (.obj .ply .stl .off .gltf .glb), volume (.vdb .nvdb), formula (.vm) or built-in scene (limn "
                 "list scenes). "
                 "A mesh is drawn as it is; --level, --scheme or crease tags in the file make it a subdivision cage")
      ->type_name("")
      ->required();
}

void add_output(CLI::App& app, Options& options, const std::string& what, bool repeatable) {
  const OptionText text{"-o,--output", "OUT", what.c_str(), kOutput};
  const auto read = [&options](const std::string& value) {
    if (value.empty()) throw InputError({"", "--output", "nothing", "no file name", "a path"});
    options.outputs.emplace_back(value);
  };
  if (repeatable)
    add_repeatable(app, text, read);
  else
    add(app, text, read);
  add_switch(app, {"--no-clobber", "", "refuse to replace files that exist", kOutput}, options.no_clobber);
}

void add_kind(CLI::App& app, Options& options) {
  app.add_option(
         "KIND", options.kind,
         "shapes, surfaces, gradients, normals, methods, metrics, lines, scenes, looks or shadings; reference: all of it, and every "
         "key of files, as Markdown")
      ->type_name("")
      ->required();
}

void add_shell(CLI::App& app, Options& options) { app.add_option("SHELL", options.kind, "bash, zsh or fish")->type_name("")->required(); }

void add_command_name(CLI::App& app, Options& options) {
  app.add_option("COMMAND", options.kind, "a command; without it the page of limn itself")->type_name("");
}

void add_no_timings(CLI::App& app, Options& options) {
  add_switch(app, {"--no-timings", "", "leave measured times out of sheet and report, so that equal calls write equal bytes", kOutput},
             options.no_timings);
}

void add_refined(CLI::App& app, Options& options) {
  add_switch(
      app,
      {"--refined", "", "vertices of a cage where --level refinements put them, with its tags, instead of on the limit surface", kSurface},
      options.refined);
}

void add_reference(CLI::App& app, Options& options) {
  add(app,
      {"--reference", "given|smooth",
       "true border of meshes that are no cages, and of volumes: that of the file as it is (given, the default: what does a coarser model "
       "of it lose?), or of the smooth surface that was meant, known no better than two ways to read the file agree",
       kSurface},
      [&options](const std::string& text) {
        const std::vector<std::string> known = {"given", "smooth"};
        if (std::find(known.begin(), known.end(), text) == known.end())
          throw InputError({"", "--reference", text, "there is no such reference", known_names(text, known)});
        options.spec.reference = text == "given" ? TruthReference::given : TruthReference::smooth;
      });
}

void add_json(CLI::App& app, Options& options) {
  add_switch(app, {"--json", "", "one JSON document on stdout and nothing else there", kOutput}, options.json);
}

void add_dump(CLI::App& app, Options& options) {
  DumpOptions& dump = options.dump;
  auto* what = add(app,
                   {"--dump", "program|tape|bricks",
                    "in place of the report what limn computes with, for debugging: the instructions of formulas (program), the same "
                    "recorded for SIMD (tape), or the bricks of level sets",
                    kOutput},
                   [&dump](const std::string& text) {
                     const std::vector<std::string> known = {"program", "tape", "bricks"};
                     if (std::find(known.begin(), known.end(), text) == known.end())
                       throw InputError({"", "--dump", text, "there is no such dump", known_names(text, known)});
                     dump.what = text;
                   });
  what->excludes(app.get_option("--json"));
  add(app, {"--brick", "N", "with --dump bricks: the values of brick N in place of the list, as it numbers them", kOutput},
      [&dump](const std::string& text) { dump.brick = parse_integer("--brick", text, 0, std::numeric_limits<int>::max()); })
      ->needs(what);
}

void add_demo(CLI::App& app, Options& options) {
  add(app, {"--size", "WxH", "every picture in pixels, 1..16384 each; smaller ones are there sooner; default: as the page says", kCamera},
      [&options](const std::string& text) { options.spec.camera.size_px = parse_size("--size", text); });
}

namespace {

/// From where the camera looks, and how the picture is framed.
void add_view_angles(CLI::App& app, CameraSpec& camera) {
  auto* eye = app.get_option("--eye");
  const auto number = [&app](const char* flag, const char* value, const char* help, std::optional<double>& target) {
    return add(app, {flag, value, help, kCamera}, [&target, flag](const std::string& text) { target = parse_number(flag, text); });
  };
  number("--azimuth", "DEG", "looks from so far round --up: 0 from the front (+z; where z is up -y), 90 from the right; default 38.7",
         camera.azimuth_deg)
      ->excludes(eye);
  add(app, {"--elevation", "DEG", "looks from so far above the horizon, -90 to 90; default 25.1", kCamera},
      [&camera](const std::string& text) {
        camera.elevation_deg = parse_number("--elevation", text);
        if (std::abs(*camera.elevation_deg) > 90.0) throw InputError({"", "--elevation", text, "out of range", "-90 to 90 degrees"});
      })
      ->excludes(eye);
  number("--roll", "DEG", "the picture turns clockwise; default 0", camera.roll_deg);
  number("--zoom", "FACTOR", "the picture enlarged about its middle, above 0; default 1", camera.zoom);
  number("--margin", "SHARE", "of the picture left free on each side of what is framed, 0 to below 0.5; default 0.07", camera.margin)
      ->excludes(eye);
}

}  // namespace

void add_camera(CLI::App& app, Options& options, bool with_views, const std::string& default_size) {
  const std::string size_help = "picture in pixels, 1..16384 each; default " + default_size;
  add(app, {"--size", "WxH", size_help.c_str(), kCamera},
      [&options](const std::string& text) { options.spec.camera.size_px = parse_size("--size", text); });
  add(app, {"--eye", "X,Y,Z", "where the camera stands, world units; default: framed", kCamera},
      [&options](const std::string& text) { options.spec.camera.eye = parse_vector3("--eye", text); });
  add(app, {"--target", "X,Y,Z", "what it looks at, world units; default: the middle of what is drawn", kCamera},
      [&options](const std::string& text) { options.spec.camera.target = parse_vector3("--target", text); });
  add(app, {"--up", "X,Y,Z", "what is up in the picture: a direction, or an axis such as z or -y; default y", kCamera},
      [&options](const std::string& text) { options.spec.camera.up = parse_direction("--up", text); });
  auto* fov = add(app, {"--fov", "DEG", "vertical field of view, degrees, above 0 and below 180; default 35", kCamera},
                  [&options](const std::string& text) { options.spec.camera.fov_deg = parse_number("--fov", text); });
  auto* ortho = add(app, {"--ortho", "HEIGHT", "orthographic, the picture's height in world units; default: perspective", kCamera},
                    [&options](const std::string& text) { options.spec.camera.ortho_height = parse_number("--ortho", text); });
  fov->excludes(ortho);
  add_view_angles(app, options.spec.camera);
  if (!with_views) return;
  add(app, {"--views", "N", "N pictures from directions spread evenly on the sphere, 1..10000; default 1: the camera's own", kCamera},
      [&options](const std::string& text) { options.spec.views = parse_integer("--views", text, 1, 10'000); });
}

void add_turntable(CLI::App& app, Options& options) {
  add(app, {"--turntable", "N", "N pictures, 2..10000, while the camera goes once round about --up; they share one size", kCamera},
      [&options](const std::string& text) { options.turntable = parse_integer("--turntable", text, 2, 10'000); })
      ->excludes(app.get_option("--views"))
      ->excludes(app.get_option("--frames"));
  auto* turntable = app.get_option("--turntable");
  app.add_flag("--animate", options.animate, "one picture that plays all frames instead of a file a frame: .png; an .apng always does")
      ->group(kCamera)
      ->needs(turntable);
  add(app, {"--fps", "N", "frames a second of such a picture, above 0 up to 100; default 24", kCamera},
      [&options](const std::string& text) {
        options.lines.frames_per_second = parse_number_above("--fps", text, 0.0, false, "above 0 and up to 100 frames a second");
        if (options.lines.frames_per_second > 100.0)
          throw InputError({"", "--fps", text, "out of range", "above 0 and up to 100 frames a second"});
      })
      ->needs(turntable);
}

void add_frames(CLI::App& app, Options& options, const char* help) {
  auto* frames = add(app, {"--frames", "N", help, kCamera},
                     [&options](const std::string& text) { options.frames.frames = parse_integer("--frames", text, 1, 10'000); });
  frames->excludes(app.get_option("--views"));
  add(app, {"--path-step", "PX", "how far the picture moves from frame to frame, pixels, above 0 up to 1; default 0.1", kCamera},
      [&options](const std::string& text) {
        const char* const right = "above 0 and up to 1 pixel";
        options.frames.step_px = parse_number_above("--path-step", text, 0.0, false, right);
        if (options.frames.step_px > 1.0) throw InputError({"", "--path-step", text, "out of range", right});
      })
      ->needs(frames);
  add(app, {"--seed", "N", "random seed of the camera path, 0..2147483647; default 1", kCamera}, [&options](const std::string& text) {
    options.frames.seed = static_cast<std::uint64_t>(parse_integer("--seed", text, 0, std::numeric_limits<int>::max()));
  })->needs(frames);
}

void add_grid(CLI::App& app, Options& options) {
  add_repeatable(app,
                 {"--grid", "NAME",
                  "a grid of a .vdb or .nvdb as limn info names it (ball, ball[1]), repeatable, or all; default: all level sets", kSurface},
                 [&options](const std::string& text) { add_unless_there(text, options.spec.grids); });
}

namespace {

// What no study sweeps.
void add_fixed_surface(CLI::App& app, Options& options) {
  for (const char* const name : kFixedSettings) add_setting(app, options, name);
  add_grid(app, options);
}

}  // namespace

void add_surface(CLI::App& app, Options& options, const SurfaceOptionNeeds& needs) {
  if (needs.surface && needs.repeatable) {
    add_compared_surfaces(app, options);
  } else if (needs.surface) {
    add(app, {"--surface", "NAME", "representation (limn list surfaces); default: what the input is by itself", kSurface},
        [&options](const std::string& text) {
          find_surface(text, "", "--surface");
          options.spec.surfaces.push_back(text);
        });
  }
  if (needs.swept) {
    add_fixed_surface(app, options);
    return;
  }
  add_setting(app, options, "voxels")->excludes(add_setting(app, options, "voxel_size"));
  add_setting(app, options, "gradient");
  if (needs.views) {
    const std::string help =
        std::string(surface_setting("level").option_help) + "; auto: as many as the picture shows to a tenth of a pixel";
    add(app, {"--level", "N|auto", help.c_str(), kSurface}, [&options](const std::string& text) {
      SurfaceSpec& surface = options.spec.surface;
      surface.level_for_view = text == "auto";
      surface.level.reset();
      if (!surface.level_for_view) ask(surface_setting("level"), text, "--level", surface);
    });
  } else {
    add_setting(app, options, "level");
  }
  add_setting(app, options, "normals");
  add_fixed_surface(app, options);
}

void add_methods(CLI::App& app, Options& options, bool compared) {
  auto* method =
      add_repeatable(app, {"--method", "NAME", "outline method (limn list methods), repeatable, the last on top; default rim", kBorder},
                     [&options](const std::string& text) {
                       find_border_method(text, "", "--method");
                       options.spec.border.methods.push_back(text);
                     });
  if (compared) {
    add_repeatable(app,
                   {"--methods", "A,B,...|all",
                    "a picture of every model by each of these methods (limn list methods), as a matrix; default: one method", kBorder},
                   [&options](const std::string& text) { read_compared_methods(text, options); })
        ->excludes(method);
  }
  add_repeatable(
      app,
      {"--set", "KEY=VALUE", "a parameter of the methods, such as threshold=0.4; METHOD.KEY=VALUE for one of several; repeatable", kBorder},
      [&options](const std::string& text) { options.spec.border.parameters.push_back(parse_key_value("--set", text)); });
}

void add_border(CLI::App& app, Options& options, bool compared) {
  add_methods(app, options, compared);
  const char* const samples_help = compared ? "rays a pixel, 1..1024; default 1" : "rays a pixel, 1..1024; default 8, with --frames 1";
  add(app, {"--samples", "N", samples_help, kBorder}, [&options](const std::string& text) {
    options.spec.border.samples = parse_integer("--samples", text, 1, 1024);
    options.samples_given = true;
  });
  add(app,
      {"--background", "COLOR",
       "colour behind everything: '#rrggbb', '#rgb' (quoted for the shell), a name such as white, R,G,B in linear light from 0 to 1, or "
       "linear:R,G,B; default: white, in .exr transparent (compare: white)",
       kBorder},
      [&options](const std::string& text) { options.spec.border.background = parse_color("--background", text); });
}

void add_look(CLI::App& app, Options& options) {
  add(app, {"--look", "NAME", "methods, shading and ground that go together (limn list looks); what other options name stays", kBorder},
      [&options](const std::string& text) {
        looks().find(text, "", "--look");
        options.spec.border.look = text;
      });
  auto* shading = add(app, {"--shading", "NAME", "how surfaces are coloured (limn list shadings); default headlight", kBorder},
                      [&options](const std::string& text) {
                        shadings().find(text, "", "--shading");
                        options.spec.border.shading = text;
                      });
  app.add_flag("--ink-only", options.ink_only, "the ink alone, with its coverage as alpha")->group(kBorder)->excludes(shading);
  app.add_flag("--transparent", options.transparent, "no ground behind the picture: its alpha says what is covered")
      ->group(kBorder)
      ->excludes(app.get_option("--background"));
}

void add_execution(CLI::App& app, Options& options) {
  add_switch(app, {"-q,--quiet", "", "nothing but errors on stderr, nothing but --json on stdout", kExecution}, options.quiet);
  add_switch(app, {"-v,--verbose", "", "timings and sizes on stderr", kExecution}, options.verbose);
  add_switch(app, {"--no-progress", "", "no progress bar (there is none unless stderr is a terminal)", kExecution}, options.no_progress);
  add(app, {"--threads", "N", "threads, 0..1024; default 0: all", kExecution},
      [&options](const std::string& text) { options.spec.threads = parse_integer("--threads", text, 0, 1024); });
  add_limits(app, options);
}

void add_limits(CLI::App& app, Options& options) {
  add(app,
      {"--max-memory", "SIZE",
       "memory the program may take, such as 500M or 4G, up to 140M of it for itself: refused where more is "
       "expected to be needed, stopped where it is reached (study: larger models are left out); default: what the machine has",
       kLimits},
      [&options](const std::string& text) { options.spec.limits.max_memory = parse_bytes("--max-memory", text); });
  add(app,
      {"--max-time", "TIME",
       "time the call may take, such as 90s or 10m: refused where twice that is expected, stopped where it is over; default: no limit",
       kLimits},
      [&options](const std::string& text) { options.spec.limits.max_time_ms = parse_milliseconds("--max-time", text); });
}

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
