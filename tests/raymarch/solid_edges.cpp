#include "tests/raymarch/solid_edges.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace limn::test {

glm::dvec3 normal_of(const std::vector<glm::dvec3>& face) { return glm::normalize(glm::cross(face[1] - face[0], face[2] - face[0])); }

std::vector<SolidEdge> edges_of(const Solid& solid) {
  std::vector<SolidEdge> edges;
  for (size_t f = 0; f < solid.faces.size(); ++f) {
    const auto& face = solid.faces[f];
    for (size_t i = 0; i < face.size(); ++i) {
      const glm::dvec3 a = face[i], b = face[(i + 1) % face.size()];
      const auto known =
          std::find_if(edges.begin(), edges.end(), [&](const SolidEdge& e) { return (e.a == a && e.b == b) || (e.a == b && e.b == a); });
      if (known == edges.end()) {
        edges.push_back({a, b, {f}});
      } else {
        known->faces.push_back(f);
      }
    }
  }
  return edges;
}

Solid solid_of(const Mesh& mesh, const glm::dvec3& moved) {
  Solid solid;
  size_t first = 0;
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    std::vector<glm::dvec3> face;
    for (std::int32_t k = 0; k < mesh.face_sizes[f]; ++k)
      face.push_back(mesh.positions[static_cast<size_t>(mesh.corner_vertices[first + static_cast<size_t>(k)])] + moved);
    first += static_cast<size_t>(mesh.face_sizes[f]);
    solid.faces.push_back(face);
    solid.materials.push_back(mesh.face_materials.empty() ? 0 : mesh.face_materials[f]);
  }
  return solid;
}

namespace {

/// Nothing but the edge's own faces stands between the point and the eye.
bool seen(const std::vector<Solid>& solids, const Solid* own, const SolidEdge& edge, const glm::dvec3& point, const Camera& camera) {
  const glm::dvec3 to_eye = view_vector(camera, point);
  for (const Solid& solid : solids) {
    for (size_t f = 0; f < solid.faces.size(); ++f) {
      if (&solid == own && std::find(edge.faces.begin(), edge.faces.end(), f) != edge.faces.end()) continue;
      const auto& face = solid.faces[f];
      const glm::dvec3 n = normal_of(face);
      const double t = glm::dot(n, face[0] - point) / glm::dot(n, to_eye);
      if (!std::isfinite(t) || t < 1e-9) continue;
      const glm::dvec3 q = point + t * to_eye;
      bool inside = true;
      for (size_t i = 0; i < face.size(); ++i)
        inside = inside && glm::dot(n, glm::cross(face[(i + 1) % face.size()] - face[i], q - face[i])) > 0.0;
      if (inside) return false;
    }
  }
  return true;
}

}  // namespace

bool seen_nearby(const std::vector<Solid>& solids, const Solid* own, const SolidEdge& edge, const glm::dvec3& point, const Camera& camera) {
  const double radius = 0.02 / pixels_per_unit_at(camera, project(camera, point).z);
  for (int i = 0; i < 16; ++i) {
    const double angle = std::numbers::pi * i / 8.0;
    const glm::dvec3 shift = camera.world_from_camera * glm::dvec3(std::cos(angle), std::sin(angle), 0.0);
    if (seen(solids, own, edge, point + radius * shift, camera)) return true;
  }
  return false;
}

SampledEdge sample_edge(const std::vector<Solid>& solids, const Solid& own, const SolidEdge& edge, const Camera& camera) {
  SampledEdge sampled{project(camera, edge.a), project(camera, edge.b), edge, camera.projection, {}};
  sampled.seen.resize(std::max<size_t>(2, static_cast<size_t>(std::ceil(sampled.length_px() * kPointsPerPixel))));
  for (size_t i = 0; i < sampled.seen.size(); ++i) sampled.seen[i] = seen(solids, &own, edge, sampled.world(sampled.place(i)), camera);
  return sampled;
}

std::vector<EdgeStretch> runs(const SampledEdge& edge) {
  std::vector<EdgeStretch> result;
  const double half = 0.5 / static_cast<double>(edge.seen.size());
  for (size_t i = 0; i < edge.seen.size(); ++i) {
    if (!edge.seen[i]) continue;
    if (i == 0 || !edge.seen[i - 1]) result.push_back({edge.place(i) - half, 0.0});
    result.back().to = edge.place(i) + half;
  }
  return result;
}

}  // namespace limn::test
