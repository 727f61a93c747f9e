#pragma once
// One polygon of a mesh: its vector area, and its triangles. Shared by normals, triangulation and audit.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "subdiv/mesh.h"

namespace limn {

/// Half the sum of the cross products of successive corners (Newell's method): along the normal of the best-fit plane, as long as the area.
glm::dvec3 vector_area(std::span<const glm::dvec3> corners);

/// The corners of face `face` whose first corner is `first`.
std::span<const std::int32_t> face_corners(const Mesh& mesh, std::int32_t first, std::size_t face);
void gather_corners(const Mesh& mesh, std::span<const std::int32_t> vertices, std::vector<glm::dvec3>& out);

/// True where the area is nothing but rounding: below 1e-14 of the square of the longest edge.
bool zero_area(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);
bool zero_area(std::span<const glm::dvec3> corners);

/// Interior angle at corner `i`, radians in [0, 2 pi): above pi at a reflex corner, as seen along `normal`.
double corner_angle(std::span<const glm::dvec3> corners, std::size_t i, const glm::dvec3& normal);

/// Corner numbers of the polygon's triangles: a fan where it is strictly convex, ear clipping in its best-fit plane otherwise
/// (Meisters 1975). A self-intersecting polygon gives some triangulation of its corners.
void triangulate_polygon(std::span<const glm::dvec3> corners, std::vector<std::array<std::int32_t, 3>>& triangles);

/// Unit normals, one for each corner, averaged over the faces around the vertex with the corner's angle as weight (Thürmer &
/// Wüthrich 1998), separately on each side of sharp edges and in each fan of faces that meet in the vertex alone.
std::vector<glm::vec3> angle_weighted_normals(const Mesh& mesh, const Smoothing& smoothing = {});

/// The mesh without its holes (every array of faces and corners; vertices stay).
Mesh without_holes(const Mesh& mesh);

/// The faces' own unit normals, one for each corner.
std::vector<glm::vec3> face_normals_at_corners(const Mesh& mesh);

/// Sharpness from which a crease or corner never rounds off (OpenSubdiv).
inline constexpr float kInfiniteSharpness = 10.0f;

}  // namespace limn
