#pragma once
// Parts made of a few solids by union and difference, as data: limn and its peers make the same part each in their own way.

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "raymarch/scene.h"

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

/// 36 spheres fused into one body: every seam and every contour is a circle.
SolidPart fused_spheres_part();

/// A plate with 161 hexagonal cells cut through it: straight edges by the thousand, most of them hidden. `half_height` is the plate's.
SolidPart honeycomb_part(double half_height = 0.09);

/// A hexagon that is cut is unbounded along y: it goes through the part.
Field field_of(const SolidPart& part);

/// That field as one grey object, seen from above at an angle.
Scene scene_of(const SolidPart& part);

}  // namespace limn
