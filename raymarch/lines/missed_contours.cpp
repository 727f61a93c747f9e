#include "raymarch/lines/missed_contours.h"

#include <algorithm>

#include "raymarch/lines/curve_walk.h"
#include "sdf/parallel.h"
#include "sdf/segment.h"

namespace limn {
namespace {

constexpr double kOnStep = 0.15;  // of a step's length: so far may the curve leave it

bool passes(const SurfaceCurve& curve, const glm::dvec3& p) {
  for (size_t i = 0; i < steps_of(curve); ++i) {
    const glm::dvec3 &a = curve.samples[i].p, &b = curve.samples[(i + 1) % curve.samples.size()].p;
    if (distance_to_segment(p, a, b) < kOnStep * glm::distance(a, b)) return true;
  }
  return false;
}

}  // namespace

std::vector<glm::dvec3> missed_contours(const std::vector<CurveSample>& grazing, const std::vector<LineContribution>& contributions,
                                        const std::vector<SurfaceCurve>& curves) {
  std::vector<std::vector<glm::dvec3>> found(grazing.size());
  parallel_for(size_t{0}, grazing.size(), [&](size_t i) {
    for (const LineContribution& one : contributions) {
      if (!one.contours_before) continue;
      for (const glm::dvec3& p : one.contours_before(grazing[i])) {
        if (std::none_of(curves.begin(), curves.end(), [&](const SurfaceCurve& curve) { return passes(curve, p); })) found[i].push_back(p);
      }
    }
  });
  std::vector<glm::dvec3> all;
  for (const auto& of_one : found) all.insert(all.end(), of_one.begin(), of_one.end());
  return all;
}

}  // namespace limn
