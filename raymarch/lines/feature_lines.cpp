// Suggestive contours, ridges and valleys: zeros of functions of curvature, cut to what is drawn of them.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "raymarch/lines/feature_marching.h"
#include "raymarch/truth/proxy.h"
#include "sdf/parallel.h"
#include "sdf/segment.h"

namespace limn {
namespace {

constexpr int kRefinements = 7;
constexpr int kCuts = 24;
constexpr double kLeastTurn = 0.3;    // of a ridge: its curvature integrated along it (Ohtake et al. 2004), radians
constexpr double kLeastSteps = 2.0;   // of a line: shorter ones are noise
constexpr double kLeastSwings = 4.0;  // the same of a level set's, whose spline swings beside edges that its voxels cannot show
constexpr double kCut_px = 1e-4;      // how precisely a line's end is found

struct Tracer {
  const LineTask& task;
  const FeatureSurface& surface;
  const FeatureFunction& function;

  glm::dvec2 px(const FeatureStation& station) const { return glm::dvec2(project(task.camera, station.point.p)); }

  /// Points between the ends of a step, so that chords keep to the tolerance. Returns how far the curve may be from a chord that could not
  /// be halved, px.
  double refine(const FeatureStep& step, int depth, std::vector<FeatureStation>& out) const {
    const std::optional<FeatureStation> middle = middle_of(surface, function, step);
    const glm::dvec2 a = px(step.from), b = px(step.to);
    // A curve that cannot be found stays within its triangle.
    if (!middle) return 0.5 * glm::distance(a, b);
    const double off = distance_to_segment(px(*middle), a, b);
    if (off < 0.5 * task.settings.tolerance_px || depth == 0) {
      if (off > 0.05 * task.settings.tolerance_px) out.push_back(*middle);
      return off < 0.5 * task.settings.tolerance_px ? 0.0 : off;
    }
    FeatureStep first{step.from, *middle}, second{*middle, step.to};
    first.from.place.triangle = second.to.place.triangle = step.from.place.triangle;
    double worst = refine(first, depth - 1, out);
    out.push_back(*middle);
    return std::max(worst, refine(second, depth - 1, out));
  }

  /// The last point of the line that is kept, on the way from one that is to one that is not.
  FeatureStation end_between(FeatureStep step) const {
    for (int i = 0; i < kCuts && glm::distance(px(step.from), px(step.to)) > kCut_px; ++i) {
      const std::optional<FeatureStation> middle = middle_of(surface, function, step);
      if (!middle) break;
      (function.kept(middle->point) >= 0.0 ? step.from : step.to) = *middle;
    }
    return step.from;
  }

  /// Where the line passes from the front to the back of its surface, on the way between two of its points.
  FeatureStation turn_between(FeatureStep step) const {
    const bool front = faces_eye(step.from);
    for (int i = 0; i < kCuts && glm::distance(px(step.from), px(step.to)) > kCut_px; ++i) {
      const std::optional<FeatureStation> middle = middle_of(surface, function, step);
      if (!middle) break;
      (faces_eye(*middle) == front ? step.from : step.to) = *middle;
    }
    return step.to;
  }
  bool faces_eye(const FeatureStation& station) const {
    return glm::dot(station.point.normal, view_vector(task.camera, station.point.p)) > 0.0;
  }

  /// Strong somewhere, and not a crumb.
  bool is_drawn(const std::vector<FeatureStep>& run) const {
    const auto strong = [&](const FeatureStep& step) { return function.strong(step.from.point) || function.strong(step.to.point); };
    if (std::none_of(run.begin(), run.end(), strong)) return false;
    double turn = 0.0, length = 0.0;
    for (const FeatureStep& step : run) {
      const double apart = glm::distance(step.from.point.p, step.to.point.p);
      turn += function.curvature_across(step.from.point).value_or(0.0) * apart;
      length += apart;
    }
    const bool turns_enough = function.line_class() == LineClass::suggestive || turn > kLeastTurn;
    return turns_enough && length > (surface.swings ? kLeastSwings : kLeastSteps) * surface.step;
  }

