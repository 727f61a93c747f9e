#pragma once
// Internal: which edges of a triangle pictures ask to be split.

#include "raymarch/local/local_hidden.h"
#include "raymarch/local/local_triangles.h"

namespace limn {

/// A triangle with the middles of its edges; edge k runs from corner k to the next.
struct TriangleSample {
  std::array<std::uint32_t, 3> vertices{};
  std::array<glm::dvec3, 3> corners{}, corner_normals{};
  std::array<glm::dvec3, 3> middles{}, middle_normals{};
  std::array<glm::dvec3, 3> beyond{};  ///< Normals at the middles on the other side of each edge; the own one at an open edge.
  std::array<bool, 3> crease{};        ///< Of the edges.
  std::array<bool, 3> crosses{};       ///< Of the edges: those that go from one side of a crease to the other.
  double coarse_px = 0.5;              ///< LocalSource's.
  bool stays = false;                  ///< Not to be split, whatever the pictures ask, but where it crosses a crease.
  bool unfolds = false;                ///< To be split where it is folded and a picture shows it.
  std::array<bool, 3> halves{};        ///< Of the edges: those that can be split.
};

/// A picture, and what is known to be hidden in it.
struct LocalView {
  Camera camera{};       ///< Render space.
  HiddenParts hidden{};  ///< Empty: nothing.
  /// Of each vertex: how fast N.V changes along the edges of its triangles at most, for each world unit.
  std::vector<double> turns{};
};

/// Bit k is set where edge k must be split: in one of the views its chord would move the border by more than the tolerance, or it stands
/// farther off the surface than any part may. `only_coarse`: for the latter reason only.
unsigned edges_to_split(const TriangleSample& triangle, std::span<const LocalView> views, const LocalSettings& settings, bool only_coarse);

}  // namespace limn
