// Scenes with meshes or volumes that are what they are: the border of their finest model, and how far another way of reading the same
// model puts it.

#include "raymarch/truth/proxy.h"
#include "raymarch/surface/model_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "raymarch/curves/curve_geometry.h"
#include "raymarch/measured_border.h"
#include "raymarch/truth/parts.h"
#include "raymarch/truth/proxy_settings.h"
#include "sdf/error.h"
#include "sdf/parallel.h"
#include "sdf/quantile.h"

namespace limn {
namespace {

// Above these a refined cage costs seconds.
constexpr std::int64_t kMostFaces = 800'000;
constexpr int kFinestLevel = 8;
constexpr double kFarthestStep_px = 2.0;  // between two levels of one curve

template <class Settings>
SceneModel model_of(const Scene& scene, const Settings& settings_of) {
  // Each object has settings of its own. They are built side by side, and put together about the whole scene's centre.
  SceneModel model;
  model.bounds = bounds(scene);
  model.render_origin = render_origin_of(scene);
  std::vector<SceneObject> objects = scene.objects;
  std::vector<SurfaceSettings> settings;
  for (SceneObject& object : objects) {
    object.level.reset();
    settings.push_back(settings_of(object));
  }
  std::vector<Surface> surfaces(objects.size());
  parallel_each(objects.size(),
                [&](size_t i) { surfaces[i] = find_surface(settings[i].kind).build(objects[i], settings[i], model.render_origin); });
  for (size_t i = 0; i < objects.size(); ++i) append_surface(objects[i], std::move(surfaces[i]), model);
  return model;
}

/// A mesh without normals of its own, of which hard edges are kept.
bool has_hard_edges(const SceneObject& object) {
  const auto* source = std::get_if<MeshSource>(&object.source);
  return source != nullptr && cage_in(object) == nullptr && source->mesh->corner_normals.empty();
}

/// Whether an edge is hard is a guess from its angle: the scene with none hard, or nothing where nothing would change.
std::optional<Scene> without_hard_edges(const Scene& scene) {
  if (std::none_of(scene.objects.begin(), scene.objects.end(), has_hard_edges)) return std::nullopt;
  Scene smooth = scene;
  for (SceneObject& object : smooth.objects)
    if (has_hard_edges(object)) std::get<MeshSource>(object.source).smooth_angle_deg = 180.0;
  return smooth;
}

/// Where curvatures come from. A volume whose band has no room for second derivatives is read once more, its band completed for them.
std::vector<CurvatureSource> curvature_sources(const Scene& scene, const SceneModel& model) {
  std::vector<CurvatureSource> sources;
  for (size_t i = 0; i < scene.objects.size(); ++i) {
    sources.push_back(model.surfaces[i].curvature);
    if (sources.back().evaluate != nullptr || !std::holds_alternative<LevelSetSource>(scene.objects[i].source)) continue;
    SurfaceSettings settings;
    settings.kind = "level_set";
    settings.gradient = "cubic";
    sources.back() = find_surface(settings.kind).build(scene.objects[i], settings, model.render_origin).curvature;
  }
  return sources;
}

/// Normals, depths and curvatures of a measured border: for a silhouette those of the sheet a little inside it.
void describe_points(const SceneModel& model, std::span<const CurvatureSource> curvatures, const Camera& camera, BorderCurves& border) {
  constexpr double kInside_px = 0.25;
  for (BorderCurve& curve : border.curves) {
    const size_t n = curve.points.size();
    std::vector<glm::dvec2> places(n);
    for (size_t i = 0; i < n; ++i) {
      const glm::dvec2 along = curve.points[std::min(i + 1, n - 1)].px - curve.points[i > 0 ? i - 1 : 0].px;
      const double length = glm::length(along);
      const glm::dvec2 outward = length > 0.0 ? glm::dvec2(-along.y, along.x) / length : glm::dvec2(0.0);
      places[i] = curve.points[i].px - (curve.kind == CurveKind::silhouette ? kInside_px : 0.0) * outward;
    }
    std::vector<PointSample> samples(n);
    sample_points(model, camera, places, samples);
    for (size_t i = 0; i < n; ++i) {
      const PointSample& s = samples[i];
      if (s.status != HitStatus::hit || s.id != curve.object) continue;
      BorderPoint& point = curve.points[i];
      point.position = s.position;
      point.normal = glm::dvec3(s.normal);
      const CurvatureSource& source = curvatures[static_cast<size_t>(s.id - 1)];
      if (source.evaluate == nullptr) continue;
      const SurfacePoint at{s.position - model.render_origin, point.normal, -1};
      SurfaceCurvature bend;
      source.evaluate(source.state.get(), std::span(&at, 1), std::span(&bend, 1));
      const glm::dvec3 v = view_vector(camera, s.position);
      point.radial_curvature = curvature_along(bend, v - glm::dot(v, point.normal) * point.normal);
    }
  }
}

/// Nearest places of a border's curves of one kind and object, on their steps.
class NearestOf {
 public:
  explicit NearestOf(const BorderCurves& border) : silhouette_(border, CurveKind::silhouette), inner_(border, CurveKind::inner) {}
  /// Infinitely far where there are none.
  glm::dvec2 on(CurveKind kind, int object, const glm::dvec2& p) const {
    constexpr double kAny = std::numeric_limits<double>::infinity();
    const auto found = (kind == CurveKind::silhouette ? silhouette_ : inner_).nearest(p, object, kAny);
    return found ? found->px : glm::dvec2(kAny);
  }

