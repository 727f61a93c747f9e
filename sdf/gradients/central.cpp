#include <algorithm>
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

/// The interpolant on the line through a place along one axis, at the faces of its cell and of those beside it: -1, 0, 1, 2.
using Section = std::array<double, 4>;

/// Bilinear across, between the four rows of nodes that bound the cell along `axis`.
template <class Accessor>
Section section(const Accessor& accessor, const CellPoint& at, int axis) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  Section result{};
  for (int k = 0; k < 16; ++k) {
    glm::ivec3 node(0);
    node[axis] = k / 4 - 1;
    node[u] = k & 1;
    node[v] = (k >> 1) & 1;
    const double weight = (node[u] ? at.local[u] : 1.0 - at.local[u]) * (node[v] ? at.local[v] : 1.0 - at.local[v]);
    result[static_cast<size_t>(k / 4)] += weight * static_cast<double>(accessor.getValue(at.node.offsetBy(node.x, node.y, node.z)));
  }
  return result;
}

/// By how much a curve through the four stands off its chord at u: half of u (1 - u) times the second difference, of those about 0 and 1
/// the one nearer to zero (Harten, Engquist, Osher, Chakravarthy 1987), so that no kink beside the cell is felt in it.
double sag(const Section& f, double u) {
  const double at_near = f[2] - 2.0 * f[1] + f[0], at_far = f[3] - 2.0 * f[2] + f[1];
  const double bend = std::max(std::min(at_near, at_far), 0.0) + std::min(std::max(at_near, at_far), 0.0);
  return 0.5 * u * (1.0 - u) * bend;
}

void values_less_sag(const LevelSetData& data, std::span<const glm::dvec3> points, std::span<double> values) {
  const auto accessor = data.accessor();
  for (size_t i = 0; i < points.size(); ++i) {
    const CellPoint at = cell_point(data.index_from_world.point(points[i]));
    values[i] = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      const Section f = section(accessor, at, axis);
      const double u = at.local[axis];
      if (axis == 0) values[i] = (1.0 - u) * f[1] + u * f[2];
      values[i] -= sag(f, u);
    }
  }
}

}  // namespace

// From a surface point at one corner of its cell to the neighbour beyond the opposite corner: (2, 1, 1).
GradientDescriptor central_gradient() {
  return {.about = {.name = "central",
                    .help = "central differences at the nodes, interpolated trilinearly; smooth",
                    .source = "Moeller, Machiraju, Mueller, Yagel 1997"},
          .half_width_voxels = std::sqrt(6.0),
          .stencil = box_stencil(0, 1, true),
          .order = 2,
          .normal_constant = 0.23,
          .gradients = gradients_at_nodes,
          .values = values_less_sag,
          .hessians = nullptr};
}

}  // namespace limn
