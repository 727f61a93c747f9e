#include "samples/lines/taper.h"

#include <algorithm>
#include <cmath>

namespace limn {
namespace {

constexpr double kReach = 8.0;    // widths, from an end
constexpr double kTip = 0.12;     // of the width, at an end
constexpr double kStep_px = 1.0;  // between places of the outline near an end

bool narrows_at(VertexKind kind) { return kind == VertexKind::cusp || kind == VertexKind::end; }

/// Places along the stroke, close together so that the outline follows the change of width.
std::vector<glm::dvec2> places_of(const Stroke& stroke) {
  std::vector<glm::dvec2> places;
  for (const LinePoint& point : stroke.points) {
    if (!places.empty()) {
      const double length = glm::distance(places.back(), point.px);
      if (length < 1e-9) continue;
      const auto parts = static_cast<int>(std::ceil(length / kStep_px));
      const glm::dvec2 from = places.back();
      for (int k = 1; k < parts; ++k) places.push_back(glm::mix(from, point.px, static_cast<double>(k) / parts));
    }
    places.push_back(point.px);
  }
  return places;
}

double share_at(double distance, double reach) {
  const double x = std::clamp(distance / reach, 0.0, 1.0);
  return kTip + (1.0 - kTip) * x * (2.0 - x);
}

}  // namespace

bool tapers(const Stroke& stroke, const StrokeStyle& style) {
  return style.taper && !stroke.closed && (narrows_at(stroke.begin) || narrows_at(stroke.finish));
}

std::vector<glm::dvec2> tapered_outline(const Stroke& stroke, double width_px) {
  const std::vector<glm::dvec2> places = places_of(stroke);
  std::vector<double> along{0.0};
  for (size_t i = 1; i < places.size(); ++i) along.push_back(along.back() + glm::distance(places[i], places[i - 1]));
  const double reach = std::min(kReach * width_px, 0.5 * along.back());
  std::vector<glm::dvec2> left, right;
  for (size_t i = 0; i < places.size(); ++i) {
    const glm::dvec2 way = places[std::min(i + 1, places.size() - 1)] - places[i > 0 ? i - 1 : 0];
    const double length = glm::length(way);
    const glm::dvec2 across = length > 0.0 ? glm::dvec2(-way.y, way.x) / length : glm::dvec2(0.0);
    double half = 0.5 * width_px;
    if (narrows_at(stroke.begin)) half *= share_at(along[i], reach);
    if (narrows_at(stroke.finish)) half *= share_at(along.back() - along[i], reach);
    left.push_back(places[i] + half * across);
    right.push_back(places[i] - half * across);
  }
  left.insert(left.end(), right.rbegin(), right.rend());
  return left;
}

}  // namespace limn
