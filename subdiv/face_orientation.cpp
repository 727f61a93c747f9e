#include "subdiv/face_orientation.h"

#include <algorithm>

#include "subdiv/mesh_parts.h"
#include "subdiv/polygon.h"

namespace limn {
namespace {

/// Faces of the parts with a set flag.
void turn_parts(Mesh& mesh, const std::vector<std::int32_t>& part_of, const std::vector<char>& turned) {
  std::ptrdiff_t first = 0;
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    const std::ptrdiff_t past = first + mesh.face_sizes[f];
    if (turned[static_cast<size_t>(part_of[f])]) {
      std::reverse(mesh.corner_vertices.begin() + first + 1, mesh.corner_vertices.begin() + past);
      if (!mesh.corner_normals.empty()) std::reverse(mesh.corner_normals.begin() + first + 1, mesh.corner_normals.begin() + past);
    }
    first = past;
  }
}

/// Negates the normals of turned parts whose normals, taken together, point against their faces: some programs write the true outside
/// beside a wrong winding.
void turn_normals(Mesh& mesh, const std::vector<std::int32_t>& part_of, const std::vector<char>& turned) {
  if (mesh.corner_normals.empty()) return;
  std::vector<double> along(turned.size(), 0.0);
  std::vector<glm::dvec3> corners;
  const std::vector<std::int32_t> first = first_corners(mesh);
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    gather_corners(mesh, face_corners(mesh, first[f], f), corners);
    const glm::dvec3 area = vector_area(corners);
    for (std::int32_t c = first[f]; c < first[f + 1]; ++c)
      along[static_cast<size_t>(part_of[f])] += glm::dot(area, glm::dvec3(mesh.corner_normals[static_cast<size_t>(c)]));
  }
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    const auto part = static_cast<size_t>(part_of[f]);
    if (!turned[part] || !(along[part] < 0.0)) continue;
    for (std::int32_t c = first[f]; c < first[f + 1]; ++c)
      mesh.corner_normals[static_cast<size_t>(c)] = -mesh.corner_normals[static_cast<size_t>(c)];
  }
}

}  // namespace

void turn_faces(Mesh& mesh) { turn_parts(mesh, std::vector<std::int32_t>(mesh.face_count(), 0), {1}); }

std::int64_t turn_outwards(Mesh& mesh) {
  if (!may_be_inverted(mesh)) return 0;
  const Edges edges = build_edges(mesh);
  MeshParts found = find_parts(mesh, edges);
  if (std::none_of(found.parts.begin(), found.parts.end(), [](const ConnectedPart& part) { return part.inverted; })) return 0;
  double volume = 0.0;
  for (const ConnectedPart& part : found.parts) volume += part.encloses() ? part.volume : 0.0;
  const bool whole = volume < 0.0;
  std::vector<char> turned(found.parts.size(), whole);
  if (whole) {
    turn_parts(mesh, found.of_face, turned);
    found = find_parts(mesh, edges);
  }
  std::vector<char> again(found.parts.size());
  for (size_t i = 0; i < again.size(); ++i) again[i] = found.parts[i].inverted;
  turn_parts(mesh, found.of_face, again);
  for (size_t i = 0; i < again.size(); ++i) turned[i] = turned[i] != again[i];
  turn_normals(mesh, found.of_face, turned);
  return std::count(turned.begin(), turned.end(), 1);
}

}  // namespace limn
