// Meshes of facets as feature surfaces: lines lie on the facets, and curvature is estimated at the vertices.

#include <algorithm>
#include <cmath>

#include "raymarch/lines/feature_surface.h"
#include "raymarch/lines/line_memory.h"
#include "raymarch/lines/mesh_layers.h"
#include "sdf/parallel.h"
#include "subdiv/fair_mesh.h"
#include "subdiv/vertex_curvature.h"

namespace limn {
namespace {

constexpr std::uint32_t kNone = SmoothTriangles::kNoTriangle;
constexpr double kEdge_px = 1e9;  // facets are not refined
constexpr int kMostFacets = 64;   // that a small step goes over

glm::dvec3 weights_at(const glm::dvec2& uv) { return {1.0 - uv.x - uv.y, uv.x, uv.y}; }

class Facets {
 public:
  Facets(std::vector<glm::dvec3> positions, std::shared_ptr<const SmoothCurvature> curvature)
      : positions_(std::move(positions)), curvature_(std::move(curvature)) {}

  const std::vector<std::array<std::uint32_t, 3>>& triangles() const { return curvature_->triangles.corners; }

  FeaturePoint point_at(std::uint32_t triangle, const glm::dvec3& weights) const {
    FeaturePoint point;
    point.sheet = triangle;
    point.uv = {weights.y, weights.z};
    for (int k = 0; k < 3; ++k) point.p += weights[k] * corner(triangle, static_cast<size_t>(k));
    const VertexCurvature between = curvature_between(*curvature_, triangle, weights);
    const double length = glm::length(between.normal);
    if (!(length > 0.0)) return point;
    point.normal = between.normal / length;
    point.shape = tangential(between.shape, point.normal);
    point.valid = true;
    return point;
  }
  FeaturePoint at(const FeaturePlace& place) const { return point_at(place.triangle, place.weights); }

  double change(const FeaturePoint& point, const glm::dvec3& tangent) const {
    return change_along(curvature_between(*curvature_, point.sheet, weights_at(point.uv)), tangent);
  }

  /// Over the facets, turned with them from one to the next.
  FeaturePoint beside(const FeaturePoint& point, const glm::dvec3& step) const {
    std::uint32_t triangle = point.sheet, from = kNone;
    glm::dvec3 weights = weights_at(point.uv), rest = step;
    for (int i = 0; i < kMostFacets; ++i) {
      const glm::dvec3 rates = rates_along(triangle, rest);
      // The side that is met first: where the weight of the corner opposite to it comes down to 0.
      double share = 1.0;
      size_t side = 3;
      for (size_t k = 0; k < 3; ++k) {
        const int opposite = static_cast<int>((k + 2) % 3);
        if (beyond(triangle)[k] == from && from != kNone) continue;
        if (rates[opposite] < 0.0 && -weights[opposite] / rates[opposite] < share)
          share = std::max(0.0, -weights[opposite] / rates[opposite]), side = k;
      }
      weights += share * rates;
      if (side == 3) return point_at(triangle, weights);
      const std::uint32_t next = beyond(triangle)[side];
      if (next == kNone) return {};
      const glm::dvec3 p = point_at(triangle, weights).p;
      rest = turned(rest * (1.0 - share), triangle, next);
      from = triangle;
      triangle = next;
      weights = weights_of(triangle, p);
    }
    return {};
  }

 private:
  const std::array<std::uint32_t, 3>& beyond(std::uint32_t triangle) const { return curvature_->triangles.beyond[triangle]; }
  const glm::dvec3& corner(std::uint32_t triangle, size_t k) const { return positions_[triangles()[triangle][k]]; }
  glm::dvec3 normal_of(std::uint32_t triangle) const {
    return glm::cross(corner(triangle, 1) - corner(triangle, 0), corner(triangle, 2) - corner(triangle, 0));
  }
  /// How the weights change along a way, brought into the facet's plane.
  glm::dvec3 rates_along(std::uint32_t triangle, const glm::dvec3& way) const {
    const glm::dvec3 u = corner(triangle, 1) - corner(triangle, 0), v = corner(triangle, 2) - corner(triangle, 0),
                     normal = glm::cross(u, v);
    const double squared = glm::dot(normal, normal);
    if (!(squared > 0.0)) return glm::dvec3(0.0);
    const double y = glm::dot(glm::cross(way, v), normal) / squared, z = glm::dot(glm::cross(u, way), normal) / squared;
    return {-y - z, y, z};
  }
  glm::dvec3 weights_of(std::uint32_t triangle, const glm::dvec3& p) const {
    return glm::dvec3(1.0, 0.0, 0.0) + rates_along(triangle, p - corner(triangle, 0));
  }
  /// As long as before, in the other facet's plane.
  glm::dvec3 turned(const glm::dvec3& way, std::uint32_t from, std::uint32_t to) const {
    const glm::dvec3 a = normal_of(from), b = normal_of(to);
    const double lengths = glm::length(a) * glm::length(b);
    if (!(lengths > 0.0)) return way;
    const glm::dvec3 axis = glm::cross(a, b) / lengths;
    const double cosine = glm::dot(a, b) / lengths;
    if (!(cosine > -0.999)) return way;
    // Rodrigues 1840, by half angles.
    return way + glm::cross(axis, way) + glm::cross(axis, glm::cross(axis, way)) / (1.0 + cosine);
  }

