// Lines of subdivision cages: contours, creases and open edges of the limit surface; layers counted on a fine mesh of it.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "raymarch/lines/cage_seams.h"
#include "raymarch/lines/line_memory.h"
#include "raymarch/lines/mesh_layers.h"
#include "raymarch/lines/placed_cage.h"
#include "raymarch/lines/seams.h"
#include "raymarch/truth/limit_curves.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr double kCell_px = 4.0;
constexpr double kProxyEdge_px = 1.5;
constexpr std::int64_t kMostTriangles = 3'000'000;

/// Rounded up, so that views from much the same distance share their samples.
int shared_steps(int steps) {
  int shared = std::min(steps, 4);
  while (shared < steps) shared += shared / 4 % 2 == 0 ? shared / 4 : shared / 4 + 1;
  return shared;
}

SurfaceCurve curve_of(const LineTask& task, const TracedCurve& traced) {
  const bool contour = traced.kind == CurveKind::silhouette;
  SurfaceCurve curve{traced.closed, contour, {}};
  for (const TracedPoint& point : traced.points) {
    CurveSample sample;
    sample.p = point.p;
    sample.px = point.px;
    sample.depth = point.depth;
    sample.high = sample.low = point.high;
    sample.radial_curvature = point.radial_curvature;
    sample.lift = point.lift;
    sample.object = traced.object;
    sample.line_class = contour ? LineClass::contour : LineClass::rim;
    curve.samples.push_back(sample);
  }
  if (contour) set_fold(task.camera, curve);
  return curve;
}

void add_cage(const LineTask& task, size_t object, LineContribution& out) {
  const PlacedCage cage = place_cage(task, object);
  const PlacedLimitSurface placed = place(*cage.surface, cage.solver_from_cage);
  KeptCage& kept = task.kept.cages[object];
  if (kept.sides.empty()) kept.sides = patch_sides(placed);
  const int steps = shared_steps(lattice_steps(placed, kept.sides, task.camera, kCell_px, kMostTriangles).steps);
  std::shared_ptr<const LimitGrid>& kept_grid = kept.grids[steps];
  if (!kept_grid) kept_grid = std::make_shared<const LimitGrid>(sample_grid(placed, task.camera, steps));
  const LimitGrid& grid = *kept_grid;
  LimitCurveSettings tracing;
  tracing.tolerance_px = 0.5 * task.settings.tolerance_px;
  tracing.object = static_cast<int>(object) + 1;
  tracing.seams = false;
  for (const TracedCurve& curve : trace_limit_curves(placed, grid, task.camera, tracing)) out.curves.push_back(curve_of(task, curve));
  if (task.wants(LineClass::rim)) {
    tracing.kind = CurveKind::inner;
    tracing.threshold = task.settings.threshold;
    for (const TracedCurve& curve : trace_limit_curves(placed, grid, task.camera, tracing)) out.curves.push_back(curve_of(task, curve));
  }
  for (const Seam& seam : limit_seams(placed, grid, task.camera, tracing.tolerance_px, tracing.object))
    out.curves.push_back(curve_of_seam(task.camera, seam));
  if (!grid.invalid_patches.empty()) {
    out.exact = false;
    out.notes.push_back(
        fmt::format("not exact: {} patches of the limit surface cannot be evaluated and are left out", grid.invalid_patches.size()));
  }
}

}  // namespace

PlacedCage place_cage(const LineTask& task, size_t object) {
  const SceneObject& scene_object = task.scene.objects[object];
  const auto& source = std::get<MeshSource>(scene_object.source);
  const glm::dvec3 center = bounds(source.mesh).center();
  std::shared_ptr<const LimitSurface>& kept = task.kept.cages[object].surface;
  if (!kept) {
    Mesh cage = source.mesh;
    for (glm::dvec3& position : cage.positions) position -= center;
    kept = std::make_shared<const LimitSurface>(cage, *source.scheme, source.file);
  }
  Affine solver_from_cage = scene_object.world_from_object;
  solver_from_cage.translation += solver_from_cage.linear * center - task.origin;
  return {kept, solver_from_cage};
}

LineContribution cage_lines(const LineTask& task, const std::vector<size_t>& objects, const ExecutionSettings& execution) {
  LineContribution out;
  std::shared_ptr<const MeshLayers> layers;
  // The one knows nothing of the other, and parts of both are done by one thread.
  parallel_invoke(
      [&] {
        for (const size_t i : objects) {
          if (execution.cancelled && execution.cancelled()) throw Cancelled{};
          add_cage(task, i, out);
        }
      },
      [&] {
        layers = std::make_shared<const MeshLayers>(task, objects, kProxyEdge_px, true);
        layers->tree().meetings();
      });
  add_mesh_layers(layers, out);
  return out;
}

}  // namespace limn
