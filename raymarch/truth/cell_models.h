#pragma once
// Internal: models of a field in the cells of an octree that do not depend on the view, so that all views share them: the branches that
// matter in eight cells, and each branch as a polynomial of degree two with bounds of its remainder. A view then tests a cell by
// arithmetic alone.

#include <cstdint>

#include "raymarch/truth/cell_scope.h"

namespace limn {

/// Models hold in cubes so much larger, for the rounding of their corners.
inline constexpr double kModelReach = 1.0 + 1e-9;

/// A function over a cube about its middle: value + slope . d + [-remainder, remainder].
struct LinearForm {
  double value = 0.0;
  glm::dvec3 slope{0.0};
  double remainder = 0.0;
};

/// A branch in a cube: f, its gradient and its Hessian (xx, xy, xz, yy, yz, zz) at the middle, and how far the last two go from there.
/// As many are kept as cells hold surface, so bounds are floats, rounded up.
struct CellModel {
  std::uint32_t at = 0;  ///< Into the scope.
  bool smooth = false;   ///< The Hessian is known.
  float slack = 0.0f;    ///< Of the value.
  double value = 0.0;
  glm::dvec3 gradient{0.0};
  glm::vec3 gradient_reach{0.0f};
  std::array<float, 6> hessian{}, hessian_reach{};
};

/// A seam of two branches that may be 0 at one place in a cell; into the scope.
struct ModelledSeam {
  size_t cell = 0;
  LiveSeam seam{};
};

/// The eight children of a cell.
struct ModelledCells {
  bool known = false;                    ///< False where no tape gives derivatives: views call CellBounds::find() instead.
  std::vector<CellModel> models{};       ///< Of branches that may be 0, child by child.
  std::array<std::uint32_t, 9> first{};  ///< Where those of each child begin, and where the last ones end.
  std::vector<ModelledSeam> seams{};
  std::array<std::uint64_t, 8> open_seam_parts{};  ///< Parts of each child, as open_parts() has them, in which one of its seams may be.
  std::vector<CellScope> inside{};                 ///< By child; empty for the innermost cells.

  std::span<const CellModel> of(size_t child) const { return std::span(models).subspan(first[child], first[child + 1] - first[child]); }
  size_t bytes() const;
};

/// Where the contour generator may be in the cube with that middle: f is 0 and so is grad f . (eye - p).
struct SeenModel {
  bool live = false;
  LinearForm field{}, facing{};
};
SeenModel seen_model(const CellSearch& search, const CellModel& model, const glm::dvec3& middle, double half);

/// The cube's 4 x 4 x 4 parts in which both forms may be 0: bit 16 x + 4 y + z.
std::uint64_t open_parts(const LinearForm& a, const LinearForm& b, double half);

}  // namespace limn
