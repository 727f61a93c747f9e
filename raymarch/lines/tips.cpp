#include "raymarch/lines/tips.h"

#include <algorithm>
#include <cmath>

#include "raymarch/truth/branches.h"
#include "sdf/field_program.h"

namespace limn {
namespace {

constexpr double kReach_px = 32.0;   // what is seen nearly along its length is followed in long steps
constexpr double kBeside_px = 8.0;   // two cells, on whose diagonal a tip may be missed
constexpr double kAlong = 0.01;      // the sine of an angle
constexpr double kOnSurface = 1e-9;  // of the extent

/// The samples beside the tip are replaced by it: they are known to a cell only.
void lead_to(const glm::dvec3& tip, const Camera& camera, SurfaceCurve& curve) {
  auto& samples = curve.samples;
  const double pixel = 1.0 / pixels_per_unit_at(camera, std::max(project(camera, tip).z, 1e-9));
  // On the cone itself the way to the tip runs along the surface; what runs beside the tip on other surfaces is left alone.
  const auto is_near = [&](const CurveSample& sample) {
    const double distance = glm::distance(sample.p, tip);
    if (distance > kReach_px * pixel) return false;
    return distance < kBeside_px * pixel || std::fabs(glm::dot(sample.high, tip - sample.p)) < kAlong * distance;
  };
  const auto first = std::find_if(samples.begin(), samples.end(), is_near);
  if (first == samples.end()) return;
  auto last = first;
  while (last != samples.end() && is_near(*last)) ++last;
  if (first == samples.begin() && last == samples.end()) {
    samples.clear();  // Rounding around the tip.
    return;
  }
  CurveSample sample = *first;
  sample.p = tip;
  project_sample(camera, sample);
  const auto at = samples.erase(first, last);
  samples.insert(at, sample);
}

}  // namespace

std::vector<glm::dvec3> tips_of(const Field& field, double extent) {
  std::vector<glm::dvec3> tips;
  FieldEvaluator evaluator(field);
  for (const Field& branch : split_branches(field, extent, true).branches) {
    for (const FieldLeaf& leaf : branch.program().leaves) {
      if (leaf.functions->tip == nullptr) continue;
      const glm::dvec3 tip = inverse(leaf.object_from_world).point(leaf.functions->tip(leaf.shape.get()));
      if (std::isfinite(tip.x) && std::isfinite(tip.y) && std::isfinite(tip.z) && std::fabs(evaluator.value(tip)) < kOnSurface * extent)
        tips.push_back(tip);
    }
  }
  return tips;
}

void lead_to_tips(const std::vector<glm::dvec3>& tips, const Camera& camera, std::vector<SurfaceCurve>& curves) {
  for (const glm::dvec3& tip : tips) {
    for (SurfaceCurve& curve : curves) {
      if (curve.smooth && !curve.samples.empty()) lead_to(tip, camera, curve);
    }
    curves.erase(std::remove_if(curves.begin(), curves.end(), [](const SurfaceCurve& curve) { return curve.samples.empty(); }),
                 curves.end());
  }
}

}  // namespace limn
