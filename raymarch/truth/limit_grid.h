#pragma once
// A limit surface sampled on a lattice over each of its patches, as one triangulated sheet whose seams are joined: what curves are traced
// over.

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "raymarch/truth/limit_lattice.h"
#include "sdf/camera.h"
#include "sdf/large_pages.h"
#include "subdiv/refine.h"

namespace limn {

/// A point of a patch and the unit world normal there; `valid` false where the surface has none.
struct LimitSample {
  glm::dvec3 position{0.0};  ///< World.
  glm::dvec3 normal{0.0};    ///< World, unit.
  bool valid = false;
};

/// A limit surface in the world.
struct PlacedLimitSurface {
  const LimitSurface& surface;
  Affine world_from_cage{};
  std::vector<LimitPatch> patches{};
};

PlacedLimitSurface place(const LimitSurface& surface, const Affine& world_from_cage);
LimitSample sample(const PlacedLimitSurface& placed, size_t patch, const glm::dvec2& uv);
/// With its curvature, world units: NaN where it has none.
struct CurvedLimitSample {
  LimitSample at{};
  SurfaceCurvature curvature{};
};
CurvedLimitSample curved_sample(const PlacedLimitSurface& placed, size_t patch, const glm::dvec2& uv);
SurfaceCurvature curvature_at(const PlacedLimitSurface& placed, size_t patch, const glm::dvec2& uv);

/// A picture that shows mostly a sheet's back turns its normals towards the eye (raymarch/mesh/open_sheet.h): then level curves are traced
/// on the surface and on the same turned round, and what lies between two sheets is left to the former.
enum class LimitTurn { none, front, back };

/// Between unit normals at one place: a crease is sharper, a patch's error is not.
inline constexpr double kSameLimitNormal = 2e-3;

/// A triangle's edge on a side of its patch.
struct SeamUse {
  std::uint32_t triangle = 0;
  int from = 0;  ///< The edge runs from this corner to the next.
};
/// What triangles on sides of their patches have in common: inside a patch no two triangles can disagree.
struct LimitSeam {
  std::pair<std::uint32_t, std::uint32_t> nodes{};  ///< Of the edge, the smaller first.
  std::uint32_t first = 0, end = 0;                 ///< Into LimitGrid::seam_uses.
};

struct LimitGrid {
  LargeVector<glm::dvec3> positions{};  ///< Of nodes, world.
  LargeVector<glm::dvec3> normals{};    ///< Of sides, world, unit.
  LargeVector<std::uint32_t> node_of_side{};
  std::vector<LimitLattice> lattices{};  ///< Of all patches that have one, in order: they make the triangles.
  std::vector<LimitBlock> blocks{};      ///< All triangles, in order.
  std::vector<SeamUse> seam_uses{};      ///< In the order of the seams.
  std::vector<LimitSeam> seams{};        ///< By their nodes.
  /// Some seam has not two triangles that run along it opposite ways: the surface has an end, or no outside, and its back may be seen.
  bool sheet = false;
  /// How far from interior vertices of valence 2 the nearest samples are at most, px: so near to them the surface is not resolved.
  double tip_px = 0.0;
  std::vector<size_t> invalid_patches{};  ///< Without a limit surface; they are left out.
};

inline std::span<const SeamUse> uses_of(const LimitGrid& grid, const LimitSeam& seam) {
  return std::span(grid.seam_uses).subspan(seam.first, seam.end - seam.first);
}

inline std::uint32_t triangle_count(const LimitGrid& grid) { return grid.lattices.empty() ? 0 : grid.lattices.back().end_triangle(); }
/// The lattice that makes triangle `t`.
const LimitLattice& lattice_of(const LimitGrid& grid, std::uint32_t t);
inline LimitTriangle triangle_of(const LimitGrid& grid, std::uint32_t t) {
  const LimitLattice& lattice = lattice_of(grid, t);
  return triangle_of(lattice, t - lattice.first_triangle);
}
/// Calls `visit(t, triangle)` for triangles from `first` to before `end`, in order.
template <class Visit>
void for_triangles(const LimitGrid& grid, std::uint32_t first, std::uint32_t end, const Visit& visit) {
  while (first < end) {
    const LimitLattice& lattice = lattice_of(grid, first);
    for (; first < std::min(end, lattice.end_triangle()); ++first) visit(first, triangle_of(lattice, first - lattice.first_triangle));
  }
}

/// A lattice's triangles in blocks, in order: written to `to`, which has room for block_count() of them. The grid has the lattice's nodes.
void write_blocks(const LimitGrid& grid, const LimitLattice& lattice, LimitBlock* to);
size_t block_count(const LimitLattice& lattice);
/// The grid's seams, and whether it is a sheet. All its triangles are there.
void find_seams(LimitGrid& grid);

/// How finely each patch is sampled.
struct LatticeSteps {
  int steps = 4;         ///< Cells along each side of a quad patch; even.
  double cell_px = 0.0;  ///< How wide they are where the patch is largest in the image.
  std::int64_t triangles = 0;
};
/// A patch's side as a chord: `length` of a whole face's, whatever share of it the patch is.
struct PatchSide {
  glm::dvec3 middle{0.0};
  double length = 0.0;
};
std::vector<PatchSide> patch_sides(const PlacedLimitSurface& placed);
/// For cells of about `cell_px`, and `max_triangles` triangles in all. `sides` are patch_sides().
LatticeSteps lattice_steps(const PlacedLimitSurface& placed, const std::vector<PatchSide>& sides, const Camera& camera, double cell_px,
                           std::int64_t max_triangles);
/// With so many steps; the camera matters to LimitGrid::tip_px alone.
LimitGrid sample_grid(const PlacedLimitSurface& placed, const Camera& camera, int steps);

/// The lattice's cells are about `cell_px` wide where the patch is largest in the image, and at most `max_triangles` triangles in all.
LimitGrid sample_grid(const PlacedLimitSurface& placed, const Camera& camera, double cell_px, std::int64_t max_triangles,
                      double& used_cell_px);

}  // namespace limn
