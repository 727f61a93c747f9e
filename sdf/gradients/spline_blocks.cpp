#include "sdf/gradients/spline_blocks.h"

#include <algorithm>
#include <memory>

namespace limn {
namespace {

constexpr size_t kMostBlocks = size_t{1} << 16;  // 256 MB: beyond that cells are worked out one by one

/// Far from the surface whole cells lie among nodes of one value, and between blocks rays cross many of them.
template <class Accessor>
SplineCoefficients cell_of_tiles(const Accessor& accessor, const nanovdb::Coord& node) {
  const auto tile = static_cast<double>(accessor.getValue(node));
  // Blocks and tiles that the cell's nodes and their neighbours lie in hold a corner of these, too.
  for (int corner = 0; corner < 8; ++corner) {
    const auto at = [&](int axis) { return (corner >> axis & 1) != 0 ? 3 : -2; };
    const nanovdb::Coord far = node.offsetBy(at(0), at(1), at(2));
    if (accessor.probeLeaf(far) != nullptr || static_cast<double>(accessor.getValue(far)) != tile)
      return spline_coefficients(accessor, node);
  }
  const std::array<double, 3> same{tile, tile, tile};
  SplineCoefficients c;
  c.fill(spline_coefficient<1>(&same[1]));
  return c;
}

}  // namespace

SplineBlocks::SplineBlocks(const LevelSetData& data)
    : data_(data), first_(data.grid->tree().getFirstNode<0>()), blocks_(data.grid->tree().nodeCount(0)) {}

SplineBlocks::~SplineBlocks() {
  for (const std::atomic<const Block*>& block : blocks_) delete block.load();
}

/// Null where there are too many.
const SplineBlocks::Block* SplineBlocks::block_of(const Leaf& leaf) const {
  std::atomic<const Block*>& kept = blocks_[static_cast<size_t>(&leaf - first_)];
  if (const Block* known = kept.load(std::memory_order_acquire)) return known;
  if (made_.load(std::memory_order_relaxed) >= kMostBlocks) return nullptr;
  constexpr int kRow = kSide + 2;
  std::array<double, static_cast<size_t>(kRow * kRow * kRow)> f;  // a node more on every side
  const auto accessor = data_.accessor();
  const auto index = [](int x, int y, int z) {
    const int place = (x * kRow + y) * kRow + z;
    return static_cast<size_t>(place);
  };
  const auto is_end = [](int x) { return x == 0 || x == kRow - 1; };
  for (int x = 0; x < kRow; ++x)
    for (int y = 0; y < kRow; ++y)
      if (!is_end(x) || !is_end(y)) row_values(accessor, leaf.origin().offsetBy(x - 1, y - 1, -1), kRow, &f[index(x, y, 0)]);
  auto made = std::make_unique<Block>();
  size_t at = 0;
  for (int x = 1; x <= kSide; ++x)
    for (int y = 1; y <= kSide; ++y)
      for (int z = 1; z <= kSide; ++z) (*made)[at++] = spline_coefficient<kRow>(&f[index(x, y, z)]);
  const Block* none = nullptr;
  // Another thread may have been first, with the same numbers.
  if (!kept.compare_exchange_strong(none, made.get(), std::memory_order_acq_rel)) return none;
  made_.fetch_add(1, std::memory_order_relaxed);
  return made.release();
}

SplineCoefficients SplineBlocks::cell(const nanovdb::Coord& node) const {
  SplineCoefficients c;
  Reader(*this).read(node, c.data(), 1);
  return c;
}

SplineBlocks::Reader::Reader(const SplineBlocks& blocks)
    : blocks_(blocks), accessor_(blocks.data_.accessor()), origin_(nanovdb::Coord::max()) {}

inline const double* SplineBlocks::Reader::block(int number) {
  const Block*& kept = around_[static_cast<size_t>(number)];
  if ((known_ >> number & 1u) == 0) {
    const Leaf* const leaf =
        accessor_.probeLeaf(origin_.offsetBy(kSide * (number / 9 - 1), kSide * (number / 3 % 3 - 1), kSide * (number % 3 - 1)));
    kept = leaf != nullptr ? blocks_.block_of(*leaf) : nullptr;
    known_ |= 1u << number;
  }
  return kept != nullptr ? kept->data() : nullptr;
}

template <class Number>
void SplineBlocks::Reader::read(const nanovdb::Coord& node, Number* to, size_t stride) {
  const nanovdb::Coord origin = node & ~static_cast<nanovdb::Coord::IndexType>(kSide - 1);
  if (origin != origin_) origin_ = origin, known_ = 0;
  // From the first node of the blocks before the middle one.
  const std::array<int, 3> low{node[0] - origin[0] + kSide - 1, node[1] - origin[1] + kSide - 1, node[2] - origin[2] + kSide - 1};
  const auto block_at = [&](size_t axis, int i) { return (low[axis] + i) / kSide; };
  for (int x = 0; x < 4; ++x) {
    for (int y = 0; y < 4; ++y) {
      const int column = 9 * block_at(0, x) + 3 * block_at(1, y);
      const double *const first = block(column + block_at(2, 0)), *const last = block(column + block_at(2, 3));
      if (first == nullptr || last == nullptr) {
        const SplineCoefficients c = cell_of_tiles(accessor_, node);
        for (size_t i = 0; i < c.size(); ++i) to[i * stride] = static_cast<Number>(c[i]);
        return;
      }
      const int row = (low[0] + x) % kSide * kSide * kSide + (low[1] + y) % kSide * kSide;
      for (int z = 0; z < 4; ++z) {
        const double* const from = block_at(2, z) == block_at(2, 0) ? first : last;
        to[spline_place(x, y, z) * stride] = static_cast<Number>(from[row + (low[2] + z) % kSide]);
      }
    }
  }
}

template void SplineBlocks::Reader::read(const nanovdb::Coord& node, float* to, size_t stride);
template void SplineBlocks::Reader::read(const nanovdb::Coord& node, double* to, size_t stride);

}  // namespace limn
