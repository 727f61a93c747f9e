// Truth of the built-in formulas, from many sides: rays beside it see ink on its left and none on its right.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include "raymarch/curves/curve_geometry.h"
#include "raymarch/gbuffer.h"
#include "raymarch/truth.h"
#include "samples/scenes/scenes.h"

namespace limn::test {
namespace {

constexpr int kViews = 8;
constexpr double kThreshold = 0.4, kSpacing_px = 0.5;
/// Rays stand so far beside the border. They say nothing in bands that are not much wider, as in the tips of wedges and where a side that
/// is seen edge-on shows its ink.
constexpr double kBeside_px = 0.04, kClear_px = 3.0 * kBeside_px;

/// The longest stretch of inner border, px, along which rays contradict its sides, and where.
struct Stretch {
  double length_px = 0.0;
  glm::dvec2 px{0.0};
};

Stretch longest_contradicted(const BorderCurves& truth, const SceneModel& model, const Camera& camera) {
  const std::vector<BorderSample> samples = within_picture(resample(truth, CurveKind::inner, kSpacing_px), camera);
  std::vector<glm::dvec2> points;
  for (const BorderSample& sample : samples) {
    points.push_back(sample.px - kBeside_px * sample.outward);
    points.push_back(sample.px + kBeside_px * sample.outward);
  }
  std::vector<PointSample> seen(points.size());
  sample_points(model, camera, points, seen);
  const auto is_ink = [&](size_t k) { return seen[k].status == HitStatus::hit && double{seen[k].n_dot_v} < kThreshold; };
  const CurveIndex silhouettes(truth, CurveKind::silhouette), inner(truth, CurveKind::inner);
  Stretch longest, current;
  for (size_t i = 0; i < samples.size(); ++i) {
    const BorderSample& at = samples[i];
    const bool asked = !silhouettes.nearest(at.px, 0, kClear_px) && !inner.nearest(at.px, 0, kClear_px, -at.outward);
    const bool right = !asked || (is_ink(2 * i) && !is_ink(2 * i + 1));
    const bool goes_on = i > 0 && samples[i].curve == samples[i - 1].curve && current.length_px > 0.0;
    current = right ? Stretch{} : Stretch{(goes_on ? current.length_px : 0.0) + samples[i].weight_px, samples[i].px};
    if (current.length_px > longest.length_px) longest = current;
  }
  return longest;
}

TEST(TruthOfScenes, HasItsInkOnTheLeft) {
  for (const char* name : {"ellipsoid", "tilted_torus", "superellipsoid", "machined_part", "gyroid"}) {
    const Scene scene = find_scene(name)->make();
    SurfaceSettings analytic;
    analytic.kind = "analytic";
    const SceneModel model = build_model(scene, analytic);
    for (int view = 0; view < kViews; ++view) {
      CameraSettings settings;
      settings.width_px = 320;
      settings.height_px = 200;
      settings.direction = view_direction(view, kViews);
      const Camera camera = resolve_camera(settings, bounds(scene));
      TruthSettings truth;
      truth.threshold = kThreshold;
      const Stretch wrong = longest_contradicted(solve_truth(scene, camera, truth, {}).curves, model, camera);
      EXPECT_LT(wrong.length_px, 1.5) << fmt::format("{}, view {} from ({:.4f}, {:.4f}, {:.4f}): up to ({:.2f}, {:.2f})", name, view,
                                                     settings.direction->x, settings.direction->y, settings.direction->z, wrong.px.x,
                                                     wrong.px.y);
    }
  }
}

}  // namespace
}  // namespace limn::test
