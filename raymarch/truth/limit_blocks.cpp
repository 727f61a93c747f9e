// Balls and cones about stretches of a lattice, by which most of its triangles need not be looked at.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "raymarch/truth/limit_grid.h"

namespace limn {
namespace {

constexpr int kBlockCells = 8;        // of a row
constexpr double kBlockSlack = 1e-7;  // radians

int blocks_in_row(const LimitLattice& lattice, int row) { return (lattice.cells(row) + kBlockCells - 1) / kBlockCells; }

/// Cells of a row, from `begin` to before `end`.
struct Stretch {
  int row = 0, begin = 0, end = 0;
};

/// The sides of a stretch's samples, each at least once.
template <class Visit>
void for_sides(const LimitLattice& lattice, const Stretch& stretch, const Visit& visit) {
  for (int row = stretch.row; row <= stretch.row + 1; ++row) {
    const int last = lattice.shape.triangle ? std::min(stretch.end, lattice.steps - row) : stretch.end;
    for (int column = stretch.begin; column <= last; ++column) visit(place_of(lattice, column, row));
  }
  if (lattice.with_tips.empty()) return;
  const size_t begin = lattice.row_begin(stretch.row) + static_cast<size_t>(2 * stretch.begin);
  const size_t end =
      std::min<size_t>(lattice.row_begin(stretch.row) + static_cast<size_t>(2 * stretch.end), lattice.row_begin(stretch.row + 1));
  for (size_t t = begin; t < end; ++t) {
    for (const LimitCorner& corner : lattice.with_tips[t].corners) {
      visit(LimitLattice::Place{corner.node, corner.side});
      visit(LimitLattice::Place{corner.node, corner.side_back});
    }
  }
}

LimitBlock block_of(const LimitGrid& grid, const LimitLattice& lattice, const Stretch& stretch) {
  const std::uint32_t row_begin = lattice.first_triangle + lattice.row_begin(stretch.row),
                      row_end = lattice.first_triangle + lattice.row_begin(stretch.row + 1);
  LimitBlock block{row_begin + static_cast<std::uint32_t>(2 * stretch.begin),
                   std::min(row_begin + static_cast<std::uint32_t>(2 * stretch.end), row_end)};
  Box box;
  for_sides(lattice, stretch, [&](const LimitLattice::Place& at) {
    box = include(box, grid.positions[at.node]);
    block.axis += grid.normals[at.side];
  });
  block.center = box.center();
  block.radius = box.radius();
  const double length = glm::length(block.axis);
  block.axis = length > 0.0 ? block.axis / length : glm::dvec3(0.0);
  double least = 1.0;
  for_sides(lattice, stretch, [&](const LimitLattice::Place& at) { least = std::min(least, glm::dot(block.axis, grid.normals[at.side])); });
  // Cosines say little of small angles.
  block.angle = length > 0.0 ? std::acos(std::max(least, -1.0)) + kBlockSlack : std::numbers::pi;
  block.sine = std::sin(block.angle);
  block.cosine = std::cos(block.angle);
  return block;
}

}  // namespace

size_t block_count(const LimitLattice& lattice) {
  size_t count = 0;
  for (int row = 0; row < lattice.steps; ++row) count += static_cast<size_t>(blocks_in_row(lattice, row));
  return count;
}

void write_blocks(const LimitGrid& grid, const LimitLattice& lattice, LimitBlock* to) {
  for (int row = 0; row < lattice.steps; ++row) {
    const int cells = lattice.cells(row), blocks = blocks_in_row(lattice, row);
    for (int b = 0; b < blocks; ++b) *to++ = block_of(grid, lattice, {row, cells * b / blocks, cells * (b + 1) / blocks});
  }
}

}  // namespace limn
