#include "subdiv/read_gltf.h"

#include <fmt/format.h>

#include <algorithm>

#include "subdiv/gltf/primitives.h"
#include "subdiv/repair_faces.h"

namespace limn {
namespace {

using namespace gltf;

void tell(std::int64_t count, const char* one, const char* many, Mesh& mesh) {
  if (count > 0) mesh.warnings.push_back(fmt::format("{} {}", count, count == 1 ? one : many));
}

void tell_what_is_missing(const Gathered& all, Mesh& mesh) {
  tell(all.out_of_range, "face names a vertex that does not exist and was dropped",
       "faces name vertices that do not exist and were dropped", mesh);
  tell(all.left_over, "corner beyond the last whole triangle was dropped", "corners beyond the last whole triangles were dropped", mesh);
  tell(all.points_and_lines, "part made of points or lines is not drawn", "parts made of points or lines are not drawn", mesh);
  tell(all.without_positions, "part without positions is not drawn", "parts without positions are not drawn", mesh);
  tell(all.unused_attributes, "list of normals or colours does not fit its vertices and was ignored",
       "lists of normals or colours do not fit their vertices and were ignored", mesh);
  if (all.missing_material) mesh.warnings.emplace_back("some parts name a material that does not exist");
  if (all.textures) mesh.warnings.emplace_back("textures are not drawn; base colours are");
  if (all.skins)
    mesh.warnings.emplace_back(
        "skins are not applied: their meshes stand where their nodes put them, in the pose of their vertices, which may be another place "
        "and size");
  if (all.morphs) mesh.warnings.emplace_back("morph targets are drawn with the file's own weights, animations are not played");
}

/// What is the same all over says nothing.
void keep_what_differs(Gathered& all) {
  Mesh& mesh = all.mesh;
  const auto used = [&](auto&& test) {
    return std::any_of(mesh.face_materials.begin(), mesh.face_materials.end(),
                       [&](std::int32_t m) { return test(static_cast<size_t>(m)); });
  };
  const bool colored = used([&](size_t m) { return all.materials.colors[m] != glm::vec3(1.0f); });
  const auto last = static_cast<std::int32_t>(all.materials.names.size()) - 1;
  if (!used([&](size_t m) { return static_cast<std::int32_t>(m) == last; }))
    all.materials.names.pop_back(), all.materials.colors.pop_back();
  if (all.materials.names.size() >= 2 || colored) mesh.material_names = std::move(all.materials.names);
  if (mesh.material_names.empty()) mesh.face_materials.clear();
  if (colored) mesh.material_colors = std::move(all.materials.colors);
  if (mesh.group_names.size() < 2) mesh.group_names.clear(), mesh.face_groups.clear();
  if (!mesh.vertex_colors.empty()) mesh.vertex_colors.resize(mesh.positions.size(), glm::vec3(1.0f));
}

std::string nothing_drawn(const Gathered& all) {
  std::string text = "the mesh has no faces";
  if (all.out_of_range > 0) text += fmt::format("; faces that name vertices out of range: {}", all.out_of_range);
  if (all.points_and_lines > 0) text += fmt::format("; parts made of points or lines: {}", all.points_and_lines);
  if (all.without_positions > 0) text += fmt::format("; parts without positions: {}", all.without_positions);
  return text;
}

}  // namespace

std::optional<Mesh> parse_gltf(std::span<const std::byte> bytes, const std::filesystem::path& folder, std::int64_t max_elements) {
  const Container container = open_container(bytes);
  if (container.version == 1) return std::nullopt;
  Document document;
  document.root = parse_json(container.json);
  if (is_version_1(container, document.root)) return std::nullopt;
  document.folder = folder;
  document.binary = container.binary;
  document.has_binary = container.has_binary;
  document.max_elements = max_elements;
  check_version_and_extensions(document.root, document.warnings);
  Gathered all;
  all.materials = read_materials(document.root);
  for (const PlacedMesh& placed : placed_meshes(document)) gather(document, placed, all);
  if (all.mesh.face_sizes.empty()) refuse("", nothing_drawn(all), "a scene with at least one triangle");
  all.mesh.warnings = std::move(document.warnings);
  tell_what_is_missing(all, all.mesh);
  repair_faces(all.mesh, {.keep_equal = true});
  keep_what_differs(all);
  return std::move(all.mesh);
}

std::optional<Mesh> read_gltf(const std::filesystem::path& file, std::int64_t max_elements) {
  const MappedFile mapped(file, "");
  return parse_gltf(mapped.bytes(), file.parent_path(), max_elements);
}

}  // namespace limn
