#pragma once
// Bringing the vertices of a mesh onto the surface of a field, creases and corners included.

#include <span>

#include "sdf/field.h"
#include "subdiv/mesh.h"

namespace limn {

struct SnapResult {
  std::vector<char> feature;  ///< For each vertex: it lies on a crease or corner, where the field's gradient jumps.
  double worst_value = 0.0;   ///< Largest |f|/|grad f| left, world units.
};

/// Moves every vertex onto the surface: along the gradient where the surface is smooth, onto the meeting of the tangent planes of both
/// sides (least squares as in Ju et al. 2002) where it is creased. Vertices are moved one by one from where they are, in parallel.
SnapResult snap_to_surface(const Field& field, Mesh& mesh);

/// The same for the vertices that `which` names; `snapped` is brought up to date.
void snap_vertices(const Field& field, Mesh& mesh, const std::vector<char>& which, SnapResult& snapped);

/// Moves vertices onto creases and corners that the faces beside feature vertices cut off: the nearer end of an edge that goes from one
/// side of a crease to the other, and a vertex of a quad that lies across a corner.
void follow_creases(const Field& field, Mesh& mesh, SnapResult& snapped);

/// Quads beside a crease are given the first corner whose diagonal lies nearer to the surface: the other one would cut the crease off.
void turn_quads_along_creases(const Field& field, Mesh& mesh, const std::vector<char>& feature);

/// A quad that turns along a diagonal on a crease becomes two triangles: methods that draw edges find no other place for that crease.
void split_quads_along_creases(const Field& field, Mesh& mesh, const std::vector<char>& feature);

/// The mean of a face's corners.
glm::dvec3 middle_of_face(const Mesh& mesh, std::span<const std::int32_t> corners);

/// The faces' middles, and how far their corners lie from these at most; `first` are the first corners of all faces.
struct FaceMiddles {
  std::vector<glm::dvec3> middles{};
  std::vector<double> radii{};
  FaceMiddles(const Mesh& mesh, const std::vector<std::int32_t>& first);
  /// Of these faces alone, in their order.
  FaceMiddles(const Mesh& mesh, const std::vector<std::int32_t>& first, std::span<const std::int32_t> faces);
};

/// Unit normals at the corners: the gradient at the vertex, at creases that of the corner's own side.
std::vector<glm::vec3> field_normals(const Field& field, const Mesh& mesh, const std::vector<char>& feature);

/// Faces whose normal disagrees with the gradient at their middle by more than a right angle; with `reflex_too` also those with a corner
/// that is turned over or reflex.
std::vector<std::int32_t> folded_faces(const Field& field, const Mesh& mesh, bool reflex_too = false);

/// Vertices of folded faces moved to the middle of their neighbours (creased ones stay), then snapped again; at most `rounds` times. Of all
/// faces, or of those at the vertices that `moved` marks.
void unfold(const Field& field, Mesh& mesh, SnapResult& snapped, int rounds, const std::vector<char>* moved = nullptr);

/// All smooth vertices moved half way to the middle of their neighbours and snapped again: evens out a cage.
void relax(const Field& field, Mesh& mesh, SnapResult& snapped, int rounds);

/// The point that is nearest to all planes (point, unit normal) in the least squares sense; in directions that they leave open, nearest to
/// `start`. Directions with singular values below a tenth of the largest count as open.
glm::dvec3 meet_planes(const std::vector<glm::dvec3>& points, const std::vector<glm::dvec3>& normals, const glm::dvec3& start);

}  // namespace limn
