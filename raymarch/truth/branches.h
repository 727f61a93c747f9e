#pragma once
// Internal: a field taken apart at its sharp unions and intersections. What is left between them has no seams of CSG, so that a curve is
// followed on it, and where two of them meet, without ever crossing an edge; which of it is surface the tree says.

#include <span>
#include <vector>

#include "sdf/field.h"

namespace limn {

/// The minimum or the maximum of two nodes, or a branch.
struct SharpNode {
  bool maximum = false;
  int left = -1, right = -1;  ///< Nodes; -1 in a branch's.
  int parent = -1;
  int branch = -1;
};

/// Branches carry the signs and offsets of what was above them: inside is negative in all of them.
struct SharpField {
  std::vector<Field> branches{};
  std::vector<SharpNode> nodes{};  ///< Children before parents; the last is the root.
  std::vector<int> node_of{};      ///< Of each branch.
  /// World units: faces of two branches that coincide count as this far apart, the first one outside, so that one of them is the surface:
  /// that of the first object, as in pictures.
  double epsilon = 0.0;
};

/// `extent` is the field's size: the epsilon is 1e-10 of it. `into_faces`: shapes with sharp edges are taken apart too
/// (ShapeFunctions::faces).
SharpField split_branches(const Field& field, double extent, bool into_faces = false);

/// Cut by one more branch, the last one: the body is inside both.
SharpField cut_by(SharpField sharp, const Field& branch);

/// Values of all nodes from those of the branches, an epsilon apart.
void node_values(const SharpField& sharp, std::span<const double> branch_values, std::vector<double>& values);

/// The nodes whose values change with those of some branches, rising; and these alone, what all others have being in `values`.
std::vector<int> nodes_above(const SharpField& sharp, std::span<const size_t> branches);
void update_node_values(const SharpField& sharp, std::span<const double> branch_values, std::span<const int> nodes,
                        std::vector<double>& values);

/// What tells on one node of a way up the tree whether a branch's zeros are on the surface of the whole.
struct MarginSide {
  int node = -1;         ///< The other side's.
  bool maximum = false;  ///< Of the two.
  double own = 0.0;      ///< The branch's own value where it is 0, an epsilon apart.
};
std::vector<MarginSide> margin_sides(const SharpField& sharp, int first, int second = -1);
double surface_margin(std::span<const MarginSide> sides, std::span<const double> values);

/// Where branch `first` is 0 (and `second`, unless it is -1, as well): above 0 where that is on the surface of the whole, below where it is
/// not. As steep as the steepest branch at most. `values` are node_values().
double surface_margin(const SharpField& sharp, std::span<const double> values, int first, int second = -1);

/// Where two branches meet the body is inside both (their seam is an intersection's) or inside either.
bool meet_as_intersection(const SharpField& sharp, int first, int second);

}  // namespace limn
