#pragma once
// Internal: bodies by sharp CSG of solids with closed forms, and the space around them cut into cells in which few of these matter
// (Woodwark & Quinlan 1982).

#include <optional>
#include <span>
#include <vector>

#include "raymarch/lines/form_surface.h"
#include "sdf/field.h"

namespace limn {

/// The union or intersection of two nodes, or one side of a surface.
struct FormNode {
  bool intersection = false;
  int left = -1, right = -1;
  int surface = -1;
};
/// What of the CSG is undecided somewhere in a box: children before parents, the last one the root. Without nodes all is on one side.
struct FormTree {
  std::vector<FormNode> nodes{};
  bool inside = false;  ///< Where there are no nodes.
};

struct FormCell {
  Box box{};
  int lower = -1, upper = -1;  ///< Cells; -1 where it is not cut.
  FormTree tree{};             ///< Valid in the box.
};

struct FormBody {
  double extent = 1.0;
  std::vector<FormSurface> surfaces{};
  std::vector<FormCell> cells{};  ///< The first holds the whole body.
};

/// `body` in solver space; nothing where a part of it has no closed form, or no bounds.
std::optional<FormBody> form_body(const Field& body);

/// What of the CSG is undecided in `box`. Empty outside the body's own box.
FormTree tree_in(const FormBody& body, const Box& box);
/// The tree of the cell that holds a point, or of the one next to it.
const FormTree& tree_at(const FormBody& body, const glm::dvec3& p);

/// Sees each node's surface as inside, outside, or left open: bits 0..3 say the outcome for the four sides of two open surfaces, bit 0
/// where neither is inside, bit 1 where `second` is, bit 2 where `first` is, bit 3 where both are.
unsigned outcomes(const FormBody& body, const FormTree& tree, const glm::dvec3& p, int first, int second, std::vector<unsigned>& scratch);

}  // namespace limn
