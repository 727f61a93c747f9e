#pragma once
// Internal: the prefiltered cubic B-spline of a grid, cell by cell.

#include <array>

#include "sdf/level_set_data.h"

namespace limn {

/// Uniform cubic B-spline over the nodes -1, 0, 1, 2 at local place u: values, first and second derivatives (de Boor 1978).
struct SplineWeights {
  std::array<double, 4> value, first, second;
};
inline SplineWeights spline_weights(double u) {
  const double v = 1.0 - u;
  return {.value = {v * v * v / 6.0, 2.0 / 3.0 - u * u * (1.0 - 0.5 * u), 2.0 / 3.0 - v * v * (1.0 - 0.5 * v), u * u * u / 6.0},
          .first = {-0.5 * v * v, u * (1.5 * u - 2.0), v * (2.0 - 1.5 * v), 0.5 * u * u},
          .second = {v, 3.0 * u - 2.0, 3.0 * v - 2.0, u}};
}

/// Of the 4 x 4 x 4 nodes about a cell, by spline_place().
using SplineCoefficients = std::array<double, 64>;
constexpr size_t spline_place(int x, int y, int z) {
  const int place = (x * 4 + y) * 4 + z;
  return static_cast<size_t>(place);
}

/// The spline's coefficient at a node, from values in rows of `row` along z, in planes of as many rows:
/// c = f - (second differences of f along the three axes) / 6. The sum of the three in place of the full product still reproduces every
/// polynomial of degree 3, which is all that third order in the gradient takes (quasi-interpolation: Condat, Blu, Unser 2005), and it
/// reads axis neighbours only.
template <int row>
double spline_coefficient(const double* f) {
  const double neighbours = f[-row * row] + f[row * row] + f[-row] + f[row] + f[-1] + f[1];
  return 2.0 * f[0] - neighbours / 6.0;
}

/// Spline coefficients at the 4 x 4 x 4 nodes about a cell.
template <class Accessor>
SplineCoefficients spline_coefficients(const Accessor& accessor, const nanovdb::Coord& node) {
  std::array<double, 216> f;  // nodes -2..3; the far corners of the block are never needed
  const auto index = [](int x, int y, int z) {
    const int place = (x * 6 + y) * 6 + z;
    return static_cast<size_t>(place);
  };
  for (int x = 0; x < 6; ++x)
    for (int y = 0; y < 6; ++y)
      if (x % 5 != 0 || y % 5 != 0) row_values(accessor, node.offsetBy(x - 2, y - 2, -2), 6, &f[index(x, y, 0)]);
  SplineCoefficients c;
  for (int x = 0; x < 4; ++x)
    for (int y = 0; y < 4; ++y)
      for (int z = 0; z < 4; ++z) c[spline_place(x, y, z)] = spline_coefficient<6>(&f[index(x + 1, y + 1, z + 1)]);
  return c;
}

/// As slope_of_spline()'s, to the bit.
inline double value_of_spline(const SplineCoefficients& c, const glm::dvec3& local) {
  const SplineWeights x = spline_weights(local.x), y = spline_weights(local.y), z = spline_weights(local.z);
  double sum = 0.0;
  for (size_t i = 0; i < 4; ++i)
    for (size_t j = 0; j < 4; ++j) {
      double value = 0.0;  // of the row along z
      for (size_t k = 0; k < 4; ++k) value += z.value[k] * c[(i * 4 + j) * 4 + k];
      sum += x.value[i] * y.value[j] * value;
    }
  return sum;
}

/// Two numbers at once, for the plain instructions of every machine.
using SplinePair = double __attribute__((vector_size(16)));

/// Value and gradient by index coordinates. spline_jet() has the Hessian, too, and sums in another order: pictures keep these bits.
inline FieldJet slope_of_spline(const SplineCoefficients& c, const glm::dvec3& local) {
  const SplineWeights x = spline_weights(local.x), y = spline_weights(local.y), z = spline_weights(local.z);
  SplinePair of_value_x{}, of_y_z{};
  for (size_t i = 0; i < 4; ++i)
    for (size_t j = 0; j < 4; ++j) {
      const double* const row = &c[(i * 4 + j) * 4];
      SplinePair value_first{};  // of the row along z
      for (size_t k = 0; k < 4; ++k) value_first += SplinePair{z.value[k], z.first[k]} * row[k];
      const SplinePair plain = SplinePair{x.value[i], x.first[i]} * y.value[j];
      of_value_x += plain * value_first[0];
      of_y_z += SplinePair{x.value[i] * y.first[j], plain[0]} * value_first;
    }
  FieldJet jet;
  jet.value = of_value_x[0];
  jet.gradient = {of_value_x[1], of_y_z[0], of_y_z[1]};
  return jet;
}

}  // namespace limn
