#include "raymarch/truth/path_index.h"

#include <algorithm>

#include "sdf/segment.h"

namespace limn {
namespace {

constexpr double kOnPath = 0.15, kOnPathLeast = 1e-3;  // of a step, and of the longest step
constexpr size_t kMostCubes = 16;                      // of a segment and the one before that are looked through for its own

std::uint64_t key_of(const glm::ivec3& cube) {
  const auto part = [](int v) { return static_cast<std::uint64_t>(v) & 0x1fffffu; };
  return (part(cube.x) << 42u | part(cube.y) << 21u | part(cube.z)) + 1;
}

}  // namespace

PathIndex::Prepared PathIndex::prepare(const std::vector<CurvePoint>& points) const {
  Prepared path;
  path.points_.reserve(points.size() + 1);
  for (const CurvePoint& point : points) path.points_.push_back({point.p, glm::normalize(point.uphill)});
  path.points_.push_back(path.points_.front());
  const auto add_to = [&](const glm::ivec3& cube, std::uint32_t segment) {
    const std::uint64_t key = key_of(cube);
    // A segment lies in few cubes, mostly in those of the one before.
    for (size_t k = path.runs_.size(); k > 0 && path.runs_.size() - k < kMostCubes; --k) {
      Prepared::CubeRun& one = path.runs_[k - 1];
      if (one.cube != key || one.run.end != segment) continue;
      ++one.run.end;
      return;
    }
    path.runs_.push_back({key, {segment, segment + 1}});
  };
  for (std::uint32_t i = 0; i + 1 < path.points_.size(); ++i) {
    const glm::dvec3 &a = path.points_[i].p, &b = path.points_[i + 1].p;
    const double reach = reach_of(glm::distance(a, b));
    const glm::ivec3 low = cube_of(glm::min(a, b) - reach), high = cube_of(glm::max(a, b) + reach);
    for (int x = low.x; x <= high.x; ++x)
      for (int y = low.y; y <= high.y; ++y)
        for (int z = low.z; z <= high.z; ++z) add_to({x, y, z}, i);
  }
  return path;
}

void PathIndex::add(const Prepared& path) {
  const auto first = static_cast<std::uint32_t>(points_.size());
  points_.insert(points_.end(), path.points_.begin(), path.points_.end());
  for (const Prepared::CubeRun& one : path.runs_) {
    bool added = false;
    std::uint32_t& last = last_in_.at(one.cube, added);
    runs_.push_back({first + one.run.begin, first + one.run.end, added ? kNone : last});
    last = static_cast<std::uint32_t>(runs_.size() - 1);
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

double PathIndex::reach_of(double length) const { return kOnPath * length + kOnPathLeast * side_; }

}  // namespace limn
