#include <array>

#include "sdf/gradients/gradients.h"

namespace limn {
namespace {

void gradients_of_cells(const LevelSetData& data, std::span<const glm::dvec3> points, std::span<glm::dvec3> gradients) {
  const auto accessor = data.accessor();
  for (size_t i = 0; i < points.size(); ++i) {
    const CellPoint at = cell_point(data.index_from_world.point(points[i]));
    const std::array<double, 8> v = cell_values(accessor, at.node);
    glm::dvec3 gradient(0.0);
    for (int corner = 0; corner < 8; ++corner) {
      glm::dvec3 weight, slope;
      for (int axis = 0; axis < 3; ++axis) {
        const bool upper = (corner >> axis) & 1;
        weight[axis] = upper ? at.local[axis] : 1.0 - at.local[axis];
        slope[axis] = upper ? 1.0 : -1.0;
      }
      gradient += v[static_cast<size_t>(corner)] *
                  glm::dvec3(slope.x * weight.y * weight.z, weight.x * slope.y * weight.z, weight.x * weight.y * slope.z);
    }
    gradients[i] = data.world_gradient(gradient);
  }
}

}  // namespace

// A surface point reaches the far corner of its cell: the diagonal (1, 1, 1).
GradientDescriptor cell_gradient() {
  return {.about = {.name = "cell",
                    .help = "gradient of the trilinear interpolant; facets show",
                    .source = "trilinear interpolation; Parker, Shirley, Livnat, Hansen, Sloan 1998"},
          .half_width_voxels = std::sqrt(3.0),
          .stencil = box_stencil(0, 1, false),
          .order = 1,
          .normal_constant = 0.7,
          .gradients = gradients_of_cells,
          .values = nullptr,
          .hessians = nullptr};
}

}  // namespace limn
