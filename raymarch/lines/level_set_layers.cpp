#include "raymarch/lines/level_set_layers.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "raymarch/analytic/clip_ray.h"
#include "raymarch/truth/locate.h"
#include "sdf/field_program.h"

namespace limn {
namespace {

constexpr double kStep = 0.25;  // of a voxel: how far rays look ahead in cells that may hold the surface
// Of a voxel: rays start from the curves' own points, beside other lines that may lie within a hundredth of a pixel.
constexpr double kLift = 1e-5;
constexpr int kHalvings = 12;       // of a step, to a root
constexpr double kShortest = 1e-4;  // of a voxel: sheets closer together are none
constexpr double kGrazed = 0.5;     // voxels: of a ray that goes in and out within so much the way is no longer across a sheet

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

/// The level set along a ray.
struct RaySample {
  double t = 0.0, f = 0.0;
  double slope = 0.0;  ///< Along the ray.
  bool inside() const { return f < 0.0; }
};

/// Where the ray goes in and out between two places, in order. Sheets of a shallow fold lie closer together than the ray's steps: its
/// slopes tell where it may go through both of them within one.
class RootFinder {
 public:
  RootFinder(FieldEvaluator& evaluator, const Ray& ray, double voxel, std::vector<Change>& changes)
      : evaluator_(evaluator), ray_(ray), shortest_(kShortest * voxel), changes_(changes) {}

  RaySample at(double t) {
    const glm::dvec3 p = ray_.at(t);
    RaySample sample{t};
    glm::dvec3 gradient(0.0);
    evaluator_.gradients(std::span(&p, 1), std::span(&sample.f, 1), std::span(&gradient, 1));
    sample.slope = glm::dot(gradient, ray_.direction);
    return sample;
  }

  void find(const RaySample& a, const RaySample& b) {
    const double length = b.t - a.t;
    if (a.inside() != b.inside()) {
      const bool rises = b.f > a.f;
      if (length <= shortest_ || (rises == (a.slope > 0.0) && rises == (b.slope > 0.0))) {
        changes_.push_back({root_between(a, b), a.inside() ? -1 : 1});
        return;
      }
    } else {
      const double sign = a.inside() ? -1.0 : 1.0, down = -sign * a.slope, up = sign * b.slope, fa = sign * a.f, fb = sign * b.f;
      if (!(down > 0.0 && up > 0.0) || length <= shortest_) return;
      // It bends away from where it is straight at both ends, up to where these meet.
      const double x = (fa - fb + up * length) / (down + up);
      if (fa - down * x > 0.0) return;
    }
    const double turn = a.slope - b.slope != 0.0 ? a.slope / (a.slope - b.slope) : 0.5;
    const RaySample middle = at(a.t + std::clamp(turn, 0.1, 0.9) * length);
    find(a, middle);
    find(middle, b);
  }

 private:
  double root_between(const RaySample& a, const RaySample& b) {
    double low = a.t, high = b.t;
    for (int k = 0; k < kHalvings; ++k) {
      const double middle = 0.5 * (low + high);
      ((evaluator_.value(ray_.at(middle)) < 0.0) == a.inside() ? low : high) = middle;
    }
    return 0.5 * (low + high);
  }

  FieldEvaluator& evaluator_;
  const Ray& ray_;
  double shortest_;
  std::vector<Change>& changes_;
};

/// Adds the changes along the ray, that at its start included.
void add_changes(FieldEvaluator& evaluator, const PlacedLevelSet& placed, const Ray& ray, std::vector<Change>& changes) {
  double t = 0.0, t_end = ray.end;
  if (!clip_ray(placed.box, ray.origin, ray.direction, t, t_end)) return;
  std::vector<RayStretch> stretches;
  placed.mask.find_stretches({placed.index_from_solver.point(ray.origin), placed.index_from_solver.linear * ray.direction}, t, t_end,
                             stretches);
  RootFinder roots(evaluator, ray, placed.voxel, changes);
  RaySample here = roots.at(t);
  if (here.inside()) changes.push_back({0.0, 1});
  for (const RayStretch& stretch : stretches) {
    // Between two of them nothing changes, but for what rounding leaves of a corner.
    const RaySample before = std::exchange(here, roots.at(stretch.begin));
    if (before.inside() != here.inside()) roots.find(before, here);
    while (here.t < stretch.end) {
      const RaySample next = roots.at(std::min(stretch.end, here.t + kStep * placed.voxel));
      roots.find(here, next);
      here = next;
    }
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

double voxel_of(const std::vector<SharedLevelSet>& level_sets, const std::vector<size_t>& body) {
  double voxel = 0.0;
  for (const size_t i : body) voxel = std::max(voxel, level_sets[i]->voxel);
  return voxel;
}

Ray ray_from(const CurveSample& sample, const Camera& camera, double voxel) {
  const double pixel = 1.0 / pixels_per_unit_at(camera, std::max(sample.depth, 1e-9));
  Ray ray;
  ray.origin = sample.p + std::max(kLift * voxel, sample.on_chord ? 0.05 * pixel : 0.0) * sample.lift;
  ray.direction = view_vector(camera, ray.origin);
  ray.end = camera.projection == Projection::perspective ? glm::distance(camera.eye, ray.origin) : project(camera, ray.origin).z;
  return ray;
}

}  // namespace

std::vector<FieldEvaluator>& LevelSetLayers::evaluators() const {
  auto& evaluators = evaluators_.local();
  if (evaluators.empty()) {
    for (const SharedLevelSet& placed : level_sets_) evaluators.emplace_back(placed->field);
  }
  return evaluators;
}

LayersSeen LevelSetLayers::before(const CurveSample& sample) const {
  auto& evaluators = this->evaluators();
  LayersSeen seen{0, std::numeric_limits<double>::infinity()};
  std::vector<Change> changes;
  for (const std::vector<size_t>& body : bodies_) {
    const Ray ray = ray_from(sample, camera_, voxel_of(level_sets_, body));
    changes.clear();
    for (const size_t i : body) add_changes(evaluators[i], *level_sets_[i], ray, changes);
    count(changes, seen);
  }
  return seen;
}

std::vector<glm::dvec3> LevelSetLayers::contours_before(const CurveSample& sample) const {
  auto& evaluators = this->evaluators();
  const Viewer viewer = make_viewer(camera_, glm::dvec3(0.0));
  std::vector<glm::dvec3> points;
  std::vector<Change> changes;
  for (const std::vector<size_t>& body : bodies_) {
    const Ray ray = ray_from(sample, camera_, voxel_of(level_sets_, body));
    for (const size_t i : body) {
      const double near = kGrazed * level_sets_[i]->voxel;
      changes.clear();
      add_changes(evaluators[i], *level_sets_[i], ray, changes);
      for (size_t k = 1; k < changes.size(); ++k) {
        if (!(changes[k - 1].t > 0.0 && changes[k].t - changes[k - 1].t < near)) continue;
        const auto found = polish(evaluators[i], viewer, 0.0, ray.at(0.5 * (changes[k - 1].t + changes[k].t)), near);
        if (found) points.push_back(found->p);
      }
    }
  }
  return points;
}

}  // namespace limn
