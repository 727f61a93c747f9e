#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "sdf/memory_text.h"
#include "sdf/size_error.h"
#include "subdiv/mesh_distance.h"
#include "subdiv/triangle_box.h"

namespace limn {
namespace {

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
    if (!triangle_meets_box(triangle_, first - reach_, last + reach_)) return;
    if (lower == upper) {
      keys_.emplace_back(lower.x, lower.y, lower.z);
      if (keys_.size() >= next_compaction_) compact();
      return;
    }
    const BlockHalves cut = halves(lower, upper);
    split(lower, cut.middle);
    split(cut.after, upper);
  }

  void compact() {
    std::sort(keys_.begin(), keys_.end());
    keys_.erase(std::unique(keys_.begin(), keys_.end()), keys_.end());
    if (static_cast<std::int64_t>(keys_.size()) > max_blocks_)
      throw SizeError(
          {"", "voxel_size", fmt::format("{}", size_),
           "the level set needs more than " + memory_text(static_cast<double>(max_blocks_) * static_cast<double>(sizeof(LevelSetBlock))),
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
