#pragma once
// Internal: coefficients of the cubic spline node by node, worked out block by block where somebody asks, and kept for all threads.

#include <atomic>
#include <vector>

#include "sdf/gradients/spline_cell.h"

namespace limn {

/// Of a level set that outlives it. Safe to ask from many threads at once.
class SplineBlocks {
  using Leaf = nanovdb::FloatGrid::TreeType::LeafNodeType;
  static constexpr int kSide = static_cast<int>(Leaf::DIM);
  static constexpr size_t kNodes = Leaf::SIZE;
  using Block = std::array<double, kNodes>;

 public:
  explicit SplineBlocks(const LevelSetData& data);
  ~SplineBlocks();
  SplineBlocks(const SplineBlocks&) = delete;
  SplineBlocks& operator=(const SplineBlocks&) = delete;

  /// spline_coefficients() of a cell, to the bit.
  SplineCoefficients cell(const nanovdb::Coord& node) const;

  /// Of cells near each other, one after the other: which blocks they lie in is found once.
  class Reader {
   public:
    explicit Reader(const SplineBlocks& blocks);
    /// cell(), at `to[place * stride]`; in floats or doubles.
    template <class Number>
    void read(const nanovdb::Coord& node, Number* to, size_t stride);

   private:
    const SplineBlocks& blocks_;
    nanovdb::FloatGrid::AccessorType accessor_;
    nanovdb::Coord origin_;  ///< Of the middle block.
    std::array<const Block*, 27> around_{};
    std::uint32_t known_ = 0;  ///< Bits of `around_`.

    const double* block(int number);
  };

 private:
  const Block* block_of(const Leaf& leaf) const;

  const LevelSetData& data_;
  const Leaf* first_;
  mutable std::vector<std::atomic<const Block*>> blocks_;  ///< By leaf; null: not asked for so far.
  mutable std::atomic<size_t> made_{0};
};

}  // namespace limn
