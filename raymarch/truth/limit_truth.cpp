// The share of subdivision cages: curves traced on the limit surfaces themselves; only whether something stands before them is asked of a
// refined mesh.

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "raymarch/mesh/open_sheet.h"
#include "raymarch/truth/limit_curves.h"
#include "raymarch/truth/proxy.h"
#include "raymarch/truth/shares.h"
#include "sdf/error.h"
#include "sdf/parallel.h"
#include "subdiv/face_orientation.h"

namespace limn {
namespace {

constexpr double kCell_px = 4.0;
constexpr std::int64_t kMostTriangles = 3'000'000;
// A point is lifted off the mesh that stands in for the surface, by more than the two lie apart.
constexpr double kLift_px = 0.1;
constexpr double kTip_px = 0.01;  // what is not resolved around vertices of valence 2 counts from here

struct CageScene {
  std::vector<TracedCurve> curves{};
  double cell_px = 0.0;       ///< The widest lattice's.
  std::int64_t left_out = 0;  ///< Faces without a limit surface.
  double left_out_px = 0.0;   ///< The widest of them.
  double tip_px = 0.0;        ///< LimitGrid::tip_px
  int silhouettes = 0, level_curves = 0;
};

/// The cage about its own middle, so that nothing is lost far from the origin.
Mesh centred(const MeshSource& source, bool turned) {
  Mesh cage = source.mesh;
  const glm::dvec3 center = bounds(cage).center();
  for (glm::dvec3& position : cage.positions) position -= center;
  if (turned) turn_faces(cage);
  return cage;
}

Affine solver_from_centred(const SceneObject& object, const glm::dvec3& origin) {
  Affine solver_from_cage = object.world_from_object;
  solver_from_cage.translation += solver_from_cage.linear * bounds(std::get<MeshSource>(object.source).mesh).center() - origin;
  return solver_from_cage;
}

/// How wide a face is in the picture, as far as its corners tell; a piece of a face counts as all of the cage.
double width_px(const Mesh& cage, const std::vector<std::int32_t>& first, int face, const Affine& solver_from_cage, const Camera& camera) {
  const bool piece = static_cast<size_t>(face) >= cage.face_count();
  const auto begin = piece ? 0 : static_cast<size_t>(first[static_cast<size_t>(face)]);
  const auto end = piece ? cage.corner_vertices.size() : static_cast<size_t>(first[static_cast<size_t>(face) + 1]);
  Box box;
  for (size_t i = begin; i < end; ++i) {
    const glm::dvec3 at = solver_from_cage.point(cage.positions[static_cast<size_t>(cage.corner_vertices[i])]);
    box = include(box, glm::dvec3(glm::dvec2(project(camera, at)), 0.0));
  }
  return box.finite() ? glm::length(box.size()) : std::hypot(camera.width_px, camera.height_px);
}

void count_left_out(const Mesh& cage, const PlacedLimitSurface& placed, const LimitGrid& grid, const Camera& camera, CageScene& out) {
  if (grid.invalid_patches.empty()) return;
  const std::vector<std::int32_t> first = first_corners(cage);
  std::vector<int> faces;
  for (const size_t k : grid.invalid_patches) faces.push_back(placed.patches[k].face);
  faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
  out.left_out += static_cast<std::int64_t>(faces.size());
  for (const int face : faces) out.left_out_px = std::max(out.left_out_px, width_px(cage, first, face, placed.world_from_cage, camera));
}

/// The curves of one object's cage; silhouettes but for the surface turned round.
void trace_side(const SampledCage& sampled, LimitTurn turn, int index, const Camera& camera, const TruthSettings& settings,
                CageScene& out) {
  const PlacedLimitSurface& placed = sampled.placed;
  const LimitGrid& grid = *sampled.grid;
  out.cell_px = std::max(out.cell_px, sampled.lattice.cell_px);
  const bool front = turn != LimitTurn::back;
  out.tip_px = std::max(out.tip_px, grid.tip_px);
  if (front) count_left_out(sampled.cage, placed, grid, camera, out);
  const auto trace = [&](CurveKind kind, double threshold, int& closed) {
    for (TracedCurve& curve : trace_limit_curves(placed, grid, camera, {kind, threshold, 0.5 * settings.tolerance_px, index, turn})) {
      closed += curve.closed;
      out.curves.push_back(std::move(curve));
    }
  };
  if (front) trace(CurveKind::silhouette, 0.0, out.silhouettes);
  if (settings.threshold > 0.0) trace(CurveKind::inner, settings.threshold, out.level_curves);
}

/// `turned`: an open sheet whose normals are turned towards the eye (raymarch/mesh/open_sheet.h), so that its back has level curves too.
void trace_object(const SceneObject& object, const SampledCage& sampled, int index, bool turned, const ShareSettings& settings,
                  CageScene& out) {
  trace_side(sampled, turned ? LimitTurn::front : LimitTurn::none, index, settings.camera, settings.truth, out);
  if (!turned) return;
  SampledCage back(object, settings, true);
  back.sample(settings.camera);
  trace_side(back, LimitTurn::back, index, settings.camera, settings.truth, out);
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

SampledCage::SampledCage(const SceneObject& object, const ShareSettings& settings, bool turned)
    : cage(centred(std::get<MeshSource>(object.source), turned)),
      surface(cage, *std::get<MeshSource>(object.source).scheme, std::get<MeshSource>(object.source).file),
      placed(place(surface, solver_from_centred(object, settings.origin))),
      lattice(lattice_steps(placed, patch_sides(placed), settings.camera, kCell_px, kMostTriangles)) {}

void SampledCage::sample(const Camera& camera) { grid = sample_grid(placed, camera, lattice.steps); }

SampledCages cages_ahead(const Scene& scene, const std::vector<size_t>& objects, const ShareSettings& settings) {
  SampledCages cages(objects.size());
  std::atomic<std::int64_t> triangles{0};
  parallel_each(objects.size(), [&](size_t k) {
    try {
      auto cage = std::make_unique<SampledCage>(scene.objects[objects[k]], settings);
      const std::int64_t own = cage->lattice.triangles;
      if (triangles.fetch_add(own) + own > kMostTriangles) {
        triangles.fetch_sub(own);
        return;
      }
      cage->sample(settings.camera);
      cages[k] = std::move(cage);
    } catch (const InputError&) {
      // Said by trace_cages(), which needs it.
    }
  });
  return cages;
}

TruthShare trace_cages(const Scene& scene, const std::vector<size_t>& objects, const ShareSettings& settings,
                       const std::shared_ptr<const TruthProxy>& proxy, SampledCages cages, const ExecutionSettings& how) {
  CageScene traced;
  for (size_t k = 0; k < objects.size(); ++k) {
    if (how.cancelled && how.cancelled()) throw Cancelled{};
    const SceneObject& object = scene.objects[objects[k]];
    const Surface& shown = proxy->model.surfaces[objects[k]];
    const bool turned = shown.open_sheet && shown.open_sheet->shows_back(shown, settings.camera);
    auto cage = std::move(cages[k]);
    if (!cage) {
      cage = std::make_unique<SampledCage>(object, settings);
      cage->sample(settings.camera);
    }
    trace_object(object, *cage, static_cast<int>(objects[k]) + 1, turned, settings, traced);
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
  if (traced.left_out > 0) {
    share.exact = false;
    share.unrefined_px = traced.left_out_px;
    share.notes.insert(share.notes.begin(),
                       fmt::format("not exact: {} of the cage's faces {} left out, the widest {:.0f} px wide, since their limit surface "
                                   "cannot be evaluated (several sheets touch there); their border is missing",
                                   traced.left_out, traced.left_out == 1 ? "is" : "are", traced.left_out_px));
  }
  if (traced.tip_px > kTip_px) {
    share.exact = false;
    share.unrefined_px = std::max(share.unrefined_px, traced.tip_px);
    share.notes.insert(
        share.notes.begin(),
        fmt::format("not exact: around interior vertices of valence 2, where the limit surface has no tangent plane, the border "
                    "is not resolved within {:.2g} px",
                    traced.tip_px));
  }
  share.lift_px = kLift_px;
  share.blocked = [proxy, objects, camera = settings.camera](const TracedPoint& point, int) {
    return is_blocked(proxy->model, objects, camera, point);
  };
  return share;
}

}  // namespace limn
