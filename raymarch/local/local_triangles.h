#pragma once
// Internal: triangles that are refined edge by edge, and the surface whose points the middles of edges become.

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "raymarch/local_model.h"

namespace limn {

struct LocalTriangle {
  std::array<std::uint32_t, 3> vertices{};
  std::array<glm::dvec3, 3> normals{};  ///< Of the corners, unit; at a crease those of this side.
  std::array<glm::dvec2, 3> uv{};       ///< Of the corners, in the patch.
  std::int32_t patch = -1;              ///< Of a limit surface.
  std::int32_t face = 0;                ///< Of the mesh that was refined.
  int folded = 0;                       ///< How many of the facets that it is a part of were folded.
};

/// Triangles of an oriented surface: no edge is passed twice in the same direction.
struct LocalTriangles {
  std::vector<glm::dvec3> positions{};  ///< Render space.
  std::vector<glm::vec3> colors{};      ///< One for each position, or empty.
  std::vector<LocalTriangle> triangles{};
};

/// Whether a facet is turned against the normals at one of its corners by more than 80 degrees: it goes across a crease that none of its
/// edges follows, and its parts would do the same.
inline bool is_folded(const std::array<glm::dvec3, 3>& corners, const std::array<glm::dvec3, 3>& normals) {
  constexpr double kCosine = 0.17364817766693033;
  const glm::dvec3 facet = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
  const double least = std::min({glm::dot(facet, normals[0]), glm::dot(facet, normals[1]), glm::dot(facet, normals[2])});
  return least < kCosine * glm::length(facet);
}

/// One side of an edge: the edge of `triangle` that runs from its corner `corner` to the next. Null at an open edge.
struct EdgeSide {
  const LocalTriangle* triangle = nullptr;
  int corner = 0;
};

/// An edge whose middle is asked for. Side 0 runs from the vertex of lower number to the other one.
struct LocalEdge {
  std::array<EdgeSide, 2> sides{};
};

/// The surface's point half way along an edge, or where the edge crosses a crease, and its normal on each side.
struct EdgeMiddle {
  glm::dvec3 position{0.0};
  std::array<glm::dvec3, 2> normals{};
  bool crease = false;  ///< The normal jumps here.
  /// The edge goes from one side of a crease to the other: `position` is where it crosses, wherever along the edge that is.
  bool crosses = false;
  bool halves = true;  ///< False where the edge must stay whole: it would not become shorter.
};

/// A corner of a triangle at a crease, whose normal is that of the triangle's side.
struct CreaseCorner {
  glm::dvec3 position{0.0}, inside{0.0};  ///< Of the corner, and of a point inside the triangle.
};

/// The surface that triangles stand for.
struct LocalSource {
  /// Sizes equal. Called by one thread.
  std::function<void(const LocalTriangles& mesh, std::span<const LocalEdge> edges, std::span<EdgeMiddle> middles)> middles{};
  /// Null where the normals of `middles` are those of their sides even at creases. A normal stays as it is where there is no better one.
  std::function<void(std::span<const CreaseCorner> corners, std::span<glm::dvec3> normals)> crease_normals{};
  /// No chord's middle stands farther off, seen from any of the views, px. Three fourths of kLocalCoarse_px at most.
  double coarse_px = 0.5;
  bool has_parameters = false;  ///< Middles are halves in the surface's parameters: splitting ends, however the surface turns.
  bool has_folds = false;       ///< Edges do not follow all creases: facets that are folded across one are split a few times only.
};

}  // namespace limn
