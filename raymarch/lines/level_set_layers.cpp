#include "raymarch/lines/level_set_layers.h"

#include <algorithm>
#include <cmath>

#include "raymarch/analytic/clip_ray.h"
#include "sdf/field_program.h"

namespace limn {
namespace {

constexpr double kStep = 0.25;  // of a voxel: how far rays look ahead near the surface
constexpr double kLift = 1e-3;  // of a voxel
constexpr int kHalvings = 12;   // of a step, to a root

struct Ray {
  glm::dvec3 origin{0.0}, direction{0.0};
  double end = 0.0;
  glm::dvec3 at(double t) const { return origin + t * direction; }
};

/// Where a ray goes in or out.
struct Change {
  double t = 0.0;
  int inside = 0;  ///< 1 where it goes in, -1 where out.
};

double root_between(FieldEvaluator& evaluator, const Ray& ray, double low, double high, bool low_inside) {
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = 0.5 * (low + high);
    ((evaluator.value(ray.at(middle)) < 0.0) == low_inside ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// Adds the changes along the ray, that at its start included.
void add_changes(FieldEvaluator& evaluator, const PlacedLevelSet& placed, const Ray& ray, std::vector<Change>& changes) {
  double t = 0.0, t_end = ray.end;
  if (!clip_ray(placed.box, ray.origin, ray.direction, t, t_end)) return;
  double f = evaluator.value(ray.at(t));
  if (f < 0.0) changes.push_back({0.0, 1});
  while (t < t_end) {
    const double before = t;
    t = std::min(t_end, t + std::max(kStep * placed.voxel, std::fabs(f) - placed.voxel));
    const double next = evaluator.value(ray.at(t));
    if ((f < 0.0) != (next < 0.0)) changes.push_back({root_between(evaluator, ray, before, t, f < 0.0), f < 0.0 ? -1 : 1});
    f = next;
  }
}

/// How often the ray goes in or out of all that lies on it.
void count(std::vector<Change>& changes, LayersSeen& seen) {
  std::stable_sort(changes.begin(), changes.end(), [](const Change& a, const Change& b) { return a.t < b.t; });
  int inside = 0;
  for (const Change& change : changes) {
    const bool was = inside > 0;
    inside += change.inside;
    if (was == (inside > 0) || change.t <= 0.0) continue;
    ++seen.count;
    seen.nearest = std::min(seen.nearest, change.t);
  }
}

}  // namespace

LayersSeen LevelSetLayers::before(const CurveSample& sample) const {
  auto& evaluators = evaluators_.local();
  if (evaluators.empty()) {
    for (const SharedLevelSet& placed : level_sets_) evaluators.emplace_back(placed->field);
  }
  const bool perspective = camera_.projection == Projection::perspective;
  const double pixel = 1.0 / pixels_per_unit_at(camera_, std::max(sample.depth, 1e-9));
  LayersSeen seen{0, std::numeric_limits<double>::infinity()};
  std::vector<Change> changes;
  for (const std::vector<size_t>& body : bodies_) {
    double voxel = 0.0;
    for (const size_t i : body) voxel = std::max(voxel, level_sets_[i]->voxel);
    Ray ray;
    ray.origin = sample.p + std::max(kLift * voxel, sample.on_chord ? 0.05 * pixel : 0.0) * sample.lift;
    ray.direction = view_vector(camera_, ray.origin);
    ray.end = perspective ? glm::distance(camera_.eye, ray.origin) : project(camera_, ray.origin).z;
    changes.clear();
    for (const size_t i : body) add_changes(evaluators[i], *level_sets_[i], ray, changes);
    count(changes, seen);
  }
  return seen;
}

}  // namespace limn
