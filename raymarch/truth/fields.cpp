// The share of fields: traced on bodies, hidden by bounds along rays.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "raymarch/truth/field_curves.h"
#include "raymarch/truth/field_visibility.h"
#include "raymarch/truth/shares.h"
#include "sdf/segment.h"

namespace limn {
namespace {

constexpr double kBulge_px = 0.05;  // a refined curve leaves its chords by less
constexpr double kTouch = 1e-6;     // of the extent: objects that share less depth touch

/// Everything in solver space.
struct SolvedScene {
  Camera camera{};
  double extent = 1.0;
  std::vector<size_t> numbers{};  ///< Of each object, in the whole scene.
  std::vector<Field> fields{};
  /// Objects that overlap are one body, whose seams are creases like any other.
  std::vector<std::vector<size_t>> bodies{};
  std::vector<Field> body_fields{};
  std::vector<size_t> body_of{};  ///< Of each object.
};

/// Some place in the box is inside the field by more than `depth`.
bool reaches_inside(FieldEvaluator& evaluator, const Box& box, double depth, int cuts) {
  if (evaluator.bounds(box).lower > -depth) return false;
  const glm::dvec3 middle = box.center();
  if (evaluator.value(middle) < -depth) return true;
  if (cuts == 0) return false;
  for (int i = 0; i < 8; ++i) {
    Box child = box;
    for (int axis = 0; axis < 3; ++axis) ((i >> axis & 1) ? child.lower : child.upper)[axis] = middle[axis];
    if (reaches_inside(evaluator, child, depth, cuts - 1)) return true;
  }
  return false;
}

/// Two fields share space. What only touches does not, nor what shares less than some hundredth of its size.
bool overlap(const Field& a, const Field& b, double extent) {
  const Box common = intersect(a.traits().bounds, b.traits().bounds);
  if (!a.traits().bounds.finite() || !b.traits().bounds.finite() || common.empty()) return false;
  FieldEvaluator both(combine(Csg::intersection, a, b));
  return reaches_inside(both, common, kTouch * extent, 6);
}

/// Joins objects that overlap. What has no bounds stays alone.
void find_bodies(SolvedScene& solved) {
  const size_t count = solved.fields.size();
  std::vector<size_t> group(count);
  for (size_t i = 0; i < count; ++i) group[i] = i;
  const auto meet = [&](size_t i, size_t j) { return overlap(solved.fields[i], solved.fields[j], solved.extent); };
  for (size_t i = 0; i < count; ++i) {
    for (size_t j = 0; j < i; ++j) {
      if (group[i] == group[j] || !meet(i, j)) continue;
      const size_t from = std::max(group[i], group[j]), to = std::min(group[i], group[j]);
      std::replace(group.begin(), group.end(), from, to);
    }
  }
  solved.body_of.resize(count);
  for (size_t i = 0; i < count; ++i) {
    if (group[i] == i) solved.bodies.emplace_back();
    solved.body_of[i] = group[i] == i ? solved.bodies.size() - 1 : solved.body_of[group[i]];
    solved.bodies[solved.body_of[i]].push_back(i);
  }
  for (const std::vector<size_t>& body : solved.bodies) {
    std::vector<Field> parts;
    parts.reserve(body.size());
    for (const size_t i : body) parts.push_back(solved.fields[i]);
    solved.body_fields.push_back(combine(Csg::union_, parts));
  }
}

/// The place among the fields of which object of a body a point lies on: where two of them meet, of the one with that normal.
int object_at(std::vector<FieldEvaluator>& evaluators, const std::vector<size_t>& body, const glm::dvec3& p, const glm::dvec3& normal,
              double extent) {
  if (body.size() == 1) return static_cast<int>(body[0]);
  double least = std::numeric_limits<double>::infinity(), best_match = -2.0;
  for (const size_t i : body) least = std::min(least, std::fabs(evaluators[i].value(p)));
  size_t best = body[0];
  for (const size_t i : body) {
    const FieldJet jet = evaluators[i].jet(p);
    const double match = glm::dot(jet.gradient, normal) / std::max(glm::length(jet.gradient), 1e-300);
    if (std::fabs(jet.value) > least + 1e-9 * extent || match <= best_match) continue;
    best_match = match;
    best = i;
  }
  return static_cast<int>(best);
}

SolvedScene to_solver_space(const Scene& scene, const std::vector<size_t>& objects, const ShareSettings& settings) {
  SolvedScene solved;
  solved.camera = settings.camera;
  solved.extent = settings.extent;
  solved.numbers = objects;
  for (const size_t i : objects) solved.fields.push_back(translate(std::get<Field>(scene.objects[i].source), -settings.origin));
  find_bodies(solved);
  return solved;
}

/// The place among the fields of an object's number in the scene.
std::optional<size_t> place_of(const SolvedScene& solved, int object) {
  const auto at = std::find(solved.numbers.begin(), solved.numbers.end(), static_cast<size_t>(object - 1));
  if (at == solved.numbers.end()) return {};
  return static_cast<size_t>(at - solved.numbers.begin());
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

/// A curve of a body, cut where it goes from one object to the next.
void add_traced(const SolvedScene& solved, const Viewer& viewer, std::vector<FieldEvaluator>& evaluators, const std::vector<size_t>& body,
                const FieldCurve& curve, std::vector<TracedCurve>& curves) {
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
    traced.points.push_back(traced_point(curve.points[i], kind, solved.camera, viewer));
    if (objects[i] == traced.object) continue;
    const TracedPoint joint = traced.points.back();
    curves.push_back(std::move(traced));
    traced = {kind, objects[i], false, {joint}};
  }
  if (!whole && curve.closed) traced.points.push_back(traced_point(curve.points[start], kind, solved.camera, viewer));
  if (traced.points.size() > 1) curves.push_back(std::move(traced));
}

std::string name_of(const Scene& scene, const std::vector<size_t>& numbers, const std::vector<size_t>& body) {
  std::string name;
  for (const size_t i : body) {
    const std::string& own = scene.objects[numbers[i]].name;
    name += (name.empty() ? "" : " and ") + (own.empty() ? fmt::format("object {}", numbers[i] + 1) : own);
  }
  return name;
}

TracedPoint point_on_step(const SolvedScene& solved, const Viewer& viewer, double threshold, const TracedCurve& curve, size_t i, double t) {
  const TracedPoint &a = curve.points[i], &b = curve.points[(i + 1) % curve.points.size()];
  FieldEvaluator whole(solved.body_fields[solved.body_of[*place_of(solved, curve.object)]]);
  const Box around = dilate(include(include(Box{}, a.p), b.p), kFanReach * glm::distance(a.p, b.p));
  FieldEvaluator evaluator(whole.restricted(around));
  const double c = curve.kind == CurveKind::silhouette ? 0.0 : threshold;
  const glm::dvec3 chord_point = glm::mix(a.p, b.p, t);
  auto found = point_between(evaluator, viewer, c, curve_point(a, {}), curve_point(b, {}), chord_point);
  // The step was refined, so that its chord is as good; farther from it lies another curve: beside the tip of a wedge its other side.
  if (found && a.crease == b.crease) {
    const glm::dvec2 at(project(solved.camera, found->p));
    if (found->crease != a.crease || distance_to_segment(at, a.px, b.px) > kBulge_px) found.reset();
  }
  const TracedPoint& nearer = t < 0.5 ? a : b;
  CurvePoint point = found ? *found : curve_point(nearer, {});
  if (!found) point.p = chord_point;
  TracedPoint q = traced_point(point, curve.kind, solved.camera, viewer);
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
  const auto solved = std::make_shared<const SolvedScene>(to_solver_space(scene, objects, settings));
  const Viewer viewer = make_viewer(solved->camera, glm::dvec3(0.0));
  FieldCurveSettings trace;
  trace.threshold = settings.truth.threshold;
  trace.tolerance_px = settings.truth.tolerance_px;
  const double reach = 4.0 * (solved->extent + glm::length(solved->camera.eye));
  trace.unbounded_domain = {glm::dvec3(-reach), glm::dvec3(reach)};
  std::vector<FieldEvaluator> evaluators;
  for (const Field& field : solved->fields) evaluators.emplace_back(field);
  for (size_t i = 0; i < solved->bodies.size(); ++i) {
    const FieldCurves found = trace_field_curves(solved->body_fields[i], solved->camera, viewer, trace, how);
    curve_notes(found, name_of(scene, objects, solved->bodies[i]), share.notes);
    share.unrefined_px = std::max(share.unrefined_px, found.worst_unrefined_px);
    for (const FieldCurve& curve : found.curves) {
      (curve.c == 0.0 ? share.contour_generators : share.level_curves) += curve.closed;
      add_traced(*solved, viewer, evaluators, solved->bodies[i], curve, share.curves);
    }
    if (how.progress) how.progress(0.5 * static_cast<double>(i + 1) / static_cast<double>(solved->bodies.size()));
  }
  const auto occluders = std::make_shared<const FieldOccluders>(solved->fields, solved->camera, solved->extent);
  share.blocked = [solved, occluders](const TracedPoint& point, int object) {
    return occluders->blocked(point, place_of(*solved, object));
  };
  share.between = [solved, viewer, threshold = settings.truth.threshold](const TracedCurve& curve, size_t i, double t) {
    return point_on_step(*solved, viewer, threshold, curve, i, t);
  };
  share.others = [solved, occluders](const glm::dvec3& p, int object) { return occluders->others(p, place_of(*solved, object)); };
  return share;
}

}  // namespace limn
