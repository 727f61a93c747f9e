#include "samples/commands/options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <limits>
#include <utility>

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
constexpr const char* kExecution = "Execution (never changes a pixel)";
constexpr const char* kLimits = "Limits (estimates are mostly within a factor of two; predicted overruns exit with 2, actual ones with 1)";

void read_compared_surfaces(const std::string& text, Options& options) {
  for (const std::string& name : parse_names(text)) {
    find_surface(name, "", "--surfaces");
    add_unless_there(name, options.spec.surfaces);
  }
}

}  // namespace

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

void add_compared_surfaces(CLI::App& app, Options& options) {
  const auto surface = [&options](const std::string& text) {
    find_surface(text, "", "--surface");
    options.spec.surfaces.push_back(text);
  };
  add_repeatable(app, {"--surface", "NAME", "only this representation (limn list surfaces), repeatable; default: all", kSurface}, surface);
  add_repeatable(app, {"--surfaces", "A,B,...", "several of them (limn list surfaces)", kSurface},
                 [&options](const std::string& text) { read_compared_surfaces(text, options); });
}

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

}  // namespace limn
