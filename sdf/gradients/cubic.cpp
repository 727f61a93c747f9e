#include "sdf/gradients/gradients.h"
#include "sdf/gradients/spline_cell.h"

namespace limn {
namespace {

void gradients_of_spline(const LevelSetData& data, std::span<const glm::dvec3> points, std::span<glm::dvec3> gradients) {
  const auto accessor = data.accessor();
  for (size_t i = 0; i < points.size(); ++i) {
    const CellPoint at = cell_point(data.index_from_world.point(points[i]));
    gradients[i] = data.world_gradient(jet_of_spline(spline_coefficients(accessor, at.node), at.local, false).gradient);
  }
}

void values_of_spline(const LevelSetData& data, std::span<const glm::dvec3> points, std::span<double> values) {
  const auto accessor = data.accessor();
  // Points come cell by cell where a grid is resampled.
  nanovdb::Coord cell;
  std::array<double, 64> c;
  for (size_t i = 0; i < points.size(); ++i) {
    const CellPoint at = cell_point(data.index_from_world.point(points[i]));
    if (i == 0 || at.node != cell) {
      c = spline_coefficients(accessor, at.node);
      cell = at.node;
    }
    values[i] = jet_of_spline(c, at.local, false).value;
  }
}

void hessians_of_spline(const LevelSetData& data, std::span<const glm::dvec3> points, std::span<FieldJet> jets) {
  const auto accessor = data.accessor();
  const glm::dmat3& index_from_world = data.index_from_world.linear;
  for (size_t i = 0; i < points.size(); ++i) {
    const CellPoint at = cell_point(data.index_from_world.point(points[i]));
    jets[i] = jet_of_spline(spline_coefficients(accessor, at.node), at.local, true);
    jets[i].gradient = data.world_gradient(jets[i].gradient);
    jets[i].hessian = glm::transpose(index_from_world) * jets[i].hessian * index_from_world;
  }
}

}  // namespace

// The spline reads nodes -1..2 on each axis, at most (2, 2, 2) from the point; each coefficient reads one node further along one axis.
GradientDescriptor cubic_gradient() {
  return {.about = {.name = "cubic",
                    .help = "prefiltered cubic B-spline; smooth to its curvature, needs a wide band",
                    .source = "quasi-interpolation: Condat, Blu, Unser 2005; B-spline: de Boor 1978"},
          .half_width_voxels = std::sqrt(17.0),
          .stencil = box_stencil(-1, 2, true),
          .order = 3,
          .normal_constant = 0.03,
          .gradients = gradients_of_spline,
          .values = values_of_spline,
          .hessians = hessians_of_spline};
}

}  // namespace limn