  std::vector<glm::dvec3> positions_;
  std::shared_ptr<const SmoothCurvature> curvature_;
};

/// One object's triangles, in solver space; `faces` are their numbers in the tree.
Mesh mesh_of(const MeshTree& tree, int object, std::vector<std::uint32_t>& faces) {
  Mesh mesh;
  std::vector<std::int32_t> number(tree.positions().size(), -1);
  for (std::uint32_t t = 0; t < tree.triangles().size(); ++t) {
    const auto& c = tree.triangles()[t].corners;
    if (tree.triangles()[t].object != object || c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) continue;
    faces.push_back(t);
    mesh.face_sizes.push_back(3);
    for (const std::uint32_t vertex : c) {
      if (number[vertex] < 0) {
        number[vertex] = static_cast<std::int32_t>(mesh.positions.size());
        mesh.positions.push_back(tree.positions()[vertex]);
      }
      mesh.corner_vertices.push_back(number[vertex]);
    }
  }
  return mesh;
}

SmoothCurvature curvature_of(Mesh mesh, const LineSettings& settings) {
  mark_creases(settings.crease_angle_deg, mesh);
  if (settings.fairing_edges > 0.0) fair(settings.fairing_edges, mesh);
  return smooth_curvature(mesh);
}

}  // namespace

std::vector<FeatureSurface> mesh_features(const LineTask& task, const std::vector<size_t>& objects, std::vector<std::string>&) {
  std::vector<FeatureSurface> surfaces;
  if (objects.empty()) return surfaces;
  const auto layers = std::make_shared<const MeshLayers>(task, objects, kEdge_px, false);
  for (const size_t object : objects) {
    FeatureSurface surface;
    const Mesh mesh = mesh_of(layers->tree(), static_cast<int>(object) + 1, surface.faces);
    if (mesh.face_sizes.empty()) continue;
    std::shared_ptr<const SmoothCurvature>& curvature = task.kept.curvatures[object];
    if (!curvature) curvature = std::make_shared<const SmoothCurvature>(curvature_of(mesh, task.settings));
    surface.step = curvature->mean_edge;
    std::vector<glm::dvec3> positions;
    for (const std::uint32_t vertex : curvature->triangles.vertex) positions.push_back(mesh.positions[vertex]);
    surface.radius = bounds(mesh).radius();
    const auto facets = std::make_shared<const Facets>(std::move(positions), curvature);
    surface.triangles = facets->triangles();
    surface.nodes.resize(curvature->vertices.size());
    for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
      for (int k = 0; k < 3; ++k) {
        glm::dvec3 weights(0.0);
        weights[k] = 1.0;
        FeaturePoint& node = surface.nodes[surface.triangles[t][static_cast<size_t>(k)]];
        if (!node.valid) node = facets->point_at(t, weights);
      }
    }
    surface.complete = [layers](SurfaceCurve& curve) {
      make_exact(curve);
      layers->pierce(curve);
    };
    surface.at = [facets](const FeaturePlace& place) { return facets->at(place); };
    surface.change = [facets](const FeaturePoint& point, const glm::dvec3& tangent) { return facets->change(point, tangent); };
    surface.beside = [facets](const FeaturePoint& point, const glm::dvec3& step) { return facets->beside(point, step); };
    surface.object = [object](const FeaturePoint&) { return static_cast<int>(object) + 1; };
    surfaces.push_back(std::move(surface));
  }
  return surfaces;
}

}  // namespace limn
