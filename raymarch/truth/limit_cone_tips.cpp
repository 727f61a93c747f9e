#include "raymarch/truth/limit_cone_tips.h"

#include <algorithm>
#include <limits>

namespace limn {
namespace {

/// Of the way from a patch's corner to the next sample: beyond what patches approximate at the corner.
constexpr double kBeside = 0.1;
/// Between the normals of two ways at a tip, at least.
constexpr double kCone = 0.05;

/// A patch's corners, in order around it.
std::vector<glm::dvec2> corners_of(const LimitPatch& patch) {
  if (patch.triangle) return {{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}};
  return {{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}};
}

/// The surface a little beside a corner, on the way to another place of the patch.
LimitSample beside(const PlacedLimitSurface& placed, size_t k, const glm::dvec2& corner, const glm::dvec2& other, double share = kBeside) {
  return sample(placed, k, glm::mix(corner, other, share));
}

/// The normal that the way to another place begins with: a bend goes on to the corner, a cone does not end in any other.
glm::dvec3 first_normal(const PlacedLimitSurface& placed, size_t k, const glm::dvec2& corner, const glm::dvec2& other) {
  const LimitSample near = beside(placed, k, corner, other), far = beside(placed, k, corner, other, 2.0 * kBeside);
  return near.valid && far.valid ? 2.0 * near.normal - far.normal : glm::dvec3(std::numeric_limits<double>::quiet_NaN());
}

}  // namespace

std::vector<glm::dvec2> cone_tips(const PlacedLimitSurface& placed, size_t k, int steps) {
  const std::vector<glm::dvec2> corners = corners_of(placed.patches[k]);
  const size_t count = corners.size();
  std::vector<glm::dvec2> tips;
  for (size_t i = 0; i < count; ++i) {
    const auto towards = [&](size_t other) { return glm::mix(corners[i], corners[other % count], 1.0 / steps); };
    const glm::dvec3 next = first_normal(placed, k, corners[i], towards(i + 1)),
                     before = first_normal(placed, k, corners[i], towards(i + count - 1));
    if (glm::distance(next, before) > kCone) tips.push_back(corners[i]);
  }
  return tips;
}

void take_sides_of_tips(const PlacedLimitSurface& placed, std::span<const glm::dvec2> tips, std::span<LimitTriangle> triangles,
                        const SideOfCorner& side_of) {
  if (tips.empty()) return;
  for (LimitTriangle& triangle : triangles) {
    for (size_t i = 0; i < 3; ++i) {
      LimitCorner& corner = triangle.corners[i];
      if (std::find(tips.begin(), tips.end(), corner.uv()) == tips.end()) continue;
      const auto side_on_way_to = [&](size_t other) {
        const LimitSample s = beside(placed, triangle.patch, corner.uv(), triangle.corners[other % 3].uv());
        return s.valid ? side_of(corner, s.normal) : corner.side;
      };
      const std::uint32_t next = side_on_way_to(i + 1), back = side_on_way_to(i + 2);
      corner.side = next;
      corner.side_back = back;
    }
  }
}

}  // namespace limn
