#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "sdf/parallel.h"
#include "sdf/size_error.h"
#include "subdiv/band_distance.h"
#include "subdiv/triangle_box.h"

namespace limn {
namespace {

/// A block (in blocks), packed so that two comparisons order blocks by x, y, z. Coordinates have 28 bits.
struct BlockKey {
  std::uint64_t xy = 0;
  std::uint32_t z = 0;
  static constexpr std::int64_t kOffset = std::int64_t{1} << 27;
  glm::ivec3 block() const {
    const auto part = [](std::uint64_t bits) { return static_cast<int>(static_cast<std::int64_t>(bits & 0xffffffffu) - kOffset); };
    return {part(xy >> 32), part(xy), part(z)};
  }
  bool operator==(const BlockKey& other) const { return xy == other.xy && z == other.z; }
  bool operator<(const BlockKey& other) const { return xy != other.xy ? xy < other.xy : z < other.z; }
};

/// A block and a triangle, ordered by x, y, z, triangle.
struct Pair {
  std::uint64_t xy, z_triangle;
  Pair() = default;
  Pair(const glm::ivec3& block, std::uint32_t triangle)
      : xy(static_cast<std::uint64_t>(block.x + BlockKey::kOffset) << 32 | static_cast<std::uint64_t>(block.y + BlockKey::kOffset)),
        z_triangle(static_cast<std::uint64_t>(block.z + BlockKey::kOffset) << 32 | triangle) {}
  BlockKey key() const { return {xy, static_cast<std::uint32_t>(z_triangle >> 32)}; }
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
    if (lower == upper) {
      out_.emplace_back(lower, triangle_);
      return;
    }
    const BlockHalves cut = halves(lower, upper);
    split(lower, cut.middle);
    split(cut.after, upper);
  }

  double size_, reach_;
  std::vector<Pair>& out_;
  std::array<glm::dvec3, 3> corners_{};
  std::uint32_t triangle_ = 0;
  glm::dvec3 center_{0.0};
  double radius_ = 0.0;
};

[[noreturn]] void refuse(double voxel_size, std::int64_t max_blocks) {
  throw SizeError({"", "voxel_size", fmt::format("{}", voxel_size),
                   fmt::format("the level set needs more than {} blocks of 8 x 8 x 8 voxels", max_blocks),
                   "larger voxels or a narrower band"});
}

/// Of a run of triangles: the blocks that they come near, in order, and which triangles come near each.
struct PieceLists {
  std::vector<BlockKey> blocks{};
  std::vector<std::uint32_t> first{};      ///< Of each block's stretch of `triangles`; one more than blocks.
  std::vector<std::uint32_t> triangles{};  ///< Ascending in each stretch.
};

/// By block; the triangles of each stay in order, as they came. Neighbours in a list of triangles lie close together, so that a box of few
/// blocks holds them, and counting brings each to its place.
void sort_by_block(std::vector<Pair>& pairs) {
  constexpr std::int64_t kMostCells = 1 << 14;
  if (pairs.empty()) return;
  glm::ivec3 lower(std::numeric_limits<int>::max()), upper(std::numeric_limits<int>::min());
  for (const Pair& pair : pairs) {
    const glm::ivec3 block = pair.key().block();
    lower = glm::min(lower, block), upper = glm::max(upper, block);
  }
  const glm::i64vec3 size = glm::i64vec3(upper) - glm::i64vec3(lower) + std::int64_t{1};
  if (std::max({size.x, size.y, size.z}) > kMostCells || size.x * size.y > kMostCells || size.x * size.y * size.z > kMostCells) {
    std::sort(pairs.begin(), pairs.end());
    return;
  }
  const auto cell_of = [&](const Pair& pair) {
    const glm::i64vec3 at = glm::i64vec3(pair.key().block()) - glm::i64vec3(lower);
    return static_cast<size_t>((at.x * size.y + at.y) * size.z + at.z);
  };
  std::vector<std::uint32_t> ends(static_cast<size_t>(size.x * size.y * size.z) + 1, 0);
  for (const Pair& pair : pairs) ++ends[cell_of(pair) + 1];
  std::partial_sum(ends.begin(), ends.end(), ends.begin());
  std::vector<Pair> sorted(pairs.size());
  for (const Pair& pair : pairs) sorted[ends[cell_of(pair)]++] = pair;
  pairs.swap(sorted);
}

PieceLists lists_of(std::vector<Pair>& pairs) {
  sort_by_block(pairs);
  PieceLists lists;
  lists.triangles.reserve(pairs.size());
  for (const Pair& pair : pairs) {
    if (lists.blocks.empty() || !(lists.blocks.back() == pair.key())) {
      lists.blocks.push_back(pair.key());
      lists.first.push_back(static_cast<std::uint32_t>(lists.triangles.size()));
    }
    lists.triangles.push_back(pair.triangle());
  }
  lists.first.push_back(static_cast<std::uint32_t>(lists.triangles.size()));
  lists.blocks.shrink_to_fit(), lists.first.shrink_to_fit();
  return lists;
}

/// In pieces of a fixed size, so that their order is no matter of threads.
std::vector<PieceLists> find_lists(const TriangleMesh& mesh, double voxel_size, double reach, std::int64_t max_blocks) {
  constexpr size_t kPiece = 2048;
  std::vector<PieceLists> found((mesh.triangles.size() + kPiece - 1) / kPiece);
  parallel_for(size_t{0}, found.size(), [&](size_t piece) {
    std::vector<Pair> pairs;
    PairFinder finder(voxel_size, reach, pairs);
    const size_t last = std::min((piece + 1) * kPiece, mesh.triangles.size());
    for (size_t i = piece * kPiece; i < last; ++i) {
      const glm::uvec3& t = mesh.triangles[i];
      finder.add({mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]}, static_cast<std::uint32_t>(i));
      // One triangle alone names a block once.
      if (static_cast<std::int64_t>(pairs.size()) / static_cast<std::int64_t>(kPiece) > max_blocks) refuse(voxel_size, max_blocks);
    }
    found[piece] = lists_of(pairs);
  });
  return found;
}

