#include "raymarch/border/vertex_widths.h"

#include "raymarch/gbuffer/file_colors.h"
#include "raymarch/mesh/polygons.h"
#include "raymarch/surface/object_mesh.h"
#include "subdiv/mesh_level_set.h"

namespace limn {
namespace {

constexpr int kCageLevel = 3;  // where a cage's polygons are not what is traced
constexpr std::int64_t kMostBytes = std::int64_t{1} << 30;

/// A mesh, and how to come to its place from the world.
struct PlacedMesh {
  std::shared_ptr<const Polygons> polygons{};
  Affine mesh_from_world{};
};

PlacedMesh placed_mesh(const SceneObject& object, const Surface& surface, const glm::dvec3& render_origin) {
  const Affine render_from_world{glm::dmat3(1.0), -render_origin};
  const auto* source = std::get_if<MeshSource>(&object.source);
  if (source == nullptr || source->mesh->vertex_colors.empty()) return {};
  if (surface.polygons) return {surface.polygons, render_from_world};
  if (source->scheme) return {refined_polygons(object, kCageLevel, kMostBytes, render_origin), render_from_world};
  return {std::make_shared<const Polygons>(*source->mesh, NormalKind::flat), inverse(object.world_from_object)};
}

}  // namespace

struct VertexWidths::Painted {
  explicit Painted(const PlacedMesh& from)
      : placed(from),
        first_corner(first_corners(from.polygons->mesh())),
        triangles(triangulate(from.polygons->mesh(), NormalKind::flat)),
        query(triangles) {}
  PlacedMesh placed;
  std::vector<std::int32_t> first_corner;
  TriangleMesh triangles;
  ClosestPointQuery query;
};

double channel_of(const glm::vec3& color, ColorChannel channel) {
  switch (channel) {
    case ColorChannel::red:
      return color.r;
    case ColorChannel::green:
      return color.g;
    case ColorChannel::blue:
      return color.b;
    case ColorChannel::luminance:
      break;
  }
  return glm::dot(glm::dvec3(color), glm::dvec3(0.2126, 0.7152, 0.0722));
}

VertexWidths::VertexWidths(const Scene& scene, const SceneModel& model, ColorChannel channel) : channel_(channel) {
  objects_.resize(scene.objects.size());
  for (size_t i = 0; i < scene.objects.size() && i < model.surfaces.size(); ++i) {
    const PlacedMesh placed = placed_mesh(scene.objects[i], model.surfaces[i], model.render_origin);
    if (placed.polygons && !placed.polygons->mesh().vertex_colors.empty()) objects_[i] = std::make_unique<const Painted>(placed);
  }
}

VertexWidths::~VertexWidths() = default;

bool VertexWidths::has(int object) const {
  return object >= 1 && static_cast<size_t>(object) <= objects_.size() && objects_[static_cast<size_t>(object - 1)];
}

std::optional<double> VertexWidths::at(int object, const glm::dvec3& position) const {
  if (!has(object)) return std::nullopt;
  const Painted& painted = *objects_[static_cast<size_t>(object - 1)];
  if (painted.triangles.triangles.empty()) return std::nullopt;
  const ClosestPoint closest = painted.query.closest(painted.placed.mesh_from_world.point(position));
  const Mesh& mesh = painted.placed.polygons->mesh();
  const auto face = static_cast<size_t>(painted.triangles.triangle_faces[closest.triangle]);
  return channel_of(vertex_color_at(mesh, painted.first_corner[face], mesh.face_sizes[face], closest.point), channel_);
}

}  // namespace limn
