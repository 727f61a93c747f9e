#pragma once
// Whether a model keeps to a tolerance, asked without measuring any border: rays on both sides of the true one, a tolerance away from it,
// must see what is there, and what brute force finds of border in its picture must lie near a true one.

#include <cmath>

#include "raymarch/curves/curve_geometry.h"
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

/// What was asked along one kind of border.
struct Asked {
  int places = 0;  ///< All, a pixel apart.
  int asked = 0;   ///< Where at least one side could be asked.
  int wrong = 0;   ///< Where a side that was asked shows something else than the truth.
  double share() const { return asked > 0 ? static_cast<double>(wrong) / asked : 0.0; }
  double share_of_all() const { return places > 0 ? static_cast<double>(wrong) / places : 0.0; }
};

/// One side of a border: rays `offset_px` along its outward normals, a tolerance away. That all of a border lies within the tolerance says
/// something of a point only where every true border is a tolerance away from it: a second one nearer by may have moved over it and be
/// right all the same. Elsewhere, and where the reference contradicts the truth, a point is not asked.
struct Side {
  std::vector<glm::dvec2> points{};
  std::vector<bool> counts{};
  Side(const std::vector<BorderSample>& samples, const BorderCurves& truth, std::optional<CurveKind> kind, double offset_px) {
    const CurveIndex borders(truth, kind);
    const double clear_px = 0.99 * std::abs(offset_px);
    for (const BorderSample& sample : samples) {
      points.push_back(sample.px + offset_px * sample.outward);
      counts.push_back(!borders.nearest(points.back(), 0, clear_px));
    }
  }
};

/// `reference` is a model as good as the truth.
inline Asked ask(const SceneModel& model, const SceneModel& reference, const PlanView& view, CurveKind kind, double threshold,
                 double tolerance_px) {
  const bool inner = kind == CurveKind::inner;
  const std::vector<BorderSample> samples = within_picture(resample(view.truth.curves, kind, 1.0), view.camera, 1.0 + tolerance_px);
  const std::optional<CurveKind> near_by = inner ? std::nullopt : std::optional(kind);  // inner borders end no sheet
  const Side inside(samples, view.truth.curves, near_by, -tolerance_px), outside(samples, view.truth.curves, near_by, tolerance_px);
  const auto true_in = seen_at(reference, view.camera, inside.points), true_out = seen_at(reference, view.camera, outside.points);
  const auto model_in = seen_at(model, view.camera, inside.points), model_out = seen_at(model, view.camera, outside.points);
  const auto is_ink = [&](const PointSample& s) { return s.status == HitStatus::hit && double{s.n_dot_v} < threshold; };
  const auto depth = [&](const PointSample& s) { return depth_of(view.camera, s); };
  Asked found;
  for (size_t i = 0; i < samples.size(); ++i) {
    ++found.places;
    bool in = inside.counts[i], out = outside.counts[i], in_right = true, out_right = true;
    if (inner) {
      in = in && is_ink(true_in[i]), out = out && !is_ink(true_out[i]);
      in_right = is_ink(model_in[i]), out_right = !is_ink(model_out[i]);
    } else {
      const double near = depth(true_in[i]), far = depth(true_out[i]), middle = 0.5 * (near + far);
      in = in && far > near, out = out && far > near;
      in_right = depth(model_in[i]) < middle, out_right = !(depth(model_out[i]) < middle);
    }
    found.asked += in || out;
    found.wrong += (in && !in_right) || (out && !out_right);
  }
  return found;
}

/// Of the places of the true border that can be asked, silhouette and inner border together, the share that the model does not put within
/// `tolerance_px`. With `of_all` the share of all places, those that cannot be asked counting as right.
inline double share_beyond(const SceneModel& model, const SceneModel& reference, const PlanView& view, double threshold,
                           double tolerance_px, PlanMetric metric, bool of_all = false) {
  Asked all;
  for (const CurveKind kind : {CurveKind::silhouette, CurveKind::inner}) {
    if (kind == CurveKind::inner && metric == PlanMetric::silhouette) continue;
    const Asked found = ask(model, reference, view, kind, threshold, tolerance_px);
    all.places += found.places;
    all.asked += found.asked;
    all.wrong += found.wrong;
  }
  return of_all ? all.share_of_all() : all.share();
}

