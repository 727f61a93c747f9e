#include "tests/bench/spline_rays.h"

#include <algorithm>
#include <cmath>

#include "raymarch/analytic/clip_ray.h"
#include "sdf/field_program.h"
#include "sdf/level_set_reconstruction.h"

namespace limn::bench {
namespace {

constexpr double kStep = 0.125;   // voxels, within kNear of the surface
constexpr double kNear = 1.5;     // voxels
constexpr double kMayDip = 0.25;  // voxels: where values along the ray turn lower than this the least one is looked for
constexpr int kHalvings = 50;
constexpr double kGolden = 0.6180339887498949;
constexpr int kNewtonSteps = 20;
constexpr double kKnown = 1e-9;      // of the farthest that a contour's point is looked for
constexpr double kFirstTurn = 1e-3;  // of the same, along the ray
constexpr double kSameFold = 1e-3;   // of the same: nearer points are of one fold
constexpr int kSlopes = 8;

class Ray {
 public:
  Ray(FieldEvaluator& evaluator, const CameraRay& ray) : evaluator_(evaluator), ray_(ray) {}
  double value(double t) { return evaluator_.value(ray_.origin + t * ray_.direction); }
  /// Between a place outside and one inside.
  double root(double outside, double inside) {
    for (int k = 0; k < kHalvings; ++k) {
      const double middle = 0.5 * (outside + inside);
      (value(middle) < 0.0 ? inside : outside) = middle;
    }
    return inside;
  }
  /// A place inside between two outside, where the value at a third between them is less than at both (golden section).
  std::optional<double> dip(double low, double high) {
    double a = high - kGolden * (high - low), b = low + kGolden * (high - low), fa = value(a), fb = value(b);
    for (int k = 0; k < kHalvings; ++k) {
      if (fa < 0.0) return a;
      if (fb < 0.0) return b;
      if (fa < fb) {
        high = b, b = a, fb = fa;
        a = high - kGolden * (high - low), fa = value(a);
      } else {
        low = a, a = b, fa = fb;
        b = low + kGolden * (high - low), fb = value(b);
      }
    }
    return {};
  }

