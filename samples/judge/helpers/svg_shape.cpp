// Basic shapes, transforms and dashes.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "samples/judge/helpers/svg_curves.h"
#include "samples/judge/helpers/svg_path.h"
#include "samples/judge/helpers/svg_style.h"

namespace limn {
namespace {

SvgTransform one_transform(std::string_view name, std::vector<double> v) {
  const size_t given = v.size();
  v.resize(6, 0.0);
  const auto matrix = [](double a, double b, double c, double d, double e, double f) {
    return SvgTransform({a, b, 0.0}, {c, d, 0.0}, {e, f, 1.0});
  };
  const double angle = v[0] * std::numbers::pi / 180.0;
  if (name == "matrix") return matrix(v[0], v[1], v[2], v[3], v[4], v[5]);
  if (name == "translate") return matrix(1, 0, 0, 1, v[0], v[1]);
  if (name == "scale") return matrix(v[0], 0, 0, given > 1 ? v[1] : v[0], 0, 0);
  if (name == "skewX") return matrix(1, 0, std::tan(angle), 1, 0, 0);
  if (name == "skewY") return matrix(1, std::tan(angle), 0, 1, 0, 0);
  if (name != "rotate") return SvgTransform(1.0);
  const double c = std::cos(angle), s = std::sin(angle);
  return matrix(1, 0, 0, 1, v[1], v[2]) * matrix(c, s, -s, c, 0, 0) * matrix(1, 0, 0, 1, -v[1], -v[2]);
}

SvgPolyline ellipse(const glm::dvec2& center, const glm::dvec2& radii, const SvgTransform& transform) {
  const CurveFlattener curves{transform};
  SvgPolyline line;
  const glm::dvec2 right = center + glm::dvec2(radii.x, 0.0), left = center - glm::dvec2(radii.x, 0.0);
  curves.line(right, line.points);
  curves.arc({right, left, radii, 0.0, false, true}, line.points);
  curves.arc({left, right, radii, 0.0, false, true}, line.points);
  line.closed = true;
  return line;
}

SvgPolyline rectangle(const glm::dvec2& low, const glm::dvec2& size, glm::dvec2 radii, const SvgTransform& transform) {
  const CurveFlattener curves{transform};
  SvgPolyline line;
  line.closed = true;
  radii = glm::clamp(radii, glm::dvec2(0.0), 0.5 * size);
  const std::array<glm::dvec2, 4> corners = {low, low + glm::dvec2(size.x, 0.0), low + size, low + glm::dvec2(0.0, size.y)};
  const std::array<glm::dvec2, 4> along = {glm::dvec2(1.0, 0.0), {0.0, 1.0}, {-1.0, 0.0}, {0.0, -1.0}};
  for (size_t i = 0; i < 4; ++i) {
    const glm::dvec2 before = corners[i] - along[(i + 3) % 4] * radii, after = corners[i] + along[i] * radii;
    curves.line(before, line.points);
    if (before != after) curves.arc({before, after, radii, 0.0, false, true}, line.points);
  }
  return line;
}

SvgPolyline polygon(const std::vector<double>& numbers, bool closed, const SvgTransform& transform) {
  const CurveFlattener curves{transform};
  SvgPolyline line;
  line.closed = closed;
  for (size_t i = 0; i + 1 < numbers.size(); i += 2) curves.line({numbers[i], numbers[i + 1]}, line.points);
  return line;
}

}  // namespace

SvgTransform svg_transform(std::string_view text) {
  SvgTransform result(1.0);
  while (true) {
    const size_t open = text.find('('), close = text.find(')');
    if (open == std::string_view::npos || close == std::string_view::npos || close < open) return result;
    std::string_view name = text.substr(0, open);
    while (!name.empty() && std::isalpha(static_cast<unsigned char>(name.front())) == 0) name.remove_prefix(1);
    while (!name.empty() && std::isalpha(static_cast<unsigned char>(name.back())) == 0) name.remove_suffix(1);
    result = result * one_transform(name, svg_numbers(text.substr(open + 1, close - open - 1)));
    text.remove_prefix(close + 1);
  }
}

std::vector<SvgPolyline> svg_shape(const pugi::xml_node& element, const SvgTransform& transform, const glm::dvec2& size) {
  const std::string_view name = local_name(element.name());
  const auto length = [&](const char* key, double whole) {
    const double value = svg_length(element.attribute(key).value(), whole);
    return std::isfinite(value) ? value : 0.0;
  };
  const double diagonal = glm::length(size) / std::numbers::sqrt2;
  std::vector<SvgPolyline> lines;
  if (name == "path") return svg_path(element.attribute("d").value(), transform);
  if (name == "line")
    lines = {polygon({length("x1", size.x), length("y1", size.y), length("x2", size.x), length("y2", size.y)}, false, transform)};
  if (name == "polyline" || name == "polygon")
    lines = {polygon(svg_numbers(element.attribute("points").value()), name == "polygon", transform)};
  const glm::dvec2 center(length("cx", size.x), length("cy", size.y));
  if (name == "circle") lines = {ellipse(center, glm::dvec2(length("r", diagonal)), transform)};
  if (name == "ellipse") lines = {ellipse(center, {length("rx", size.x), length("ry", size.y)}, transform)};
  if (name == "rect") {
    glm::dvec2 radii(length("rx", size.x), length("ry", size.y));
    if (element.attribute("rx").empty()) radii.x = radii.y;
    if (element.attribute("ry").empty()) radii.y = radii.x;
    lines = {rectangle({length("x", size.x), length("y", size.y)}, {length("width", size.x), length("height", size.y)}, radii, transform)};
  }
  std::erase_if(lines, [](const SvgPolyline& line) { return line.points.size() < 2; });
  return lines;
}

std::vector<SvgPolyline> dashed(const SvgPolyline& line, const std::vector<double>& dash, double offset) {
  std::vector<glm::dvec2> points = line.points;
  if (line.closed) points.push_back(points.front());
  double total = 0.0, period = 0.0;
  for (size_t i = 0; i + 1 < points.size(); ++i) total += glm::distance(points[i], points[i + 1]);
  for (const double one : dash) period += one;
  constexpr double kMostDashes = 1e6;
  if (!(period > 0.0) || total * static_cast<double>(dash.size()) / period > kMostDashes) return {line};
  size_t at = 0;
  double left = std::fmod(offset, period);
  if (left < 0.0) left += period;
  while (left >= dash[at]) left -= dash[at], at = (at + 1) % dash.size();
  left = dash[at] - left;
  std::vector<SvgPolyline> pieces;
  std::vector<glm::dvec2> piece = {points.front()};
  for (size_t i = 0; i + 1 < points.size(); ++i) {
    const double length = glm::distance(points[i], points[i + 1]);
    double done = 0.0;
    while (length - done > left) {
      done += left;
      piece.push_back(points[i] + (points[i + 1] - points[i]) * (done / length));
      if (at % 2 == 0 && piece.size() > 1) pieces.push_back({piece, false});
      piece = {piece.back()};
      at = (at + 1) % dash.size();
      left = dash[at];
    }
    left -= length - done;
    piece.push_back(points[i + 1]);
  }
  if (at % 2 == 0 && piece.size() > 1) pieces.push_back({piece, false});
  return pieces;
}

}  // namespace limn
