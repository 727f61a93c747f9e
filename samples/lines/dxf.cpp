// Strokes as DXF of release 12, which every program reads: polylines whose arcs are bulges, arcs and circles, a layer a class and
// visibility. The format's own documentation: Autodesk, "DXF Reference", group codes. Units are the page's millimetres, or pixels; y is up.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "samples/lines/write_drawing.h"

namespace limn {
namespace {

constexpr double kChord_px = 0.01;  // how far chords of a Bezier curve lie from it

class DxfText {
 public:
  explicit DxfText(const LineDrawing& drawing) : drawing_(drawing) {
    const glm::dvec2 size(drawing.width_px, drawing.height_px);
    const glm::dvec2 page = drawing.settings.page_mm.value_or(size);
    scale_ = std::min(page.x / size.x, page.y / size.y);
    corner_ = 0.5 * (page - scale_ * size);
  }

  std::string run() {
    tables();
    code(0, "SECTION");
    code(2, "ENTITIES");
    for (const Stroke& stroke : drawing_.strokes) add(stroke);
    code(0, "ENDSEC");
    code(0, "EOF");
    return std::move(text_);
  }

 private:
  void code(int group, const std::string& value) { text_ += fmt::format("{:>3}\n{}\n", group, value); }
  void code(int group, int value) { code(group, std::to_string(value)); }
  void code(int group, double value) { code(group, fmt::format("{:.9g}", value)); }
  void place_at(int group, const glm::dvec2& p) {
    code(group, p.x);
    code(group + 10, p.y);
    code(group + 20, 0.0);
  }
  glm::dvec2 placed(const glm::dvec2& px) const {
    return corner_ + scale_ * glm::dvec2(px.x, static_cast<double>(drawing_.height_px) - px.y);
  }

  static std::string layer_of(const Stroke& stroke) {
    std::string name = name_of(stroke.line_class) + (stroke.invisibility == 0 ? "_VISIBLE" : "_HIDDEN");
    std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    return name;
  }

  void tables() {
    code(0, "SECTION");
    code(2, "HEADER");
    code(9, "$ACADVER");
    code(1, "AC1009");
    code(0, "ENDSEC");
    code(0, "SECTION");
    code(2, "TABLES");
    line_types();
    std::vector<std::pair<std::string, bool>> layers;
    for (const Stroke& stroke : drawing_.strokes) {
      const std::pair<std::string, bool> layer(layer_of(stroke), stroke.invisibility == 0);
      if (std::find(layers.begin(), layers.end(), layer) == layers.end()) layers.push_back(layer);
    }
    code(0, "TABLE");
    code(2, "LAYER");
    code(70, static_cast<int>(layers.size()));
    for (const auto& [name, visible] : layers) {
      code(0, "LAYER");
      code(2, name);
      code(70, 0);
      code(62, visible ? 7 : 8);
      code(6, visible ? "CONTINUOUS" : "HIDDEN");
    }
    code(0, "ENDTAB");
    code(0, "ENDSEC");
  }

  void line_types() {
    code(0, "TABLE");
    code(2, "LTYPE");
    code(70, 2);
    code(0, "LTYPE");
    code(2, "CONTINUOUS");
    code(70, 0);
    code(3, "Solid line");
    code(72, 65);
    code(73, 0);
    code(40, 0.0);
    code(0, "LTYPE");
    code(2, "HIDDEN");
    code(70, 0);
    code(3, "Dashes");
    code(72, 65);
    code(73, 2);
    code(40, scale_ * 9.0);
    code(49, scale_ * 6.0);
    code(49, scale_ * -3.0);
    code(0, "ENDTAB");
  }

  void add(const Stroke& stroke) {
    const auto* const circle = stroke.steps.size() == 1 ? std::get_if<ArcTo>(&stroke.steps[0]) : nullptr;
    if (circle != nullptr && stroke.closed) {
      code(0, "CIRCLE");
      code(8, layer_of(stroke));
      place_at(10, placed(circle->center));
      code(40, scale_ * circle->radius);
      return;
    }
    code(0, "POLYLINE");
    code(8, layer_of(stroke));
    code(66, 1);
    place_at(10, glm::dvec2(0.0));
    code(70, stroke.closed ? 1 : 0);
    vertices(stroke);
    code(0, "SEQEND");
    code(8, layer_of(stroke));
  }

  /// A Bezier curve becomes chords to a hundredth of a pixel.
  void vertices(const Stroke& stroke) {
    struct Corner {
      glm::dvec2 at{0.0};
      double bulge = 0.0;  ///< Of the step that follows: the tangent of a quarter of its angle, positive counter-clockwise, y up.
    };
    std::vector<Corner> corners{{stroke.start, 0.0}};
    for (const PathStep& step : stroke.steps) {
      if (const auto* line = std::get_if<LineTo>(&step)) {
        corners.push_back({line->to, 0.0});
      } else if (const auto* arc = std::get_if<ArcTo>(&step)) {
        corners.back().bulge = -std::tan(0.25 * arc->sweep);
        corners.push_back({arc->to, 0.0});
      } else {
        const auto& cubic = std::get<CubicTo>(step);
        const glm::dvec2 from = corners.back().at;
        // Chords lie off by an eighth of the greatest second derivative over the square of their number (Wang 1984).
        const double second = 6.0 * std::max(glm::length(from - 2.0 * cubic.control1 + cubic.control2),
                                             glm::length(cubic.control1 - 2.0 * cubic.control2 + cubic.to));
        const int parts = std::clamp(static_cast<int>(std::ceil(std::sqrt(second / (8.0 * kChord_px)))), 2, 400);
        for (int k = 1; k <= parts; ++k) {
          const double t = static_cast<double>(k) / parts, s = 1.0 - t;
          corners.push_back(
              {s * s * s * from + 3.0 * s * s * t * cubic.control1 + 3.0 * s * t * t * cubic.control2 + t * t * t * cubic.to, 0.0});
        }
      }
    }
    if (stroke.closed && corners.size() > 1 && glm::distance(corners.front().at, corners.back().at) < 1e-9) corners.pop_back();
    for (const Corner& corner : corners) {
      code(0, "VERTEX");
      code(8, layer_of(stroke));
      place_at(10, placed(corner.at));
      if (corner.bulge != 0.0) code(42, corner.bulge);
    }
  }

  const LineDrawing& drawing_;
  double scale_ = 1.0;
  glm::dvec2 corner_{0.0};
  std::string text_;
};

}  // namespace

std::string dxf_text(const LineDrawing& drawing) { return DxfText(drawing).run(); }

}  // namespace limn