/// All blocks of all pieces, in order.
std::vector<BlockKey> all_blocks(const std::vector<PieceLists>& pieces) {
  std::vector<BlockKey> blocks;
  for (const PieceLists& piece : pieces) {
    blocks.insert(blocks.end(), piece.blocks.begin(), piece.blocks.end());
  }
  parallel_sort(blocks.begin(), blocks.end());
  blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  return blocks;
}

}  // namespace

BlockTriangles triangles_near_blocks(const TriangleMesh& mesh, double voxel_size, double reach, std::int64_t max_blocks) {
  const std::vector<PieceLists> pieces = find_lists(mesh, voxel_size, reach, max_blocks);
  const std::vector<BlockKey> blocks = all_blocks(pieces);
  if (static_cast<std::int64_t>(blocks.size()) > max_blocks) refuse(voxel_size, max_blocks);
  const auto place_of = [&blocks](const BlockKey& key) {
    return static_cast<size_t>(std::lower_bound(blocks.begin(), blocks.end(), key) - blocks.begin());
  };
  BlockTriangles result;
  for (const BlockKey& key : blocks) result.origins.push_back(8 * key.block());
  result.first.assign(blocks.size() + 1, 0);
  for (const PieceLists& piece : pieces)
    for (size_t k = 0; k < piece.blocks.size(); ++k) result.first[place_of(piece.blocks[k]) + 1] += piece.first[k + 1] - piece.first[k];
  for (size_t block = 0; block < blocks.size(); ++block) result.first[block + 1] += result.first[block];
  result.triangles.resize(result.first.back());
  std::vector<size_t> next(result.first.begin(), result.first.end() - 1);
  // Piece after piece: triangles ascend in each list.
  for (const PieceLists& piece : pieces) {
    for (size_t k = 0; k < piece.blocks.size(); ++k) {
      const auto from = piece.triangles.begin() + piece.first[k], to = piece.triangles.begin() + piece.first[k + 1];
      size_t& at = next[place_of(piece.blocks[k])];
      std::copy(from, to, result.triangles.begin() + static_cast<std::ptrdiff_t>(at));
      at += static_cast<size_t>(to - from);
    }
  }
  return result;
}

}  // namespace limn
