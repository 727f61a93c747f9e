#include "raymarch/border/section_map.h"

#include <algorithm>
#include <cmath>

#include "raymarch/gbuffer/file_colors.h"
#include "raymarch/gbuffer/picture_rows.h"
#include "raymarch/mesh/polygons.h"

namespace limn {
namespace {

struct ObjectSections {
  const Mesh* mesh = nullptr;  ///< Null where the object has nothing to tell sections by.
  std::vector<std::int32_t> first_corner;
};

std::vector<ObjectSections> objects_with(const SceneModel& model, SectionSource source) {
  std::vector<ObjectSections> objects(model.surfaces.size());
  for (size_t i = 0; i < objects.size(); ++i) {
    const auto& polygons = model.surfaces[i].polygons;
    if (polygons == nullptr) continue;
    const Mesh& mesh = polygons->mesh();
    if (source == SectionSource::groups ? mesh.face_groups.empty() : mesh.vertex_colors.empty()) continue;
    objects[i].mesh = &mesh;
    if (source == SectionSource::vertex_colors) objects[i].first_corner = first_corners(mesh);
  }
  return objects;
}

glm::vec3 cell_of(const glm::vec3& position, double cell_size) {
  glm::vec3 parity;
  for (int axis = 0; axis < 3; ++axis) {
    const double cell = std::floor(static_cast<double>(position[axis]) / cell_size);
    parity[axis] = static_cast<float>(cell - 2.0 * std::floor(0.5 * cell));
  }
  return parity;
}

glm::vec3 section_of(const BorderInput& input, const ObjectSections& object, SectionSource source, size_t pixel) {
  const std::int32_t face = input.gbuffer.face.pixels[pixel];
  if (object.mesh == nullptr || face < 0 || static_cast<size_t>(face) >= object.mesh->face_count()) return glm::vec3(0.0f);
  if (source == SectionSource::groups) {
    return {static_cast<float>(object.mesh->face_groups[static_cast<size_t>(face)] + 1), 0.0f, 0.0f};
  }
  const glm::dvec3 point = glm::dvec3(input.gbuffer.position.pixels[pixel]) - input.model.render_origin;
  return vertex_color_at(*object.mesh, object.first_corner[static_cast<size_t>(face)], object.mesh->face_sizes[static_cast<size_t>(face)],
                         point);
}

}  // namespace

SectionMap section_map(const BorderInput& input, SectionSource source, double cell_size) {
  const GBuffer& seen = input.gbuffer;
  SectionMap map;
  map.sections = {seen.width, seen.height, glm::vec3(0.0f)};
  std::vector<ObjectSections> objects;
  if (source != SectionSource::position) {
    objects = objects_with(input.model, source);
    if (std::none_of(objects.begin(), objects.end(), [](const ObjectSections& object) { return object.mesh != nullptr; })) {
      map.missing = source == SectionSource::groups ? "no object is a mesh with face groups" : "no object is a mesh with vertex colours";
      return map;
    }
  }
  for_each_band(seen.height, [&](int y0, int y1) {
    for (size_t i = seen.id.index(0, y0); i < seen.id.index(0, y1); ++i) {
      if (seen.id.pixels[i] == 0) continue;
      map.sections.pixels[i] = source == SectionSource::position
                                   ? cell_of(seen.position.pixels[i], cell_size)
                                   : section_of(input, objects[static_cast<size_t>(seen.id.pixels[i] - 1)], source, i);
    }
  });
  return map;
}

}  // namespace limn
