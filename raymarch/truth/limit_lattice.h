#pragma once
// Internal: the samples of one patch of a limit surface as nodes and sides of a grid, and the triangles between them, two a cell. There are
// so many triangles that to keep them takes longer than to make each anew from its place in the lattice.

#include <array>
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

namespace limn {

/// A quad face, a triangle of a Loop cage, or a corner's share of an n-gon.
struct LimitPatch {
  int face = 0, sub_face = 0;
  bool share = false;     ///< Of an n-gon.
  bool triangle = false;  ///< Its domain is u + v <= 1.
};

struct LimitCorner {
  std::uint32_t node = 0;  ///< The same for all corners at one place.
  /// The same for all corners of one place that share a normal; index into LimitGrid::normals. On the way to the triangle's next corner,
  /// and to the one before: at the tip of a cone, as a sharp corner of smooth edges has, each way there has a normal of its own.
  std::uint32_t side = 0, side_back = 0;
  std::uint16_t column = 0, row = 0, steps = 1;  ///< Of its patch's lattice.

  glm::dvec2 uv() const { return glm::dvec2(column, row) / double(steps); }
};
struct LimitTriangle {
  std::uint32_t patch = 0;
  std::array<LimitCorner, 3> corners{};
};
/// The side of corner `at` of a triangle, on the edge to its corner `other`.
inline std::uint32_t side_towards(const LimitTriangle& triangle, int at, int other) {
  const LimitCorner& corner = triangle.corners[static_cast<size_t>(at)];
  return other == (at + 1) % 3 ? corner.side : corner.side_back;
}

/// Of a patch: its samples, `steps` + 1 along a side, and the triangles between them, row by row of cells.
struct LimitLattice {
  /// What a sample is in the grid.
  struct Place {
    std::uint32_t node = 0, side = 0;
  };
  std::uint32_t patch = 0;  ///< Into PlacedLimitSurface::patches.
  LimitPatch shape{};       ///< That patch.
  int steps = 1;
  std::uint32_t first_triangle = 0;  ///< Of all triangles of the grid.
  std::vector<Place> rim{};          ///< Of samples on the patch's sides, by rows: see rim_index().
  std::vector<Place> inside{};       ///< Of each row's first sample that is not on a side; those after it have the numbers that follow.
  std::vector<LimitTriangle> with_tips{};  ///< All triangles, where some of their corners have two sides.

  /// Cells of a row.
  int cells(int row) const { return shape.triangle ? steps - row : steps; }
  std::uint32_t triangle_count() const { return static_cast<std::uint32_t>((shape.triangle ? 1 : 2) * steps * steps); }
  std::uint32_t end_triangle() const { return first_triangle + triangle_count(); }
  /// The first triangle of a row's cells, of the lattice's own.
  std::uint32_t row_begin(int row) const { return static_cast<std::uint32_t>(shape.triangle ? row * (2 * steps - row) : 2 * row * steps); }
};

/// Whether a sample lies on a side of its patch.
inline bool on_rim(const LimitPatch& patch, int steps, int column, int row) {
  return column == 0 || row == 0 || (patch.triangle ? column + row == steps : column == steps || row == steps);
}
/// How many samples lie on a patch's sides.
inline size_t rim_size(const LimitPatch& patch, int steps) { return (patch.triangle ? size_t{3} : size_t{4}) * static_cast<size_t>(steps); }
/// Which of them one is: rows of v from 0, each by u.
inline size_t rim_index(const LimitPatch& patch, int steps, int column, int row) {
  if (row == 0) return static_cast<size_t>(column);
  const size_t before = static_cast<size_t>(steps) + 1 + 2 * (static_cast<size_t>(row) - 1);
  if (!patch.triangle && row == steps) return before + static_cast<size_t>(column);
  return before + (column > 0 ? 1 : 0);
}

/// A sample's place in the grid.
inline LimitLattice::Place place_of(const LimitLattice& lattice, int column, int row) {
  if (on_rim(lattice.shape, lattice.steps, column, row)) return lattice.rim[rim_index(lattice.shape, lattice.steps, column, row)];
  const LimitLattice::Place first = lattice.inside[static_cast<size_t>(row)];
  const auto at = static_cast<std::uint32_t>(column - 1);
  return {first.node + at, first.side + at};
}
/// A cell's triangle: the lower, or the upper, which the last cells of a triangular patch's rows do not have. The diagonal runs from the
/// upper left to the lower right.
LimitTriangle triangle_of(const LimitLattice& lattice, int column, int row, bool upper);
/// The same by the triangle's number in the lattice.
LimitTriangle triangle_of(const LimitLattice& lattice, std::uint32_t t);

/// Some triangles in a row: their nodes lie in a ball, and the normals of their sides in a cone. Both together tell of most that no curve
/// goes through them.
struct LimitBlock {
  std::uint32_t first = 0, end = 0;  ///< Of all triangles of the grid.
  glm::dvec3 center{0.0}, axis{0.0};
  double radius = 0.0;
  double angle = 0.0;               ///< Between the cone's axis and its surface.
  double sine = 0.0, cosine = 1.0;  ///< Of it.
};

}  // namespace limn
