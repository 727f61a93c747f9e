#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "sdf/error.h"
#include "subdiv/mesh_distance.h"

namespace limn {
namespace {

/// Separating axes of a box and a triangle (Akenine-Möller 2001); the box is centred at the origin. Touching counts as overlap.
bool overlaps(const glm::dvec3& half, const std::array<glm::dvec3, 3>& p) {
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

using Key = std::tuple<int, int, int>;

class BlockFinder {
 public:
  BlockFinder(double voxel_size, double reach, std::int64_t max_blocks) : size_(voxel_size), reach_(reach), max_blocks_(max_blocks) {}

  void add(const std::array<glm::dvec3, 3>& triangle) {
    triangle_ = triangle;
    Box box;
    for (const glm::dvec3& p : triangle) box = include(box, p);
    const glm::ivec3 lower = block_of(box.lower - reach_), upper = block_of(box.upper + reach_);
    split(lower, upper);
  }

  std::vector<glm::ivec3> take() {
    compact();
    std::vector<glm::ivec3> origins;
    origins.reserve(keys_.size());
    for (const auto& [x, y, z] : keys_) origins.emplace_back(8 * x, 8 * y, 8 * z);
    return origins;
  }

 private:
  glm::ivec3 block_of(const glm::dvec3& p) const { return glm::ivec3(glm::floor(p / (8.0 * size_))); }

  /// Halves a range of blocks until it is one block or out of reach, so that a large triangle costs what it touches.
  void split(const glm::ivec3& lower, const glm::ivec3& upper) {
    const glm::dvec3 first = 8.0 * size_ * glm::dvec3(lower), last = size_ * (8.0 * glm::dvec3(upper) + 7.0);
    const glm::dvec3 center = 0.5 * (first + last);
    if (!overlaps(0.5 * (last - first) + reach_, {triangle_[0] - center, triangle_[1] - center, triangle_[2] - center})) return;
    const glm::ivec3 count = upper - lower;
    if (count == glm::ivec3(0)) {
      keys_.emplace_back(lower.x, lower.y, lower.z);
      if (keys_.size() >= next_compaction_) compact();
      return;
    }
    const int axis = count.x >= count.y && count.x >= count.z ? 0 : count.y >= count.z ? 1 : 2;
    glm::ivec3 middle = upper, after = lower;
    middle[axis] = lower[axis] + count[axis] / 2;
    after[axis] = middle[axis] + 1;
    split(lower, middle);
    split(after, upper);
  }

  void compact() {
    std::sort(keys_.begin(), keys_.end());
    keys_.erase(std::unique(keys_.begin(), keys_.end()), keys_.end());
    if (static_cast<std::int64_t>(keys_.size()) > max_blocks_)
      throw InputError({"", "--voxel-size", fmt::format("{}", size_),
                        fmt::format("the level set would take more than {:.1f} GB",
                                    static_cast<double>(max_blocks_) * 1e-9 * static_cast<double>(sizeof(LevelSetBlock))),
                        "larger voxels or a narrower band"});
    next_compaction_ = std::max<size_t>(1 << 16, 2 * keys_.size());
  }

  double size_, reach_;
  std::int64_t max_blocks_;
  std::array<glm::dvec3, 3> triangle_{};
  std::vector<Key> keys_;
  size_t next_compaction_ = 1 << 16;
};

}  // namespace

std::vector<glm::ivec3> blocks_near_triangles(const TriangleMesh& mesh, double voxel_size, double reach, std::int64_t max_blocks) {
  BlockFinder finder(voxel_size, reach, max_blocks);
  for (const glm::uvec3& t : mesh.triangles) finder.add({mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]});
  return finder.take();
}

}  // namespace limn
