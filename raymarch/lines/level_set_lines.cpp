// Lines of level sets: contours of the spline whose gradients their normals are, found cell by cell.

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "raymarch/analytic/clip_ray.h"
#include "raymarch/lines/placed_level_set.h"
#include "raymarch/lines/seams.h"
#include "raymarch/truth/field_curves.h"
#include "sdf/field_program.h"
#include "sdf/level_set_reconstruction.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr double kTurn = 0.03;  // radians, beyond twice the spread that a cell's corners show
constexpr double kStep = 0.25;  // of a voxel: how far rays look ahead near the surface
constexpr double kLift = 1e-3;  // of a voxel

/// One object in solver space.
struct PlacedGrid : PlacedLevelSet {
  std::vector<SurfaceCell> cells{};
};

PlacedGrid place_grid(const LineTask& task, size_t object) {
  PlacedGrid grid{place_level_set(task, object)};
  grid.cells = surface_cells(std::get<LevelSetSource>(task.scene.objects[object].source).level_set);
  const glm::dmat3 turn = glm::transpose(inverse(grid.solver_from_world).linear);
  for (SurfaceCell& cell : grid.cells) {
    const glm::dvec3 normal = turn * glm::dvec3(cell.normal);
    if (glm::length(normal) > 0.0) cell.normal = glm::vec3(glm::normalize(normal));
  }
  return grid;
}

/// Cells of a cubic lattice in solver space that a contour, or the rim's curve, may go through.
struct Lattice {
  CellGrid grid{};
  std::vector<glm::ivec3> cells{};
};

Lattice lattice_of(const PlacedGrid& placed, const LineTask& task, const std::vector<double>& levels) {
  Lattice lattice;
  lattice.grid.side = placed.voxel;
  const glm::dmat3& linear = placed.solver_from_index.linear;
  const bool aligned = linear == glm::dmat3(linear[0][0]) && linear[0][0] > 0.0;
  // Nodes of the lattice are nodes of the level set where that is possible; indices are to be positive.
  glm::ivec3 lowest(0);
  if (aligned) {
    for (const SurfaceCell& cell : placed.cells) lowest = glm::min(lowest, cell.node);
    lowest -= 2;
    lattice.grid.corner = placed.solver_from_index.point(glm::dvec3(lowest));
  } else {
    lattice.grid.corner = placed.box.lower - 2.0 * placed.voxel;
  }
  const auto cell_at = [&](const glm::dvec3& p) { return glm::ivec3(glm::floor((p - lattice.grid.corner) / lattice.grid.side)); };
  for (const SurfaceCell& cell : placed.cells) {
    const glm::dvec3 middle = placed.solver_from_index.point(glm::dvec3(cell.node) + 0.5);
    const double facing = glm::dot(glm::dvec3(cell.normal), view_vector(task.camera, middle)),
                 reach = 2.0 * static_cast<double>(cell.spread) + kTurn;
    const bool may = cell.normal == glm::vec3(0.0f) || std::any_of(levels.begin(), levels.end(), [&](double level) {
                       return std::fabs(std::asin(std::clamp(facing, -1.0, 1.0)) - std::asin(level)) <= reach;
                     });
    if (!may) continue;
    const glm::ivec3 own = aligned ? cell.node - lowest : cell_at(middle);
    const int around = aligned && !cell.near_corner ? 0 : 1;
    for (int x = -around; x <= around; ++x)
      for (int y = -around; y <= around; ++y)
        for (int z = -around; z <= around; ++z) lattice.cells.push_back(own + glm::ivec3(x, y, z));
  }
  const auto before = [](const glm::ivec3& a, const glm::ivec3& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); };
  std::sort(lattice.cells.begin(), lattice.cells.end(), before);
  lattice.cells.erase(std::unique(lattice.cells.begin(), lattice.cells.end()), lattice.cells.end());
  return lattice;
}

CellResult march(const CellSearch& search, const std::vector<glm::ivec3>& cells, const ExecutionSettings& execution) {
  constexpr size_t kBlock = 256;
  std::vector<CellOutput> parts((cells.size() + kBlock - 1) / kBlock);
  parallel_for(size_t{0}, parts.size(), [&](size_t part) {
    if (execution.cancelled && execution.cancelled()) throw Cancelled{};
    FieldEvaluator evaluator(search.sharp.branches[0]);
    for (size_t i = part * kBlock; i < std::min(cells.size(), (part + 1) * kBlock); ++i)
      march_cell(evaluator, search.viewer, search.grid, cells[i], search.levels, search.families, parts[part]);
  });
  CellResult result;
  for (const CellOutput& part : parts) {
    for (size_t family = 0; family < kCurveFamilies; ++family) {
      CellCurves& all = result.branches[0][family];
      all.crossings.insert(all.crossings.end(), part[family].crossings.begin(), part[family].crossings.end());
      all.links.insert(all.links.end(), part[family].links.begin(), part[family].links.end());
    }
  }
  return result;
}

