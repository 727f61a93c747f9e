// Lines of level sets: contours of the spline whose gradients their normals are, and the seams of those that overlap, found cell by cell.

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "raymarch/lines/curve_walk.h"
#include "raymarch/lines/found_curves.h"
#include "raymarch/lines/level_set_lattice.h"
#include "raymarch/lines/level_set_layers.h"
#include "raymarch/lines/line_memory.h"
#include "sdf/field_program.h"
#include "sdf/level_set_reconstruction.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr size_t kEdgesOfCell = 4;      // new ones that the surface meets, more or less
constexpr double kHalfDiagonal = 0.87;  // of a cell, over its side
constexpr double kSeamReach = 2.0;      // voxels: farther from a surface there is no seam with it

// Newton's steps onto a contour.
constexpr int kMostSteps = 8;
constexpr double kFlat = 1e-10;    // the square of the sine between the gradients of f and of its slope: less is rounding
constexpr double kClose = 1e-3;    // voxels: what is left after such a step is about its square
constexpr double kMostOff = 0.25;  // voxels

constexpr size_t kMostKeptBytes = size_t{512} << 20;

/// `curves_of` each part.
template <class Part, class CurvesOf>
CellCurves joined(const std::vector<Part>& parts, const CurvesOf& curves_of) {
  CellCurves all;
  size_t crossings = 0, links = 0;
  for (const Part& part : parts) crossings += curves_of(part).crossings.size(), links += curves_of(part).links.size();
  all.crossings.reserve(crossings);
  all.links.reserve(links);
  for (const Part& part : parts) {
    const CellCurves& curves = curves_of(part);
    all.crossings.insert(all.crossings.end(), curves.crossings.begin(), curves.crossings.end());
    all.links.insert(all.links.end(), curves.links.begin(), curves.links.end());
  }
  return all;
}

/// Without cells that hold no contour, by bounds.
std::vector<SurfaceCell> without_clear(const PlacedLevelSet& placed, std::vector<SurfaceCell> cells, const Camera& eye) {
  if (!placed.bounds) return cells;
  const bool perspective = eye.projection == Projection::perspective;
  const glm::dvec3 at = perspective ? placed.index_from_solver.point(eye.eye) : placed.index_from_solver.linear * eye.world_from_camera[2];
  return placed.bounds->that_may_hold_contours(cells, at, perspective ? 1.0 : 0.0);
}

/// Cells whose normals may take one of the levels of N.V.
std::vector<SurfaceCell> turning_cells(const PlacedLevelSet& placed, const LineTask& task, const Camera& facing,
                                       const std::vector<double>& levels, const ExecutionSettings& execution) {
  const bool perspective = task.camera.projection == Projection::perspective;
  std::vector<std::vector<SurfaceCell>> parts(blocks_of(placed.cells.size()));
  for_blocks(placed.cells.size(), execution, [&](size_t part, size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const SurfaceCell& cell = placed.cells[i];
      const glm::dvec3 middle = placed.solver_from_index.point(glm::dvec3(cell.node) + 0.5);
      const double toward_eye = std::clamp(glm::dot(glm::dvec3(cell.normal), view_vector(task.camera, middle)), -1.0, 1.0),
                   // From the cell's middle the eye is seen in another direction than from elsewhere in it.
          parallax = perspective ? kHalfDiagonal * placed.voxel / glm::distance(task.camera.eye, middle) : 0.0,
                   reach = static_cast<double>(cell.spread) + 2.0 * parallax;
      const bool may = cell.normal == glm::vec3(0.0f) || std::any_of(levels.begin(), levels.end(), [&](double level) {
                         // An arc is no shorter than its height.
                         return std::fabs(toward_eye - level) <= reach && std::fabs(std::asin(toward_eye) - std::asin(level)) <= reach;
                       });
      if (may) parts[part].push_back(cell);
    }
    if (levels.size() == 1 && levels[0] == 0.0) parts[part] = without_clear(placed, std::move(parts[part]), facing);
  });
  std::vector<SurfaceCell> cells;
  for (const auto& part : parts) cells.insert(cells.end(), part.begin(), part.end());
  return cells;
}

