#pragma once
// Parts made of a few solids by union and difference, as data: limn and its peers make the same part each in their own way.

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "sdf/field.h"

namespace limn::bench {

/// All stand along the y axis.
struct PartSolid {
  enum class Kind {
    sphere,    ///< size.x: radius
    cylinder,  ///< size.x: radius; size.y: half height
    torus,     ///< size.x, size.y: radii of the ring and of the tube
    box,       ///< size: half sides
    hexagon    ///< size.x: from the middle to the sides, the first of which looks along x; size.y: half height, or more
  };
  Kind kind = Kind::sphere;
  glm::dvec3 size{1.0}, center{0.0};
  bool cut = false;  ///< Out of the union of those that are not.
};

struct LinePart {
  std::string name{};
  std::vector<PartSolid> solids{};
};

/// torus, hub (a disc and a boss with six bores), fused_spheres (36), honeycomb (a plate with 161 cells).
std::vector<LinePart> line_parts();

/// A hexagon that is cut is unbounded along y: it goes through the part.
Field field_of(const LinePart& part);

}  // namespace limn::bench
