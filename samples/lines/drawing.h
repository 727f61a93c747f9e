#pragma once
// A view graph as strokes to be drawn, in whatever file: chosen by visibility, fitted to the curves asked for, and styled by class.

#include <array>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "raymarch/lines.h"

namespace limn {

/// How a class of lines is drawn, visible or hidden.
struct StrokeStyle {
  double width_px = 1.0;
  std::string color = "#000000";  ///< "#rrggbb".
  std::vector<double> dash_px{};  ///< Lengths of dashes and gaps in turn; empty: solid.
  bool taper = false;             ///< Thinner towards cusps and ends.
};

/// Of all classes.
struct DrawingStyle {
  std::string name{};
  std::map<LineClass, StrokeStyle> visible{}, hidden{};
};
/// "plain", "technical" or "ink". Throws InputError (field "style") for another name.
DrawingStyle built_in_style(const std::string& name);

/// A built-in style, or the one in a .css file (styles.cpp). Throws InputError.
DrawingStyle read_style(const std::string& name_or_file);

/// What a stroke becomes in a file.
enum class CurveForm { polyline, bezier, arc };

struct DrawingSettings {
  int lowest_invisibility = 0, highest_invisibility = 0;  ///< Layers in front of what is drawn.
  CurveForm form = CurveForm::polyline;
  double fit_px = 0.05;                 ///< How far fitted curves may lie from the line.
  std::optional<glm::dvec2> page_mm{};  ///< The drawing, scaled to fit; unset: a unit is a pixel.
  DrawingStyle style{};
};

/// To the next place of a path.
struct LineTo {
  glm::dvec2 to{0.0};
};
struct CubicTo {
  glm::dvec2 control1{0.0}, control2{0.0}, to{0.0};
};
struct ArcTo {
  glm::dvec2 center{0.0}, to{0.0};
  double radius = 0.0;
  double sweep = 0.0;  ///< Radians from the place before, positive clockwise on the screen (y down); 2 pi for a circle.
};
using PathStep = std::variant<LineTo, CubicTo, ArcTo>;

struct Stroke {
  LineClass line_class = LineClass::contour;
  int invisibility = 0;
  int object = 1;
  int chain = 0;  ///< Index into ViewGraph::chains.
  int id = 0;     ///< Kept from frame to frame; of a lone view the chain's index.
  bool closed = false;
  VertexKind begin = VertexKind::end, finish = VertexKind::end;  ///< Of an open one.
  std::vector<LinePoint> points{};
  glm::dvec2 start{0.0};
  std::vector<PathStep> steps{};
};

/// In px of the picture, y down.
struct LineDrawing {
  int width_px = 0, height_px = 0;
  DrawingSettings settings{};
  std::vector<Stroke> strokes{};  ///< Hidden ones first, then by class as they are painted.
};

/// `ids`: one a chain (raymarch/line_tracks.h); empty: their indices.
LineDrawing make_drawing(const ViewGraph& graph, int width_px, int height_px, const DrawingSettings& settings,
                         const std::vector<int>& ids = {});

/// The path through a stroke's points, within the tolerance of them.
std::vector<PathStep> fit_path(const std::vector<LinePoint>& points, bool closed, CurveForm form, double fit_px);

}  // namespace limn