CellOutput march(const CellSearch& search, size_t branch, const PlacedLevelSet& placed, const SurfaceLattice& lattice,
                 LatticeMemory& memory, const ExecutionSettings& execution) {
  memory.prepare(lattice.grid, kMostKeptBytes);
  std::vector<LatticeSamples*> samples;
  for (const LatticePart& region : lattice.regions) samples.push_back(&memory.regions[region.key].branches[0]);
  std::vector<CellOutput> parts(lattice.regions.size());
  parallel_for(size_t{0}, parts.size(), [&](size_t r) {
    if (execution.cancelled && execution.cancelled()) throw Cancelled{};
    FieldEvaluator evaluator(search.sharp.branches[branch]);
    std::optional<SplineCellReader> spline;
    if (lattice.first_node && placed.bounds) spline.emplace(*placed.bounds);
    if (spline) samples[r]->edges.reserve(kEdgesOfCell * (lattice.regions[r].end - lattice.regions[r].begin));
    const Seeds seeds{true, spline ? &*spline : nullptr, lattice.first_node.value_or(glm::ivec3(0))};
    for (size_t i = lattice.regions[r].begin; i < lattice.regions[r].end; ++i) {
      march_cell(evaluator, search.viewer, lattice.grid, lattice.cells[i], search.levels, search.families, samples[r], parts[r], seeds);
    }
  });
  CellOutput all;
  for (size_t family = 0; family < kCurveFamilies; ++family)
    all[family] = joined(parts, [&](const CellOutput& part) -> const CellCurves& { return part[family]; });
  return all;
}

/// Surface cells of one level set that another one's surface may go through.
std::vector<SurfaceCell> cells_near(const PlacedLevelSet& own, const PlacedLevelSet& other, const ExecutionSettings& execution) {
  const double reach = kSeamReach * (own.voxel + other.voxel);
  std::vector<char> near(own.cells.size(), 0);
  for_blocks(own.cells.size(), execution, [&](size_t, size_t begin, size_t end) {
    FieldEvaluator evaluator(other.field);
    for (size_t i = begin; i < end; ++i) {
      const glm::dvec3 middle = own.solver_from_index.point(glm::dvec3(own.cells[i].node) + 0.5);
      near[i] = holds(other.box, middle) && std::fabs(evaluator.value(middle)) < reach;
    }
  });
  std::vector<SurfaceCell> cells;
  for (size_t i = 0; i < near.size(); ++i) {
    if (near[i] != 0) cells.push_back(own.cells[i]);
  }
  return cells;
}

/// `meeting`: cells of the finer one; found if empty.
CellCurves march_pair(const CellSearch& search, const PlacedLevelSet& one, const PlacedLevelSet& other, std::vector<SurfaceCell>& meeting,
                      const ExecutionSettings& execution) {
  const PlacedLevelSet &own = one.voxel <= other.voxel ? one : other, &second = one.voxel <= other.voxel ? other : one;
  if (meeting.empty()) meeting = cells_near(own, second, execution);
  const SurfaceLattice lattice = lattice_of(own, meeting, execution);
  std::vector<CellCurves> parts(blocks_of(lattice.cells.size()));
  for_blocks(lattice.cells.size(), execution, [&](size_t part, size_t begin, size_t end) {
    FieldEvaluator first(one.field), last(other.field);
    for (size_t i = begin; i < end; ++i) march_seam(first, last, search.viewer, lattice.grid, lattice.cells[i], parts[part]);
  });
  return joined(parts, [](const CellCurves& part) -> const CellCurves& { return part; });
}