/// A pair of rays between which a picture has a border, as it is closed in.
struct BorderBetween {
  glm::dvec2 a_px{0.0}, b_px{0.0};
  PointSample a{}, b{};
};

/// Whether two rays see two sides of a border: of the object, of the ink or, as long as it does not close, of a step in depth by more than
/// a pixel.
struct BorderSides {
  const Camera& camera;
  double threshold;  ///< Of the ink; 0: the silhouette alone.

  int side(const PointSample& sample) const {
    if (sample.status != HitStatus::hit) return 0;
    return double{sample.n_dot_v} < threshold ? 1 : 2;
  }
  /// How far one hit lies from the other's tangent plane: little on a slope, however steep, and much across the end of a sheet.
  double step_px(const PointSample& a, const PointSample& b) const {
    const glm::dvec3 between = b.position - a.position;
    const double off = std::max(std::abs(glm::dot(glm::dvec3(a.normal), between)), std::abs(glm::dot(glm::dvec3(b.normal), between)));
    return off * pixels_per_unit_at(camera, std::min(depth_of(camera, a), depth_of(camera, b)));
  }
  bool differ(const PointSample& a, const PointSample& b) const { return side(a) != side(b); }
  bool border(const PointSample& a, const PointSample& b) const { return differ(a, b) || (side(a) != 0 && step_px(a, b) > 1.0); }
};

/// All pairs of neighbours in a grid of rays a pixel apart that may have a border between them.
inline std::vector<BorderBetween> neighbours_that_differ(const SceneModel& model, const BorderSides& sides) {
  const int width = sides.camera.width_px, height = sides.camera.height_px;
  std::vector<glm::dvec2> points;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) points.push_back({x + 0.5, y + 0.5});
  }
  const std::vector<PointSample> seen = seen_at(model, sides.camera, points);
  std::vector<BorderBetween> pairs;
  const auto look = [&](size_t i, size_t j) {
    if (sides.border(seen[i], seen[j])) pairs.push_back({points[i], points[j], seen[i], seen[j]});
  };
  for (int y = 0; y + 1 < height; ++y) {
    for (int x = 0; x + 1 < width; ++x) {
      const auto i = static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
      look(i, i + 1);
      look(i, i + static_cast<size_t>(width));
    }
  }
  return pairs;
}

/// Of the border that brute force finds in a model's picture, with rays a pixel apart and halving between them, the share that lies farther
/// than `tolerance_px` from every true one.
inline double share_of_false_border(const SceneModel& model, const PlanView& view, double threshold, double tolerance_px,
                                    PlanMetric metric) {
  constexpr int kHalvings = 7;
  const BorderSides sides{view.camera, metric == PlanMetric::silhouette ? 0.0 : threshold};
  std::vector<BorderBetween> pairs = neighbours_that_differ(model, sides);
  for (int halving = 0; halving < kHalvings; ++halving) {
    std::vector<glm::dvec2> middles;
    for (const BorderBetween& pair : pairs) middles.push_back(0.5 * (pair.a_px + pair.b_px));
    const std::vector<PointSample> seen = seen_at(model, view.camera, middles);
    for (size_t i = 0; i < pairs.size(); ++i) {
      BorderBetween& pair = pairs[i];
      const bool by_side = sides.differ(pair.a, pair.b);
      const bool left = by_side ? sides.differ(pair.a, seen[i]) : sides.step_px(pair.a, seen[i]) > sides.step_px(seen[i], pair.b);
      (left ? pair.b_px : pair.a_px) = middles[i];
      (left ? pair.b : pair.a) = seen[i];
    }
  }
  const CurveIndex borders(view.truth.curves, {});
  int all = 0, wrong = 0;
  for (const BorderBetween& pair : pairs) {
    if (!sides.border(pair.a, pair.b)) continue;  // a slope, and no step
    ++all;
    wrong += !borders.nearest(0.5 * (pair.a_px + pair.b_px), 0, tolerance_px + std::exp2(-kHalvings));
  }
  return all > 0 ? static_cast<double>(wrong) / all : 0.0;
}

}  // namespace limn::test
