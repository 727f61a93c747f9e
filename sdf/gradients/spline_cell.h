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
constexpr size_t spline_place(int x, int y, int z) { return static_cast<size_t>((x * 4 + y) * 4 + z); }

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

/// As jet_of_spline()'s, to the bit.
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

/// Value, gradient and (where asked for) Hessian by index coordinates.
inline FieldJet jet_of_spline(const SplineCoefficients& c, const glm::dvec3& local, bool with_hessian) {
  const SplineWeights x = spline_weights(local.x), y = spline_weights(local.y), z = spline_weights(local.z);
  FieldJet jet;
  glm::dmat3& h = jet.hessian;
  for (size_t i = 0; i < 4; ++i)
    for (size_t j = 0; j < 4; ++j) {
      double value = 0.0, first = 0.0, second = 0.0;  // of the row along z
      for (size_t k = 0; k < 4; ++k) {
        const double coefficient = c[(i * 4 + j) * 4 + k];
        value += z.value[k] * coefficient;
        first += z.first[k] * coefficient;
        second += z.second[k] * coefficient;
      }
      jet.value += x.value[i] * y.value[j] * value;
      jet.gradient += glm::dvec3(x.first[i] * y.value[j] * value, x.value[i] * y.first[j] * value, x.value[i] * y.value[j] * first);
      if (!with_hessian) continue;
      h[0][0] += x.second[i] * y.value[j] * value;
      h[1][1] += x.value[i] * y.second[j] * value;
      h[2][2] += x.value[i] * y.value[j] * second;
      h[1][0] += x.first[i] * y.first[j] * value;
      h[2][0] += x.first[i] * y.value[j] * first;
      h[2][1] += x.value[i] * y.first[j] * first;
    }
  h[0][1] = h[1][0];
  h[0][2] = h[2][0];
  h[1][2] = h[2][1];
  return jet;
}

}  // namespace limn
