#pragma once
// Parts made of solids by union and difference, as data: limn and its peers make the same part each in their own way.

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "sdf/field.h"

namespace limn {

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

struct SolidPart {
  std::string name{};
  std::vector<PartSolid> solids{};
};

SolidPart torus_part();
SolidPart hub_part();            ///< A disc and a boss with six bores.
SolidPart fused_spheres_part();  ///< 36.
SolidPart honeycomb_part();      ///< A plate with 161 cells.

/// A hexagon that is cut is unbounded along y: it goes through the part.
Field field_of(const SolidPart& part);

}  // namespace limn
