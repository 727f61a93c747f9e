#include "samples/input/world_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "raymarch/mesh/polygons.h"
#include "raymarch/surface/resampled_volume.h"
#include "sdf/error.h"
#include "sdf/level_set_grids.h"
#include "sdf/local_grid.h"
#include "subdiv/face_orientation.h"
#include "subdiv/mesh_level_set.h"
#include "subdiv/tessellate.h"

namespace limn {
namespace {

Mesh polygons_of(const LevelSet& level_set) {
  PolygonSoup soup = mesh_from_level_set(level_set);
  Mesh mesh;
  mesh.positions = std::move(soup.positions);
  mesh.face_sizes = std::move(soup.face_sizes);
  mesh.corner_vertices = std::move(soup.corner_vertices);
  return mesh;
}

Mesh local_mesh(const SceneObject& object, const SurfaceSettings& settings, bool refined_positions) {
  const NormalKind normals = settings.normals.value_or(NormalKind::limit);
  const int level = object.level.value_or(settings.level);
  if (const Field* field = std::get_if<Field>(&object.source)) {
    return tessellate(*field, {.level = level, .normals = normals, .max_bytes = settings.max_bytes});
  }
  if (const auto* source = std::get_if<MeshSource>(&object.source)) {
    if (!source->scheme && !settings.scheme) return source->mesh;
    const Scheme scheme = settings.scheme ? *settings.scheme : *source->scheme;
    Mesh refined = refine(source->mesh,
                          {.scheme = scheme,
                           .level = level,
                           .to_limit = !refined_positions,
                           .normals = normals,
                           .max_bytes = settings.max_bytes,
                           .keep_holes = refined_positions},
                          source->file);
    if (refined_positions) return refined;
    // Its vertices lie on the limit surface: whoever subdivided it once more by the tags would get another one.
    refined.creases.clear();
    refined.corners.clear();
    refined.boundary = BoundaryRule::edge_and_corner;
    refined.crease_method = CreaseMethod::uniform;
    refined.triangle_rule = TriangleRule::catmark;
    return refined;
  }
  const auto& volume = std::get<LevelSetSource>(object.source);
  if (local_volume(volume.level_set))
    throw InputError({volume.file, "object", object.name, std::string("cannot be meshed: ") + kLocalVolume, "a .vdb file"});
  return polygons_of(volume.level_set);
}

// Materials are dropped where any of the parts has none: an array covers all faces or does not exist.
void append(Mesh& all, const Mesh& part, const std::string& name) {
  const bool first = all.positions.empty();
  const auto vertex_offset = static_cast<std::int32_t>(all.positions.size());
  const bool normals = (first || !all.corner_normals.empty()) && !part.corner_normals.empty();
  const bool smoothing = (first || !all.face_smoothing.empty()) && !part.face_smoothing.empty();
  const bool colors = (first || !all.vertex_colors.empty()) && !part.vertex_colors.empty();
  const bool materials = (first || !all.face_materials.empty()) && !part.face_materials.empty();
  const auto material_offset = static_cast<std::int32_t>(all.material_names.size());
  for (const std::int32_t hole : part.holes) all.holes.push_back(static_cast<std::int32_t>(all.face_sizes.size()) + hole);
  all.positions.insert(all.positions.end(), part.positions.begin(), part.positions.end());
  all.face_sizes.insert(all.face_sizes.end(), part.face_sizes.begin(), part.face_sizes.end());
  for (const std::int32_t vertex : part.corner_vertices) all.corner_vertices.push_back(vertex_offset + vertex);
  all.face_groups.resize(all.face_sizes.size(), static_cast<std::int32_t>(all.group_names.size()));
  all.group_names.push_back(name);
  const auto join = [](auto& target, const auto& source, bool keep) {
    if (keep)
      target.insert(target.end(), source.begin(), source.end());
    else
      target.clear();
  };
  join(all.corner_normals, part.corner_normals, normals);
  join(all.vertex_colors, part.vertex_colors, colors);
  // Objects share no vertices, so that groups of one number stay apart.
  join(all.face_smoothing, part.face_smoothing, smoothing);
  if (materials) {
    if (!all.material_colors.empty() || !part.material_colors.empty()) {
      all.material_colors.resize(all.material_names.size(), glm::vec3(1.0f));
      all.material_colors.insert(all.material_colors.end(), part.material_colors.begin(), part.material_colors.end());
      all.material_colors.resize(all.material_names.size() + part.material_names.size(), glm::vec3(1.0f));
    }
    for (const std::int32_t material : part.face_materials) all.face_materials.push_back(material_offset + material);
    all.material_names.insert(all.material_names.end(), part.material_names.begin(), part.material_names.end());
  } else {
    all.face_materials.clear();
    all.material_names.clear();
    all.material_colors.clear();
  }
  if (first) {
    all.boundary = part.boundary;
    all.crease_method = part.crease_method;
    all.triangle_rule = part.triangle_rule;
  }
  for (const Crease& crease : part.creases) {
    all.creases.push_back({vertex_offset + crease.vertex_a, vertex_offset + crease.vertex_b, crease.sharpness});
  }
  for (const CornerTag& corner : part.corners) all.corners.push_back({vertex_offset + corner.vertex, corner.sharpness});
}

template <class T>
size_t count_of(const Scene& scene) {
  size_t count = 0;
  for (const SceneObject& object : scene.objects) count += std::holds_alternative<T>(object.source) ? 1 : 0;
  return count;
}

/// A level set made of a volume's mesh has the voxels asked for itself.
bool takes_other_voxels(const SurfaceSettings& settings) { return settings.resample_volumes && settings.kind != "mesh_level_set"; }

/// Distances stay true where a transform keeps angles.
bool keeps_angles(const glm::dmat3& linear) {
  const glm::dmat3 product = glm::transpose(linear) * linear;
  const double scale = (product[0][0] + product[1][1] + product[2][2]) / 3.0;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      if (std::abs(product[i][k] - (i == k ? scale : 0.0)) > 1e-9 * scale) return false;
  return true;
}

double own_voxel_in_world(const LevelSet& level_set, const Affine& placed) {
  const glm::dmat3 axes = placed.linear * level_set.info().world_from_index.linear;
  return std::min({glm::length(axes[0]), glm::length(axes[1]), glm::length(axes[2])});
}

/// One volume where it stands: as it is, moved, or with other voxels.
LevelSet world_volume(const SceneObject& object, const SurfaceSettings& settings, std::vector<std::string>& notes) {
  const auto& source = std::get<LevelSetSource>(object.source);
  const Affine& placed = object.world_from_object;
  if (!settings.resample_volumes && placed.linear == glm::dmat3(1.0) && placed.translation == glm::dvec3(0.0)) return source.level_set;
  if (!settings.resample_volumes && keeps_angles(placed.linear)) return moved(source.level_set, placed);
  SurfaceSettings own = settings;
  if (!settings.resample_volumes) {
    own.voxel_size = own_voxel_in_world(source.level_set, placed);
    own.half_width_voxels = std::max(source.level_set.info().half_width_voxels, find_gradient(own.gradient).half_width_voxels);
  } else if (own.half_width_voxels == 0.0) {
    own.half_width_voxels = std::max(3.0, find_gradient(own.gradient).half_width_voxels);
  }
  const ResampledLevelSet made = resample_volume(object, source, own, placed);
  notes.push_back(object.name + ": " + resampling_words(made));
  return made.level_set;
}

}  // namespace

Mesh world_mesh(const SceneObject& object, const SurfaceSettings& settings, bool refined_positions) {
  const auto* volume = std::get_if<LevelSetSource>(&object.source);
  if (volume != nullptr && takes_other_voxels(settings))
    return polygons_of(resample_volume(object, *volume, settings, object.world_from_object).level_set);
  Mesh mesh = local_mesh(object, settings, refined_positions);
  if (std::holds_alternative<Field>(object.source)) return mesh;
  const Affine& world_from_object = object.world_from_object;
  for (glm::dvec3& position : mesh.positions) position = world_from_object.point(position);
  for (glm::vec3& normal : mesh.corner_normals) {
    const glm::dvec3 turned = world_from_object.normal(normal);
    const double length = glm::length(turned);
    normal = length > 0.0 ? glm::vec3(turned / length) : normal;
  }
  // A mirrored object would come out inside out.
  if (glm::determinant(world_from_object.linear) < 0.0) turn_faces(mesh);
  return mesh;
}

Mesh world_mesh(const Scene& scene, const SurfaceSettings& settings, bool refined_positions, std::vector<std::string>* lost) {
  if (scene.objects.size() == 1) return world_mesh(scene.objects.front(), settings, refined_positions);
  Mesh all;
  size_t normals = 0, smoothing = 0, colors = 0, materials = 0;
  for (const SceneObject& object : scene.objects) {
    const Mesh part = world_mesh(object, settings, refined_positions);
    normals += part.corner_normals.empty() ? 0 : 1;
    smoothing += part.face_smoothing.empty() ? 0 : 1;
    colors += part.vertex_colors.empty() ? 0 : 1;
    materials += part.face_materials.empty() ? 0 : 1;
    append(all, part, object.name);
  }
  const size_t objects = scene.objects.size();
  const std::pair<const char*, size_t> had[] = {
      {"normals", normals}, {"smoothing groups", smoothing}, {"vertex colours", colors}, {"materials", materials}};
  for (const auto& [what, count] : had) {
    if (lost == nullptr || count == 0 || count == objects) continue;
    lost->push_back(fmt::format("{} are not written: {} of {} objects have none, and one mesh has them everywhere or nowhere", what,
                                objects - count, objects));
  }
  return all;
}

Mesh world_local_mesh(const Scene& scene, const SurfaceSettings& settings, const LocalSettings& local, std::vector<std::string>& warnings) {
  const SceneModel model = build_local_model(scene, settings, local);
  Mesh all;
  for (size_t i = 0; i < scene.objects.size(); ++i) {
    Mesh part = model.surfaces[i].polygons->mesh();
    for (glm::dvec3& position : part.positions) position += model.render_origin;
    const std::vector<std::string>& said = model.surfaces[i].info.warnings;
    warnings.insert(warnings.end(), said.begin(), said.end());
    if (scene.objects.size() == 1) return part;
    append(all, part, scene.objects[i].name);
  }
  return all;
}

LevelSetSettings level_set_settings(const SurfaceSettings& settings, const Box& bounds) {
  LevelSetSettings level_set;
  level_set.voxel_size = settings.voxel_size > 0.0 ? settings.voxel_size : bounds.longest_side() / settings.voxels;
  // 3 is what other programs expect of a level set; more only where the gradient asked for needs it.
  level_set.half_width_voxels =
      settings.half_width_voxels > 0.0 ? settings.half_width_voxels : std::max(3.0, find_gradient(settings.gradient).half_width_voxels);
  level_set.max_bytes = settings.max_bytes;
  level_set.progress = settings.progress;
  return level_set;
}

LevelSet world_level_set(const Scene& scene, const SurfaceSettings& settings, std::vector<std::string>& warnings) {
  const size_t fields = count_of<Field>(scene);
  const Box scene_bounds = bounds(scene);
  if (count_of<LevelSetSource>(scene) > 0 && settings.kind != "mesh_level_set") {
    if (scene.objects.size() == 1) {
      std::vector<std::string> notes;
      return world_volume(scene.objects.front(), settings, notes);
    }
    throw InputError({scene.name, "object", "", "volumes beside other objects cannot be written as one level set",
                      "an .obj or .ply, or surface = mesh_level_set, which joins them"});
  }
  if (fields == scene.objects.size() && settings.kind != "mesh_level_set") {
    std::vector<Field> all;
    for (const SceneObject& object : scene.objects) all.push_back(std::get<Field>(object.source));
    return level_set_from_field(combine(Csg::union_, all), level_set_settings(settings, scene_bounds));
  }
  const TriangleMesh triangles = triangulate(world_mesh(scene, settings), NormalKind::flat);
  MeshLevelSet made = level_set_from_mesh(triangles, level_set_settings(settings, scene_bounds));
  warnings.insert(warnings.end(), made.warnings.begin(), made.warnings.end());
  return made.level_set;
}

std::vector<LevelSet> world_level_sets(const Scene& scene, const SurfaceSettings& settings, WorldNotes& said) {
  const bool volumes = count_of<LevelSetSource>(scene) == scene.objects.size() && settings.kind != "mesh_level_set";
  if (!volumes) return {world_level_set(scene, settings, said.warnings)};
  std::vector<LevelSet> level_sets;
  for (const SceneObject& object : scene.objects) {
    const LevelSet& own = std::get<LevelSetSource>(object.source).level_set;
    const bool local = local_volume(own) != nullptr;
    if (local && settings.resample_volumes)
      throw InputError({scene.name, "voxels", "", std::string("have no effect: ") + kLocalVolume, "its own voxels"});
    const std::vector<LevelSet> grids = local ? grids_of(own) : std::vector{world_volume(object, settings, said.notes)};
    level_sets.insert(level_sets.end(), grids.begin(), grids.end());
  }
  return level_sets;
}

}  // namespace limn
