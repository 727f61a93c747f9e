#include "raymarch/lines/nearer_crossings.h"

#include <algorithm>
#include <cmath>

#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr double kBucket_px = 4.0;
constexpr double kMargin_px = 1e-3;      // so that no rounding leaves a bucket out
constexpr double kBeyondFrame_px = 8.0;  // steps farther outside the picture are left out
constexpr double kBelowOne = 1.0 - 1e-15;
constexpr double kParallel = 1e-9;  // the sine of the angle between steps

struct Step {
  std::uint64_t bucket = 0;
  std::uint32_t curve = 0, index = 0;
};

struct Ends {
  const CurveSample &a, &b;
};
Ends ends_of(const SurfaceCurve& curve, size_t i) { return {curve.samples[i], curve.samples[(i + 1) % curve.samples.size()]}; }

size_t steps_of(const SurfaceCurve& curve) { return curve.closed ? curve.samples.size() : curve.samples.size() - 1; }

/// Calls `visit` for the buckets that a step goes through, row by row.
template <class Visit>
void for_buckets(const Ends& step, const Camera& camera, const Visit& visit) {
  if (!(step.a.depth > 0.0 && step.b.depth > 0.0)) return;
  const glm::dvec2 size(camera.width_px, camera.height_px);
  const glm::dvec2 low = glm::max(glm::min(step.a.px, step.b.px), glm::dvec2(-kBeyondFrame_px));
  const glm::dvec2 high = glm::min(glm::max(step.a.px, step.b.px), size + kBeyondFrame_px);
  if (!(low.x <= high.x && low.y <= high.y)) return;
  const auto bucket = [](double x) { return static_cast<std::uint64_t>((x + kBeyondFrame_px) / kBucket_px); };
  const std::uint64_t first = bucket(low.y), last = bucket(high.y);
  const glm::dvec2 d = step.b.px - step.a.px;
  for (std::uint64_t y = first; y <= last; ++y) {
    double left = low.x, right = high.x;
    if (last > first) {
      // What of the step lies in the row, and a little more.
      const double top = static_cast<double>(y) * kBucket_px - kBeyondFrame_px - kMargin_px, bottom = top + kBucket_px + 2.0 * kMargin_px;
      const double at_top = step.a.px.x + d.x * std::clamp((top - step.a.px.y) / d.y, 0.0, 1.0),
                   at_bottom = step.a.px.x + d.x * std::clamp((bottom - step.a.px.y) / d.y, 0.0, 1.0);
      left = std::max(left, std::min(at_top, at_bottom) - kMargin_px);
      right = std::min(right, std::max(at_top, at_bottom) + kMargin_px);
      if (!(left <= right)) continue;
    }
    for (std::uint64_t x = bucket(left); x <= bucket(right); ++x) visit(y << 32 | x);
  }
}

double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

struct Meeting {
  double t = 0.0, u = 0.0;
  bool onto_left = false;  ///< The step goes over to the left of the nearer one.
};

/// The share of a straight step in space that is seen at a share of its image.
double share_in_space(const Ends& step, double t, const Camera& camera) {
  if (camera.projection != Projection::perspective) return t;
  return t * step.a.depth / (step.b.depth + t * (step.a.depth - step.b.depth));
}

/// Where `nearer` crosses `step` in the image, in front of it by more than `nearer_px`.
std::optional<Meeting> meet(const Ends& step, const Ends& nearer, double nearer_px, const Camera& camera) {
  const glm::dvec2 d = step.b.px - step.a.px, e = nearer.b.px - nearer.a.px, between = nearer.a.px - step.a.px;
  const double determinant = cross(d, e);
  // Steps of one straight line meet nowhere, whatever rounding says.
  if (std::fabs(determinant) <= kParallel * glm::length(d) * glm::length(e)) return {};
  // Half-open, so that a polyline that goes through another's vertex crosses it once.
  const double in_image = cross(between, e) / determinant, in_nearer = cross(between, d) / determinant;
  if (!(in_image >= 0.0 && in_image < 1.0 && in_nearer >= 0.0 && in_nearer < 1.0)) return {};
  const double t = std::min(share_in_space(step, in_image, camera), kBelowOne),
               u = std::min(share_in_space(nearer, in_nearer, camera), kBelowOne);
  const double depth = glm::mix(step.a.depth, step.b.depth, t), front = glm::mix(nearer.a.depth, nearer.b.depth, u);
  if (!(front < depth - nearer_px / pixels_per_unit_at(camera, depth))) return {};
  return Meeting{t, u, cross(d, e) > 0.0};
}

bool neighbours(size_t i, size_t j, size_t count) {
  const size_t apart = i > j ? i - j : j - i;
  return apart <= 1 || apart + 1 == count;
}

}  // namespace

std::vector<std::vector<NearerCrossing>> nearer_crossings(const std::vector<SurfaceCurve>& curves, const Camera& camera) {
  std::vector<Step> folds;
  for (size_t c = 0; c < curves.size(); ++c) {
    for (size_t i = 0; i < steps_of(curves[c]); ++i) {
      if (curves[c].samples[i].more_on_left == 0) continue;
      for_buckets(ends_of(curves[c], i), camera, [&](std::uint64_t bucket) {
        folds.push_back({bucket, static_cast<std::uint32_t>(c), static_cast<std::uint32_t>(i)});
      });
    }
  }
  std::stable_sort(folds.begin(), folds.end(), [](const Step& a, const Step& b) { return a.bucket < b.bucket; });
  std::vector<std::vector<NearerCrossing>> result(curves.size());
  parallel_for(size_t{0}, curves.size(), [&](size_t c) {
    const size_t count = steps_of(curves[c]);
    for (size_t i = 0; i < count; ++i) {
      const Ends step = ends_of(curves[c], i);
      std::vector<NearerCrossing> here;
      for_buckets(step, camera, [&](std::uint64_t bucket) {
        auto other = std::lower_bound(folds.begin(), folds.end(), bucket, [](const Step& s, std::uint64_t b) { return s.bucket < b; });
        for (; other != folds.end() && other->bucket == bucket; ++other) {
          if (other->curve == c && neighbours(other->index, i, count)) continue;
          const std::optional<Meeting> meeting = meet(step, ends_of(curves[other->curve], other->index),
                                                      std::max(curves[c].nearer_px, curves[other->curve].nearer_px), camera);
          if (!meeting) continue;
          const int more_on_left = curves[other->curve].samples[other->index].more_on_left;
          here.push_back({static_cast<double>(i) + meeting->t, meeting->onto_left ? more_on_left : -more_on_left, other->curve,
                          static_cast<double>(other->index) + meeting->u});
        }
      });
      // A step that lies in several buckets meets another in each of them.
      std::sort(here.begin(), here.end(), [](const NearerCrossing& a, const NearerCrossing& b) {
        return std::tie(a.at, a.curve, a.on_nearer) < std::tie(b.at, b.curve, b.on_nearer);
      });
      here.erase(std::unique(here.begin(), here.end(),
                             [](const NearerCrossing& a, const NearerCrossing& b) {
                               return a.at == b.at && a.curve == b.curve && a.on_nearer == b.on_nearer;
                             }),
                 here.end());
      result[c].insert(result[c].end(), here.begin(), here.end());
    }
  });
  return result;
}

}  // namespace limn
