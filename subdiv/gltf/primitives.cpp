#include "subdiv/gltf/primitives.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "subdiv/gltf/accessor.h"

namespace limn::gltf {
namespace {

enum Mode : std::uint64_t { kTriangles = 4, kStrip = 5, kFan = 6 };

/// What the vertices of a primitive are made from: primitives with the same share them.
using VertexKey = std::tuple<std::uint64_t, std::int64_t, const Json*>;
struct SharedVertices {
  size_t first = 0, count = 0;
};

struct Part {
  const Json& primitive;
  std::string where;
  glm::dmat4 world_from_mesh{1.0};
  std::vector<double> weights{};  ///< Of morph targets.
};

/// Room for more, so that many small parts do not copy all that is there each time.
template <class T>
void grow(std::vector<T>& values, size_t more) {
  if (values.capacity() - values.size() < more) values.reserve(std::max(values.size() + more, 2 * values.capacity()));
}

void count(Document& document, std::uint64_t more, Gathered& all) {
  all.elements += static_cast<std::int64_t>(std::min<std::uint64_t>(more, std::uint64_t{1} << 62));
  if (more > std::uint64_t{1} << 40 || all.elements > document.max_elements)
    refuse("", "more vertices and corners than allowed", fmt::format("at most {}", document.max_elements));
}

std::optional<std::uint64_t> attribute(const Json& primitive, const char* name, const std::string& where) {
  const Json* attributes = find_object(primitive, "attributes");
  return attributes ? whole_number(*attributes, name, where + ".attributes") : std::nullopt;
}

void check_draco(const Document& document, const Part& part, std::uint64_t positions) {
  const Json* extensions = find_object(part.primitive, "extensions");
  if (!extensions || !find(*extensions, "KHR_draco_mesh_compression")) return;
  const Json* accessor = find_element(document.root, "accessors", positions);
  if (accessor && (find(*accessor, "bufferView") || find(*accessor, "sparse"))) return;  // plain data beside the compressed ones
  refuse(part.where, "the mesh is compressed with Draco, which is not read",
         "a file that is not compressed with Draco (exporters have a switch for it)", "KHR_draco_mesh_compression");
}

/// Adds the morph targets' differences of one attribute, as the file weights them.
void add_morphs(Document& document, const Part& part, const char* name, Elements& base) {
  for (size_t i = 0; i < part.weights.size(); ++i) {
    const Json* target = find_element(part.primitive, "targets", i);
    if (part.weights[i] == 0.0 || !target) continue;
    const std::string where = part.where + "." + element("targets", i);
    const auto accessor = whole_number(*target, name, where);
    if (!accessor) continue;
    const Elements moved = read_elements(document, *accessor, where + "." + name);
    if (moved.count != base.count || moved.components != base.components)
      refuse(where + "." + name, "of a wrong length", "one for each vertex");
    for (size_t k = 0; k < base.values.size(); ++k) base.values[k] += part.weights[i] * moved.values[k];
  }
}

glm::vec3 color_of(const Elements& colors, size_t i) {
  glm::vec3 color(1.0f);
  for (int k = 0; k < 3; ++k) {
    const double value = colors.values[i * colors.stride() + static_cast<size_t>(k)];
    color[k] = std::isfinite(value) ? static_cast<float>(std::clamp(value, 0.0, 1.0)) : 1.0f;
  }
  return color;
}

void add_colors(Document& document, const Part& part, size_t first, size_t vertices, Gathered& all) {
  Mesh& mesh = all.mesh;
  const auto accessor = attribute(part.primitive, "COLOR_0", part.where);
  if (accessor && components_of(document, *accessor) >= 3 && count_of(document, *accessor) == vertices) {
    const Elements colors = read_elements(document, *accessor, part.where + ".attributes.COLOR_0");
    mesh.vertex_colors.resize(first, glm::vec3(1.0f));
    grow(mesh.vertex_colors, vertices);
    for (size_t i = 0; i < vertices; ++i) mesh.vertex_colors.push_back(color_of(colors, i));
  } else {
    all.unused_attributes += accessor.has_value();
    if (!mesh.vertex_colors.empty()) mesh.vertex_colors.resize(first + vertices, glm::vec3(1.0f));
  }
}

SharedVertices add_vertices(Document& document, const Part& part, std::uint64_t accessor, Gathered& all) {
  Elements positions = read_elements(document, accessor, part.where + ".attributes.POSITION");
  if (positions.components != 3) refuse(part.where + ".attributes.POSITION", "of a wrong type", "VEC3");
  add_morphs(document, part, "POSITION", positions);
  count(document, positions.count, all);
  const SharedVertices added{all.mesh.positions.size(), positions.count};
  const glm::dmat4& m = part.world_from_mesh;
  grow(all.mesh.positions, positions.count);
  // Not multiplied by an identity, each number stays what it is: a -0, too, and an infinity beside a finite number.
  const bool identity = m == glm::dmat4(1.0);
  for (size_t i = 0; i < positions.count; ++i)
    all.mesh.positions.push_back(identity ? positions.vec3(i) : glm::dvec3(m * glm::dvec4(positions.vec3(i), 1.0)));
  add_colors(document, part, added.first, added.count, all);
  return added;
}

/// The corners of the primitive's triangles, three each, before anything is known of whether they exist.
std::vector<std::uint32_t> corners_of(Document& document, const Part& part, std::uint64_t mode, size_t vertices, Gathered& all) {
  std::vector<std::uint32_t> list;
  if (const auto indices = whole_number(part.primitive, "indices", part.where)) {
    list = read_indices(document, *indices, part.where + ".indices");
  } else {
    list.resize(vertices);
    for (size_t i = 0; i < vertices; ++i) list[i] = static_cast<std::uint32_t>(i);
  }
  if (mode == kTriangles) {
    all.left_over += static_cast<std::int64_t>(list.size() % 3);
    list.resize(list.size() / 3 * 3);
    return list;
  }
  std::vector<std::uint32_t> triangles;
  triangles.reserve(3 * list.size());
  for (size_t i = 0; i + 2 < list.size(); ++i) {
    std::uint32_t a = list[i], b = list[i + 1];
    const std::uint32_t c = list[i + 2];
    if (mode == kFan) a = list[0];
    if (mode == kStrip && i % 2 == 1) std::swap(a, b);
    // Strips are sewn together by triangles without area.
    if (a != b && b != c && a != c) triangles.insert(triangles.end(), {a, b, c});
  }
  return triangles;
}

/// Turns normals with the mesh. The matrix of cofactors has the same directions as the inverse's transpose, and exists always.
glm::dmat3 normal_matrix(const glm::dmat4& m) {
  const glm::dvec3 x(m[0]), y(m[1]), z(m[2]);
  const glm::dmat3 cofactors(glm::cross(y, z), glm::cross(z, x), glm::cross(x, y));
  return glm::dot(x, cofactors[0]) < 0.0 ? -cofactors : cofactors;
}

std::vector<glm::vec3> read_normals(Document& document, const Part& part, size_t vertices, Gathered& all) {
  const auto accessor = attribute(part.primitive, "NORMAL", part.where);
  if (!accessor) return {};
  if (components_of(document, *accessor) != 3 || count_of(document, *accessor) != vertices) {
    ++all.unused_attributes;
    return {};
  }
  Elements values = read_elements(document, *accessor, part.where + ".attributes.NORMAL");
  add_morphs(document, part, "NORMAL", values);
  const bool identity = part.world_from_mesh == glm::dmat4(1.0);
  const glm::dmat3 turned = normal_matrix(part.world_from_mesh);
  std::vector<glm::vec3> normals(vertices);
  for (size_t i = 0; i < vertices; ++i) {
    const glm::dvec3 n = identity ? values.vec3(i) : turned * values.vec3(i);
    const double size = glm::length(n);
    // One that is none is left to the face.
    normals[i] = size > 0.0 && std::isfinite(size) ? glm::vec3(n / size) : glm::vec3(0.0f);
  }
  return normals;
}

std::int32_t material_of(const Part& part, Gathered& all) {
  bool wrong = false;
  const auto last = static_cast<std::int32_t>(all.materials.names.size()) - 1;
  const auto named = lenient_number(part.primitive, "material", wrong);
  const bool known = named && *named < static_cast<std::uint64_t>(last);
  all.missing_material |= wrong || (named && !known);
  const std::int32_t material = known ? static_cast<std::int32_t>(*named) : last;
  all.textures |= all.materials.textured[static_cast<size_t>(material)] != 0;
  return material;
}

void add_triangles(Document& document, const Part& part, std::uint64_t mode, const SharedVertices& vertices, std::int32_t group,
                   Gathered& all) {
  const std::vector<std::uint32_t> corners = corners_of(document, part, mode, vertices.count, all);
  const std::vector<glm::vec3> normals = read_normals(document, part, vertices.count, all);
  count(document, corners.size(), all);
  Mesh& mesh = all.mesh;
  const size_t corners_before = mesh.corner_vertices.size();
  if (!normals.empty()) {
    mesh.corner_normals.resize(corners_before, glm::vec3(0.0f));
    grow(mesh.corner_normals, corners.size());
  }
  grow(mesh.corner_vertices, corners.size());
  // A mirrored part would be turned inside out.
  const bool mirrored = glm::determinant(glm::dmat3(part.world_from_mesh)) < 0.0;
  const std::int32_t material = material_of(part, all);
  size_t faces = 0;
  for (size_t i = 0; i < corners.size(); i += 3) {
    const std::uint32_t abc[3] = {corners[i], corners[mirrored ? i + 2 : i + 1], corners[mirrored ? i + 1 : i + 2]};
    if (abc[0] >= vertices.count || abc[1] >= vertices.count || abc[2] >= vertices.count) {
      ++all.out_of_range;
      continue;
    }
    ++faces;
    for (const std::uint32_t v : abc) {
      mesh.corner_vertices.push_back(static_cast<std::int32_t>(vertices.first + v));
      if (!normals.empty()) mesh.corner_normals.push_back(normals[v]);
    }
  }
  if (normals.empty() && !mesh.corner_normals.empty()) mesh.corner_normals.resize(mesh.corner_vertices.size(), glm::vec3(0.0f));
  mesh.face_sizes.resize(mesh.face_sizes.size() + faces, 3);
  mesh.face_materials.resize(mesh.face_sizes.size(), material);
  mesh.face_groups.resize(mesh.face_sizes.size(), group);
}

std::vector<double> morph_weights(const Json* node, const Json& mesh) {
  std::vector<double> weights;
  const Json* list = node ? find(*node, "weights") : nullptr;
  if (!list) list = find(mesh, "weights");
  if (!list || !list->is_array()) return weights;
  for (const Json& item : *list) weights.push_back(item.is_number() && std::isfinite(item.get<double>()) ? item.get<double>() : 0.0);
  return weights;
}

}  // namespace

void gather(Document& document, const PlacedMesh& placed, Gathered& all) {
  const Json* mesh = find_element(document.root, "meshes", placed.mesh);
  const Json* node = placed.node ? find_element(document.root, "nodes", *placed.node) : nullptr;
  if (!mesh)
    refuse(placed.node ? element("nodes", *placed.node) : "meshes", "there is no such mesh",
           fmt::format("{} meshes", length(document.root, "meshes")), fmt::format("{}", placed.mesh));
  const std::string at = element("meshes", placed.mesh);
  const Json* primitives = find(*mesh, "primitives");
  if (!primitives || !primitives->is_array()) refuse(at + ".primitives", "not a list", "a list of primitives");
  if (node && find(*node, "skin")) all.skins = true;
  std::string name = node ? text(*node, "name") : std::string();
  if (name.empty()) name = text(*mesh, "name");
  if (name.empty()) name = fmt::format("mesh {}", placed.mesh);

  std::map<VertexKey, SharedVertices> shared;
  for (size_t i = 0; i < primitives->size(); ++i) {
    const Part part{(*primitives)[i], at + "." + element("primitives", i), placed.world_from_mesh, morph_weights(node, *mesh)};
    const std::uint64_t mode = whole_number(part.primitive, "mode", part.where).value_or(kTriangles);
    const auto positions = attribute(part.primitive, "POSITION", part.where);
    if (mode < kTriangles || mode > kFan) {
      ++all.points_and_lines;
      continue;
    }
    if (!positions) {
      ++all.without_positions;
      continue;
    }
    check_draco(document, part, *positions);
    const Json* targets = find(part.primitive, "targets");
    all.morphs |= targets != nullptr;
    const auto color = attribute(part.primitive, "COLOR_0", part.where);
    const VertexKey key{*positions, color ? static_cast<std::int64_t>(*color) : -1, targets};
    auto known = shared.find(key);
    if (known == shared.end()) known = shared.emplace(key, add_vertices(document, part, *positions, all)).first;
    const auto group = static_cast<std::int32_t>(all.mesh.group_names.size());
    all.mesh.group_names.push_back(name);
    add_triangles(document, part, mode, known->second, group, all);
  }
}

}  // namespace limn::gltf
