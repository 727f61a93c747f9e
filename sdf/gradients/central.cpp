#include <array>

#include "sdf/gradients/gradients.h"

namespace limn {
namespace {

template <class Accessor>
glm::dvec3 difference(const Accessor& accessor, const nanovdb::Coord& node) {
  const auto value = [&](int x, int y, int z) { return static_cast<double>(accessor.getValue(node.offsetBy(x, y, z))); };
  return 0.5 * glm::dvec3(value(1, 0, 0) - value(-1, 0, 0), value(0, 1, 0) - value(0, -1, 0), value(0, 0, 1) - value(0, 0, -1));
}

void gradients_at_nodes(const LevelSetData& data, std::span<const glm::dvec3> points, std::span<glm::dvec3> gradients) {
  const auto accessor = data.accessor();
  for (size_t i = 0; i < points.size(); ++i) {
    const CellPoint at = cell_point(data.index_from_world.point(points[i]));
    glm::dvec3 gradient(0.0);
    for (int corner = 0; corner < 8; ++corner) {
      const int x = corner & 1, y = (corner >> 1) & 1, z = (corner >> 2) & 1;
      const double weight = (x ? at.local.x : 1.0 - at.local.x) * (y ? at.local.y : 1.0 - at.local.y) * (z ? at.local.z : 1.0 - at.local.z);
      gradient += weight * difference(accessor, at.node.offsetBy(x, y, z));
    }
    gradients[i] = data.world_gradient(gradient);
  }
}

}  // namespace

// From a surface point at one corner of its cell to the neighbour beyond the opposite corner: (2, 1, 1).
GradientDescriptor central_gradient() {
  return {.about = {.name = "central",
                    .help = "central differences at the nodes, interpolated trilinearly; smooth",
                    .source = "Moeller, Machiraju, Mueller, Yagel 1997"},
          .half_width_voxels = std::sqrt(6.0),
          .order = 2,
          .gradients = gradients_at_nodes,
          .hessians = nullptr};
}

}  // namespace limn
