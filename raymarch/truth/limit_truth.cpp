// The share of subdivision cages: curves traced on the limit surfaces themselves; only whether something stands before them is asked of a
// refined mesh.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "raymarch/mesh/open_sheet.h"
#include "raymarch/truth/limit_curves.h"
#include "raymarch/truth/proxy.h"
#include "raymarch/truth/shares.h"
#include "subdiv/face_orientation.h"

namespace limn {
namespace {

constexpr double kCell_px = 4.0;
constexpr std::int64_t kMostTriangles = 3'000'000;
// A point is lifted off the mesh that stands in for the surface, by more than the two lie apart.
constexpr double kLift_px = 0.1;

struct CageScene {
  std::vector<TracedCurve> curves{};
  double cell_px = 0.0;  ///< The widest lattice's.
  std::int64_t invalid_patches = 0;
  int silhouettes = 0, level_curves = 0;
};

/// The curves of one object's cage, placed; `front`: silhouettes too.
void trace_side(const PlacedLimitSurface& placed, bool front, int index, const Camera& camera, const TruthSettings& settings,
                CageScene& out) {
  double cell_px = 0.0;
  const LimitGrid grid = sample_grid(placed, camera, kCell_px, kMostTriangles, cell_px);
  out.cell_px = std::max(out.cell_px, cell_px);
  if (front) out.invalid_patches += grid.invalid_patches;
  const auto trace = [&](CurveKind kind, double threshold, int& closed) {
    for (TracedCurve& curve : trace_limit_curves(placed, grid, camera, {kind, threshold, 0.5 * settings.tolerance_px, index})) {
      closed += curve.closed;
      out.curves.push_back(std::move(curve));
    }
  };
  if (front) trace(CurveKind::silhouette, 0.0, out.silhouettes);
  if (settings.threshold > 0.0) trace(CurveKind::inner, settings.threshold, out.level_curves);
}

/// The cage about its own middle, so that nothing is lost far from the origin. `turned`: an open sheet whose normals are turned towards the
/// eye (raymarch/mesh/open_sheet.h), so that its back has level curves too.
void trace_object(const SceneObject& object, int index, bool turned, const Camera& camera, const glm::dvec3& origin,
                  const TruthSettings& settings, CageScene& out) {
  const auto& source = std::get<MeshSource>(object.source);
  Mesh cage = source.mesh;
  const glm::dvec3 center = bounds(cage).center();
  for (glm::dvec3& position : cage.positions) position -= center;
  Affine solver_from_cage = object.world_from_object;
  solver_from_cage.translation += solver_from_cage.linear * center - origin;
  const LimitSurface surface(cage, *source.scheme, source.file);
  trace_side(place(surface, solver_from_cage), true, index, camera, settings, out);
  if (!turned) return;
  turn_faces(cage);
  const LimitSurface back(cage, *source.scheme, source.file);
  trace_side(place(back, solver_from_cage), false, index, camera, settings, out);
}

/// One ray from a lifted point to the eye.
bool is_blocked(const SceneModel& model, const std::vector<size_t>& objects, const Camera& camera, const TracedPoint& point) {
  const double unit_px = pixels_per_unit_at(camera, std::max(point.depth, 1e-9));
  const glm::dvec3 start = point.p + (kLift_px / unit_px) * point.lift, direction = view_vector(camera, start);
  const double reach = camera.projection == Projection::perspective ? glm::distance(start, camera.eye)
                                                                    : std::max(0.0, project(camera, start).z) + 4.0 * model.bounds.radius();
  RayBatch rays;
  HitBatch hits;
  rays.count = 1;
  rays.set(0, start, direction, 0.0, reach);
  for (const size_t object : objects) {
    const Surface& surface = model.surfaces[object];
    hits.status[0] = HitStatus::miss;
    hits.t[0] = rays.t_max[0];
    surface.trace(surface.state.get(), rays, hits);
    if (hits.status[0] != HitStatus::miss) return true;
  }
  return false;
}

}  // namespace

TruthShare trace_cages(const Scene& scene, const std::vector<size_t>& objects, const ShareSettings& settings,
                       std::shared_ptr<const TruthProxy> proxy, const ExecutionSettings& how) {
  CageScene traced;
  for (const size_t i : objects) {
    if (how.cancelled && how.cancelled()) throw Cancelled{};
    const Surface& shown = proxy->model.surfaces[i];
    const bool turned = shown.open_sheet && shown.open_sheet->shows_back(shown, settings.camera);
    trace_object(scene.objects[i], static_cast<int>(i) + 1, turned, settings.camera, settings.origin, settings.truth, traced);
  }
  TruthShare share;
  share.objects = objects;
  share.curves = std::move(traced.curves);
  share.contour_generators = traced.silhouettes;
  share.level_curves = traced.level_curves;
  share.notes.push_back(
      fmt::format("closed curves narrower than {:.1f} px are found only where they reach a sample of the surface; what hides what "
                  "was decided on a mesh with edges of {:.1f} px, lifted by {} px; around extraordinary vertices normals are "
                  "right to 0.01 degrees",
                  traced.cell_px, proxy->edge_px, kLift_px));
  if (traced.invalid_patches > 0)
    share.notes.push_back(fmt::format("{} faces without a limit surface were left out", traced.invalid_patches));
  share.blocked = [proxy, objects, camera = settings.camera](const TracedPoint& point, int) {
    return is_blocked(proxy->model, objects, camera, point);
  };
  return share;
}

}  // namespace limn
