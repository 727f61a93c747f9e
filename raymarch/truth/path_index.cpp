#include "raymarch/truth/path_index.h"

#include <algorithm>

#include "sdf/segment.h"

namespace limn {
namespace {

constexpr double kOnPath = 0.15, kOnPathLeast = 1e-3;  // of a step, and of the longest step

std::uint64_t key_of(const glm::ivec3& cube) {
  const auto part = [](int v) { return static_cast<std::uint64_t>(v) & 0x1fffffu; };
  return (part(cube.x) << 42u | part(cube.y) << 21u | part(cube.z)) + 1;
}

}  // namespace

void PathIndex::add(const std::vector<CurvePoint>& points) {
  const size_t first = points_.size();
  for (const CurvePoint& point : points) points_.push_back({point.p, glm::normalize(point.uphill)});
  points_.push_back(points_[first]);
  // Most segments lie in the same cube as the one before.
  glm::ivec3 cube(std::numeric_limits<int>::min());
  std::uint32_t run = kNone;
  for (size_t i = first; i + 1 < points_.size(); ++i) {
    const glm::dvec3 &a = points_[i].p, &b = points_[i + 1].p;
    const double reach = reach_of(glm::distance(a, b));
    const glm::ivec3 low = cube_of(glm::min(a, b) - reach), high = cube_of(glm::max(a, b) + reach);
    if (low == high && low == cube) {
      runs_[run].end = static_cast<std::uint32_t>(i + 1);
      continue;
    }
    for (int x = low.x; x <= high.x; ++x)
      for (int y = low.y; y <= high.y; ++y)
        for (int z = low.z; z <= high.z; ++z) run = add_to({x, y, z}, static_cast<std::uint32_t>(i));
    cube = low == high ? low : glm::ivec3(std::numeric_limits<int>::min());
  }
}

bool PathIndex::holds(const CurvePoint& point) const {
  const std::uint32_t* const last = last_in_.find(key_of(cube_of(point.p)));
  for (std::uint32_t at = last != nullptr ? *last : kNone; at != kNone; at = runs_[at].before) {
    for (std::uint32_t i = runs_[at].begin; i < runs_[at].end; ++i) {
      const PathPoint &a = points_[i], &b = points_[i + 1];
      if (glm::dot(a.uphill + b.uphill, point.uphill) > 0.0 && distance_to_segment(point.p, a.p, b.p) < reach_of(glm::distance(a.p, b.p)))
        return true;
    }
  }
  return false;
}

std::uint32_t PathIndex::add_to(const glm::ivec3& cube, std::uint32_t segment) {
  bool added = false;
  std::uint32_t& last = last_in_.at(key_of(cube), added);
  if (!added && runs_[last].end == segment) {
    ++runs_[last].end;
  } else {
    runs_.push_back({segment, segment + 1, added ? kNone : last});
    last = static_cast<std::uint32_t>(runs_.size() - 1);
  }
  return last;
}

double PathIndex::reach_of(double length) const { return kOnPath * length + kOnPathLeast * side_; }

}  // namespace limn
