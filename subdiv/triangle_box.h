#pragma once
// Internal: separating axes of a box and a triangle, and how ranges of blocks are halved while a triangle is looked for in them.

#include <algorithm>
#include <array>
#include <glm/glm.hpp>

namespace limn {

/// Akenine-Möller 2001. Touching counts as meeting.
inline bool triangle_meets_box(const std::array<glm::dvec3, 3>& triangle, const glm::dvec3& lower, const glm::dvec3& upper) {
  const glm::dvec3 center = 0.5 * (lower + upper), half = 0.5 * (upper - lower);
  const glm::dvec3 p[3] = {triangle[0] - center, triangle[1] - center, triangle[2] - center};
  const auto separated = [&](const glm::dvec3& axis) {
    const double a = glm::dot(axis, p[0]), b = glm::dot(axis, p[1]), c = glm::dot(axis, p[2]);
    const double reach = glm::dot(glm::abs(axis), half);
    return std::min({a, b, c}) > reach || std::max({a, b, c}) < -reach;
  };
  constexpr glm::dvec3 kAxes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (const glm::dvec3& axis : kAxes)
    if (separated(axis)) return false;
  const glm::dvec3 edges[3] = {p[1] - p[0], p[2] - p[1], p[0] - p[2]};
  if (separated(glm::cross(edges[0], edges[1]))) return false;
  for (const glm::dvec3& edge : edges)
    for (const glm::dvec3& axis : kAxes)
      if (separated(glm::cross(edge, axis))) return false;
  return true;
}

/// A range of blocks, both ends included, cut across its longest side: [lower, middle] and [after, upper].
struct BlockHalves {
  glm::ivec3 middle{0}, after{0};
};
inline BlockHalves halves(const glm::ivec3& lower, const glm::ivec3& upper) {
  const glm::ivec3 count = upper - lower;
  const int axis = count.x >= count.y && count.x >= count.z ? 0 : count.y >= count.z ? 1 : 2;
  BlockHalves cut{upper, lower};
  cut.middle[axis] = lower[axis] + count[axis] / 2;
  cut.after[axis] = cut.middle[axis] + 1;
  return cut;
}

}  // namespace limn
