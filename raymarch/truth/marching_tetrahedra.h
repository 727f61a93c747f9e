#pragma once
// Internal: one cell of the finest grid, cut into six tetrahedra around its diagonal (Kuhn), whose faces match those of its neighbours.

#include <array>
#include <cstdint>
#include <vector>

#include "raymarch/truth/lattice_samples.h"
#include "raymarch/truth/locate.h"
#include "sdf/level_set_reconstruction.h"

namespace limn {

/// Cubes of `side` from `corner`; cell (0, 0, 0) is the first.
struct CellGrid {
  glm::dvec3 corner{0.0};
  double side = 1.0;
  glm::dvec3 vertex(const glm::ivec3& index) const { return corner + side * glm::dvec3(index); }
  Box cell(const glm::ivec3& index) const { return {vertex(index), vertex(index + 1)}; }
};

/// Where a curve goes through a face of a tetrahedron. The key says which face, for both cells that share it.
struct Crossing {
  std::uint64_t key = 0;
  CurvePoint point{};
};
struct Link {
  std::uint64_t from = 0, to = 0;
};
struct CellCurves {
  std::vector<Crossing> crossings{};
  std::vector<Link> links{};
  KeyedValues<char> known{};  ///< Of seeds: keys of `crossings`, each of which is there once.
};

/// Levels of N.V that are looked for: contour generators and the rim's curve.
inline constexpr size_t kCurveFamilies = 2;
using FamilyMask = unsigned;  ///< Bit i: family i.

using CellOutput = std::array<CellCurves, kCurveFamilies>;

/// Where a curve is the seam of two fields instead: the zeros of `second` on the surface of `first`. True where it goes through the cell.
/// Points have no normals yet.
bool march_seam(FieldEvaluator& first, FieldEvaluator& second, const Viewer& viewer, const CellGrid& grid, const glm::ivec3& cell,
                CellCurves& output);

/// Points that lie on the curve to within a hundredth of a cell and not on the faces, for those who follow it from there.
struct Seeds {
  bool wanted = false;
  /// Of the field, whose cells are the grid's, from that node on; needs `samples`. Null: the field itself is asked.
  SplineCellReader* spline = nullptr;
  glm::ivec3 first_node{0};
};

/// So many cells around the marched one is the field evaluated.
inline constexpr double kMarchReach = 7.5;
/// True where a curve goes through the cell. `evaluator` need be right within kMarchReach of it. Cell indices below 2^19. `samples`, if not
/// null, are those of the field, with what other cells have found.
bool march_cell(FieldEvaluator& evaluator, const Viewer& viewer, const CellGrid& grid, const glm::ivec3& cell,
                const std::array<double, kCurveFamilies>& levels, FamilyMask families, LatticeSamples* samples, CellOutput& output,
                const Seeds& seeds = {});

}  // namespace limn
