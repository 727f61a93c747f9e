#include "sdf/gradients/spline_hull.h"

#include <algorithm>
#include <cmath>

#include "sdf/gradients/bernstein.h"

namespace limn {
namespace {

/// Adds a third of the derivative along an axis times what is linear along it: `l0` at the cell's lower side, `l1` at its upper one.
template <size_t stride>
void add_slope(const CellHull& b, float l0, float l1, CellHull& sum) {
  for_rows<stride>([&](size_t i) {
    const float b1 = b[i + stride], b2 = b[i + 2 * stride], d0 = b1 - b[i], d1 = b2 - b1, d2 = b[i + 3 * stride] - b2;
    sum[i] += d0 * l0;
    sum[i + stride] += kHullThird * (d0 * l1 + 2.0f * d1 * l0);
    sum[i + 2 * stride] += kHullThird * (2.0f * d1 * l1 + d2 * l0);
    sum[i + 3 * stride] += d2 * l1;
  });
}

/// All of one sign, for certain. `size`: how large what was summed up is.
bool has_one_sign(const CellHull& b, float size) {
  const float least = kHullRounding * size;
  if (b[0] > 0.0f) return std::all_of(b.begin(), b.end(), [&](float x) { return x > least; });
  return std::all_of(b.begin(), b.end(), [&](float x) { return x < -least; });
}

float greatest(const CellHull& b) {
  float most = 0.0f;
  for (const float x : b) most = std::max(most, std::fabs(x));
  return most;
}

/// The multiple of `b` that leaves the least variation of `a`.
float common_part(const CellHull& a, const CellHull& b) {
  float sum_a = 0.0f, sum_b = 0.0f, ab = 0.0f, bb = 0.0f;
  for (size_t i = 0; i < a.size(); ++i) sum_a += a[i], sum_b += b[i];
  const float mean_a = sum_a / static_cast<float>(a.size()), mean_b = sum_b / static_cast<float>(b.size());
  for (size_t i = 0; i < a.size(); ++i) ab += (a[i] - mean_a) * (b[i] - mean_b), bb += (b[i] - mean_b) * (b[i] - mean_b);
  return bb > 0.0f ? ab / bb : 0.0f;
}

}  // namespace

bool may_turn_from(const SplineCoefficients& c, const glm::dvec3& node, const SplineTarget& target) {
  CellHull b;
  for (size_t i = 0; i < b.size(); ++i) b[i] = static_cast<float>(c[i]);
  const float size = greatest(b);
  make_bernstein(b);
  if (has_one_sign(b, size)) return false;
  const glm::dvec3 near = target.p - target.w * node;
  const glm::vec3 low(near), high(near - target.w), longest = glm::max(glm::abs(low), glm::abs(high));
  CellHull slope{};
  add_slope<16>(b, low.x, high.x, slope);
  add_slope<4>(b, low.y, high.y, slope);
  add_slope<1>(b, low.z, high.z, slope);
  const float slope_size = 2.0f * size * (longest.x + longest.y + longest.z);
  if (has_one_sign(slope, slope_size)) return false;
  // Both have zeros, but where surface and slope change along the same way not at one place: where both vanish, so do all sums of theirs.
  const float times = common_part(slope, b);
  if (!std::isfinite(times)) return true;
  for (size_t i = 0; i < b.size(); ++i) slope[i] -= times * b[i];
  return !has_one_sign(slope, slope_size + std::fabs(times) * size);
}

}  // namespace limn
