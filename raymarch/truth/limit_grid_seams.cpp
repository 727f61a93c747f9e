// Where patches of a limit surface meet: the edges of triangles on their sides.

#include <algorithm>
#include <tuple>

#include "raymarch/truth/limit_grid.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

/// Whether both corners lie on one side of their patch.
bool on_one_side(const LimitPatch& patch, const LimitCorner& a, const LimitCorner& b) {
  if ((a.column == 0 && b.column == 0) || (a.row == 0 && b.row == 0)) return true;
  const int n = a.steps;
  if (patch.triangle) return a.column + a.row == n && b.column + b.row == n;
  return (a.column == n && b.column == n) || (a.row == n && b.row == n);
}

using Nodes = std::pair<std::uint32_t, std::uint32_t>;
using NodesAndUse = std::pair<Nodes, SeamUse>;

void add_uses(const LimitLattice& lattice, int column, int row, std::vector<NodesAndUse>& uses) {
  const bool has_upper = !lattice.shape.triangle || column + 1 < lattice.cells(row);
  for (const bool upper : {false, true}) {
    if (upper && !has_upper) return;
    const LimitTriangle triangle = triangle_of(lattice, column, row, upper);
    const std::uint32_t t = lattice.first_triangle + lattice.row_begin(row) + static_cast<std::uint32_t>(2 * column + (upper ? 1 : 0));
    for (int from = 0; from < 3; ++from) {
      const LimitCorner &a = triangle.corners[static_cast<size_t>(from)], &b = triangle.corners[static_cast<size_t>((from + 1) % 3)];
      if (a.node != b.node && on_one_side(lattice.shape, a, b)) uses.push_back({std::minmax(a.node, b.node), {t, from}});
    }
  }
}

/// Of a lattice's cells along its patch's sides.
void add_uses(const LimitLattice& lattice, std::vector<NodesAndUse>& uses) {
  for (int row = 0; row < lattice.steps; ++row) {
    const int cells = lattice.cells(row);
    const bool whole_row = row == 0 || row == lattice.steps - 1;
    for (int column = 0; column < cells; column += whole_row ? 1 : std::max(cells - 1, 1)) add_uses(lattice, column, row, uses);
  }
}

}  // namespace

void find_seams(LimitGrid& grid) {
  std::vector<NodesAndUse> all;
  for (const LimitLattice& lattice : grid.lattices) add_uses(lattice, all);
  parallel_sort(all.begin(), all.end(), [](const auto& a, const auto& b) {
    return std::tie(a.first, a.second.triangle, a.second.from) < std::tie(b.first, b.second.triangle, b.second.from);
  });
  grid.seam_uses.reserve(all.size());
  for (const auto& [nodes, use] : all) grid.seam_uses.push_back(use);
  for (size_t first = 0, end = 0; first < all.size(); first = end) {
    while (end < all.size() && all[end].first == all[first].first) ++end;
    grid.seams.push_back({all[first].first, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(end)});
  }
  const auto starts_at = [&](const SeamUse& use) { return triangle_of(grid, use.triangle).corners[static_cast<size_t>(use.from)].node; };
  grid.sheet = std::any_of(grid.seams.begin(), grid.seams.end(), [&](const LimitSeam& seam) {
    const std::span<const SeamUse> both = uses_of(grid, seam);
    return both.size() != 2 || starts_at(both[0]) == starts_at(both[1]);
  });
}

}  // namespace limn
