#include "tests/bench/lines_oracle.h"

#include <array>
#include <cmath>

#include "raymarch/gbuffer.h"
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

struct Asked {
  glm::dvec2 px{0.0};
  double depth = 0.0;
  const LineEdge* edge = nullptr;
};

/// The depth of a straight step at a share of its image: in perspective its inverse is linear there.
double depth_between(const Camera& camera, double a, double b, double share) {
  if (camera.projection != Projection::perspective) return glm::mix(a, b, share);
  return a * b / glm::mix(b, a, share);
}

void add_points(const LineEdge& edge, const Camera& camera, std::vector<Asked>& asked, std::vector<glm::dvec2>& points_px) {
  double whole = 0.0;
  for (size_t i = 1; i < edge.points.size(); ++i) whole += glm::distance(edge.points[i].px, edge.points[i - 1].px);
  double along = 0.0, next = kFromEnds_px;
  for (size_t i = 1; i < edge.points.size(); ++i) {
    const LinePoint &a = edge.points[i - 1], &b = edge.points[i];
    const double length = glm::distance(a.px, b.px);
    for (; length > 0.0 && next <= along + length && next <= whole - kFromEnds_px; next += kApart_px) {
      const double t = (next - along) / length;
      const glm::dvec2 px = glm::mix(a.px, b.px, t), across = glm::dvec2(a.px.y - b.px.y, b.px.x - a.px.x) / length;
      asked.push_back({px, depth_between(camera, a.depth, b.depth, t), &edge});
      for (const Ray& ray : kAlong) points_px.push_back(px + ray.beside_px * across);
      for (const Ray& ray : kOutside) points_px.push_back(px + ray.beside_px * across);
    }
    along += length;
  }
}

}  // namespace

SceneModel oracle_model(const Scene& scene) {
  SurfaceSettings settings;
  settings.kind = "";
  settings.gradient = "cubic";
  Scene asked = scene;
  for (SceneObject& object : asked.objects) {
    object.level.reset();
    const auto* mesh = std::get_if<MeshSource>(&object.source);
    if (mesh == nullptr || !mesh->scheme) continue;
    object.level = 0;
    while (*object.level < 8 && predict_refined_size(mesh->mesh, *mesh->scheme, *object.level + 1).faces <= kMostFaces) ++*object.level;
  }
  return build_model(asked, settings);
}

void add(const OracleCount& more, OracleCount& sum) {
  sum.points += more.points;
  sum.visible += more.visible;
  sum.occluded += more.occluded;
  sum.seen += more.seen;
  sum.places.insert(sum.places.end(), more.places.begin(), more.places.end());
}

OracleCount ask_oracle(const SceneModel& model, const Camera& camera, const ViewGraph& graph) {
  std::vector<Asked> asked;
  std::vector<glm::dvec2> points_px;
  for (const LineEdge& edge : graph.edges) add_points(edge, camera, asked, points_px);
  std::vector<PointSample> samples(points_px.size());
  sample_points(model, camera, points_px, samples);
  OracleCount count;
  for (size_t i = 0; i < asked.size(); ++i) {
    const double unit_px = pixels_per_unit_at(camera, asked[i].depth);
    size_t next = i * (kAlong.size() + kOutside.size());
    const auto is_nearer = [&](const PointSample& hit, double margin_px) {
      return hit.status == HitStatus::hit && project(camera, hit.position).z < asked[i].depth - margin_px / unit_px;
    };
    const bool in_front = is_nearer(samples[next], kInFront_px);
    const auto nearer = [&](const auto& rays) {
      size_t found = 0;
      for (const Ray& ray : rays) found += is_nearer(samples[next++], ray.nearer_px);
      return found;
    };
    const size_t along = nearer(kAlong), outside = nearer(kOutside);
    ++count.points;
    const bool visible = asked[i].edge->invisibility == 0, contour = asked[i].edge->line_class == LineClass::contour;
    count.visible += visible;
    const bool occluded = visible && along == kAlong.size() && (!contour || outside == kOutside.size());
    const bool passed = !visible && contour && outside == 0;
    const bool seen = passed || (!visible && along == 0 && !in_front);
    count.occluded += occluded;
    count.seen += seen;
    if (occluded || seen) count.places.push_back(asked[i].px);
  }
  return count;
}

}  // namespace limn::bench
