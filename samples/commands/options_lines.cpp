// Options of the commands that draw lines and judge drawings.

#include <CLI/CLI.hpp>

#include "samples/commands/options.h"
#include "samples/commands/options_parts.h"
#include "samples/spec/parse.h"
#include "samples/spec/parse_color.h"
#include "sdf/error.h"

namespace limn {
namespace {

constexpr const char* kLines = "Lines";
constexpr const char* kJudge = "Comparison";
constexpr const char* kJudgeLimits = "Limits of the drawing (exit code 1 beyond them; a length such as 5px, or a share such as 1%)";

/// What of suggestive contours, ridges and valleys is drawn.
void add_feature_limits(CLI::App& app, LineSettings& lines) {
  add(app, {"--suggestive-angle", "DEG", "suggestive contours: least angle between normal and view; default 20", kLines},
      [&lines](const std::string& text) {
        const char* const expected = "from 0 to below 90 degrees";
        lines.suggestive_angle_deg = parse_number_above("--suggestive-angle", text, 0.0, true, expected);
        if (lines.suggestive_angle_deg >= 90.0) throw InputError({"", "--suggestive-angle", text, "out of range", expected});
      });
  add(app,
      {"--suggestive-slope", "D",
       "suggestive contours: least derivative of the radial curvature towards the eye, times the object's radius squared; default 2",
       kLines},
      [&lines](const std::string& text) {
        lines.suggestive_slope = parse_number_above("--suggestive-slope", text, 0.0, true, "a number from 0 up");
      });
  add(app,
      {"--ridge-strength", "K", "ridges and valleys: least curvature across the line, times the object's radius, above 0; default 4",
       kLines},
      [&lines](const std::string& text) {
        lines.ridge_strength = parse_number_above("--ridge-strength", text, 0.0, false, "a number above 0");
      });
}

/// What makes a point one of a line, beside its class.
void add_line_definitions(CLI::App& app, LineSettings& lines) {
  add(app, {"--threshold", "T", "N.V of the rim's line, above 0 and below 1; default 0.4", kLines}, [&lines](const std::string& text) {
    lines.threshold = parse_number_above("--threshold", text, 0.0, false, "above 0 and below 1");
    if (lines.threshold >= 1.0) throw InputError({"", "--threshold", text, "out of range", "above 0 and below 1"});
  });
  add(app, {"--crease-angle", "DEG", "edges of meshes are creases where their faces' normals differ by more; default 40", kLines},
      [&lines](const std::string& text) {
        lines.crease_angle_deg = parse_number_above("--crease-angle", text, 0.0, false, "above 0 and below 180 degrees");
        if (lines.crease_angle_deg >= 180.0)
          throw InputError({"", "--crease-angle", text, "out of range", "above 0 and below 180 degrees"});
      });
  add_switch(app, {"--smooth", "", "of meshes: the lines of the smooth surface through their vertices, not along edges of facets", kLines},
             lines.smooth_meshes);
  add(app,
      {"--fair", "EDGES",
       "of meshes: waves as short as so many mean edges are smoothed away, such as a scan's noise; without --smooth for lines of curvature "
       "alone; default 0: none",
       kLines},
      [&lines](const std::string& text) {
        lines.fairing_edges = parse_number_above("--fair", text, 0.0, true, "a number from 0 to 1000");
      });
  add_feature_limits(app, lines);
}

}  // namespace

void add_line_surface(CLI::App& app, Options& options) {
  add(app, {"--surface", "mesh|level_set|mesh_level_set", "the lines of a model; default: those of the surface itself", kSurface},
      [&options](const std::string& text) {
        const std::vector<std::string> known = {"mesh", "level_set", "mesh_level_set"};
        if (std::find(known.begin(), known.end(), text) == known.end())
          throw InputError({"", "--surface", text, "has no lines of its own", known_names(text, known)});
        options.spec.surfaces.push_back(text);
      });
  add_setting(app, options, "voxels")->excludes(add_setting(app, options, "voxel_size"));
  add_setting(app, options, "level");
  add_setting(app, options, "half_width");
  add_setting(app, options, "scheme");
  add_grid(app, options);
}

void add_lines(CLI::App& app, Options& options) {
  LineOptions& lines = options.lines;
  add(app,
      {"--lines", "A,B,...|all", "classes of lines (limn list lines); default: contour, boundary, crease, intersection, material", kLines},
      [&lines](const std::string& text) {
        lines.lines.classes.clear();
        if (text == "all") {
          for (const LineClassDescriptor& one : line_classes()) lines.lines.classes.push_back(one.line_class);
          return;
        }
        for (const std::string& name : parse_names(text))
          add_unless_there(line_classes().find(name, "", "--lines").line_class, lines.lines.classes);
      });
  add_switch(app, {"--hidden", "", "hidden lines too, dashed and painted first", kLines}, lines.hidden);
  add(app, {"--qi", "A..B", "only lines with A to B layers of surface in front of them (quantitative invisibility); default 0", kLines},
      [&lines](const std::string& text) { lines.layers = parse_layers("--qi", text); });
  add_line_definitions(app, lines.lines);
  add(app, {"--curves", "polyline|bezier|arc", "what strokes are made of; default polyline", kLines}, [&lines](const std::string& text) {
    const std::vector<std::string> known = {"polyline", "bezier", "arc"};
    const auto at = std::find(known.begin(), known.end(), text);
    if (at == known.end()) throw InputError({"", "--curves", text, "there are no such curves", known_names(text, known)});
    lines.drawing.form = static_cast<CurveForm>(at - known.begin());
  });
  add(app, {"--fit", "PX", "how far Bezier curves and arcs may lie from the line, pixels, above 0; default 0.05", kLines},
      [&lines](const std::string& text) { lines.drawing.fit_px = parse_number_above("--fit", text, 0.0, false, "above 0 px"); });
  add(app, {"--page", "WxHmm", "the drawing fitted into a page of millimetres; default: a unit is a pixel", kLines},
      [&lines](const std::string& text) { lines.drawing.page_mm = parse_page("--page", text); });
  add(app,
      {"--style", "plain|technical|ink|FILE.css",
       "widths, colours and dashes of each class: plain, technical, ink, or a style sheet; default plain", kLines},
      [&lines](const std::string& text) { lines.drawing.style = read_style(text); });
  add_switch(app, {"--strict", "", "exit with 1 where the certificate finds a conflict", kLines}, lines.strict);
}

void add_line_frames(CLI::App& app, Options& options) {
  LineOptions& lines = options.lines;
  add_frames(app, options, "N pictures while the camera wanders within a pixel, or goes round with --turn, 1..10000; lines keep their ids");
  auto* frames = app.get_option("--frames");
  add(app,
      {"--turn", "DEG",
       "the camera goes round its target about --up, by so many degrees over all frames; 360: once, the last frame a step short", kCamera},
      [&lines](const std::string& text) { lines.turn_deg = parse_number("--turn", text); })
      ->needs(frames)
      ->excludes(app.get_option("--path-step"))
      ->excludes(app.get_option("--seed"));
  auto* animate = app.add_flag("--animate", lines.animate, "one SVG that plays all frames instead of a file a frame");
  animate->group(kLines)->needs(frames);
  add(app, {"--fps", "N", "frames a second of --animate, above 0; default 24", kLines}, [&lines](const std::string& text) {
    lines.frames_per_second = parse_number_above("--fps", text, 0.0, false, "above 0 frames a second");
  })->needs(animate);
}

namespace {

void add_ink(CLI::App& app, InkChoice& ink) {
  auto* color =
      add(app,
          {"--ink", "COLOR",
           "colour of the lines in the drawing; default: all strokes of an SVG, and what is darker than a picture's background", kJudge},
          [&ink](const std::string& text) { ink.color = glm::dvec3(parse_color("--ink", text)); });
  auto* alpha = app.add_flag("--alpha", ink.alpha, "the picture's alpha is the ink");
  alpha->group(kJudge)->excludes(color);
  add(app, {"--mask", "FILE", "a picture whose first channel is the ink, 1 where a line is", kJudge},
      [&ink](const std::string& text) { ink.mask = text; })
      ->excludes(color)
      ->excludes(alpha);
}

void add_judge_limits(CLI::App& app, JudgeLimits& limits) {
  const auto length = [&app](const char* flag, const char* help, std::optional<LengthLimit>& limit) {
    add(app, {flag, "LENGTH", help, kJudgeLimits}, [&limit, flag](const std::string& text) { limit = parse_length_limit(flag, text); });
  };
  length("--max-missed", "visible lines that the drawing lacks", limits.missed);
  length("--max-false", "strokes where no line is", limits.false_ink);
  length("--max-hidden", "strokes along lines that the surface hides", limits.hidden);
  length("--max-doubled", "strokes that are one too many", limits.doubled);
  add(app, {"--max-displaced", "PX", "95 % of the matched lines lie within, pixels", kJudgeLimits}, [&limits](const std::string& text) {
    limits.displaced_px = parse_number_above("--max-displaced", text, 0.0, true, "a number of pixels from 0 up");
  });
}

}  // namespace

void add_compare_limits(CLI::App& app, Options& options) {
  constexpr const char* kCompareLimits = "Limits of each picture (exit code 1 beyond them)";
  CompareLimits& limits = options.compare;
  add(app, {"--max-differ", "LENGTH", "border pixels that differ from the reference's, such as 50px, or 2% of its border", kCompareLimits},
      [&limits](const std::string& text) { limits.differ = parse_length_limit("--max-differ", text); });
  add(app, {"--max-displaced", "PX", "95 % of the border lie within, from the true one, pixels", kCompareLimits},
      [&limits](const std::string& text) {
        limits.displaced_px = parse_number_above("--max-displaced", text, 0.0, true, "a number of pixels from 0 up");
      });
  add(app, {"--junit", "FILE", "the limits as JUnit XML, a test case for each picture and limit", kOutput},
      [&limits](const std::string& text) { limits.junit = text; });
}

void add_judge(CLI::App& app, Options& options) {
  JudgeOptions& judge = options.judge;
  app.add_option("DRAWING", judge.drawing, "an SVG, or a picture: .png .exr .tif .jpg")->type_name("")->required();
  add(app, {"--against", "INPUT", "what was drawn: scene file, mesh, volume, formula or built-in scene, as for limn contours", kJudge},
      [&options](const std::string& text) { options.spec.input = text; })
      ->required();
  add(app,
      {"--lines", "A,B,...|all", "classes of lines (limn list lines) that the drawing should hold; default: as limn contours draws",
       kJudge},
      [&judge](const std::string& text) {
        if (text == "all") {
          for (const LineClassDescriptor& one : line_classes()) add_unless_there(one.line_class, judge.lines.classes);
          return;
        }
        for (const std::string& name : parse_names(text))
          add_unless_there(line_classes().find(name, "", "--lines").line_class, judge.lines.classes);
      });
  add_line_definitions(app, judge.lines);
  add(app, {"--search", "PX", "strokes farther than this from a line do not match it, pixels, above 0 up to 32; default 2", kJudge},
      [&judge](const std::string& text) {
        const char* const expected = "above 0 and up to 32 pixels";
        judge.settings.search_px = parse_number_above("--search", text, 0.0, false, expected);
        if (judge.settings.search_px > 32.0) throw InputError({"", "--search", text, "out of range", expected});
      });
  add_ink(app, judge.ink);
  add(app, {"--junit", "FILE", "the limits as JUnit XML, a test case each", kOutput},
      [&judge](const std::string& text) { judge.junit = text; });
  add_judge_limits(app, judge.limits);
}

}  // namespace limn
