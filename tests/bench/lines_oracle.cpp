#include "tests/bench/lines_oracle.h"

#include <cmath>

#include "raymarch/gbuffer.h"
#include "subdiv/refine.h"

namespace limn::bench {
namespace {

constexpr double kApart_px = 2.0, kFromEnds_px = 0.5, kBeside_px = 0.25;
constexpr std::int64_t kMostFaces = 2'000'000;
constexpr double kNearer_px = 1.0;  // what is nearer by less, px at its depth, is the line's own surface

struct Asked {
  glm::dvec2 px{0.0};
  double depth = 0.0;
  bool visible = false;
};

void add_points(const LineEdge& edge, std::vector<Asked>& asked, std::vector<glm::dvec2>& points_px) {
  double whole = 0.0;
  for (size_t i = 1; i < edge.points.size(); ++i) whole += glm::distance(edge.points[i].px, edge.points[i - 1].px);
  double along = 0.0, next = kFromEnds_px;
  for (size_t i = 1; i < edge.points.size(); ++i) {
    const LinePoint &a = edge.points[i - 1], &b = edge.points[i];
    const double length = glm::distance(a.px, b.px);
    for (; length > 0.0 && next <= along + length && next <= whole - kFromEnds_px; next += kApart_px) {
      const double t = (next - along) / length;
      const glm::dvec2 px = glm::mix(a.px, b.px, t), across = glm::dvec2(a.px.y - b.px.y, b.px.x - a.px.x) / length;
      asked.push_back({px, glm::mix(a.depth, b.depth, t), edge.invisibility == 0});
      for (const double beside : {0.0, kBeside_px, -kBeside_px}) points_px.push_back(px + beside * across);
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
  for (const LineEdge& edge : graph.edges) add_points(edge, asked, points_px);
  std::vector<PointSample> samples(points_px.size());
  sample_points(model, camera, points_px, samples);
  OracleCount count;
  for (size_t i = 0; i < asked.size(); ++i) {
    const double margin = kNearer_px / pixels_per_unit_at(camera, asked[i].depth);
    int nearer = 0;
    for (size_t k = 3 * i; k < 3 * i + 3; ++k) {
      nearer += samples[k].status == HitStatus::hit && project(camera, samples[k].position).z < asked[i].depth - margin;
    }
    ++count.points;
    count.visible += asked[i].visible;
    const bool occluded = asked[i].visible && nearer == 3, seen = !asked[i].visible && nearer == 0;
    count.occluded += occluded;
    count.seen += seen;
    if (occluded || seen) count.places.push_back(asked[i].px);
  }
  return count;
}

}  // namespace limn::bench
