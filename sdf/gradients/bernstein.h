#pragma once
// Internal: Bernstein coefficients of a spline's cell. A polynomial lies within the convex hull of its own (Farin 2002, section 6.3). In
// floats: bounds have to allow for what these round by.

#include <array>
#include <cstddef>

namespace limn {

/// Numbered as spline coefficients are (spline_place()).
using CellHull = std::array<float, 64>;

constexpr float kHullRounding = 1e-5f;  // of the greatest coefficient, well above what the sums round by
constexpr float kHullThird = 1.0f / 3.0f, kHullSixth = 1.0f / 6.0f;

/// Calls `visit(first place)` of each row of four along the axis with that stride: 16 along x, 4 along y, 1 along z.
template <size_t stride, class Visit>
void for_rows(const Visit& visit) {
  for (size_t outer = 0; outer < 64; outer += 4 * stride)
    for (size_t i = outer; i < outer + stride; ++i) visit(i);
}

template <size_t stride>
void convert_along(CellHull& c) {
  for_rows<stride>([&](size_t i) {
    const float c0 = c[i], c1 = c[i + stride], c2 = c[i + 2 * stride], c3 = c[i + 3 * stride];
    c[i] = kHullSixth * (c0 + 4.0f * c1 + c2);
    c[i + stride] = kHullThird * (2.0f * c1 + c2);
    c[i + 2 * stride] = kHullThird * (c1 + 2.0f * c2);
    c[i + 3 * stride] = kHullSixth * (c1 + 4.0f * c2 + c3);
  });
}
/// From B-spline coefficients, in place.
inline void make_bernstein(CellHull& c) {
  convert_along<16>(c);
  convert_along<4>(c);
  convert_along<1>(c);
}

}  // namespace limn
