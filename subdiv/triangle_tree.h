#pragma once
// Internal: which triangles of a mesh come near a box, and how they face.

#include "subdiv/mesh.h"

namespace limn {

/// How the triangles of a part of a mesh face, and how large they are. Empty: lower > upper.
struct FacetBounds {
  glm::dvec3 lower{2.0}, upper{-2.0};  ///< Of each component of their unit normals.
  double longest_edge = 0.0;
  bool empty() const { return lower.x > upper.x; }
};

/// A tree of boxes over a mesh's triangles.
class TriangleTree {
 public:
  TriangleTree() = default;
  explicit TriangleTree(const TriangleMesh& mesh);

  /// Appends the triangles whose boxes meet this one; no order.
  void find(const Box& box, std::vector<std::uint32_t>& found) const;
  /// Whether a triangle meets the box.
  bool any_meets(const TriangleMesh& mesh, const Box& box) const;
  /// Of the triangles whose boxes meet this one.
  FacetBounds facets(const Box& box) const;
  /// Least and most of the dot product of `direction` and the normals of those triangles; lower > upper where there are none.
  Interval facing(const Box& box, const glm::dvec3& direction) const;

 private:
  struct Node {
    Box box{};
    FacetBounds facets{};
    std::uint32_t first = 0, count = 0;  ///< Of a leaf, in leaves_; count 0: not a leaf.
    std::uint32_t right = 0;             ///< The left child follows its parent.
  };
  /// By the order of the leaves.
  struct Leaf {
    Box box{};
    glm::dvec3 normal{0.0};  ///< 0 where the triangle has no area.
    double longest_edge = 0.0;
    std::uint32_t triangle = 0;
  };
  struct Builder;
  /// `visit_node(node, inside)` says whether to look into a node that meets the box; `inside`: all of it lies in the box.
  /// `visit_leaf(leaf)`: false stops.
  template <class VisitNode, class VisitLeaf>
  bool visit(const Box& box, const VisitNode& visit_node, const VisitLeaf& visit_leaf) const;

  std::vector<Node> nodes_{};
  std::vector<Leaf> leaves_{};
};

}  // namespace limn
