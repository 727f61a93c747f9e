#include "sdf/geometry.h"

namespace limn {

Box transform(const Affine& a, const Box& box) {
  if (box.empty() || !box.finite()) return box;
  Box result;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p((corner & 1) ? box.upper.x : box.lower.x, (corner & 2) ? box.upper.y : box.lower.y,
                       (corner & 4) ? box.upper.z : box.lower.z);
    result = include(result, a.point(p));
  }
  return result;
}

}  // namespace limn