 private:
  CurveIndex silhouette_, inner_;
};

using BorderOfModel = std::function<BorderCurves(const Camera& camera)>;

/// Crossings are found to 0.002 px, and steps between them keep to the curve within 0.01 px (measured_border.h).
constexpr double kGivenBound_px = 0.012;
/// Pictures with a longer side are not doubled.
constexpr int kMostDoubled_px = 8192;

/// How far two readings of one object put its border from each other: the 95th percentile over the first one's points.
double disagreement_px(const BorderCurves& a, const NearestOf& b, int object) {
  std::vector<double> distances;
  for (const BorderCurve& curve : a.curves) {
    if (curve.object != object) continue;
    // A hundred places of a curve tell as much as all of them.
    const size_t step = std::max<size_t>(1, curve.points.size() / 100);
    for (size_t i = 0; i < curve.points.size(); i += step)
      distances.push_back(glm::distance(curve.points[i].px, b.on(curve.kind, object, curve.points[i].px)));
  }
  return distances.empty() ? 0.0 : lower_quantile(std::move(distances), 0.95);
}

/// A refined cage's border nears the limit's with the square of the edges' length: of two levels, the finer one is off by a third of what
/// lies between them (Richardson 1911). Points that the other level has nowhere near stay where they are.
void extrapolate(BorderCurves& border, const NearestOf& coarser, int object) {
  for (BorderCurve& curve : border.curves) {
    if (curve.object != object) continue;
    for (BorderPoint& point : curve.points) {
      const glm::dvec2 step = point.px - coarser.on(curve.kind, object, point.px);
      if (glm::length(step) < kFarthestStep_px) point.px += step / 3.0;
    }
  }
}

/// What is known of each object: cages are extrapolated, meshes and volumes that are all there is keep what their other reading says.
/// `smooth`: of the meshes with none of their edges hard, if any.
void judge_objects(const Scene& scene, int level, TruthReference reference, const NearestOf& second, const std::optional<NearestOf>& smooth,
                   BorderTruth& truth) {
  for (size_t i = 0; i < scene.objects.size(); ++i) {
    const SceneObject& object = scene.objects[i];
    if (std::holds_alternative<Field>(object.source) || (reference == TruthReference::given && !is_cage(object))) continue;
    const int number = static_cast<int>(i) + 1;
    const std::string name = object.name.empty() ? fmt::format("object {}", number) : object.name;
    double apart_px = disagreement_px(truth.curves, second, number);
    if (smooth && has_hard_edges(object)) apart_px = std::max(apart_px, disagreement_px(truth.curves, *smooth, number));
    if (is_cage(object) && level > 0) {
      extrapolate(truth.curves, second, number);
      truth.bound_px = std::max(truth.bound_px, apart_px / 3.0);
      truth.notes.push_back(
          fmt::format("not exact: {} is extrapolated from its levels {} and {}, order 2: by {:.2g} px or less for 95 % of its "
                      "border",
                      name, level - 1, level, apart_px / 3.0));
      continue;
    }
    truth.bound_px = std::max(truth.bound_px, apart_px);
    truth.notes.push_back(
        fmt::format("not exact: {} is all there is of it and cannot be refined; read another way ({}), it puts 95 % of its "
                    "border within {:.2g} px of this one",
                    name,
                    std::holds_alternative<LevelSetSource>(object.source) ? "a lower gradient"
                    : has_hard_edges(object)                              ? "facets, or no edge hard"
                                                                          : "facets",
                    apart_px));
  }
}

}  // namespace

bool is_cage(const SceneObject& object) { return cage_in(object) != nullptr; }

int proxy_level(const Scene& scene, const Camera& camera, double edge_px) {
  int level = 0;
  while (level < kFinestLevel && edge_px_at(scene, camera, level) > edge_px && faces_at(scene, level + 1) <= kMostFaces) ++level;
  return level;
}

namespace {

SceneModel model_at(const Scene& scene, int level, std::int64_t max_bytes, TruthProxy& out) {
  return model_of(scene, [&](const SceneObject& object) {
    SurfaceSettings settings = finest_settings(object, level, out);
    settings.max_bytes = max_bytes;
    return settings;
  });
}

}  // namespace

SceneModel proxy_model(const Scene& scene, int level, std::int64_t max_bytes) {
  TruthProxy words;
  return model_at(scene, level, max_bytes, words);
}

TruthProxy make_proxy(const Scene& scene, const Camera& camera, std::int64_t max_bytes, double edge_px) {
  return *proxy_for(scene, camera, {.max_bytes = max_bytes}, edge_px);
}

void offer_model(const Scene& scene, const SurfaceSettings& settings, const SceneModel& model, TruthCache& cache) {
  if (cache.proxy != nullptr) return;
  const bool any_cage = std::any_of(scene.objects.begin(), scene.objects.end(), is_cage);
  TruthProxy proxy{model, any_cage ? settings.level : 0};
  const bool fits = std::all_of(scene.objects.begin(), scene.objects.end(), [&](const SceneObject& object) {
    const SurfaceSettings finest = finest_settings(object, settings.level, proxy);
    const std::string kind = settings.kind.empty() ? natural_surface(object) : settings.kind;
    return std::holds_alternative<MeshSource>(object.source) && kind == finest.kind && settings.normals == finest.normals &&
           !settings.scheme && !(is_cage(object) && object.level);
  });
  if (fits) cache.proxy = std::make_shared<const TruthProxy>(std::move(proxy));
}

std::shared_ptr<const TruthProxy> proxy_for(const Scene& scene, const Camera& camera, const TruthSettings& settings, double edge_px) {
  auto out = std::make_shared<TruthProxy>();
  out->level = proxy_level(scene, camera, edge_px);
  out->edge_px = edge_px_at(scene, camera, out->level);
  TruthCache none, &cache = settings.cache != nullptr ? *settings.cache : none;
  if (cache.proxy != nullptr && cache.proxy->level == out->level) {
    out->model = cache.proxy->model;
    out->words = cache.proxy->words;
    return out;
  }
  cache.proxy.reset();
  out->model = model_at(scene, out->level, settings.max_bytes, *out);
  cache.proxy = out;
  return out;
}

namespace {

// Twice as many pixels each way.
Camera doubled(Camera camera) {
  camera.width_px *= 2;
  camera.height_px *= 2;
  camera.focal_px *= 2.0;
  camera.pixels_per_unit *= 2.0;
  return camera;
}

/// The border of files as they are, from rays half a pixel apart; it is known as well as rays a pixel apart agree with it.
void find_given_border(const Scene& scene, const Camera& camera, const BorderOfModel& border_of, BorderTruth& truth) {
  truth.bound_px = kGivenBound_px;
  if (std::max(camera.width_px, camera.height_px) > kMostDoubled_px) return;
  const BorderCurves coarse = std::move(truth.curves);
  truth.curves = border_of(doubled(camera));
  for (BorderCurve& curve : truth.curves.curves)
    for (BorderPoint& point : curve.points) point.px *= 0.5;
  const NearestOf nearest(truth.curves);
  for (size_t i = 0; i < scene.objects.size(); ++i)
    truth.bound_px = std::max(truth.bound_px, disagreement_px(coarse, nearest, static_cast<int>(i) + 1));
}

}  // namespace

BorderTruth solve_truth_by_proxy(const Scene& scene, const Camera& camera, const TruthSettings& settings, const ExecutionSettings& how) {
  const std::shared_ptr<const TruthProxy> proxy = proxy_for(scene, camera, settings, 1.0);
  const TruthProxy& finest = *proxy;
  MeasuredBorderSettings measuring;
  measuring.threshold = settings.threshold;
  const auto border_of = [&](const SceneModel& model, const Camera& eye) {
    return measure_border(model, eye, render_gbuffer(model, eye, how), measuring, how);
  };
  BorderTruth truth;
  truth.curves = border_of(finest.model, camera);
  const bool as_given = settings.reference == TruthReference::given;
  if (as_given && std::none_of(scene.objects.begin(), scene.objects.end(), is_cage)) {
    find_given_border(
        scene, camera, [&](const Camera& eye) { return border_of(finest.model, eye); }, truth);
  } else {
    truth.exact = false;
    std::optional<NearestOf> smooth;
    if (const auto soft = as_given ? std::nullopt : without_hard_edges(scene))
      smooth.emplace(
          border_of(model_of(*soft, [](const SceneObject& object) { return SurfaceSettings{.kind = natural_surface(object)}; }), camera));
    const SceneModel second = model_of(scene, [&](const SceneObject& object) { return second_settings(object, finest.level); });
    judge_objects(scene, finest.level, settings.reference, NearestOf(border_of(second, camera)), smooth, truth);
  }
  describe_points(finest.model, curvature_sources(scene, finest.model), camera, truth.curves);
  for (const BorderCurve& curve : truth.curves.curves) {
    if (curve.closed) ++(curve.kind == CurveKind::silhouette ? truth.contour_generators : truth.level_curves);
  }
  const SeenInk seen = [&](std::span<const glm::dvec2> points, std::span<std::uint8_t> ink) {
    std::vector<PointSample> samples(points.size());
    sample_points(finest.model, camera, points, samples);
    for (size_t i = 0; i < points.size(); ++i)
      ink[i] = samples[i].status == HitStatus::hit && static_cast<double>(samples[i].n_dot_v) < settings.threshold;
  };
  truth.coverage = coverage_of(truth.curves, camera.width_px, camera.height_px, seen, how).share;
  for (const std::string& word : finest.words) truth.from += (truth.from.empty() ? "" : "; ") + word;
  return truth;
}

}  // namespace limn
