#include "raymarch/gbuffer/file_colors.h"

#include <cmath>

#include "raymarch/gbuffer/picture_rows.h"
#include "raymarch/mesh/polygons.h"
#include "raymarch/surface/field_parts.h"

namespace limn {
namespace {

/// What the pixel's ray met, in render space. From the depth: a position in world space loses its digits far from the origin.
glm::dvec3 point_of(const GBuffer& gbuffer, const Camera& render_camera, int x, int y) {
  const CameraRay ray = camera_ray(render_camera, x + gbuffer.sample.x, y + gbuffer.sample.y);
  const double along = -glm::dot(ray.direction, render_camera.world_from_camera[2]);
  return ray.origin + ray.direction * (static_cast<double>(gbuffer.depth.at(x, y)) / along);
}

glm::vec3 color_of(const Mesh& mesh, const std::vector<std::int32_t>& first_corner, std::int32_t face, const GBuffer& gbuffer,
                   const Camera& render_camera, int x, int y) {
  const auto f = static_cast<size_t>(face);
  glm::vec3 color(1.0f);
  if (!mesh.material_colors.empty() && !mesh.face_materials.empty())
    color = mesh.material_colors[static_cast<size_t>(mesh.face_materials[f])];
  if (!mesh.vertex_colors.empty())
    color *= vertex_color_at(mesh, first_corner[f], mesh.face_sizes[f], point_of(gbuffer, render_camera, x, y));
  return color;
}

}  // namespace

glm::vec3 vertex_color_at(const Mesh& mesh, std::int32_t first_corner, std::int32_t corners, const glm::dvec3& point) {
  const auto vertex = [&](std::int32_t k) {
    return static_cast<size_t>(mesh.corner_vertices[static_cast<size_t>(first_corner) + static_cast<size_t>(k)]);
  };
  const auto color = [&](std::int32_t k) { return mesh.vertex_colors[vertex(k)]; };
  glm::dvec3 sum(0.0);
  double weights = 0.0;
  for (std::int32_t k = 0; k < corners; ++k) {
    const glm::dvec3 to = mesh.positions[vertex(k)] - point, to_next = mesh.positions[vertex((k + 1) % corners)] - point;
    const double distance = glm::length(to), next_distance = glm::length(to_next);
    // On an edge only its ends count; the weights below would be infinite there.
    if (distance * next_distance + glm::dot(to, to_next) <= 1e-9 * distance * next_distance) {
      const double whole = distance + next_distance;
      return whole > 0.0 ? glm::mix(color(k), color((k + 1) % corners), static_cast<float>(distance / whole)) : color(k);
    }
    double weight = 0.0;
    for (const std::int32_t side : {1, corners - 1}) {
      const glm::dvec3 other = mesh.positions[vertex((k + side) % corners)] - point;
      const double product = distance * glm::length(other);
      // tan(angle / 2) = sin / (1 + cos), finite but where the point lies on the edge; there a huge weight is the limit.
      weight += glm::length(glm::cross(to, other)) / std::max(product + glm::dot(to, other), 1e-12 * product + 1e-300);
    }
    weight /= std::max(distance, 1e-300);
    if (!std::isfinite(weight) || weight > 1e200) return color(k);
    sum += weight * glm::dvec3(color(k));
    weights += weight;
  }
  return weights > 0.0 ? glm::vec3(sum / weights) : color(0);
}

FileColors file_colors(const SceneModel& model) {
  FileColors colors;
  for (size_t i = 0; i < model.surfaces.size(); ++i) {
    if (const FieldParts* parts = parts_of(model.surfaces[i]); parts != nullptr && has_colors(parts->field())) {
      colors.any = colors.any_of_parts = true;
      colors.parts.resize(model.surfaces.size(), nullptr);
      colors.parts[i] = parts;
    }
    if (!model.surfaces[i].polygons || !model.surfaces[i].polygons->has_colors()) continue;
    const Mesh& mesh = model.surfaces[i].polygons->mesh();
    colors.any = true;
    colors.meshes.resize(model.surfaces.size(), nullptr);
    colors.meshes[i] = &mesh;
    colors.any_of_vertices |= !mesh.vertex_colors.empty();
  }
  return colors;
}

GBufferLayers layers_read(const FileColors& colors) {
  return {.depth = colors.any_of_vertices || colors.any_of_parts,
          .position = false,
          .normal = false,
          .n_dot_v = colors.any,
          .id = colors.any,
          .material = false,
          .face = colors.any,
          .status = false};
}

namespace {

void find_part_colors(const FileColors& colors, const GBuffer& gbuffer, const Camera& render_camera, Image<glm::vec3>& result) {
  for_each_band(gbuffer.height, [&](int y0, int y1) {
    FieldParts::Place place;
    for (int y = y0; y < y1; ++y) {
      for (int x = 0; x < gbuffer.width; ++x) {
        const std::int32_t id = gbuffer.id.at(x, y);
        const FieldParts* parts = id == 0 ? nullptr : colors.parts[static_cast<size_t>(id - 1)];
        if (parts == nullptr) continue;
        const std::optional<glm::vec3>& color = parts->leaf(parts->owner(point_of(gbuffer, render_camera, x, y), place)).color;
        if (color) result.at(x, y) = *color;
      }
    }
  });
}

}  // namespace

void find_file_colors(const FileColors& colors, const GBuffer& gbuffer, const Camera& camera, const glm::dvec3& render_origin,
                      Image<glm::vec3>& result) {
  const Camera render_camera = moved(camera, render_origin);
  if (colors.any_of_parts && !gbuffer.depth.pixels.empty()) find_part_colors(colors, gbuffer, render_camera, result);
  if (colors.meshes.empty() || gbuffer.face.pixels.empty() || (colors.any_of_vertices && gbuffer.depth.pixels.empty())) return;
  std::vector<std::vector<std::int32_t>> first(colors.meshes.size());
  for (size_t i = 0; i < first.size(); ++i) {
    if (colors.meshes[i] != nullptr && !colors.meshes[i]->vertex_colors.empty()) first[i] = first_corners(*colors.meshes[i]);
  }
  for_each_band(gbuffer.height, [&](int y0, int y1) {
    for (int y = y0; y < y1; ++y) {
      for (int x = 0; x < gbuffer.width; ++x) {
        const std::int32_t id = gbuffer.id.at(x, y), face = gbuffer.face.at(x, y);
        if (id == 0 || face < 0) continue;
        const auto object = static_cast<size_t>(id - 1);
        const Mesh* mesh = colors.meshes[object];
        if (mesh == nullptr || static_cast<size_t>(face) >= mesh->face_count()) continue;
        result.at(x, y) = color_of(*mesh, first[object], face, gbuffer, render_camera, x, y);
      }
    }
  });
}

}  // namespace limn
