#pragma once
// A limit surface sampled on a lattice over each of its patches, as one triangulated sheet whose seams are joined: what curves are traced
// over.

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "sdf/camera.h"
#include "sdf/large_pages.h"
#include "subdiv/refine.h"

namespace limn {

/// A quad face, a triangle of a Loop cage, or a corner's share of an n-gon.
struct LimitPatch {
  int face = 0, sub_face = 0;
  bool share = false;     ///< Of an n-gon.
  bool triangle = false;  ///< Its domain is u + v <= 1.
};

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

struct LimitCorner {
  std::uint32_t node = 0;  ///< The same for all corners at one place.
  /// The same for all corners of one place that share a normal; index into LimitGrid::normals. On the way to the triangle's next corner,
  /// and to the one before: at the tip of a cone, as a sharp corner of smooth edges has, each way there has a normal of its own.
  std::uint32_t side = 0, side_back = 0;
  std::uint16_t column = 0, row = 0, steps = 1;  ///< Of its patch's lattice. There are many corners: their places are kept small.

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

/// Some triangles in a row: their nodes lie in a ball, and the normals of their sides in a cone. Both together tell of most that no curve
/// goes through them.
struct LimitBlock {
  std::uint32_t first = 0, end = 0;  ///< Into LimitGrid::triangles.
  glm::dvec3 center{0.0}, axis{0.0};
  double radius = 0.0;
  double angle = 0.0;               ///< Between the cone's axis and its surface.
  double sine = 0.0, cosine = 1.0;  ///< Of it.
};

struct LimitGrid {
  LargeVector<glm::dvec3> positions{};  ///< Of nodes, world.
  LargeVector<glm::dvec3> normals{};    ///< Of sides, world, unit.
  LargeVector<std::uint32_t> node_of_side{};
  LargeVector<LimitTriangle> triangles{};
  std::vector<LimitBlock> blocks{};  ///< All triangles, in order.
  std::vector<SeamUse> seam_uses{};  ///< In the order of the seams.
  std::vector<LimitSeam> seams{};    ///< By their nodes.
  /// Some seam has not two triangles that run along it opposite ways: the surface has an end, or no outside, and its back may be seen.
  bool sheet = false;
  /// How far from interior vertices of valence 2 the nearest samples are at most, px: so near to them the surface is not resolved.
  double tip_px = 0.0;
  std::vector<size_t> invalid_patches{};  ///< Without a limit surface; they are left out.
};

inline std::span<const SeamUse> uses_of(const LimitGrid& grid, const LimitSeam& seam) {
  return std::span(grid.seam_uses).subspan(seam.first, seam.end - seam.first);
}

/// Of all triangles of a grid, in order.
std::vector<LimitBlock> blocks_of(const LimitGrid& grid);

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
