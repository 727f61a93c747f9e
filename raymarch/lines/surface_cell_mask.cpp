#include "raymarch/lines/surface_cell_mask.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace limn {
namespace {

constexpr double kGap = 1e-9;  // voxels: stretches that lie closer together are one

/// From one cube of a lattice to the next along a ray (Amanatides & Woo 1987, "A fast voxel traversal algorithm for ray tracing").
struct LatticeWalk {
  glm::ivec3 at{0};
  glm::ivec3 way{0};
  glm::dvec3 next{0.0}, apart{0.0};  ///< Where the ray goes through the next face across each axis, and how far apart such faces are.

  LatticeWalk(const IndexRay& ray, double side, double t, const glm::ivec3& low, const glm::ivec3& high) {
    for (int axis = 0; axis < 3; ++axis) {
      const double from = ray.origin[axis] / side, rate = ray.direction[axis] / side;
      at[axis] = static_cast<int>(std::floor(std::clamp(from + t * rate, static_cast<double>(low[axis]), static_cast<double>(high[axis]))));
      way[axis] = rate < 0.0 ? -1 : 1;
      const double face = at[axis] + (rate < 0.0 ? 0 : 1);
      next[axis] = rate != 0.0 ? (face - from) / rate : std::numeric_limits<double>::infinity();
      apart[axis] = rate != 0.0 ? 1.0 / std::fabs(rate) : 0.0;
    }
  }
  double end() const { return std::min({next.x, next.y, next.z}); }
  void go_on() {
    const int axis = next.x <= next.y ? (next.x <= next.z ? 0 : 2) : (next.y <= next.z ? 1 : 2);
    at[axis] += way[axis];
    next[axis] += apart[axis];
  }
};

}  // namespace

std::uint64_t SurfaceCellMask::key_of(const glm::ivec3& block) {
  const auto part = [](int v) { return static_cast<std::uint64_t>(v) & 0x1fffffu; };
  return (part(block.x) << 42u | part(block.y) << 21u | part(block.z)) + 1;
}

SurfaceCellMask::SurfaceCellMask(std::span<const SurfaceCell> cells) {
  // Cells of one block mostly follow each other.
  std::uint64_t last = 0;
  Block* block = nullptr;
  for (const SurfaceCell& cell : cells) {
    const std::uint64_t key = key_of(cell.node >> 3);
    bool added = false;
    if (key != last) block = &blocks_.at(key, added), last = key;
    const glm::ivec3 place = cell.node & (kSide - 1);
    (*block)[static_cast<size_t>(place.x)] |= std::uint64_t{1} << (place.y * kSide + place.z);
  }
}

bool SurfaceCellMask::holds(const glm::ivec3& node) const {
  const Block* const block = blocks_.find(key_of(node >> 3));
  return block != nullptr && holds(*block, node & (kSide - 1));
}

void SurfaceCellMask::find_stretches(const IndexRay& ray, double begin, double end, std::vector<RayStretch>& stretches) const {
  stretches.clear();
  const double gap = kGap / glm::length(ray.direction);
  constexpr int kFarthest = 1 << 20;
  const glm::ivec3 low(-kFarthest), high(kFarthest);
  LatticeWalk blocks(ray, kSide, begin, low, high);
  for (double t = begin; t < end; blocks.go_on()) {
    const double block_begin = t, block_end = std::min(end, std::max(t, blocks.end()));
    t = block_end;
    const Block* const block = blocks_.find(key_of(blocks.at));
    if (block == nullptr || !(block_begin < block_end)) continue;
    const glm::ivec3 first = kSide * blocks.at, last = first + (kSide - 1);
    LatticeWalk cells(ray, 1.0, block_begin, first, last);
    for (double from = block_begin; from < block_end; cells.go_on()) {
      const glm::ivec3 place = cells.at - first;
      if (glm::any(glm::lessThan(place, glm::ivec3(0))) || glm::any(glm::greaterThan(place, glm::ivec3(kSide - 1)))) break;
      const double to = std::min(block_end, std::max(from, cells.end()));
      if (from < to && holds(*block, place)) {
        if (!stretches.empty() && from - stretches.back().end <= gap)
          stretches.back().end = to;
        else
          stretches.push_back({from, to});
      }
      from = to;
    }
  }
}

}  // namespace limn