SurfaceCurve curve_of(const LineTask& task, const FieldCurve& found, int object) {
  SurfaceCurve curve{found.closed, found.c == 0.0, {}};
  for (const CurvePoint& point : found.points) {
    CurveSample sample;
    sample.p = point.p;
    sample.high = sample.low = point.high;
    sample.radial_curvature = point.radial_curvature;
    sample.lift = found.c != 0.0 ? view_vector(task.camera, point.p) : point.radial_curvature < 0.0 ? -point.high : point.high;
    sample.line_class = found.c == 0.0 ? LineClass::contour : LineClass::rim;
    sample.object = object;
    project_sample(task.camera, sample);
    curve.samples.push_back(sample);
  }
  if (curve.smooth) set_fold(task.camera, curve);
  return curve;
}

/// Counts sign changes along rays, a quarter of a voxel at a time near the surface and as far as the distance says elsewhere.
class GridLayers {
 public:
  GridLayers(std::vector<PlacedGrid> grids, const Camera& camera) : grids_(std::move(grids)), camera_(camera) {}

  int before(const CurveSample& sample) const {
    auto& evaluators = evaluators_.local();
    if (evaluators.empty()) {
      for (const PlacedGrid& grid : grids_) evaluators.emplace_back(grid.field);
    }
    int layers = 0;
    for (size_t i = 0; i < grids_.size(); ++i) layers += sign_changes(evaluators[i], grids_[i], sample);
    return layers;
  }

 private:
  int sign_changes(FieldEvaluator& evaluator, const PlacedGrid& grid, const CurveSample& sample) const {
    const double pixel = 1.0 / pixels_per_unit_at(camera_, std::max(sample.depth, 1e-9));
    const double lift = std::max(kLift * grid.voxel, sample.on_chord ? 0.05 * pixel : 0.0);
    const glm::dvec3 origin = sample.p + lift * sample.lift;
    const bool perspective = camera_.projection == Projection::perspective;
    const glm::dvec3 direction = view_vector(camera_, origin);
    double t = 0.0, t_end = perspective ? glm::distance(camera_.eye, origin) : project(camera_, origin).z;
    if (!clip_ray(grid.box, origin, direction, t, t_end)) return 0;
    double f = evaluator.value(origin + t * direction);
    int changes = 0;
    while (t < t_end) {
      t = std::min(t_end, t + std::max(kStep * grid.voxel, std::fabs(f) - grid.voxel));
      const double next = evaluator.value(origin + t * direction);
      changes += (f < 0.0) != (next < 0.0);
      f = next;
    }
    return changes;
  }

  std::vector<PlacedGrid> grids_;
  Camera camera_;
  mutable tbb::enumerable_thread_specific<std::vector<FieldEvaluator>> evaluators_;
};

}  // namespace

PlacedLevelSet place_level_set(const LineTask& task, size_t object) {
  const SceneObject& scene_object = task.scene.objects[object];
  const LevelSet& level_set = std::get<LevelSetSource>(scene_object.source).level_set;
  Affine solver_from_world = scene_object.world_from_object;
  solver_from_world.translation -= task.origin;
  FieldLeaf leaf = reconstruction_field(level_set).program().leaves[0];
  leaf.object_from_world = inverse(solver_from_world);
  PlacedLevelSet placed{field_from_leaf(leaf, false), solver_from_world};
  placed.solver_from_index = compose(solver_from_world, level_set.info().world_from_index);
  const glm::dmat3& axes = placed.solver_from_index.linear;
  placed.voxel = std::max({glm::length(axes[0]), glm::length(axes[1]), glm::length(axes[2])});
  placed.box = dilate(transform(solver_from_world, level_set.info().bounds), 2.0 * placed.voxel);
  return placed;
}

LineContribution level_set_lines(const LineTask& task, const std::vector<size_t>& objects, const ExecutionSettings& execution) {
  LineContribution out;
  std::vector<PlacedGrid> grids;
  std::vector<double> levels{0.0};
  if (task.wants(LineClass::rim)) levels.push_back(task.settings.threshold);
  const Viewer viewer = make_viewer(task.camera, glm::dvec3(0.0));
  for (const size_t object : objects) {
    grids.push_back(place_grid(task, object));
    const PlacedGrid& placed = grids.back();
    const Lattice lattice = lattice_of(placed, task, levels);
    const SharpField sharp = split_branches(placed.field, task.extent);
    const CellSearch search{sharp, task.camera, viewer, lattice.grid, 0, {0.0, task.settings.threshold}, levels.size() > 1 ? 3u : 1u, true};
    CellResult found = march(search, lattice.cells, execution);
    FieldCurves curves;
    curves_of_cells(found, search, {task.settings.tolerance_px, task.extent, 1.0}, execution, curves);
    out.unrefined_px = std::max(out.unrefined_px, curves.worst_unrefined_px);
    for (const FieldCurve& curve : curves.curves) out.curves.push_back(curve_of(task, curve, static_cast<int>(object) + 1));
  }
  const auto layers = std::make_shared<const GridLayers>(std::move(grids), task.camera);
  out.layers_before = [layers](const CurveSample& sample) { return LayersSeen{layers->before(sample)}; };
  return out;
}

}  // namespace limn