/// Level sets that overlap are one body, as fields are.
FieldBodies bodies_of(const LineTask& task, const std::vector<SharedLevelSet>& grids, const std::vector<size_t>& objects) {
  std::vector<std::vector<size_t>>& kept = task.kept.level_sets.bodies;
  if (kept.empty()) kept = overlapping(grids);
  FieldBodies bodies;
  bodies.extent = task.extent;
  bodies.numbers = objects;
  bodies.bodies = kept;
  for (const SharedLevelSet& grid : grids) bodies.fields.push_back(grid->field);
  return bodies;
}

SharpField union_of(const std::vector<SharedLevelSet>& grids, const std::vector<size_t>& body, double extent) {
  SharpField sharp = split_branches(grids[body[0]]->field, extent);
  for (size_t k = 1; k < body.size(); ++k) {
    const int before = static_cast<int>(sharp.nodes.size()) - 1, branch = before + 1, above = before + 2;
    sharp.branches.push_back(grids[body[k]]->field);
    sharp.node_of.push_back(branch);
    sharp.nodes.push_back({false, -1, -1, above, static_cast<int>(k)});
    sharp.nodes.push_back({false, before, branch, -1, -1});
    sharp.nodes[static_cast<size_t>(before)].parent = above;
  }
  return sharp;
}

/// What the level sets of a scene have in common.
struct Tracing {
  const LineTask& task;
  const ExecutionSettings& execution;
  const std::vector<SharedLevelSet>& grids;
  const FieldBodies& bodies;
  std::vector<FieldEvaluator>& evaluators;
  std::vector<double> levels{0.0};
};

/// Where the surface turns within a voxel as a crease does nothing is drawn but what turns away from the eye.
void note_edges(const LineTask& task, const PlacedLevelSet& grid, LineContribution& out) {
  const double half_turn = 0.5 * glm::radians(task.settings.crease_angle_deg);
  const auto sharp = std::count_if(grid.cells.begin(), grid.cells.end(),
                                   [&](const SurfaceCell& cell) { return static_cast<double>(cell.spread) > half_turn; });
  if (sharp == 0 || !task.wants(LineClass::crease)) return;
  out.notes.push_back(fmt::format("level sets have no creases: {} of {} cells may turn by more than {:.0f} degrees within a voxel", sharp,
                                  grid.cells.size(), task.settings.crease_angle_deg));
}

/// The contour's point nearest to one close by: f and its slope along the view are 0 there. Its gradients span the plane across the curve
/// at cusps, too; on flat walls that are seen edge-on they do not, and the surface's nearest point is as good as any.
glm::dvec3 onto_contour(FieldEvaluator& evaluator, const Camera& camera, const glm::dvec3& near, double close) {
  glm::dvec3 p = near;
  for (int k = 0; k < kMostSteps; ++k) {
    const FieldJet jet = evaluator.jet(p);
    const glm::dvec3 view = view_vector(camera, p);
    const double slope = glm::dot(jet.gradient, view);
    glm::dvec3 of_slope = jet.hessian * view;
    if (camera.projection == Projection::perspective) of_slope -= (jet.gradient - slope * view) / glm::distance(camera.eye, p);
    const double ff = glm::dot(jet.gradient, jet.gradient), fs = glm::dot(jet.gradient, of_slope), ss = glm::dot(of_slope, of_slope),
                 determinant = ff * ss - fs * fs;
    glm::dvec3 move = -jet.value / ff * jet.gradient;
    if (determinant > kFlat * ff * ss)
      move = -((jet.value * ss - slope * fs) * jet.gradient + (slope * ff - jet.value * fs) * of_slope) / determinant;
    p += move;
    if (!(glm::length(move) > close)) break;
  }
  return p;
}

/// Between samples a contour is followed to its own points: the cubic through the samples leads near them.
void add_points_between(const LineTask& task, const PlacedLevelSet& grid, SurfaceCurve& curve) {
  const bool contour = curve.smooth && std::all_of(curve.samples.begin(), curve.samples.end(),
                                                   [](const CurveSample& sample) { return sample.line_class == LineClass::contour; });
  if (!contour) return;
  const auto evaluators =
      std::make_shared<tbb::enumerable_thread_specific<FieldEvaluator>>([field = grid.field] { return FieldEvaluator(field); });
  curve.between = [evaluators, path = std::make_shared<const CurvePath>(path_of(curve)), camera = task.camera, most = grid.voxel](
                      size_t step, double share) {
    const glm::dvec3 near = point_between(*path, step, share), p = onto_contour(evaluators->local(), camera, near, kClose * most);
    return glm::distance(p, near) < kMostOff * most ? p : near;
  };
}

