#pragma once
// Views of shapes whose suggestive contours, ridges and valleys are known, and what is drawn of them.

#include <algorithm>
#include <cmath>
#include <random>

#include "raymarch/lines.h"
#include "sdf/segment.h"
#include "tests/raymarch/line_views.h"

namespace limn {

inline constexpr double kMajor = 1.0, kMinor = 0.4;  // of a torus

inline Camera camera_from(const glm::dvec3& direction, const Box& box, bool perspective) {
  CameraSettings settings;
  settings.target = box.center();
  settings.eye = box.center() + 3.5 * box.radius() * glm::normalize(direction);
  settings.up = std::fabs(glm::normalize(direction).y) > 0.9 ? glm::dvec3(1.0, 0.0, 0.0) : glm::dvec3(0.0, 1.0, 0.0);
  settings.width_px = 480;
  settings.height_px = 360;
  settings.vertical_fov = 2.2 * std::asin(1.0 / 3.5);
  if (!perspective) {
    settings.projection = Projection::orthographic;
    settings.ortho_height = 2.2 * box.radius();
  }
  return resolve_camera(settings, box);
}

inline glm::dvec3 random_direction(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
}

using Polyline = std::vector<LinePoint>;

inline std::vector<Polyline> edges_of(const ViewGraph& graph, LineClass line_class) {
  std::vector<Polyline> lines;
  for (const LineEdge& edge : graph.edges) {
    if (edge.line_class != line_class) continue;
    lines.push_back(edge.points);
    if (edge.begin < 0) lines.back().push_back(edge.points.front());
  }
  return lines;
}

inline double distance_to_any(const std::vector<Polyline>& lines, const glm::dvec2& p) {
  double least = 1e9;
  for (const Polyline& line : lines) {
    for (size_t i = 0; i + 1 < line.size(); ++i) least = std::min(least, distance_to_segment(p, line[i].px, line[i + 1].px));
  }
  return least;
}

/// How far points of the one's suggestive contours are at most from the other's, px.
inline double farthest(const ViewGraph& one, const ViewGraph& other) {
  const std::vector<Polyline> lines = edges_of(other, LineClass::suggestive);
  double most = 0.0;
  for (const Polyline& line : edges_of(one, LineClass::suggestive)) {
    for (const LinePoint& point : line) most = std::max(most, distance_to_any(lines, point.px));
  }
  return most;
}

}  // namespace limn
