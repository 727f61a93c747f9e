#include "raymarch/lines/level_set_lattice.h"

#include <array>
#include <atomic>
#include <bit>

namespace limn {
namespace {

constexpr int kRegionBits = 4, kRegion = 1 << kRegionBits;  // cells along a region's side
constexpr int kIndexBits = 20;                              // of a cell along an axis
constexpr size_t kWords = size_t{1} << (3 * kRegionBits - 6);

std::uint64_t packed(const glm::ivec3& cell, int bits) {
  const auto part = [](int v) { return static_cast<std::uint64_t>(v); };
  return (part(cell.x) << bits | part(cell.y)) << bits | part(cell.z);
}
glm::ivec3 unpacked(std::uint64_t key, int bits) {
  const auto part = [&](int shift) { return static_cast<int>(key >> shift & ((std::uint64_t{1} << bits) - 1)); };
  return {part(2 * bits), part(bits), part(0)};
}
std::uint64_t region_of(const glm::ivec3& cell) { return packed(cell >> kRegionBits, kIndexBits - kRegionBits); }

/// Lattice cells around each of some cells of a level set.
struct Cover {
  const PlacedLevelSet& placed;
  const CellGrid& grid;
  glm::ivec3 lowest{0};
  bool aligned = false;

  glm::ivec3 own(const SurfaceCell& cell) const {
    if (aligned) return cell.node - lowest;
    const glm::dvec3 middle = placed.solver_from_index.point(glm::dvec3(cell.node) + 0.5);
    return glm::ivec3(glm::floor((middle - grid.corner) / grid.side));
  }
  int around() const { return aligned ? 0 : 1; }
};

/// The keys of the regions that are covered, rising.
std::vector<std::uint64_t> regions_under(const Cover& cover, const std::vector<SurfaceCell>& cells, const ExecutionSettings& execution) {
  std::vector<std::vector<std::uint64_t>> parts(blocks_of(cells.size()));
  for_blocks(cells.size(), execution, [&](size_t part, size_t begin, size_t end) {
    std::vector<std::uint64_t>& keys = parts[part];
    for (size_t i = begin; i < end; ++i) {
      const glm::ivec3 own = cover.own(cells[i]);
      const glm::ivec3 low = (own - cover.around()) >> kRegionBits, high = (own + cover.around()) >> kRegionBits;
      for (int x = low.x; x <= high.x; ++x)
        for (int y = low.y; y <= high.y; ++y)
          for (int z = low.z; z <= high.z; ++z) keys.push_back(packed({x, y, z}, kIndexBits - kRegionBits));
    }
    std::sort(keys.begin(), keys.end());
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  });
  std::vector<std::uint64_t> all;
  for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

/// A bit for each cell of each region: each cell is marked many times by its neighbours, and comes out once and in order, unsorted.
class RegionMarks {
 public:
  explicit RegionMarks(const std::vector<std::uint64_t>& keys) : keys_(keys), marks_(keys.size() * kWords) {}

  /// `last`: the region that was asked for last, likely the same.
  void mark(const glm::ivec3& cell, size_t& last) {
    const std::uint64_t key = region_of(cell);
    if (keys_[last] != key) last = static_cast<size_t>(std::lower_bound(keys_.begin(), keys_.end(), key) - keys_.begin());
    const std::uint64_t bit = packed(cell & (kRegion - 1), kRegionBits), mask = std::uint64_t{1} << (bit & 63u);
    std::atomic<std::uint64_t>& word = marks_[last * kWords + (bit >> 6u)];
    if ((word.load(std::memory_order_relaxed) & mask) == 0) word.fetch_or(mask, std::memory_order_relaxed);
  }

  size_t count(size_t region) const {
    size_t sum = 0;
    for (size_t w = 0; w < kWords; ++w) sum += static_cast<size_t>(std::popcount(word(region, w)));
    return sum;
  }
  void write(size_t region, glm::ivec3* to) const {
    const glm::ivec3 corner = unpacked(keys_[region], kIndexBits - kRegionBits) * kRegion;
    for (size_t w = 0; w < kWords; ++w) {
      for (std::uint64_t rest = word(region, w); rest != 0; rest &= rest - 1)
        *to++ = corner + unpacked(w * 64 + static_cast<size_t>(std::countr_zero(rest)), kRegionBits);
    }
  }

 private:
  std::uint64_t word(size_t region, size_t w) const { return marks_[region * kWords + w].load(std::memory_order_relaxed); }
  const std::vector<std::uint64_t>& keys_;
  std::vector<std::atomic<std::uint64_t>> marks_;
};

}  // namespace

SurfaceLattice lattice_of(const PlacedLevelSet& placed, const std::vector<SurfaceCell>& cells, const ExecutionSettings& execution) {
  SurfaceLattice lattice;
  lattice.grid.side = placed.voxel;
  const glm::dmat3& linear = placed.solver_from_index.linear;
  Cover cover{placed, lattice.grid};
  cover.aligned = linear == glm::dmat3(linear[0][0]) && linear[0][0] > 0.0;
  // Nodes of the lattice are nodes of the level set where that is possible; indices are to be positive.
  if (cover.aligned) {
    for (const SurfaceCell& cell : placed.cells) cover.lowest = glm::min(cover.lowest, cell.node);
    cover.lowest -= 2;
    lattice.grid.corner = placed.solver_from_index.point(glm::dvec3(cover.lowest));
    lattice.first_node = cover.lowest;
  } else {
    lattice.grid.corner = placed.box.lower - 2.0 * placed.voxel;
  }
  const std::vector<std::uint64_t> keys = regions_under(cover, cells, execution);
  RegionMarks marks(keys);
  for_blocks(cells.size(), execution, [&](size_t, size_t begin, size_t end) {
    size_t last = 0;
    for (size_t i = begin; i < end; ++i) {
      const glm::ivec3 own = cover.own(cells[i]);
      const int around = cover.around();
      for (int x = -around; x <= around; ++x)
        for (int y = -around; y <= around; ++y)
          for (int z = -around; z <= around; ++z) marks.mark(own + glm::ivec3(x, y, z), last);
    }
  });
  lattice.regions.resize(keys.size());
  parallel_for(size_t{0}, keys.size(), [&](size_t r) { lattice.regions[r] = {keys[r], 0, marks.count(r)}; });
  for (size_t r = 0, begin = 0; r < keys.size(); begin = lattice.regions[r++].end) {
    lattice.regions[r].begin = begin;
    lattice.regions[r].end += begin;
  }
  lattice.cells.resize(keys.empty() ? 0 : lattice.regions.back().end);
  parallel_for(size_t{0}, keys.size(), [&](size_t r) { marks.write(r, lattice.cells.data() + lattice.regions[r].begin); });
  return lattice;
}

}  // namespace limn
