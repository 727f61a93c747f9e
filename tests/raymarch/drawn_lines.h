#pragma once
// What a view graph draws, and whether it is what it should be.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "raymarch/lines.h"
#include "sdf/segment.h"
#include "sdf/shape.h"
#include "tests/raymarch/line_views.h"

namespace limn {

/// A random direction, near or far, either projection.
inline Camera random_camera(std::mt19937& random, const Scene& scene, bool perspective) {
  std::normal_distribution<double> normal;
  const glm::dvec3 direction = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
  return line_view(bounds(scene), direction, std::uniform_real_distribution<double>(2.5, 6.0)(random), perspective);
}

inline ViewGraph lines_of(const Scene& scene, const Camera& camera) { return solve_lines(scene, camera, {}, {}); }

using Polyline = std::vector<glm::dvec2>;

inline double distance_to(const std::vector<Polyline>& lines, const glm::dvec2& p) {
  double least = 1e9;
  for (const Polyline& line : lines) {
    for (size_t i = 0; i + 1 < line.size(); ++i) {
      // The ends say how near a step can be.
      const double length = std::fabs(line[i + 1].x - line[i].x) + std::fabs(line[i + 1].y - line[i].y);
      if (std::max(std::fabs(p.x - line[i].x), std::fabs(p.y - line[i].y)) - length > least) continue;
      least = std::min(least, distance_to_segment(p, line[i], line[i + 1]));
    }
  }
  return least;
}

/// Lines of a graph's chains, those of one class, or with `visible` the visible ones alone.
inline std::vector<Polyline> drawn(const ViewGraph& graph, LineClass line_class, bool visible) {
  std::vector<Polyline> lines;
  for (const LineChain& chain : graph.chains) {
    if (chain.line_class != line_class || (visible && chain.invisibility > 0)) continue;
    Polyline line;
    for (const LinePoint& point : points_of(graph, chain)) line.push_back(point.px);
    if (chain.closed) line.push_back(line.front());
    lines.push_back(std::move(line));
  }
  return lines;
}

/// Both ways: everything of one near the other.
inline void expect_same(const std::vector<Polyline>& exact, const std::vector<Polyline>& found, const std::string& what) {
  const auto worst = [](const std::vector<Polyline>& lines, const std::vector<Polyline>& others) {
    std::pair<double, glm::dvec2> most(0.0, 0.0);
    for (const Polyline& line : lines) {
      for (const glm::dvec2& p : line) {
        if (const double off = distance_to(others, p); off > most.first) most = {off, p};
      }
    }
    return most;
  };
  const auto [beside, beside_at] = worst(found, exact);
  const auto [missing, missing_at] = worst(exact, found);
  EXPECT_LE(beside, 0.01) << what << fmt::format(": drawn where no line is, at {}, {}", beside_at.x, beside_at.y);
  EXPECT_LE(missing, 0.01) << what << fmt::format(": not drawn at {}, {}", missing_at.x, missing_at.y);
}

inline void expect_sound(const ViewGraph& graph, const std::string& what) {
  EXPECT_TRUE(graph.conflicts.empty()) << what << ": " << graph.conflicts.front().what;
  std::vector<int> uses(graph.edges.size(), 0);
  for (const LineChain& chain : graph.chains) {
    for (const ChainLink& link : chain.links) {
      ++uses[static_cast<size_t>(link.edge)];
      EXPECT_EQ(graph.edges[static_cast<size_t>(link.edge)].invisibility, chain.invisibility) << what;
    }
  }
  EXPECT_TRUE(std::all_of(uses.begin(), uses.end(), [](int n) { return n == 1; })) << what << ": an edge is not in just one chain";
  for (const LineEdge& edge : graph.edges) {
    EXPECT_GE(edge.points.size(), 2u) << what;
    EXPECT_GE(edge.invisibility, 0) << what;
  }
}

}  // namespace limn
