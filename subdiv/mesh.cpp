#include "subdiv/mesh.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "sdf/error.h"
#include "subdiv/used_vertices.h"

namespace limn {
namespace {

/// OpenSubdiv numbers a face's corners with 16 bits; polygons beyond that are not met outside damaged files.
constexpr std::int32_t kMaxFaceSize = 65535;

[[noreturn]] void refuse(const std::string& file, std::string field, std::string value, std::string problem, std::string expected) {
  throw InputError({file, std::move(field), std::move(value), std::move(problem), std::move(expected)});
}

void check_positions(const Mesh& mesh, const std::string& file) {
  for (size_t v = 0; v < mesh.vertex_count(); ++v) {
    const glm::dvec3& p = mesh.positions[v];
    // Beyond 1e100 products of coordinates overflow, which no later stage could report as well as this one.
    if (std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) && glm::length(p) < 1e100) continue;
    refuse(file, fmt::format("vertex {}", v + 1), fmt::format("{}, {}, {}", p.x, p.y, p.z), "the position is not a finite number",
           "every coordinate must be finite and below 1e100");
  }
}

void check_faces(const Mesh& mesh, const std::string& file) {
  if (mesh.face_sizes.empty()) refuse(file, "", "", "the mesh has no faces", "at least one face with 3 or more corners");
  std::int64_t corners = 0;
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    const std::int32_t size = mesh.face_sizes[f];
    if (size < 3 || size > kMaxFaceSize)
      refuse(file, fmt::format("face {}", f + 1), fmt::format("{} corners", size), "a face with too few or too many corners",
             fmt::format("3 to {} corners", kMaxFaceSize));
    corners += size;
  }
  const auto count = static_cast<std::int64_t>(mesh.corner_vertices.size());
  if (corners != count)
    refuse(file, "faces", fmt::format("{} corners", count), "the number of corners disagrees with the faces' sizes",
           fmt::format("{} corners", corners));
  if (count > std::numeric_limits<std::int32_t>::max())
    refuse(file, "faces", fmt::format("{} corners", count), "too many corners", "fewer than 2^31");
}

void check_index(std::int64_t index, size_t count, const std::string& file, const std::string& field, const char* what) {
  if (index >= 0 && index < static_cast<std::int64_t>(count)) return;
  refuse(file, field, fmt::format("{}", index), fmt::format("{} index out of range", what),
         count == 0 ? std::string("there are none") : fmt::format("0 to {}, counted from 0", count - 1));
}

void check_indices(const Mesh& mesh, const std::string& file) {
  const size_t vertices = mesh.vertex_count();
  size_t corner = 0;
  for (size_t f = 0; f < mesh.face_count(); ++f)
    for (std::int32_t i = 0; i < mesh.face_sizes[f]; ++i, ++corner) {
      const std::int32_t v = mesh.corner_vertices[corner];
      if (v < 0 || static_cast<size_t>(v) >= vertices) check_index(v, vertices, file, fmt::format("face {}", f + 1), "vertex");
    }
}

void check_sharpness(float sharpness, const std::string& file, const std::string& field) {
  if (!(sharpness >= 0.0f) || !std::isfinite(sharpness))
    refuse(file, field, fmt::format("{}", sharpness), "the sharpness is out of range", "0 (smooth) and more; 10 is infinitely sharp");
}

void check_tags(const Mesh& mesh, const std::string& file) {
  for (size_t i = 0; i < mesh.creases.size(); ++i) {
    const std::string field = fmt::format("crease {}", i + 1);
    check_index(mesh.creases[i].vertex_a, mesh.vertex_count(), file, field, "vertex");
    check_index(mesh.creases[i].vertex_b, mesh.vertex_count(), file, field, "vertex");
    check_sharpness(mesh.creases[i].sharpness, file, field);
  }
  for (size_t i = 0; i < mesh.corners.size(); ++i) {
    const std::string field = fmt::format("corner {}", i + 1);
    check_index(mesh.corners[i].vertex, mesh.vertex_count(), file, field, "vertex");
    check_sharpness(mesh.corners[i].sharpness, file, field);
  }
}

