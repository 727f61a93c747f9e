#pragma once
// A field from samples on a grid.

#include <vector>

#include "sdf/field.h"

namespace limn::python {

/// Samples at origin + spacing * (i, j, k).
struct GridSamples {
  std::vector<float> values{};  ///< x slowest: index (i * count.y + j) * count.z + k. Negative inside.
  glm::ivec3 count{0};          ///< At least 2 each.
  glm::dvec3 origin{0.0};       ///< World, of sample (0, 0, 0).
  double spacing = 1.0;         ///< World, above 0.
};

/// The trilinear interpolant; beyond the grid the value at its nearest point. The Lipschitz constant is that of the samples' differences.
/// Throws InputError where a sample on the grid's faces is not above 0: the surface must end within.
Field field_from_grid(GridSamples samples);

}  // namespace limn::python