  CurveSample sample_of(const FeatureStation& station) const {
    CurveSample sample;
    const glm::dvec3 view = view_vector(task.camera, station.point.p);
    sample.p = station.point.p;
    sample.high = sample.low = station.point.normal;
    sample.radial_curvature = radial_curvature_of(station.point, view);
    sample.lift = view;
    sample.line_class = function.line_class();
    sample.object = surface.object(station.point);
    project_sample(task.camera, sample);
    return sample;
  }

  bool facet_faces_eye(const FeatureStep& step) const {
    const auto& nodes = surface.triangles[step.from.place.triangle];
    const glm::dvec3 &a = surface.nodes[nodes[0]].p, &b = surface.nodes[nodes[1]].p, &c = surface.nodes[nodes[2]].p;
    return glm::dot(glm::cross(b - a, c - a), view_vector(task.camera, a)) > 0.0;
  }

  /// Past its own contour a line has a layer more in front: the curve gets a joint there.
  SurfaceCurve curve_of(const std::vector<FeatureStep>& run, bool closed) const {
    SurfaceCurve curve{closed, false, {}};
    for (size_t i = 0; i < run.size(); ++i) {
      const FeatureStep& step = run[i];
      curve.samples.push_back(sample_of(step.from));
      if (!surface.faces.empty()) {
        curve.samples.back().faces.fill(surface.faces[step.from.place.triangle]);
        // On an edge between a facet that faces the eye and one that does not.
        const bool first = i == 0 && !closed;
        curve.samples.back().joint = !first && facet_faces_eye(run[i > 0 ? i - 1 : run.size() - 1]) != facet_faces_eye(step);
        continue;
      }
      if (faces_eye(step.from) == faces_eye(step.to)) continue;
      curve.samples.push_back(sample_of(turn_between(step)));
      curve.samples.back().joint = true;
    }
    if (!closed) curve.samples.push_back(sample_of(run.back().to));
    return curve;
  }
};

/// A chain in steps as short as the tolerance wants.
struct FineChain {
  std::vector<FeatureStep> steps{};
  std::vector<double> off_px{};  ///< Of each step: how far the curve may be from it.
  std::vector<char> kept{};      ///< Of each step's beginning, and of the last one's end.
};

FineChain fine_chain(const Tracer& tracer, const FeatureChain& chain) {
  FineChain fine;
  const auto is_kept = [&](const FeatureStation& station) -> char { return tracer.function.kept(station.point) >= 0.0; };
  for (const FeatureStep& step : chain.steps) {
    std::vector<FeatureStation> stations{step.from};
    // What begins and ends within a triangle is left out.
    const bool any = is_kept(step.from) || is_kept(step.to);
    const double off_px = any ? tracer.refine(step, kRefinements, stations) : 0.0;
    stations.push_back(step.to);
    for (size_t i = 0; i + 1 < stations.size(); ++i) {
      fine.steps.push_back({stations[i], stations[i + 1]});
      fine.off_px.push_back(off_px);
      fine.kept.push_back(any && is_kept(stations[i]));
    }
  }
  fine.kept.push_back(chain.closed ? fine.kept.front() : is_kept(fine.steps.back().to));
  return fine;
}

/// The stretches of a chain that are kept, and strong somewhere.
std::vector<SurfaceCurve> kept_curves(const Tracer& tracer, const FeatureChain& chain, double& worst_px) {
  const FineChain fine = fine_chain(tracer, chain);
  const size_t n = fine.steps.size();
  std::vector<SurfaceCurve> curves;
  std::vector<FeatureStep> run;
  double run_worst_px = 0.0;
  const auto finish = [&](bool closed) {
    if (!run.empty() && tracer.is_drawn(run)) {
      curves.push_back(tracer.curve_of(run, closed));
      worst_px = std::max(worst_px, run_worst_px);
    }
    run.clear();
    run_worst_px = 0.0;
  };
  // A closed chain is walked from a point that is not kept.
  const auto not_kept = std::find(fine.kept.begin(), fine.kept.end(), 0);
  const size_t first = chain.closed && not_kept != fine.kept.end() ? static_cast<size_t>(not_kept - fine.kept.begin()) : 0;
  for (size_t k = 0; k < n; ++k) {
    const size_t i = (first + k) % n;
    FeatureStep step = fine.steps[i];
    if (!fine.kept[i] && !fine.kept[i + 1]) continue;
    run_worst_px = std::max(run_worst_px, fine.off_px[i]);
    if (!fine.kept[i]) step.from = tracer.end_between({step.to, step.from});
    if (!fine.kept[i + 1]) step.to = tracer.end_between(step);
    run.push_back(step);
    if (!fine.kept[i + 1]) finish(false);
  }
  finish(chain.closed && not_kept == fine.kept.end());
  return curves;
}

void drop_repeated_points(std::vector<SurfaceCurve>& curves) {
  for (SurfaceCurve& curve : curves) {
    const auto same = [](const CurveSample& a, const CurveSample& b) { return a.p == b.p; };
    curve.samples.erase(std::unique(curve.samples.begin(), curve.samples.end(), same), curve.samples.end());
    if (curve.closed && curve.samples.size() > 1 && same(curve.samples.front(), curve.samples.back())) curve.samples.pop_back();
  }
  curves.erase(std::remove_if(curves.begin(), curves.end(),
                              [](const SurfaceCurve& curve) { return curve.samples.size() < (curve.closed ? 3u : 2u); }),
               curves.end());
}

void add_lines(const LineTask& task, const FeatureSurface& surface, LineClass line_class, const ExecutionSettings& execution,
               LineContribution& out) {
  const FeatureFunction function(surface, task, line_class);
  const Tracer tracer{task, surface, function};
  const std::vector<FeatureChain> chains = march_features(surface, function, execution);
  std::vector<std::vector<SurfaceCurve>> found(chains.size());
  std::vector<double> worst_px(chains.size(), 0.0);
  parallel_each(size_t{0} + chains.size(), [&](size_t i) {
    if (execution.cancelled && execution.cancelled()) throw Cancelled{};
    found[i] = kept_curves(tracer, chains[i], worst_px[i]);
    drop_repeated_points(found[i]);
    if (!surface.complete) return;
    for (SurfaceCurve& curve : found[i]) surface.complete(curve);
  });
  for (size_t i = 0; i < chains.size(); ++i) {
    if (!found[i].empty()) out.unrefined_px = std::max(out.unrefined_px, worst_px[i]);
    out.curves.insert(out.curves.end(), found[i].begin(), found[i].end());
  }
}

}  // namespace

LineContribution feature_lines(const LineTask& task, const ExecutionSettings& execution) {
  LineContribution out;
  std::vector<size_t> fields, cages, meshes, level_sets;
  for (size_t i = 0; i < task.scene.objects.size(); ++i) {
    const SceneObject& object = task.scene.objects[i];
    if (std::holds_alternative<Field>(object.source)) {
      fields.push_back(i);
    } else if (std::holds_alternative<LevelSetSource>(object.source)) {
      level_sets.push_back(i);
    } else {
      (is_cage(object) ? cages : meshes).push_back(i);
    }
  }
  std::vector<FeatureSurface> surfaces = field_features(task, fields, out.notes);
  const auto add = [&](std::vector<FeatureSurface> found) { std::move(found.begin(), found.end(), std::back_inserter(surfaces)); };
  add(cage_features(task, cages, out.notes));
  add(mesh_features(task, meshes, out.notes));
  add(level_set_features(task, level_sets, out.notes));
  for (const FeatureSurface& surface : surfaces) {
    for (const LineClass line_class : {LineClass::suggestive, LineClass::ridge, LineClass::valley}) {
      if (task.wants(line_class)) add_lines(task, surface, line_class, execution, out);
    }
  }
  if (out.unrefined_px > 0.0)
    out.notes.push_back(
        fmt::format("suggestive contours, ridges and valleys: where curvature jumps they are known to within {:.2g} px", out.unrefined_px));
  return out;
}

}  // namespace limn
