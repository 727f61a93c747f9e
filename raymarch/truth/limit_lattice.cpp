#include "raymarch/truth/limit_lattice.h"

#include <cmath>

namespace limn {
namespace {

LimitCorner corner_of(const LimitLattice& lattice, int column, int row) {
  const LimitLattice::Place at = place_of(lattice, column, row);
  return {at.node,
          at.side,
          at.side,
          static_cast<std::uint16_t>(column),
          static_cast<std::uint16_t>(row),
          static_cast<std::uint16_t>(lattice.steps)};
}

}  // namespace

LimitTriangle triangle_of(const LimitLattice& lattice, int column, int row, bool upper) {
  if (!lattice.with_tips.empty()) return lattice.with_tips[lattice.row_begin(row) + static_cast<size_t>(2 * column + (upper ? 1 : 0))];
  const auto at = [&](int i, int j) { return corner_of(lattice, i, j); };
  if (!upper) return {lattice.patch, {at(column, row), at(column + 1, row), at(column, row + 1)}};
  return {lattice.patch, {at(column + 1, row), at(column + 1, row + 1), at(column, row + 1)}};
}

LimitTriangle triangle_of(const LimitLattice& lattice, std::uint32_t t) {
  const int n = lattice.steps, at = static_cast<int>(t);
  // Rows of a triangular patch grow shorter: from row j on, (n - j)^2 triangles are left.
  const int row = lattice.shape.triangle ? n - static_cast<int>(std::ceil(std::sqrt(static_cast<double>(n * n - at)))) : at / (2 * n);
  const int in_row = at - static_cast<int>(lattice.row_begin(row));
  return triangle_of(lattice, in_row / 2, row, in_row % 2 == 1);
}

}  // namespace limn
