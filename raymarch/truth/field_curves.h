#pragma once
// Contour generators and level curves of N.V on a field's surface, traced whole, hidden parts included. Interval bounds of f and of N.V - c
// prune an octree (Plantinga & Vegter 2006), so that no cell of the finest grid that holds a curve is left out; marching tetrahedra join
// the sign changes of N.V - c on the surface from face to face, so that curves come out closed.

#include <cstdint>
#include <functional>

#include "raymarch/gbuffer.h"
#include "raymarch/truth/field_cells.h"
#include "raymarch/truth/locate.h"

namespace limn {

struct FieldCurveSettings {
  double threshold = 0.4;  ///< 0: contour generators only.
  double tolerance_px = 0.005;
  double cell_px = 4.0;    ///< Side of the finest cells, where the budget allows.
  int finest_level = 10;   ///< The budget: the domain's side is cut into at most two to this power.
  Box unbounded_domain{};  ///< What stands in for bounds that are infinite.
  /// Seams of sharp CSG come out whole, as curves of their own into which contours lead, and not where N.V passes a level across them only.
  bool whole_seams = false;
  std::function<LatticeMemory*(int level)> memory{};  ///< What views of the field share, by the level of its cells; may be empty.
};

struct FieldCurve {
  double c = 0.0;  ///< 0: a contour generator.
  bool closed = false;
  bool seam = false;     ///< A whole seam, of which N.V says nothing.
  bool concave = false;  ///< Of a seam: the body fills more than half of the space around it.
  std::vector<CurvePoint> points{};
  /// Of a seam: the branches that meet there, as split_branches() numbers them.
  int first = -1, second = -1;
};

struct FieldCurves {
  std::vector<FieldCurve> curves{};
  int level = 0;
  double cell = 0.0;       ///< Side of the finest cells, world units.
  double cell_px = 0.0;    ///< The same where it is seen largest.
  std::int64_t cells = 0;  ///< Finest cells that bounds could not exclude.
  /// Of those, with parts farther than `unproven_px` from every curve found that bounds still do not exclude when they are cut again.
  std::int64_t unsettled = 0;
  double unproven_px = 0.0;         ///< Within it of a curve, where it is seen largest, another one would not be told from it.
  std::int64_t rough = 0;           ///< Points that neither Newton nor bisection could place: interpolated in their cell.
  std::int64_t unrefined = 0;       ///< Steps for which no point between could be found.
  std::int64_t broken = 0;          ///< Steps that leave the curve along the line of sight: another arm of it lies within the same cell.
  double worst_unrefined_px = 0.0;  ///< How far the curve may be from such a step, from how it turns; and gaps between a curve's pieces.
  std::int64_t open_ends = 0;
  bool domain_cut = false;  ///< The field is unbounded: curves are followed within the domain only.
};

/// `field` in solver space, as `camera`.
FieldCurves trace_field_curves(const Field& field, const Camera& camera, const Viewer& viewer, const FieldCurveSettings& settings,
                               const ExecutionSettings& how);

/// The curve on which `zeros` is 0 on one branch of a field, as far as that is surface of the whole: a seam of `sharp`, which is the field
/// taken apart, cut by `zeros` (cut_by). Like other seams it comes out whole; `zeros` has no bounds.
FieldCurves trace_zeros_on_branch(const Field& field, const SharpField& sharp, int branch, const Camera& camera, const Viewer& viewer,
                                  const FieldCurveSettings& settings, const ExecutionSettings& how);

/// What is known of a field beside the cells that its curves go through.
struct CellCurveSettings {
  double tolerance_px = 0.005;
  double extent = 1.0;
  double lipschitz = 1.0;
  double follow = 0.0;              ///< Where it is above 0 curves are followed by their tangents, in steps up to it: follow_strands().
  std::vector<glm::dvec3> seeds{};  ///< Contours are followed from these, too, where no crossing of cells has led to them.
};
/// The second half of trace_field_curves(): crossings of cells joined, cut to what is surface, refined, joined again; added to `result`.
/// `found` is used up.
void curves_of_cells(CellResult& found, const CellSearch& search, const CellCurveSettings& settings, const ExecutionSettings& how,
                     FieldCurves& result);

}  // namespace limn
