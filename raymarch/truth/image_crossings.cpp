#include "raymarch/truth/image_crossings.h"

#include <algorithm>
#include <cmath>

#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr double kBucketPx = 4.0;
constexpr double kBeyondFramePx = 8.0;  // steps farther outside the picture are left out
// What is nearer by less (px, at its depth) is the same place, as where a level curve and a contour follow one crease.
constexpr double kNearerPx = 0.05;

struct Step {
  std::uint64_t bucket = 0;
  std::uint32_t curve = 0, index = 0;
};

struct Ends {
  const TracedPoint &a, &b;
};
Ends ends_of(const TracedCurve& curve, size_t i) { return {curve.points[i], curve.points[(i + 1) % curve.points.size()]}; }

size_t steps_of(const TracedCurve& curve) { return curve.closed ? curve.points.size() : curve.points.size() - 1; }

template <class Visit>
void for_buckets(const Ends& step, const Camera& camera, const Visit& visit) {
  if (!(step.a.depth > 0.0 && step.b.depth > 0.0)) return;
  const glm::dvec2 size(camera.width_px, camera.height_px);
  const glm::dvec2 low = glm::max(glm::min(step.a.px, step.b.px), glm::dvec2(-kBeyondFramePx));
  const glm::dvec2 high = glm::min(glm::max(step.a.px, step.b.px), size + kBeyondFramePx);
  if (!(low.x <= high.x && low.y <= high.y)) return;
  const auto bucket = [](double x) { return static_cast<std::uint64_t>((x + kBeyondFramePx) / kBucketPx); };
  for (std::uint64_t y = bucket(low.y); y <= bucket(high.y); ++y) {
    for (std::uint64_t x = bucket(low.x); x <= bucket(high.x); ++x) visit(y << 32 | x);
  }
}

double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

/// The share of `step` at which `silhouette` crosses it, nearer to the eye; negative where it does not.
double crossing(const Ends& step, const Ends& silhouette, const Camera& camera) {
  const glm::dvec2 d = step.b.px - step.a.px, e = silhouette.b.px - silhouette.a.px, between = silhouette.a.px - step.a.px;
  const double determinant = cross(d, e);
  if (determinant == 0.0) return -1.0;
  const double t = cross(between, e) / determinant, u = cross(between, d) / determinant;
  if (!(t >= 0.0 && t <= 1.0 && u >= 0.0 && u <= 1.0)) return -1.0;
  const double depth = glm::mix(step.a.depth, step.b.depth, t), nearer = glm::mix(silhouette.a.depth, silhouette.b.depth, u);
  return nearer < depth - kNearerPx / pixels_per_unit_at(camera, depth) ? t : -1.0;
}

bool neighbours(size_t i, size_t j, size_t count) {
  const size_t apart = i > j ? i - j : j - i;
  return apart <= 1 || apart + 1 == count;
}

}  // namespace

std::vector<CurveCrossings> image_crossings(const std::vector<TracedCurve>& curves, const Camera& camera) {
  std::vector<Step> silhouettes;
  for (size_t c = 0; c < curves.size(); ++c) {
    if (curves[c].kind != CurveKind::silhouette) continue;
    for (size_t i = 0; i < steps_of(curves[c]); ++i) {
      for_buckets(ends_of(curves[c], i), camera, [&](std::uint64_t bucket) {
        silhouettes.push_back({bucket, static_cast<std::uint32_t>(c), static_cast<std::uint32_t>(i)});
      });
    }
  }
  std::stable_sort(silhouettes.begin(), silhouettes.end(), [](const Step& a, const Step& b) { return a.bucket < b.bucket; });
  std::vector<CurveCrossings> result(curves.size());
  parallel_for(size_t{0}, curves.size(), [&](size_t c) {
    const size_t count = steps_of(curves[c]);
    result[c].resize(count);
    for (size_t i = 0; i < count; ++i) {
      const Ends step = ends_of(curves[c], i);
      for_buckets(step, camera, [&](std::uint64_t bucket) {
        auto other =
            std::lower_bound(silhouettes.begin(), silhouettes.end(), bucket, [](const Step& s, std::uint64_t b) { return s.bucket < b; });
        for (; other != silhouettes.end() && other->bucket == bucket; ++other) {
          if (other->curve == c && neighbours(other->index, i, count)) continue;
          const double t = crossing(step, ends_of(curves[other->curve], other->index), camera);
          if (t >= 0.0) result[c][i].push_back({t, other->curve});
        }
      });
    }
  });
  return result;
}

}  // namespace limn
