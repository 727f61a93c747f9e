// Truth of scenes made of fields and cages: each kind traced in its way, then hidden, thinned and filled together.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "raymarch/mesh/open_sheet.h"
#include "raymarch/truth/proxy.h"
#include "raymarch/truth/shares.h"
#include "sdf/error.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

// Where kinds meet no one can say between tests how deep a point is inside the other: there visibility is tested this often, px.
constexpr double kMixedSpacing_px = 2.0;

ShareSettings solver_space(const Scene& scene, const Camera& camera, const TruthSettings& settings) {
  ShareSettings share;
  const Box box = bounds(scene);
  if (box.finite()) share.origin = box.center();
  share.camera = moved(camera, share.origin);
  share.extent = box.finite() && box.radius() > 0.0 ? box.radius() : std::max(1e-6, glm::length(share.camera.eye));
  share.truth = settings;
  return share;
}

/// Calls of one scene, each sent to the share whose curve it is about. Outlived by `shares`.
CurveScene joined(const std::vector<TruthShare>& shares, const Camera& camera, size_t objects) {
  std::vector<const TruthShare*> share_of(objects, nullptr);
  for (const TruthShare& share : shares) {
    for (const size_t i : share.objects) share_of[i] = &share;
  }
  CurveScene scene{camera};
  for (const TruthShare& share : shares) scene.lift_px = std::max(scene.lift_px, share.lift_px);
  scene.blocked = [&shares](const TracedPoint& point, int object) {
    return std::any_of(shares.begin(), shares.end(), [&](const TruthShare& share) { return share.blocked(point, object); });
  };
  scene.between = [share_of, camera](const TracedCurve& curve, size_t i, double t) {
    const TruthShare& share = *share_of[static_cast<size_t>(curve.object - 1)];
    return share.between ? share.between(curve, i, t) : chord_point(curve, i, t, camera);
  };
  const bool any = std::any_of(shares.begin(), shares.end(), [](const TruthShare& share) { return bool{share.others}; });
  if (objects > 1 && any) {
    scene.others = [&shares](const glm::dvec3& p, int object) {
      double least = std::numeric_limits<double>::infinity();
      for (const TruthShare& share : shares) {
        if (share.others) least = std::min(least, share.others(p, object));
      }
      return least;
    };
  }
  return scene;
}

SeenInk make_seen(const std::shared_ptr<const TruthProxy>& proxy, const Camera& camera, double threshold) {
  return [proxy, camera, threshold](std::span<const glm::dvec2> points, std::span<std::uint8_t> ink) {
    std::vector<PointSample> samples(points.size());
    sample_points(proxy->model, camera, points, samples);
    for (size_t i = 0; i < samples.size(); ++i) {
      ink[i] = samples[i].status == HitStatus::hit && static_cast<double>(samples[i].n_dot_v) < threshold;
    }
  };
}

/// Shares of different kinds go through each other: some point of the one's curves is inside the other's field.
bool interpenetrate(const std::vector<TruthShare>& shares, double extent) {
  constexpr double kDeep = 1e-4;
  for (const TruthShare& share : shares) {
    for (const TruthShare& other : shares) {
      if (&share == &other || !other.others) continue;
      for (const TracedCurve& curve : share.curves) {
        for (const TracedPoint& point : curve.points) {
          if (other.others(point.p, curve.object) < -kDeep * extent) return true;
        }
      }
    }
  }
  return false;
}

/// With the trees that rays need, which the first of them would have to wait for.
std::shared_ptr<const TruthProxy> ready_proxy(const Scene& scene, const std::vector<size_t>& cages, const Camera& camera,
                                              const ShareSettings& sharing) {
  auto proxy = proxy_for(scene, camera, sharing.truth, 1.5);
  prepare_points(proxy->model);
  parallel_each(cages.size(), [&](size_t k) {
    const Surface& shown = proxy->model.surfaces[cages[k]];
    if (shown.open_sheet) static_cast<void>(shown.open_sheet->shows_back(shown, sharing.camera));
  });
  return proxy;
}

std::string words_of(const std::vector<size_t>& fields, const std::vector<size_t>& cages) {
  std::string words = fields.empty() ? "" : fields.size() == 1 ? "the field" : "the fields";
  if (!cages.empty())
    words +=
        std::string(fields.empty() ? "" : " and ") + (cages.size() == 1 || fields.empty() ? "the limit surface" : "the limit surfaces");
  return words;
}

}  // namespace

BorderTruth solve_truth_traced(const Scene& scene, const Camera& camera, const TruthSettings& settings, const ExecutionSettings& how) {
  std::vector<size_t> fields, cages;
  for (size_t i = 0; i < scene.objects.size(); ++i) (std::holds_alternative<Field>(scene.objects[i].source) ? fields : cages).push_back(i);
  const ShareSettings sharing = solver_space(scene, camera, settings);
  std::shared_ptr<const TruthProxy> proxy;
  SampledCages sampled;
  // Much of either is done by one thread, and the one knows nothing of the other.
  parallel_invoke([&] { proxy = ready_proxy(scene, cages, camera, sharing); }, [&] { sampled = cages_ahead(scene, cages, sharing); });
  std::vector<TruthShare> shares;
  if (!fields.empty()) shares.push_back(trace_fields(scene, fields, sharing, how));
  if (!cages.empty()) shares.push_back(trace_cages(scene, cages, sharing, proxy, std::move(sampled), how));
  if (shares.size() > 1 && interpenetrate(shares, sharing.extent)) return solve_truth_by_proxy(scene, camera, settings, how);

  BorderTruth truth;
  truth.from = words_of(fields, cages);
  std::vector<TracedCurve> curves;
  double unrefined_px = 0.0;
  for (const TruthShare& share : shares) {
    curves.insert(curves.end(), share.curves.begin(), share.curves.end());
    truth.contour_generators += share.contour_generators;
    truth.level_curves += share.level_curves;
    truth.notes.insert(truth.notes.end(), share.notes.begin(), share.notes.end());
    truth.exact = truth.exact && share.exact;
    unrefined_px = std::max(unrefined_px, share.unrefined_px);
  }
  VisibilitySettings visibility;
  if (shares.size() > 1) visibility.spacing_px = kMixedSpacing_px;
  const auto parts = visible_parts(curves, joined(shares, sharing.camera, scene.objects.size()), visibility, how);
  if (how.progress) how.progress(0.8);
  truth.curves = border_of(parts, 0.5 * settings.tolerance_px, sharing.origin);
  const Coverage coverage = coverage_of(truth.curves, camera.width_px, camera.height_px, make_seen(proxy, camera, settings.threshold), how);
  truth.coverage = coverage.share;
  // A mesh that stands in for a limit surface differs from it by parts of a pixel, which says nothing of the curves.
  if (coverage.disputed > 0 && cages.empty()) {
    truth.notes.push_back(fmt::format("{} pairs of neighbouring pixels differ in ink where no curve was found", coverage.disputed));
  }
  truth.bound_px = settings.tolerance_px + visibility.split_px + unrefined_px;
  if (how.progress) how.progress(1.0);
  return truth;
}

}  // namespace limn