void check_size(size_t size, size_t expected, const std::string& file, const char* field, const char* of) {
  if (size != 0 && size != expected)
    refuse(file, field, fmt::format("{}", size), "wrong count", fmt::format("{}, one for each {}, or none", expected, of));
}

void check_names(const std::vector<std::int32_t>& indices, size_t names, const std::string& file, const char* field) {
  for (const std::int32_t index : indices) check_index(index, names, file, field, "name");
}

void check_colors(const std::vector<glm::vec3>& colors, const std::string& file, const char* field) {
  for (const glm::vec3& color : colors)
    if (!std::isfinite(color.x + color.y + color.z))
      refuse(file, field, fmt::format("{}, {}, {}", color.x, color.y, color.z), "a colour is not finite", "numbers from 0 to 1");
}

}  // namespace

std::vector<char> drawn_vertices(const Mesh& mesh) {
  std::vector<char> drawn(mesh.vertex_count(), 0);
  if (mesh.holes.empty()) {
    mark_used(
        mesh.corner_vertices.size(), [&](size_t i) { return mesh.corner_vertices[i]; }, drawn);
    return drawn;
  }
  size_t corner = 0, hole = 0;
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    const bool is_hole = hole < mesh.holes.size() && static_cast<size_t>(mesh.holes[hole]) == f;
    hole += is_hole;
    for (std::int32_t i = 0; i < mesh.face_sizes[f]; ++i, ++corner)
      if (!is_hole) drawn[static_cast<size_t>(mesh.corner_vertices[corner])] = 1;
  }
  return drawn;
}

void copy_names(const Mesh& from, Mesh& to) {
  to.material_names = from.material_names;
  to.material_colors = from.material_colors;
  to.group_names = from.group_names;
  to.draws_colors = from.draws_colors;
}

Box bounds(const Mesh& mesh) {
  return box_of_used(drawn_vertices(mesh), [&](size_t v) { return mesh.positions[v]; });
}

std::vector<std::int32_t> first_corners(const Mesh& mesh) {
  std::vector<std::int32_t> first;
  first.reserve(mesh.face_count() + 1);
  std::int32_t sum = 0;
  for (const std::int32_t size : mesh.face_sizes) first.push_back(sum), sum += size;
  first.push_back(sum);
  return first;
}

void validate(const Mesh& mesh, const std::string& file) {
  if (mesh.vertex_count() > static_cast<size_t>(std::numeric_limits<std::int32_t>::max()))
    refuse(file, "vertices", fmt::format("{}", mesh.vertex_count()), "too many vertices", "fewer than 2^31");
  check_faces(mesh, file);
  check_positions(mesh, file);
  check_indices(mesh, file);
  check_tags(mesh, file);
  check_size(mesh.corner_normals.size(), mesh.corner_vertices.size(), file, "normals", "corner");
  check_size(mesh.vertex_colors.size(), mesh.vertex_count(), file, "colors", "vertex");
  check_size(mesh.face_materials.size(), mesh.face_count(), file, "materials", "face");
  check_size(mesh.face_groups.size(), mesh.face_count(), file, "groups", "face");
  check_names(mesh.face_materials, mesh.material_names.size(), file, "materials");
  check_size(mesh.material_colors.size(), mesh.material_names.size(), file, "material colors", "material");
  check_colors(mesh.material_colors, file, "material colors");
  check_colors(mesh.vertex_colors, file, "colors");
  check_names(mesh.face_groups, mesh.group_names.size(), file, "groups");
  check_size(mesh.face_smoothing.size(), mesh.face_count(), file, "smoothing groups", "face");
  for (size_t i = 0; i < mesh.holes.size(); ++i) {
    check_index(mesh.holes[i], mesh.face_count(), file, "holes", "face");
    if (i > 0 && mesh.holes[i] <= mesh.holes[i - 1])
      refuse(file, "holes", fmt::format("{} after {}", mesh.holes[i], mesh.holes[i - 1]), "the list of holes is not in order",
             "each face once, rising");
  }
  if (mesh.holes.size() == mesh.face_count())
    refuse(file, "holes", fmt::format("{}", mesh.holes.size()), "every face is a hole", "at least one face that is drawn");
}

}  // namespace limn
