#include <array>

#include "sdf/gradients/gradients.h"
#include "sdf/gradients/spline_jet.h"

namespace limn {
namespace {

/// Coefficients of the cells that one call's points lie in: points of a batch share cells, where voxels are larger than what lies between
/// them.
class CellCoefficients {
 public:
  explicit CellCoefficients(const LevelSetData& data) : accessor_(data.accessor()) {}

  const SplineCoefficients& at(const nanovdb::Coord& node) {
    const auto low = [](int x) { return static_cast<size_t>(x & 3); };
    Entry& entry = entries_[low(node[0]) * 16 + low(node[1]) * 4 + low(node[2])];
    if (!entry.filled || entry.node != node) entry = {true, node, spline_coefficients(accessor_, node)};
    return entry.coefficients;
  }

 private:
  struct Entry {
    bool filled = false;
    nanovdb::Coord node{};
    SplineCoefficients coefficients;
  };
  nanovdb::FloatGrid::AccessorType accessor_;
  std::array<Entry, 64> entries_;
};

void gradients_of_spline(const LevelSetData& data, std::span<const glm::dvec3> points, std::span<glm::dvec3> gradients) {
  CellCoefficients cells(data);
  for (size_t i = 0; i < points.size(); ++i) {
    const CellPoint at = cell_point(data.index_from_world.point(points[i]));
    gradients[i] = data.world_gradient(slope_of_spline(cells.at(at.node), at.local).gradient);
  }
}

void values_of_spline(const LevelSetData& data, std::span<const glm::dvec3> points, std::span<double> values) {
  CellCoefficients cells(data);
  for (size_t i = 0; i < points.size(); ++i) {
    const CellPoint at = cell_point(data.index_from_world.point(points[i]));
    values[i] = value_of_spline(cells.at(at.node), at.local);
  }
}

void hessians_of_spline(const LevelSetData& data, std::span<const glm::dvec3> points, std::span<FieldJet> jets) {
  CellCoefficients cells(data);
  const glm::dmat3& index_from_world = data.index_from_world.linear;
  for (size_t i = 0; i < points.size(); ++i) {
    const CellPoint at = cell_point(data.index_from_world.point(points[i]));
    jets[i] = spline_jet(cells.at(at.node), at.local);
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
