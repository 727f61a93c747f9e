#include "samples/python/call_fields.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <map>

#include "raymarch/border.h"
#include "raymarch/look.h"
#include "samples/spec/parse.h"
#include "samples/spec/parse_color.h"
#include "samples/spec/surface_setting.h"
#include "sdf/error.h"

namespace limn::python {
namespace {

/// Reads the text of `field` into the settings.
using Reader = std::function<void(const std::string& field, const std::string& text, CallSettings& settings)>;
using Readers = std::map<std::string, Reader>;

/// A name out of a few.
size_t choice_of(const std::string& field, const std::string& text, const std::vector<std::string>& known, const std::string& problem) {
  const auto at = std::find(known.begin(), known.end(), text);
  if (at == known.end()) throw InputError({"", field, text, problem, known_names(text, known)});
  return static_cast<size_t>(at - known.begin());
}

bool flag_of_text(const std::string& field, const std::string& text) {
  return choice_of(field, text, {"False", "True"}, "is no flag") == 1;
}

/// A finite number in [low, high), the low end excluded where `above` says so.
double number_below(const std::string& field, const std::string& text, double low, bool above, double high, const std::string& expected) {
  const double number = parse_number_above(field, text, low, !above, expected);
  if (number >= high) throw InputError({"", field, text, "out of range", expected});
  return number;
}

void read_level(const std::string& field, const std::string& text, CallSettings& settings) {
  SurfaceSpec& surface = settings.spec.surface;
  surface.level_for_view = text == "auto";
  surface.level.reset();
  if (!surface.level_for_view) ask(surface_setting("level"), text, field, surface);
}

void add_surface(Readers& readers) {
  for (const SurfaceSetting& setting : surface_setting_list()) {
    readers[setting.name] = [&setting](const std::string& field, const std::string& text, CallSettings& settings) {
      SurfaceSpec& surface = settings.spec.surface;
      ask(setting, text, field, surface);
      if (surface.voxels && surface.voxel_size)
        throw InputError({"", "voxel_size", "", "cannot be given together with voxels", "one of the two"});
    };
  }
  readers["level"] = read_level;
  readers["surface"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    find_surface(text, "", field);
    settings.spec.surfaces.push_back(text);
  };
  readers["grid"] = [](const std::string&, const std::string& text, CallSettings& settings) { settings.spec.grids.push_back(text); };
  readers["reference"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    const bool smooth = choice_of(field, text, {"given", "smooth"}, "there is no such reference") == 1;
    settings.spec.reference = smooth ? TruthReference::smooth : TruthReference::given;
  };
}

/// A number of the camera that belongs to no eye.
void add_view_angles(Readers& readers) {
  const auto angle = [&readers](const char* name, std::optional<double> CameraSpec::*member) {
    readers[name] = [member](const std::string& field, const std::string& text, CallSettings& settings) {
      CameraSpec& camera = settings.spec.camera;
      camera.*member = parse_number(field, text);
      if (camera.eye && camera.turns()) throw InputError({"", field, text, "cannot be given together with eye", "one of the two"});
    };
  };
  angle("azimuth", &CameraSpec::azimuth_deg);
  angle("elevation", &CameraSpec::elevation_deg);
  angle("roll", &CameraSpec::roll_deg);
  angle("zoom", &CameraSpec::zoom);
  angle("margin", &CameraSpec::margin);
}

void add_camera(Readers& readers) {
  readers["size"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    settings.spec.camera.size_px = parse_size(field, text);
  };
  readers["eye"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    settings.spec.camera.eye = parse_vector3(field, text);
  };
  readers["target"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    settings.spec.camera.target = parse_vector3(field, text);
  };
  readers["up"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    settings.spec.camera.up = parse_direction(field, text);
  };
  readers["fov"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    settings.spec.camera.fov_deg = parse_number(field, text);
  };
  readers["ortho"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    if (settings.spec.camera.fov_deg) throw InputError({"", field, text, "cannot be given together with fov", "one of the two"});
    settings.spec.camera.ortho_height = parse_number(field, text);
  };
  add_view_angles(readers);
  readers["views"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    settings.spec.views = parse_integer(field, text, 1, 10'000);
  };
  readers["view"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    settings.view = parse_integer(field, text, 0, settings.spec.views - 1);
  };
}

void add_border(Readers& readers) {
  readers["method"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    find_border_method(text, "", field);
    settings.spec.border.methods.push_back(text);
  };
  readers["column"] = [](const std::string&, const std::string& text, CallSettings& settings) {
    std::vector<std::string>& columns = settings.spec.border.columns;
    std::vector<std::string> names = {text};
    if (text == "all") names = border_methods().names();
    for (const std::string& name : names) {
      find_border_method(name, "", "methods");
      if (std::find(columns.begin(), columns.end(), name) == columns.end()) columns.push_back(name);
    }
  };
  readers["set"] = [](const std::string&, const std::string& text, CallSettings& settings) {
    settings.spec.border.parameters.push_back(parse_key_value("parameters", text));
  };
  readers["samples"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    settings.spec.border.samples = parse_integer(field, text, 1, 1024);
    settings.samples_given = true;
  };
  readers["background"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    settings.spec.border.background = parse_color(field, text);
  };
}

void add_look(Readers& readers) {
  readers["look"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    looks().find(text, "", field);
    settings.spec.border.look = text;
  };
  readers["shading"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    shadings().find(text, "", field);
    settings.spec.border.shading = text;
  };
  readers["transparent"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    settings.transparent = flag_of_text(field, text);
    if (settings.transparent && settings.spec.border.background)
      throw InputError({"", field, "", "cannot be given together with background", "one of the two"});
  };
  readers["ink_only"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    settings.ink_only = flag_of_text(field, text);
    if (!settings.ink_only) return;
    if (settings.spec.border.shading) throw InputError({"", field, "", "cannot be given together with shading", "one of the two"});
    settings.spec.border.shading = "none";
  };
  readers["mattes"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    settings.mattes = flag_of_text(field, text);
  };
}

void add_execution(Readers& readers) {
  readers["threads"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    settings.spec.threads = parse_integer(field, text, 0, 1024);
  };
  readers["max_memory"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    settings.spec.limits.max_memory = parse_bytes(field, text);
  };
}

void add_sweep(Readers& readers) {
  readers["levels"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    const auto read = [&field](const std::string& one) { return parse_integer(field, one, 0, 8); };
    settings.sweep.levels = parse_integers(text, read, [](int value) { return value + 1; });
    // Levels make a mesh a cage, as `level` does elsewhere.
    if (!settings.sweep.levels.empty()) settings.spec.surface.level = settings.sweep.levels.back();
  };
  readers["voxels_swept"] = [](const std::string&, const std::string& text, CallSettings& settings) {
    const auto read = [](const std::string& one) { return parse_integer("voxels", one, 4, 8192); };
    settings.sweep.voxels = parse_integers(text, read, [](int value) { return 2 * value; });
  };
  readers["normals_swept"] = [](const std::string&, const std::string& text, CallSettings& settings) {
    settings.sweep.normals.push_back(parse_normals(text, "", "normals"));
  };
  readers["gradients"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    find_gradient(text, "", field);
    settings.sweep.gradients.push_back(text);
  };
  readers["thresholds"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    settings.sweep.thresholds = parse_thresholds(field, text);
  };
  readers["views_swept"] = [](const std::string&, const std::string& text, CallSettings& settings) {
    settings.sweep.views = parse_integer("views", text, 1, 10'000);
  };
  readers["flicker"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    settings.sweep.flicker = flag_of_text(field, text);
  };
  readers["fresh"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    settings.fresh = flag_of_text(field, text);
  };
}

void add_plan(Readers& readers) {
  readers["local"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    settings.local_px = parse_number_above(field, text, 0.0, false, "a number of pixels above 0");
  };
  readers["local_models"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    settings.plan_local = flag_of_text(field, text);
  };
  readers["tolerance"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    settings.plan.tolerance_px = parse_number_above(field, text, 0.0, false, "a number of pixels above 0");
  };
  readers["metric"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    settings.plan.silhouette = parse_plan_metric(field, text);
  };
  readers["budget"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    if (text.empty() || text.back() != 's')
      settings.plan.budget_bytes = parse_bytes(field, text, kLeastBudget);
    else
      settings.plan.budget_ms = parse_milliseconds(field, text);
  };
}

void add_lines(Readers& readers) {
  readers["lines"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    std::vector<LineClass>& classes = settings.lines.classes;
    for (const LineClassDescriptor& one : line_classes())
      if (text == "all") classes.push_back(one.line_class);
    if (text != "all") classes.push_back(line_classes().find(text, "", field).line_class);
  };
  readers["lines_threshold"] = [](const std::string&, const std::string& text, CallSettings& settings) {
    settings.lines.threshold = number_below("threshold", text, 0.0, true, 1.0, "above 0 and below 1");
  };
  readers["crease_angle"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    settings.lines.crease_angle_deg = number_below(field, text, 0.0, true, 180.0, "above 0 and below 180 degrees");
  };
  readers["smooth"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    settings.lines.smooth_meshes = flag_of_text(field, text);
  };
  readers["fair"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    settings.lines.fairing_edges = parse_number_above(field, text, 0.0, true, "a number from 0 to 1000");
  };
  readers["suggestive_angle"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    settings.lines.suggestive_angle_deg = number_below(field, text, 0.0, false, 90.0, "from 0 to below 90 degrees");
  };
  readers["suggestive_slope"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    settings.lines.suggestive_slope = parse_number_above(field, text, 0.0, true, "a number from 0 up");
  };
  readers["ridge_strength"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    settings.lines.ridge_strength = parse_number_above(field, text, 0.0, false, "a number above 0");
  };
}

void add_drawing(Readers& readers) {
  readers["hidden"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    if (flag_of_text(field, text)) settings.drawing.highest_invisibility = std::numeric_limits<int>::max();
  };
  readers["layers"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    std::tie(settings.drawing.lowest_invisibility, settings.drawing.highest_invisibility) = parse_layers(field, text);
  };
  readers["curves"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    settings.drawing.form = static_cast<CurveForm>(choice_of(field, text, {"polyline", "bezier", "arc"}, "there are no such curves"));
  };
  readers["fit"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    settings.drawing.fit_px = parse_number_above(field, text, 0.0, false, "above 0 px");
  };
  readers["page"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    settings.drawing.page_mm = parse_page(field, text);
  };
  readers["style"] = [](const std::string&, const std::string& text, CallSettings& settings) { settings.drawing.style = read_style(text); };
}

void add_judge(Readers& readers) {
  readers["search"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    const char* const expected = "above 0 and up to 32 pixels";
    settings.judge.search_px = parse_number_above(field, text, 0.0, false, expected);
    if (settings.judge.search_px > 32.0) throw InputError({"", field, text, "out of range", expected});
  };
  readers["ink"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    settings.ink.color = glm::dvec3(parse_color(field, text));
  };
  readers["alpha"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    settings.ink.alpha = flag_of_text(field, text);
  };
  readers["mask"] = [](const std::string&, const std::string& text, CallSettings& settings) { settings.ink.mask = text; };
  const auto limit = [&readers](const char* name, std::optional<LengthLimit> JudgeLimits::*member) {
    readers[name] = [member](const std::string& field, const std::string& text, CallSettings& settings) {
      settings.limits.*member = parse_length_limit(field, text);
    };
  };
  limit("max_missed", &JudgeLimits::missed);
  limit("max_false", &JudgeLimits::false_ink);
  limit("max_hidden", &JudgeLimits::hidden);
  limit("max_doubled", &JudgeLimits::doubled);
  readers["max_displaced"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    settings.limits.displaced_px = parse_number_above(field, text, 0.0, true, "a number of pixels from 0 up");
  };
}

void add_truth(Readers& readers) {
  readers["threshold"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    settings.truth.threshold = number_below(field, text, 0.0, false, 1.0, "from 0 to below 1");
  };
  readers["tolerance_px"] = [](const std::string& field, const std::string& text, CallSettings& settings) {
    const double tolerance = parse_number_above(field, text, 0.0, false, "a number of pixels above 0");
    settings.truth.tolerance_px = tolerance;
    settings.lines.tolerance_px = tolerance;
  };
}

const Readers& all_readers() {
  static const Readers all = [] {
    Readers readers;
    for (const auto add :
         {add_surface, add_camera, add_border, add_look, add_execution, add_sweep, add_plan, add_lines, add_drawing, add_judge, add_truth})
      add(readers);
    return readers;
  }();
  return all;
}

}  // namespace

void read_fields(const CallFields& fields, CallSettings& settings) {
  const Readers& readers = all_readers();
  for (const auto& [name, text] : fields) {
    const auto found = readers.find(name);
    if (found == readers.end()) throw InputError({"", name, text, "is no setting of this call", ""});
    found->second(name, text, settings);
  }
}

}  // namespace limn::python
