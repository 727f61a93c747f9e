#pragma once
// Internal to limn-read-svg: path data and basic shapes as polylines, transforms, dashes.

#include <glm/glm.hpp>
#include <pugixml.hpp>
#include <string_view>
#include <vector>

namespace limn {

/// Homogeneous: x' = m * (x, y, 1).
using SvgTransform = glm::dmat3;

/// "translate(3,4) rotate(30)"; what is not understood ends the list.
SvgTransform svg_transform(std::string_view text);

struct SvgPolyline {
  std::vector<glm::dvec2> points{};
  bool closed = false;
};

/// The subpaths of path data, moved by `transform` and flattened to kSvgFlatness_px there. As SVG asks, an error ends the path: what stands
/// before it is kept.
std::vector<SvgPolyline> svg_path(std::string_view data, const SvgTransform& transform);

/// Those of any element that draws: path, line, polyline, polygon, rect, circle, ellipse. `size` is what percentages are of. Empty for
/// others.
std::vector<SvgPolyline> svg_shape(const pugi::xml_node& element, const SvgTransform& transform, const glm::dvec2& size);

/// The dashes of a line. `dash` and `offset` in its units; lines with more than a million dashes stay whole.
std::vector<SvgPolyline> dashed(const SvgPolyline& line, const std::vector<double>& dash, double offset);

/// Numbers with spaces or commas between them, up to the first that is none.
std::vector<double> svg_numbers(std::string_view text);

}  // namespace limn
