// Truth of scenes made of fields: traced, hidden, thinned and filled.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "raymarch/truth/field_curves.h"
#include "raymarch/truth/field_visibility.h"
#include "raymarch/truth/parts.h"

namespace limn {
namespace {

/// Everything in solver space.
struct SolvedScene {
  glm::dvec3 origin{0.0};  ///< World.
  Camera camera{};
  double extent = 1.0;
  std::vector<Field> fields{};
};

SolvedScene to_solver_space(const Scene& scene, const Camera& camera) {
  SolvedScene solved;
  const Box box = bounds(scene);
  if (box.finite()) solved.origin = box.center();
  solved.camera = moved(camera, solved.origin);
  solved.extent = box.finite() && box.radius() > 0.0 ? box.radius() : std::max(1e-6, glm::length(solved.camera.eye));
  for (const SceneObject& object : scene.objects) solved.fields.push_back(translate(std::get<Field>(object.source), -solved.origin));
  return solved;
}

TracedPoint traced_point(const CurvePoint& point, CurveKind kind, const Camera& camera, const Viewer& viewer) {
  TracedPoint q;
  q.p = point.p;
  const glm::dvec3 image = project(camera, q.p);
  q.px = glm::dvec2(image);
  q.depth = image.z;
  q.high = point.high;
  q.low = point.low;
  q.crease = point.crease;
  if (!point.crease) q.radial_curvature = point.radial_curvature;
  const glm::dvec3 v = viewer.toward_eye(q.p);
  if (kind == CurveKind::silhouette) {
    // Across the view, between the normals of the sheet that is seen and the one that is not.
    const double seen = std::max(glm::dot(q.high, v), 0.0), unseen = std::max(-glm::dot(q.low, v), 0.0);
    glm::dvec3 n = point.crease ? unseen * q.high + seen * q.low : q.high;
    const double length = glm::length(n);
    n = length > 0.0 ? n / length : q.high;
    q.lift = n;
    q.outward = image_direction(camera, q.p, n);
  } else {
    q.shown = !point.crease || glm::dot(q.low, v) > 0.0;
    q.lift = v;
    q.outward = image_direction(camera, q.p, point.uphill);
  }
  return q;
}

CurvePoint curve_point(const TracedPoint& q, const glm::dvec3& uphill) {
  CurvePoint point;
  point.p = q.p;
  point.high = q.high;
  point.low = q.low;
  point.crease = q.crease;
  point.radial_curvature = q.radial_curvature;
  point.uphill = uphill;
  return point;
}

TracedPoint point_on_step(const std::vector<Field>& fields, const Camera& camera, const Viewer& viewer, double threshold,
                          const TracedCurve& curve, size_t i, double t) {
  const TracedPoint &a = curve.points[i], &b = curve.points[(i + 1) % curve.points.size()];
  const Field& field = fields[static_cast<size_t>(curve.object - 1)];
  FieldEvaluator whole(field);
  const Box around = dilate(include(include(Box{}, a.p), b.p), kFanReach * glm::distance(a.p, b.p));
  FieldEvaluator evaluator(whole.restricted(around));
  const double c = curve.kind == CurveKind::silhouette ? 0.0 : threshold;
  const glm::dvec3 chord_point = glm::mix(a.p, b.p, t);
  const auto found = point_between(evaluator, viewer, c, curve_point(a, {}), curve_point(b, {}), chord_point);
  const TracedPoint& nearer = t < 0.5 ? a : b;
  CurvePoint point = found ? *found : curve_point(nearer, {});
  if (!found) point.p = chord_point;
  TracedPoint q = traced_point(point, curve.kind, camera, viewer);
  if (curve.kind == CurveKind::inner) q.outward = nearer.outward;
  return q;
}

void curve_notes(const FieldCurves& found, const std::string& name, std::vector<std::string>& notes) {
  const auto note = [&](std::string text) { notes.push_back(fmt::format("{}: {}", name, text)); };
  if (found.cell_px > 6.0) {
    note(fmt::format("searched in cells of {:.3g} px (the budget of cells is spent): closed curves within one cell may be missing",
                     found.cell_px));
  }
  if (found.unsettled > 0) {
    note(fmt::format("closed curves smaller than {:.2g} px cannot be excluded in {} places", found.cell_px / found.unsettled_cuts,
                     found.unsettled));
  }
  if (found.rough > 0) note(fmt::format("{} points placed to within a cell of {:.2g} px only", found.rough, found.cell_px));
  if (found.open_ends > 0 && !found.domain_cut) note(fmt::format("{} curve ends lead nowhere", found.open_ends));
  if (found.domain_cut) note("has no end: its curves are followed in the scene's surroundings only, and its horizon is left out");
}

SeenInk make_seen(const Scene& scene, const Camera& camera, double threshold) {
  SurfaceSettings settings;
  settings.kind = "analytic";
  auto model = std::make_shared<const SceneModel>(build_model(scene, settings));
  return [model, camera, threshold](std::span<const glm::dvec2> points, std::span<std::uint8_t> ink) {
    std::vector<PointSample> samples(points.size());
    sample_points(*model, camera, points, samples);
    for (size_t i = 0; i < samples.size(); ++i) {
      ink[i] = samples[i].status == HitStatus::hit && static_cast<double>(samples[i].n_dot_v) < threshold;
    }
  };
}

void report(const ExecutionSettings& how, double share) {
  if (how.progress) how.progress(share);
}

}  // namespace

BorderTruth solve_truth_on_fields(const Scene& scene, const Camera& camera, const TruthSettings& settings, const ExecutionSettings& how) {
  BorderTruth truth;
  truth.from = scene.objects.size() == 1 ? "the field" : "the fields";
  const SolvedScene solved = to_solver_space(scene, camera);
  const Viewer viewer = make_viewer(solved.camera, glm::dvec3(0.0));
  FieldCurveSettings trace;
  trace.threshold = settings.threshold;
  trace.tolerance_px = settings.tolerance_px;
  const double reach = 4.0 * (solved.extent + glm::length(solved.camera.eye));
  trace.unbounded_domain = {glm::dvec3(-reach), glm::dvec3(reach)};

  std::vector<TracedCurve> curves;
  double unrefined_px = 0.0;
  for (size_t i = 0; i < solved.fields.size(); ++i) {
    const FieldCurves found = trace_field_curves(solved.fields[i], solved.camera, viewer, trace, how);
    curve_notes(found, scene.objects[i].name.empty() ? fmt::format("object {}", i + 1) : scene.objects[i].name, truth.notes);
    unrefined_px = std::max(unrefined_px, found.worst_unrefined_px);
    for (const FieldCurve& curve : found.curves) {
      TracedCurve traced{curve.c == 0.0 ? CurveKind::silhouette : CurveKind::inner, static_cast<int>(i + 1), curve.closed, {}};
      for (const CurvePoint& point : curve.points) traced.points.push_back(traced_point(point, traced.kind, solved.camera, viewer));
      (traced.kind == CurveKind::silhouette ? truth.contour_generators : truth.level_curves) += curve.closed;
      curves.push_back(std::move(traced));
    }
    report(how, 0.5 * static_cast<double>(i + 1) / static_cast<double>(solved.fields.size()));
  }

  const FieldOccluders occluders(solved.fields, solved.camera, solved.extent);
  CurveScene curve_scene{solved.camera};
  curve_scene.blocked = [&](const TracedPoint& point, int object) { return occluders.blocked(point, object); };
  curve_scene.between = [&](const TracedCurve& curve, size_t i, double t) {
    return point_on_step(solved.fields, solved.camera, viewer, settings.threshold, curve, i, t);
  };
  if (solved.fields.size() > 1) {
    curve_scene.others = [&](const glm::dvec3& p, int object) { return occluders.others(p, object); };
  }
  const VisibilitySettings visibility;
  const auto parts = visible_parts(curves, curve_scene, visibility, how);
  report(how, 0.8);
  truth.curves = border_of(parts, 0.5 * settings.tolerance_px, solved.origin);
  const Coverage coverage = coverage_of(truth.curves, camera.width_px, camera.height_px, make_seen(scene, camera, settings.threshold), how);
  truth.coverage = coverage.share;
  if (coverage.disputed > 0) {
    truth.notes.push_back(fmt::format("{} pairs of neighbouring pixels differ in ink where no curve was found", coverage.disputed));
  }
  truth.bound_px = settings.tolerance_px + visibility.split_px + unrefined_px;
  report(how, 1.0);
  return truth;
}

}  // namespace limn
