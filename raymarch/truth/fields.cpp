// The share of fields: traced on bodies, hidden by bounds along rays.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "raymarch/truth/field_bodies.h"
#include "raymarch/truth/field_curves.h"
#include "raymarch/truth/field_visibility.h"
#include "raymarch/truth/shares.h"
#include "sdf/segment.h"

namespace limn {
namespace {

constexpr double kBulge_px = 0.05;   // a refined curve leaves its chords by less
constexpr double kNear_px = 0.5;     // within which its points are looked for first,
constexpr double kShortReach = 0.5;  // where that is less of a step

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

/// A curve of a body, cut where it goes from one object to the next.
void add_traced(const FieldBodies& solved, const Camera& camera, const Viewer& viewer, std::vector<FieldEvaluator>& evaluators,
                const std::vector<size_t>& body, const FieldCurve& curve, std::vector<TracedCurve>& curves) {
  const CurveKind kind = curve.c == 0.0 ? CurveKind::silhouette : CurveKind::inner;
  const size_t n = curve.points.size();
  std::vector<int> objects(n);
  for (size_t i = 0; i < n; ++i) {
    const CurvePoint& point = curve.points[i];
    const int place = object_at(evaluators, body, point.p, kind == CurveKind::silhouette ? point.high : point.low, solved.extent);
    objects[i] = static_cast<int>(solved.numbers[static_cast<size_t>(place)] + 1);
  }
  const auto change = std::adjacent_find(objects.begin(), objects.end(), std::not_equal_to<>());
  const bool whole = change == objects.end();
  const size_t start = whole || !curve.closed ? 0 : static_cast<size_t>(change - objects.begin()) + 1;
  TracedCurve traced{kind, objects[start], whole && curve.closed, {}};
  for (size_t k = 0; k < n; ++k) {
    const size_t i = (start + k) % n;
    traced.points.push_back(traced_point(curve.points[i], kind, camera, viewer));
    if (objects[i] == traced.object) continue;
    const TracedPoint joint = traced.points.back();
    curves.push_back(std::move(traced));
    traced = {kind, objects[i], false, {joint}};
  }
  if (!whole && curve.closed) traced.points.push_back(traced_point(curve.points[start], kind, camera, viewer));
  if (traced.points.size() > 1) curves.push_back(std::move(traced));
}

/// The curve's point beside a place on the chord of a refined step, found by a search of at most `reach` step lengths. The chord is as good
/// where it finds another curve: beside the tip of a wedge its other side.
std::optional<CurvePoint> beside_chord(FieldEvaluator& whole, const Camera& camera, const Viewer& viewer, double c, const TracedPoint& a,
                                       const TracedPoint& b, const glm::dvec3& chord_point, double reach) {
  Box around = include(Box{}, chord_point);
  if (reach >= 1.0) around = include(include(around, a.p), b.p);
  FieldEvaluator evaluator(whole.restricted(dilate(around, kFanReach * reach * glm::distance(a.p, b.p))));
  auto found = point_between(evaluator, viewer, c, curve_point(a, {}), curve_point(b, {}), chord_point, reach);
  if (found && a.crease == b.crease) {
    const glm::dvec2 at(project(camera, found->p));
    if (found->crease != a.crease || distance_to_segment(at, a.px, b.px) > kBulge_px) found.reset();
  }
  return found;
}

TracedPoint point_on_step(const FieldBodies& solved, const Camera& camera, const Viewer& viewer, double threshold, const TracedCurve& curve,
                          size_t i, double t) {
  const TracedPoint &a = curve.points[i], &b = curve.points[(i + 1) % curve.points.size()];
  FieldEvaluator whole(solved.body_fields[solved.body_of[*place_of(solved, curve.object)]]);
  const double c = curve.kind == CurveKind::silhouette ? 0.0 : threshold;
  const glm::dvec3 chord_point = glm::mix(a.p, b.p, t);
  // The curve leaves the chord by little: a small box, in which most of a large field is without influence, nearly always holds it.
  const double near = kNear_px / pixels_per_unit_at(camera, glm::mix(a.depth, b.depth, t)), reach = near / glm::distance(a.p, b.p);
  std::optional<CurvePoint> found;
  if (a.crease == b.crease && reach < kShortReach) found = beside_chord(whole, camera, viewer, c, a, b, chord_point, reach);
  if (!found) found = beside_chord(whole, camera, viewer, c, a, b, chord_point, 1.0);
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
  if (!found.curves.empty()) {
    note(
        fmt::format("bounds (at sharp edges, what N.V is around them) leave no room for a closed curve that was not found, but within "
                    "{:.2g} px of one that was{}",
                    found.unproven_px,
                    found.unsettled > 0 ? fmt::format(", and in {} places of less than {:.2g} px", found.unsettled, found.cell_px) : ""));
  }
  if (found.rough > 0) note(fmt::format("{} points placed to within a cell of {:.2g} px only", found.rough, found.cell_px));
  if (found.open_ends > 0 && !found.domain_cut) note(fmt::format("{} curve ends lead nowhere", found.open_ends));
  if (found.domain_cut) note("has no end: its curves are followed in the scene's surroundings only, and its horizon is left out");
}

}  // namespace

TruthShare trace_fields(const Scene& scene, const std::vector<size_t>& objects, const ShareSettings& settings,
                        const ExecutionSettings& how) {
  TruthShare share;
  share.objects = objects;
  const auto solved = std::make_shared<const FieldBodies>(field_bodies(scene, objects, settings.origin, settings.extent));
  const Viewer viewer = make_viewer(settings.camera, glm::dvec3(0.0));
  FieldCurveSettings trace;
  trace.threshold = settings.truth.threshold;
  trace.tolerance_px = settings.truth.tolerance_px;
  const double reach = 4.0 * (solved->extent + glm::length(settings.camera.eye));
  trace.unbounded_domain = {glm::dvec3(-reach), glm::dvec3(reach)};
  std::vector<FieldEvaluator> evaluators;
  for (const Field& field : solved->fields) evaluators.emplace_back(field);
  for (size_t i = 0; i < solved->bodies.size(); ++i) {
    const FieldCurves found = trace_field_curves(solved->body_fields[i], settings.camera, viewer, trace, how);
    curve_notes(found, name_of_body(scene, objects, solved->bodies[i]), share.notes);
    share.unrefined_px = std::max(share.unrefined_px, found.worst_unrefined_px);
    for (const FieldCurve& curve : found.curves) {
      (curve.c == 0.0 ? share.contour_generators : share.level_curves) += curve.closed;
      add_traced(*solved, settings.camera, viewer, evaluators, solved->bodies[i], curve, share.curves);
    }
    if (how.progress) how.progress(0.5 * static_cast<double>(i + 1) / static_cast<double>(solved->bodies.size()));
  }
  const auto occluders = std::make_shared<const FieldOccluders>(solved->fields, settings.camera, solved->extent);
  share.blocked = [solved, occluders](const TracedPoint& point, int object) {
    return occluders->blocked(point, place_of(*solved, object));
  };
  share.between = [solved, camera = settings.camera, viewer, threshold = settings.truth.threshold](const TracedCurve& curve, size_t i,
                                                                                                   double t) {
    return point_on_step(*solved, camera, viewer, threshold, curve, i, t);
  };
  share.others = [solved, occluders](const glm::dvec3& p, int object) { return occluders->others(p, place_of(*solved, object)); };
  return share;
}

}  // namespace limn
