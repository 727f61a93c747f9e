#include "tests/bench/lines_oracle.h"

#include <array>
#include <cmath>
#include <limits>

#include "raymarch/gbuffer.h"
#include "sdf/parallel.h"
#include "subdiv/refine.h"

namespace limn::bench {
namespace {

constexpr double kApart_px = 2.0, kFromEnds_px = 0.5;
constexpr std::int64_t kMostFaces = 2'000'000;
/// A ray beside a line, to its right in the image. What it hits nearer than the line by more than this, px at its depth, lies in front.
struct Ray {
  double beside_px = 0.0, nearer_px = 0.0;
};
// At a crease the line's own surface may rise towards the eye beside it, and at the line itself by as much as the line's tolerance makes
// it.
constexpr std::array<Ray, 3> kAlong = {{{0.0, 1.0}, {0.25, 1.0}, {-0.25, 1.0}}};
constexpr double kInFront_px = 0.02;  // what the ray through the point hits nearer by this hides what is drawn as hidden
// What a contour bounds lies on its left: rays that pass it closely on its right meet none of its own surface, however near.
constexpr std::array<Ray, 4> kOutside = {{{0.25, 0.002}, {0.05, 0.002}, {0.0125, 0.002}, {0.003, 0.002}}};
constexpr size_t kRays = kAlong.size() + kOutside.size();
constexpr double kOffContour_px = 0.02;  // a drawn contour and the spline's, farther apart than any tolerance asked for
// Flat walls of voxels are seen edge-on, and contours on them are known badly along the ray.
constexpr double kMostOfSpline_px = 20.0, kMostOfField_px = 0.5;
constexpr double kFieldStep_px = 0.005;  // rays miss no sheet of a field thicker than this
constexpr std::array<double, 4> kOutsideOfSpline_px = {0.25, 0.0125, 3e-4, 1e-7};

struct Asked {
  glm::dvec2 px{0.0};
  double depth = 0.0;
  glm::dvec2 across{0.0};  ///< To the line's right, one pixel.
  const LineEdge* edge = nullptr;
};

/// The depth of a straight step at a share of its image: in perspective its inverse is linear there.
double depth_between(const Camera& camera, double a, double b, double share) {
  if (camera.projection != Projection::perspective) return glm::mix(a, b, share);
  return a * b / glm::mix(b, a, share);
}

void add_points(const LineEdge& edge, const Camera& camera, std::vector<Asked>& asked) {
  double whole = 0.0;
  for (size_t i = 1; i < edge.points.size(); ++i) whole += glm::distance(edge.points[i].px, edge.points[i - 1].px);
  double along = 0.0, next = kFromEnds_px;
  for (size_t i = 1; i < edge.points.size(); ++i) {
    const LinePoint &a = edge.points[i - 1], &b = edge.points[i];
    const double length = glm::distance(a.px, b.px);
    for (; length > 0.0 && next <= along + length && next <= whole - kFromEnds_px; next += kApart_px) {
      const double t = (next - along) / length;
      const glm::dvec2 px = glm::mix(a.px, b.px, t), across = glm::dvec2(a.px.y - b.px.y, b.px.x - a.px.x) / length;
      asked.push_back({px, depth_between(camera, a.depth, b.depth, t), across, &edge});
    }
    along += length;
  }
}

/// Where the rays of one point go, those along the line first.
struct Aimed {
  std::array<glm::dvec2, kRays> points_px{};
  double depth = 0.0;      ///< Of the point itself.
  bool is_spline = false;  ///< The contour of a level set.
  bool at_itself = false;  ///< The first ray goes through the contour, to rounding.
};

glm::dvec3 point_at(const Camera& camera, const glm::dvec2& px, double depth) {
  const CameraRay ray = camera_ray(camera, px.x, px.y);
  return ray.origin + depth / (project(camera, ray.origin + ray.direction).z - project(camera, ray.origin).z) * ray.direction;
}

/// The contour's own point where it is drawn, no farther from there along the ray than `most_px`.
std::optional<glm::dvec3> own_point(const Asked& asked, const Camera& camera, FieldEvaluator& surface, double most_px) {
  const double most = most_px / pixels_per_unit_at(camera, asked.depth);
  const auto p = on_contour(surface, camera, point_at(camera, asked.px, asked.depth), most);
  const bool close = p && glm::distance(glm::dvec2(project(camera, *p)), asked.px) < kOffContour_px;
  return close ? p : std::nullopt;
}

/// A level set's contour is aimed at itself, not where it is drawn.
Aimed aim(const Asked& asked, const Camera& camera, FieldEvaluator* spline) {
  Aimed aimed;
  aimed.depth = asked.depth;
  glm::dvec2 px = asked.px;
  if (spline != nullptr && asked.edge->line_class == LineClass::contour) {
    aimed.is_spline = true;
    if (const auto p = own_point(asked, camera, *spline, kMostOfSpline_px)) {
      const glm::dvec3 seen = project(camera, *p);
      aimed.at_itself = true;
      px = seen, aimed.depth = seen.z;
    }
  }
  size_t k = 0;
  for (const Ray& ray : kAlong) aimed.points_px[k++] = px + ray.beside_px * asked.across;
  for (size_t i = 0; i < kOutside.size(); ++i)
    aimed.points_px[k++] = px + (aimed.at_itself ? kOutsideOfSpline_px[i] : kOutside[i].beside_px) * asked.across;
  return aimed;
}

/// The ray through the own point of a field's contour meets something in front of it, sample by sample in double precision: rays of the
/// marcher beside a drawn point may pass by a sheet that ends within the drawing's tolerance.
bool is_behind_field(const Asked& asked, const Camera& camera, FieldEvaluator& field) {
  const auto p = own_point(asked, camera, field, kMostOfField_px);
  if (!p) return false;
  const glm::dvec3 seen = project(camera, *p);
  const CameraRay ray = camera_ray(camera, seen.x, seen.y);
  const double unit_px = pixels_per_unit_at(camera, seen.z), end = glm::dot(*p - ray.origin, ray.direction) - kInFront_px / unit_px,
               lipschitz = field.field().traits().lipschitz;
  for (double t = 0.0; t < end;) {
    const double f = field.value(ray.origin + t * ray.direction);
    if (f < 0.0) return true;
    t += std::max(f / lipschitz, kFieldStep_px / unit_px);
  }
  return false;
}

/// Depths of what rays hit first; infinite where they hit nothing.
using Depths = std::vector<std::array<double, kRays>>;

void add_hits(const SceneModel& model, const Camera& camera, const std::vector<Aimed>& aimed, Depths& depths) {
  std::vector<glm::dvec2> points_px;
  for (const Aimed& at : aimed) points_px.insert(points_px.end(), at.points_px.begin(), at.points_px.end());
  std::vector<PointSample> samples(points_px.size());
  sample_points(model, camera, points_px, samples);
  for (size_t i = 0; i < samples.size(); ++i) {
    if (samples[i].status != HitStatus::hit) continue;
    double& depth = depths[i / kRays][i % kRays];
    depth = std::min(depth, project(camera, samples[i].position).z);
  }
}

void add_hits(const SplineBody& body, FieldEvaluator& evaluator, const Camera& camera, const Aimed& aimed,
              std::array<double, kRays>& depths) {
  for (size_t k = 0; k < kRays; ++k) {
    const CameraRay ray = camera_ray(camera, aimed.points_px[k].x, aimed.points_px[k].y);
    const double depth_a_unit = project(camera, ray.origin + ray.direction).z - project(camera, ray.origin).z;
    if (const auto t = first_hit(body, evaluator, ray, aimed.depth / depth_a_unit)) depths[k] = std::min(depths[k], *t * depth_a_unit);
  }
}

/// Of all rays of all points.
Depths hit_depths(const Oracle& oracle, const Camera& camera, const std::vector<Asked>& asked, std::vector<Aimed>& aimed) {
  std::array<double, kRays> nothing{};
  nothing.fill(std::numeric_limits<double>::infinity());
  Depths depths(asked.size(), nothing);
  aimed.resize(asked.size());
  constexpr size_t kBlock = 64;
  parallel_for(size_t{0}, (asked.size() + kBlock - 1) / kBlock, [&](size_t block) {
    std::vector<std::optional<FieldEvaluator>> evaluators;
    for (const auto& body : oracle.splines) evaluators.push_back(body ? std::optional<FieldEvaluator>(body->field) : std::nullopt);
    for (size_t i = block * kBlock; i < std::min(asked.size(), (block + 1) * kBlock); ++i) {
      auto& own = evaluators[static_cast<size_t>(asked[i].edge->object - 1)];
      aimed[i] = aim(asked[i], camera, own ? &*own : nullptr);
      for (size_t k = 0; k < evaluators.size(); ++k)
        if (evaluators[k]) add_hits(*oracle.splines[k], *evaluators[k], camera, aimed[i], depths[i]);
    }
  });
  if (oracle.model) add_hits(*oracle.model, camera, aimed, depths);
  return depths;
}

}  // namespace

Oracle make_oracle(const Scene& scene) {
  Oracle oracle{{}, spline_bodies(scene), {}};
  for (const SceneObject& object : scene.objects) {
    const Field* field = std::get_if<Field>(&object.source);
    oracle.fields.push_back(field == nullptr ? std::optional<Field>() : *field);
  }
  SurfaceSettings settings;
  settings.kind = "";
  Scene asked = scene;
  std::erase_if(asked.objects, [](const SceneObject& object) { return std::holds_alternative<LevelSetSource>(object.source); });
  if (asked.objects.empty()) return oracle;
  for (SceneObject& object : asked.objects) {
    object.level.reset();
    const auto* mesh = std::get_if<MeshSource>(&object.source);
    if (mesh == nullptr || !mesh->scheme) continue;
    object.level = 0;
    while (*object.level < 8 && predict_refined_size(mesh->mesh, *mesh->scheme, *object.level + 1).faces <= kMostFaces) ++*object.level;
  }
  oracle.model = build_model(asked, settings);
  return oracle;
}

void add(const OracleCount& more, OracleCount& sum) {
  sum.points += more.points;
  sum.visible += more.visible;
  sum.occluded += more.occluded;
  sum.seen += more.seen;
  sum.undecided += more.undecided;
  sum.places.insert(sum.places.end(), more.places.begin(), more.places.end());
}

OracleCount ask_oracle(const Oracle& oracle, const Camera& camera, const ViewGraph& graph) {
  std::vector<Asked> asked;
  for (const LineEdge& edge : graph.edges) add_points(edge, camera, asked);
  std::vector<Aimed> aimed;
  const Depths depths = hit_depths(oracle, camera, asked, aimed);
  std::vector<std::optional<FieldEvaluator>> fields;
  for (const auto& field : oracle.fields) fields.push_back(field ? std::optional<FieldEvaluator>(*field) : std::nullopt);
  OracleCount count;
  for (size_t i = 0; i < asked.size(); ++i) {
    const double unit_px = pixels_per_unit_at(camera, aimed[i].depth);
    size_t next = 0;
    const auto is_nearer = [&](size_t ray, double margin_px) { return depths[i][ray] < aimed[i].depth - margin_px / unit_px; };
    const bool in_front = is_nearer(0, kInFront_px);
    const auto nearer = [&](const auto& rays) {
      size_t found = 0;
      for (const Ray& ray : rays) found += is_nearer(next++, ray.nearer_px);
      return found;
    };
    const size_t along = nearer(kAlong), outside = nearer(kOutside);
    ++count.points;
    const bool visible = asked[i].edge->invisibility == 0, contour = asked[i].edge->line_class == LineClass::contour;
    count.visible += visible;
    const bool occluded = visible && along == kAlong.size() && (!contour || outside == kOutside.size());
    // The ray through a contour's own point, known far better than its polyline, decides where rays beside it pass within rounding. Where
    // that point is not found rays that differ within what the polyline is known to say nothing.
    const bool passes_outside = !visible && contour && outside == 0;
    const bool undecided = passes_outside && in_front && aimed[i].is_spline && !aimed[i].at_itself;
    const bool passed = passes_outside && !undecided && !(aimed[i].at_itself && in_front);
    const bool passes = passed || (!visible && along == 0 && !in_front);
    auto& field = fields[static_cast<size_t>(asked[i].edge->object - 1)];
    const bool seen = passes && !(contour && field && is_behind_field(asked[i], camera, *field));
    count.occluded += occluded;
    count.seen += seen;
    count.undecided += undecided;
    if (occluded || seen) count.places.push_back(asked[i].px);
  }
  return count;
}

}  // namespace limn::bench