 private:
  FieldEvaluator& evaluator_;
  CameraRay ray_;
};

}  // namespace

std::vector<std::optional<SplineBody>> spline_bodies(const Scene& scene) {
  std::vector<std::optional<SplineBody>> bodies;
  for (const SceneObject& object : scene.objects) {
    bodies.emplace_back();
    const auto* source = std::get_if<LevelSetSource>(&object.source);
    if (source == nullptr) continue;
    const LevelSetInfo& info = source->level_set.info();
    const Affine& world_from_object = object.world_from_object;
    const glm::dmat3 axes = compose(world_from_object, info.world_from_index).linear;
    const double voxel = std::max({glm::length(axes[0]), glm::length(axes[1]), glm::length(axes[2])});
    FieldLeaf leaf = reconstruct(source->level_set).field.program().leaves[0];
    leaf.object_from_world = inverse(world_from_object);
    bodies.back() = SplineBody{field_from_leaf(leaf, false), dilate(transform(world_from_object, info.bounds), 2.0 * voxel), voxel};
  }
  return bodies;
}

std::optional<double> first_hit(const SplineBody& body, FieldEvaluator& evaluator, const CameraRay& ray, double end) {
  double t = 0.0;
  if (!clip_ray(body.box, ray.origin, ray.direction, t, end)) return {};
  Ray along(evaluator, ray);
  double f = along.value(t);
  if (f < 0.0) return t;
  double before = t, f_before = f;
  while (t < end) {
    const double next = std::min(end, t + std::max(kStep, f / body.voxel > kNear ? f / body.voxel - 1.0 : 0.0) * body.voxel);
    const double f_next = along.value(next);
    // Sheets between two samples: the ray may dip into the body where its values turn.
    if (f <= f_before && f <= f_next && f < kMayDip * body.voxel) {
      if (const auto dip = along.dip(before, next)) return along.root(before, *dip);
    }
    if (f_next < 0.0) return along.root(t, next);
    before = t;
    f_before = f;
    t = next;
    f = f_next;
  }
  return {};
}

namespace {

/// By Newton's iteration: f and its slope along the ray are 0, by moves along the ray and across it.
std::optional<glm::dvec3> newton(FieldEvaluator& evaluator, const Camera& camera, const glm::dvec3& drawn, double most) {
  glm::dvec3 p = drawn;
  for (int k = 0; k < kNewtonSteps; ++k) {
    const FieldJet jet = evaluator.jet(p);
    const glm::dvec3 view = view_vector(camera, p), along_ray = glm::dot(jet.gradient, view) * view;
    const glm::dvec3 across = glm::normalize(jet.gradient - along_ray);
    const double slope = glm::dot(jet.gradient, view), f_across = glm::dot(jet.gradient, across), bend = glm::dot(view, jet.hessian * view),
                 twist = glm::dot(view, jet.hessian * across);
    const double determinant = slope * twist - f_across * bend;
    if (determinant == 0.0) return {};
    const double move_along = (-jet.value * twist + f_across * slope) / determinant,
                 move_across = (jet.value * bend - slope * slope) / determinant;
    const glm::dvec3 move = move_along * view + move_across * across;
    if (!(glm::length(move) < most)) return {};
    p += move;
    if (glm::distance(p, drawn) > most) return {};
    if (glm::length(move) < kKnown * most) return p;
  }
  return {};
}

/// Between two places f rises, or falls, all along the view: both belong to one fold of the surface.
bool on_one_fold(FieldEvaluator& evaluator, const Camera& camera, const glm::dvec3& drawn, const glm::dvec3& found) {
  double first = 0.0;
  for (int k = 0; k < kSlopes; ++k) {
    const glm::dvec3 p = glm::mix(drawn, found, static_cast<double>(k) / kSlopes);
    const double slope = glm::dot(evaluator.jet(p).gradient, view_vector(camera, p));
    if (k == 0) first = slope;
    if (first * slope < 0.0) return false;
  }
  return true;
}

/// Where f turns along the view, from the point to where its slope leads: from a point of a hump down to the least f, of a hollow up to the
/// greatest. Nothing within `most`.
std::optional<glm::dvec3> turn_along(FieldEvaluator& evaluator, const glm::dvec3& start, const glm::dvec3& view, bool hump, double most) {
  const auto slope_at = [&](double t) { return glm::dot(evaluator.jet(start + t * view).gradient, view); };
  const double slope = slope_at(0.0);
  if (slope == 0.0) return start;
  const double way = (slope > 0.0) == hump ? -1.0 : 1.0;
  double near = 0.0, far = way * kFirstTurn * most;
  while (slope_at(far) * slope > 0.0) {
    near = far;
    far *= 1.25;
    if (std::fabs(far) > most) return {};
  }
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = 0.5 * (near + far);
    (slope_at(middle) * slope > 0.0 ? near : far) = middle;
  }
  return start + 0.5 * (near + far) * view;
}

/// By moves along the ray to where f turns and across it to where that turn is on the surface. On a flat wall seen edge-on, where Newton's
/// steps leave for another fold of it, they do not.
std::optional<glm::dvec3> by_turns(FieldEvaluator& evaluator, const Camera& camera, const glm::dvec3& drawn, double most) {
  const glm::dvec3 first_view = view_vector(camera, drawn);
  const bool hump = glm::dot(first_view, evaluator.jet(drawn).hessian * first_view) > 0.0;
  glm::dvec3 p = drawn;
  for (int k = 0; k < kNewtonSteps; ++k) {
    const glm::dvec3 view = view_vector(camera, p);
    const auto turn = turn_along(evaluator, p, view, hump, most);
    if (!turn) return {};
    const FieldJet jet = evaluator.jet(*turn);
    const glm::dvec3 across = jet.gradient - glm::dot(jet.gradient, view) * view;
    const glm::dvec3 move = -jet.value / glm::dot(across, across) * across;
    p = *turn + move;
    if (!(glm::distance(p, drawn) < most)) return {};
    if (glm::length(move) < kKnown * most) return p;
  }
  return {};
}

}  // namespace

std::optional<glm::dvec3> on_contour(FieldEvaluator& evaluator, const Camera& camera, const glm::dvec3& drawn, double most) {
  const auto found = newton(evaluator, camera, drawn, most);
  if (found && (glm::distance(drawn, *found) < kSameFold * most || on_one_fold(evaluator, camera, drawn, *found))) return found;
  return by_turns(evaluator, camera, drawn, most);
}

}  // namespace limn::bench
