#pragma once
// Polygon meshes: as loaded (n-gons, creases, groups kept) and as triangles ready to trace.

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "sdf/geometry.h"

namespace limn {

/// Semi-sharp edge of a subdivision cage; sharpness 0 is smooth, 10 and above is infinitely sharp (OpenSubdiv).
struct Crease {
  std::int32_t vertex_a = 0;  ///< Index into Mesh::positions.
  std::int32_t vertex_b = 0;  ///< Index into Mesh::positions.
  float sharpness = 0.0f;     ///< >= 0.
};
/// Semi-sharp vertex of a subdivision cage; sharpness as for a Crease.
struct CornerTag {
  std::int32_t vertex = 0;  ///< Index into Mesh::positions.
  float sharpness = 0.0f;   ///< >= 0.
};

/// What happens to open edges under subdivision: OpenSubdiv's VTX_BOUNDARY_NONE, EDGE_ONLY, EDGE_AND_CORNER.
enum class BoundaryRule { none, edge_only, edge_and_corner };
/// How semi-sharp creases lose sharpness from level to level: OpenSubdiv's CREASE_UNIFORM and CREASE_CHAIKIN.
enum class CreaseMethod { uniform, chaikin };
/// Weights of triangles under Catmull-Clark: OpenSubdiv's TRI_SUB_CATMARK and TRI_SUB_SMOOTH.
enum class TriangleRule { catmark, smooth };

/// A polygon mesh. Vertices are welded by index only; nothing is merged by position, so what the file says stays as found.
struct Mesh {
  std::vector<glm::dvec3> positions{};          ///< In the file's units and axes.
  std::vector<std::int32_t> face_sizes{};       ///< Corners of each face, >= 3.
  std::vector<std::int32_t> corner_vertices{};  ///< All faces' corners one after the other, counter-clockwise seen from outside.
  std::vector<glm::vec3> corner_normals{};      ///< As found in the file, one for each corner; empty where it has none.
  std::vector<glm::vec3> vertex_colors{};       ///< Linear, one for each vertex; or empty.
  std::vector<std::int32_t> face_materials{};   ///< Index into material_names for each face; or empty.
  std::vector<std::int32_t> face_groups{};      ///< Index into group_names for each face; or empty.
  std::vector<std::string> material_names{};    ///< As in the file; the same name may occur twice.
  std::vector<glm::vec3> material_colors{};  ///< Linear, one for each of material_names; or empty. Vertex colours are multiplied by them.
  std::vector<std::string> group_names{};    ///< As in the file.
  std::vector<Crease> creases{};             ///< Of a cage; empty where the file has none.
  std::vector<CornerTag> corners{};          ///< Of a cage; empty where the file has none.
  BoundaryRule boundary = BoundaryRule::edge_and_corner;  ///< Of a cage.
  CreaseMethod crease_method = CreaseMethod::uniform;     ///< Of a cage.
  TriangleRule triangle_rule = TriangleRule::catmark;     ///< Of a cage.
  std::vector<std::int32_t> holes{};                      ///< Faces of a cage that are refined and not drawn; rising, unique.
  std::vector<std::int32_t> face_smoothing{};  ///< Smoothing group of each face, 0: smooth with no other; or empty: the file has none.
  bool draws_colors = true;                    ///< False: the object's own color is drawn, whatever colours the file has.
  /// What the reader dropped, repaired or ignored, a sentence each with its count; for people, shown once.
  std::vector<std::string> warnings{};

  size_t face_count() const { return face_sizes.size(); }   ///< Holes included.
  size_t vertex_count() const { return positions.size(); }  ///< Unused ones included.
};

/// For each vertex whether a face that is drawn uses it (what no face uses, or holes alone, does not count).
std::vector<char> drawn_vertices(const Mesh& mesh);
/// Names of materials and groups, colours of materials, and whether colours are drawn: what a mesh that is made of another one shares with
/// it, face by face.
void copy_names(const Mesh& from, Mesh& to);
/// The box around the vertices that are drawn, in the file's units; empty where there are none.
Box bounds(const Mesh& mesh);
/// Index of each face's first corner, with one past the end at the back: size face_count() + 1.
std::vector<std::int32_t> first_corners(const Mesh& mesh);

/// Throws InputError (naming `file`) unless every index is in range, every position finite, every face has 3 or more corners,
/// the optional arrays have the right sizes and there is at least one face.
void validate(const Mesh& mesh, const std::string& file);

/// How normals are made: `flat` a face's own; `vertex` averaged by corner angle, split at infinitely sharp creases;
/// `limit` those of the limit surface (subdivision) or of the field (a tessellated shape).
enum class NormalKind { flat, vertex, limit };

/// Across which edges `vertex` normals are averaged, beside infinitely sharp creases, which always split them. Normals split where two or
/// more such edges part the faces around a vertex, so that a single sharp edge of a noisy scan changes nothing.
struct Smoothing {
  double angle_deg = 180.0;  ///< Edges whose faces' normals differ by more are sharp; 180: none.
  bool by_groups = false;    ///< Mesh::face_smoothing, where there is any, in place of the angle: smooth within a group above 0.
};

/// Triangles ready to trace.
struct TriangleMesh {
  std::vector<glm::dvec3> positions{};             ///< In the mesh's units and axes.
  std::vector<glm::uvec3> triangles{};             ///< Counter-clockwise seen from outside.
  std::vector<glm::vec3> corner_normals{};         ///< Unit; three for each triangle, or empty: the facets' own.
  std::vector<std::int32_t> triangle_faces{};      ///< The polygon each came from.
  std::vector<std::int32_t> triangle_materials{};  ///< Or empty.
  std::int64_t dropped_triangles = 0;              ///< Without area; they are in none of the arrays above.
  std::int64_t bytes() const;                      ///< Memory that the arrays hold.
};

/// The polygons of `mesh` as triangles: fans for convex faces, ear clipping for the others; zero-area triangles are dropped and counted.
/// `kind` flat or vertex (limit normals come from subdiv/refine.h, as corner_normals: a mesh's own are used where `use_mesh_normals`).
/// Holes are left out.
TriangleMesh triangulate(const Mesh& mesh, NormalKind kind, bool use_mesh_normals = false, const Smoothing& smoothing = {});
/// With these normals, one for each corner, in place of the mesh's own; none: those of `kind`.
TriangleMesh triangulate(const Mesh& mesh, NormalKind kind, std::span<const glm::vec3> corner_normals, const Smoothing& smoothing = {});

}  // namespace limn
