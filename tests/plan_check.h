#pragma once
// Whether a model keeps to a tolerance, asked without measuring any border: rays on both sides of the true one, a tolerance away from it,
// must see what is there.

#include <cmath>

#include "raymarch/curve_geometry.h"
#include "raymarch/gbuffer.h"
#include "samples/plan/plan.h"

namespace limn::test {

inline std::vector<PointSample> seen_at(const SceneModel& model, const Camera& camera, const std::vector<glm::dvec2>& points) {
  std::vector<PointSample> samples(points.size());
  sample_points(model, camera, points, samples);
  return samples;
}

inline double depth_of(const Camera& camera, const PointSample& sample) {
  return sample.status == HitStatus::hit ? project(camera, sample.position).z : 1e9;
}

/// Of the true border, the share that the model does not put within `tolerance_px`; the larger of silhouette's and inner border's.
/// `reference` is a model as good as the truth. Places where even the reference shows no border between the two rays (bands narrower than
/// the tolerance) cannot be told apart and count as right.
inline double share_beyond(const SceneModel& model, const SceneModel& reference, const PlanView& view, double threshold,
                           double tolerance_px, PlanMetric metric) {
  const auto is_ink = [&](const PointSample& s) { return s.status == HitStatus::hit && double{s.n_dot_v} < threshold; };
  double worst = 0.0;
  for (const CurveKind kind : {CurveKind::silhouette, CurveKind::inner}) {
    if (kind == CurveKind::inner && metric == PlanMetric::silhouette) continue;
    std::vector<glm::dvec2> inside, outside;
    for (const CurveSample& sample : within_picture(resample(view.truth.curves, kind, 1.0), view.camera, 1.0 + tolerance_px)) {
      inside.push_back(sample.px - tolerance_px * sample.outward);
      outside.push_back(sample.px + tolerance_px * sample.outward);
    }
    const auto true_in = seen_at(reference, view.camera, inside), true_out = seen_at(reference, view.camera, outside);
    const auto model_in = seen_at(model, view.camera, inside), model_out = seen_at(model, view.camera, outside);
    double asked = 0.0, wrong = 0.0;
    for (size_t i = 0; i < inside.size(); ++i) {
      bool ok = true;
      asked += 1.0;
      if (kind == CurveKind::inner) {
        if (!is_ink(true_in[i]) || is_ink(true_out[i])) continue;
        ok = is_ink(model_in[i]) && !is_ink(model_out[i]);
      } else {
        const double in = depth_of(view.camera, true_in[i]), out = depth_of(view.camera, true_out[i]);
        if (!(out > in)) continue;
        const auto is_near = [&](const PointSample& s) { return depth_of(view.camera, s) < 0.5 * (in + out); };
        ok = is_near(model_in[i]) && !is_near(model_out[i]);
      }
      wrong += ok ? 0.0 : 1.0;
    }
    if (asked > 0.0) worst = std::max(worst, wrong / asked);
  }
  return worst;
}

}  // namespace limn::test
