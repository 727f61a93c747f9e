#pragma once
// What is wrong with a mesh, counted: edges, faces, parts, the digits of its coordinates.

#include <cstdint>
#include <span>
#include <vector>

#include "sdf/large_pages.h"
#include "subdiv/mesh.h"

namespace limn {

/// An undirected edge with the faces on it.
struct Edge {
  std::int32_t vertex_a = 0,    ///< As the first face runs along it: from here.
      vertex_b = 0;             ///< To here.
  std::int32_t face_a = -1,     ///< The first face.
      face_b = -1;              ///< The second; -1 at an open edge. Faces beyond the second are only counted.
  std::int32_t face_count = 0;  ///< At least 1.
  bool consistent = true;       ///< The two faces run along it in opposite directions, as on an orientable surface.
};
using Edges = PassingVector<Edge>;  ///< Each edge once.

/// All edges of a mesh, each once.
Edges build_edges(const Mesh& mesh);
/// The same of faces whose corners are at vertices 0, ..., vertex_count - 1.
Edges build_edges(std::span<const std::int32_t> face_sizes, std::span<const std::int32_t> corner_vertices, size_t vertex_count);

/// Connected parts by shared vertices: a part index for each face, and their count.
std::int32_t part_of_faces(const Mesh& mesh, std::vector<std::int32_t>& part);

/// Faces with an angle above this are obtuse: the error of a triangle's normal is bounded by its size only while its largest angle stays
/// away from 180 degrees (Babuska & Aziz 1976). Radians.
inline constexpr double kObtuseAngle = 150.0 * 3.14159265358979323846 / 180.0;

/// Counts and extremes of one mesh. A clean closed mesh has 0 in every count of faults.
struct MeshFacts {
  std::int64_t faces = 0;                   ///< Of the mesh, without holes.
  std::int64_t looked_at = 0;               ///< Of these faces; fewer in sampled_mesh_facts.
  std::int64_t open_edges = 0;              ///< With a face on one side only.
  std::int64_t non_manifold_edges = 0;      ///< With more than two faces.
  std::int64_t inconsistent_edges = 0;      ///< Whose two faces disagree on the outside.
  std::int64_t duplicate_faces = 0;         ///< With the same vertices as another.
  std::int64_t zero_area_faces = 0;         ///< Without area; they count in none of the angles below.
  std::int64_t unused_vertices = 0;         ///< That no face uses.
  std::int64_t extraordinary_vertices = 0;  ///< Valence other than `regular_valence`; half of it and corners on a border are regular.
  int regular_valence = 6;                  ///< 4 where quads prevail.

  std::int64_t parts = 0,           ///< Connected by shared vertices.
      closed_parts = 0;             ///< Every edge has two faces, which agree on the outside.
  std::int64_t inverted_parts = 0;  ///< Of negative volume, closed or with holes too small to doubt it, and not within another part.
  std::int64_t cavities = 0;        ///< Closed, of negative volume, within another part: rightly so.
  double volume = 0.0;              ///< Signed, of the closed parts; the file's units.

  double smallest_angle = 0.0;  ///< Radians, of the faces with an area.
  std::int64_t slivers = 0;     ///< Smallest angle below 1 degree.
  /// Obtuse faces (kObtuseAngle) whose normal is off every neighbour's, as on Schwarz's lantern; slivers in a flat region are not.
  std::int64_t off_normal_faces = 0;
  double off_normal_area_share = 0.0;  ///< 0..1.
  double off_normal_angle = 0.0;       ///< Radians, of the worst: the least angle to a neighbour's normal.

  double median_edge = 0.0;         ///< Length, the file's units.
  double largest_coordinate = 0.0;  ///< Of any component, absolute.
  /// What single precision resolves at `largest_coordinate`; 0 where the coordinates have more digits than that, or are so round that they
  /// lose none by it.
  double coordinate_step = 0.0;
};
/// Of all faces but holes.
MeshFacts mesh_facts(const Mesh& mesh);

/// What `count` faces, spread evenly over the mesh's list of them, and their neighbours tell: counts are of these faces and their edges,
/// and are not scaled; parts, volume and vertices are not looked at. One pass over the mesh; beyond it the time depends on `count` alone.
MeshFacts sampled_mesh_facts(const Mesh& mesh, std::size_t count);

}  // namespace limn