void add_body(const Tracing& tracing, const std::vector<size_t>& body, LineContribution& out) {
  const LineTask& task = tracing.task;
  const Viewer viewer = make_viewer(task.camera, glm::dvec3(0.0));
  const SharpField sharp = union_of(tracing.grids, body, task.extent);
  const FamilyMask families = tracing.levels.size() > 1 ? 3u : 1u;
  const CellSearch search{sharp, task.camera, viewer, {}, 0, {0.0, task.settings.threshold}, families, true};
  CellResult found;
  for (size_t k = 0; k < body.size(); ++k) {
    const PlacedLevelSet& grid = *tracing.grids[body[k]];
    const SurfaceLattice lattice =
        lattice_of(grid, turning_cells(grid, task, viewer.facing, tracing.levels, tracing.execution), tracing.execution);
    found.branches[static_cast<int>(k)] = march(search, k, grid, lattice, task.kept.level_sets.lattices[body[k]], tracing.execution);
    for (size_t j = 0; j < k; ++j) {
      const PlacedLevelSet& other = *tracing.grids[body[j]];
      if (intersect(grid.box, other.box).empty()) continue;
      found.seams[{static_cast<int>(j), static_cast<int>(k)}] =
          march_pair(search, other, grid, task.kept.level_sets.meetings[{body[j], body[k]}], tracing.execution);
    }
  }
  FieldCurves curves;
  double voxel = std::numeric_limits<double>::infinity();
  for (const size_t k : body) voxel = std::min(voxel, tracing.grids[k]->voxel);
  curves_of_cells(found, search, {task.settings.tolerance_px, task.extent, 1.0, voxel, task.missed}, tracing.execution, curves);
  out.unrefined_px = std::max(out.unrefined_px, curves.worst_unrefined_px);
  const FieldTask fields{task, tracing.bodies, body, viewer, tracing.evaluators};
  std::vector<SurfaceCurve> found_curves =
      surface_curves(fields, curves.curves.size(), [&](size_t i) -> const FieldCurve& { return curves.curves[i]; });
  if (body.size() == 1)
    parallel_for(size_t{0}, found_curves.size(), [&](size_t i) { add_points_between(task, *tracing.grids[body[0]], found_curves[i]); });
  out.curves.insert(out.curves.end(), std::make_move_iterator(found_curves.begin()), std::make_move_iterator(found_curves.end()));
}

}  // namespace

LineContribution level_set_lines(const LineTask& task, const std::vector<size_t>& objects, const ExecutionSettings& execution) {
  LineContribution out;
  std::vector<SharedLevelSet> grids;
  grids.reserve(objects.size());
  for (const size_t object : objects) {
    grids.push_back(place_level_set(task, object));
    note_edges(task, *grids.back(), out);
  }
  const FieldBodies bodies = bodies_of(task, grids, objects);
  std::vector<FieldEvaluator> evaluators;
  for (const Field& field : bodies.fields) evaluators.emplace_back(field);
  Tracing tracing{task, execution, grids, bodies, evaluators};
  if (task.wants(LineClass::rim)) tracing.levels.push_back(task.settings.threshold);
  for (const std::vector<size_t>& body : bodies.bodies) add_body(tracing, body, out);
  const auto layers = std::make_shared<const LevelSetLayers>(grids, bodies.bodies, task.camera);
  out.layers_before = [layers](const CurveSample& sample) { return layers->before(sample); };
  out.contours_before = [layers](const CurveSample& sample) { return layers->contours_before(sample); };
  return out;
}

}  // namespace limn
