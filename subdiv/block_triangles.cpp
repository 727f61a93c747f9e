#include <fmt/format.h>

#include <array>
#include <cmath>

#include "sdf/error.h"
#include "sdf/parallel.h"
#include "subdiv/band_distance.h"
#include "subdiv/triangle_box.h"

namespace limn {
namespace {

/// A block (in blocks) and a triangle, packed so that two comparisons order them by x, y, z, triangle. Coordinates have 28 bits.
struct Pair {
  std::uint64_t xy, z_triangle;
  static constexpr std::int64_t kOffset = std::int64_t{1} << 27;
  Pair() = default;
  Pair(const glm::ivec3& block, std::uint32_t triangle)
      : xy(static_cast<std::uint64_t>(block.x + kOffset) << 32 | static_cast<std::uint64_t>(block.y + kOffset)),
        z_triangle(static_cast<std::uint64_t>(block.z + kOffset) << 32 | triangle) {}
  glm::ivec3 block() const {
    const auto part = [](std::uint64_t bits) { return static_cast<int>(static_cast<std::int64_t>(bits & 0xffffffffu) - kOffset); };
    return {part(xy >> 32), part(xy), part(z_triangle >> 32)};
  }
  std::uint32_t triangle() const { return static_cast<std::uint32_t>(z_triangle); }
  bool operator<(const Pair& other) const { return xy != other.xy ? xy < other.xy : z_triangle < other.z_triangle; }
};

class PairFinder {
 public:
  PairFinder(double voxel_size, double reach, std::vector<Pair>& out) : size_(voxel_size), reach_(reach), out_(out) {}

  void add(const std::array<glm::dvec3, 3>& corners, std::uint32_t triangle) {
    corners_ = corners;
    triangle_ = triangle;
    Box box;
    for (const glm::dvec3& p : corners) box = include(box, p);
    center_ = box.center();
    radius_ = 0.0;
    for (const glm::dvec3& p : corners) radius_ = std::max(radius_, glm::distance(center_, p));
    // Nodes, not blocks' volumes: between the last node of a block and the first of the next lies a voxel that is nobody's.
    const glm::dvec3 lower = (box.lower - reach_) / size_, upper = (box.upper + reach_) / size_;
    split(glm::ivec3(glm::floor((glm::ceil(lower)) / 8.0)), glm::ivec3(glm::floor(glm::floor(upper) / 8.0)));
  }

 private:
  /// Halves a range of blocks until it is one block or out of reach, so that a large triangle costs what it touches.
  void split(const glm::ivec3& lower, const glm::ivec3& upper) {
    if (upper.x < lower.x || upper.y < lower.y || upper.z < lower.z) return;
    const glm::dvec3 first = 8.0 * size_ * glm::dvec3(lower), last = size_ * (8.0 * glm::dvec3(upper) + 7.0);
    // A small triangle is as good as its sphere: a few pairs too many cost less than separating axes.
    const glm::dvec3 away = center_ - glm::clamp(center_, first, last);
    const double limit = reach_ + radius_;
    if (glm::dot(away, away) > limit * limit) return;
    if (radius_ > 2.0 * size_ && !triangle_meets_box(corners_, first - reach_, last + reach_)) return;
    const glm::ivec3 count = upper - lower;
    if (count == glm::ivec3(0)) {
      out_.emplace_back(lower, triangle_);
      return;
    }
    const int axis = count.x >= count.y && count.x >= count.z ? 0 : count.y >= count.z ? 1 : 2;
    glm::ivec3 middle = upper, after = lower;
    middle[axis] = lower[axis] + count[axis] / 2;
    after[axis] = middle[axis] + 1;
    split(lower, middle);
    split(after, upper);
  }

  double size_, reach_;
  std::vector<Pair>& out_;
  std::array<glm::dvec3, 3> corners_{};
  std::uint32_t triangle_ = 0;
  glm::dvec3 center_{0.0};
  double radius_ = 0.0;
};

[[noreturn]] void refuse(double voxel_size, std::int64_t max_blocks) {
  throw InputError({"", "--voxel-size", fmt::format("{}", voxel_size),
                    fmt::format("the level set would take more than {} blocks of 8 x 8 x 8 voxels", max_blocks),
                    "larger voxels or a narrower band"});
}

std::vector<Pair> find_pairs(const TriangleMesh& mesh, double voxel_size, double reach, std::int64_t max_blocks) {
  // Pieces of a fixed size, so that their order is no matter of threads.
  constexpr size_t kPiece = 2048;
  const size_t pieces = (mesh.triangles.size() + kPiece - 1) / kPiece;
  std::vector<std::vector<Pair>> found(pieces);
  parallel_for(size_t{0}, pieces, [&](size_t piece) {
    PairFinder finder(voxel_size, reach, found[piece]);
    const size_t last = std::min((piece + 1) * kPiece, mesh.triangles.size());
    for (size_t i = piece * kPiece; i < last; ++i) {
      const glm::uvec3& t = mesh.triangles[i];
      finder.add({mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]}, static_cast<std::uint32_t>(i));
      // One triangle alone names a block once.
      if (static_cast<std::int64_t>(found[piece].size()) / static_cast<std::int64_t>(kPiece) > max_blocks) refuse(voxel_size, max_blocks);
    }
  });
  std::vector<size_t> first(pieces + 1, 0);
  for (size_t piece = 0; piece < pieces; ++piece) first[piece + 1] = first[piece] + found[piece].size();
  std::vector<Pair> pairs(first.back());
  parallel_for(size_t{0}, pieces, [&](size_t piece) {
    std::copy(found[piece].begin(), found[piece].end(), pairs.begin() + static_cast<std::ptrdiff_t>(first[piece]));
  });
  return pairs;
}

}  // namespace

BlockTriangles triangles_near_blocks(const TriangleMesh& mesh, double voxel_size, double reach, std::int64_t max_blocks) {
  std::vector<Pair> pairs = find_pairs(mesh, voxel_size, reach, max_blocks);
  parallel_sort(pairs.begin(), pairs.end());
  BlockTriangles result;
  result.triangles.reserve(pairs.size());
  for (const Pair& pair : pairs) {
    if (result.origins.empty() || result.origins.back() != 8 * pair.block()) {
      result.origins.push_back(8 * pair.block());
      result.first.push_back(result.triangles.size());
    }
    result.triangles.push_back(pair.triangle());
  }
  result.first.push_back(result.triangles.size());
  if (static_cast<std::int64_t>(result.origins.size()) > max_blocks) refuse(voxel_size, max_blocks);
  return result;
}

}  // namespace limn
