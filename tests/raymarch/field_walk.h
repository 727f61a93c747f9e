#pragma once
// One ray against a field, in double, by nothing but the field's own values and bounds: slow, and independent of tapes, beams and SIMD.

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#include "sdf/field.h"

namespace limn::test {

struct WalkSettings {
  double extent = 1.0;        ///< World units: resolutions are shares of it.
  double resolution = 1e-11;  ///< Stretches are not divided below this share.
};

/// The root of f in [a, b], whose ends differ in sign.
inline double bisect_root(FieldEvaluator& field, const glm::dvec3& o, const glm::dvec3& d, double a, double b) {
  const bool before = field.value(o + a * d) > 0.0;
  for (int halving = 0; halving < 200; ++halving) {
    const double middle = 0.5 * (a + b);
    if (middle <= a || middle >= b) break;
    ((field.value(o + middle * d) > 0.0) == before ? a : b) = middle;
  }
  return 0.5 * (a + b);
}

/// Where o + t d first meets the surface in [t, end]: t itself where f is 0 there; infinity where it does not.
inline double walk_field(FieldEvaluator& field, const glm::dvec3& o, const glm::dvec3& d, double t, double end, const WalkSettings& how) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const double lipschitz = field.field().traits().lipschitz * (1.0 + 1e-6), least = how.resolution * how.extent;
  double f = field.value(o + t * d);
  const bool outside = f > 0.0;
  double length = 0.0;
  while (t < end) {
    if ((f > 0.0) != outside || f == 0.0) return t;
    if (const double step = std::abs(f) / lipschitz; step > 0.01 * how.extent) {  // Hart 1996
      t += step;
      length = 0.0;
      if (t < end) f = field.value(o + t * d);
      continue;
    }
    // The longest stretch about which bounds say something.
    length = std::max(2.0 * length, least);
    if (length == least) length = std::max(length, 2.0 * std::abs(f) / lipschitz);
    for (;; length *= 0.5) {
      const double to = std::min(t + length, end);
      const RayBounds bounds = field.bounds_along(o, d, {t, to});
      const bool clear = bounds.value.lower > 0.0 || bounds.value.upper < 0.0;
      const bool monotone = bounds.slope.lower > 0.0 || bounds.slope.upper < 0.0;
      if (!clear && !monotone && length > least) continue;
      const double f_to = field.value(o + to * d);
      if ((f_to > 0.0) != outside) return bisect_root(field, o, d, t, to);
      t = to;
      f = f_to;
      break;
    }
  }
  return kNone;
}

/// How near to the surface a ray comes on [from, to], where it stays on one side of it; on the other side, how deep it goes: the value of
/// f, over its Lipschitz constant, that is farthest to the side `outside` is not. Found by samples, refined by golden section.
inline double deepest(FieldEvaluator& field, const glm::dvec3& o, const glm::dvec3& d, double from, double to, bool outside) {
  const double sign = outside ? 1.0 : -1.0;
  const auto value = [&](double t) { return sign * field.value(o + t * d); };
  constexpr int kSamples = 4000;
  double best = value(from), at = from;
  for (int i = 1; i <= kSamples; ++i) {
    const double t = from + (to - from) * i / kSamples, f = value(t);
    if (f < best) best = f, at = t;
  }
  double a = std::max(from, at - (to - from) / kSamples), b = std::min(to, at + (to - from) / kSamples);
  for (int step = 0; step < 60; ++step) {
    const double u = a + 0.381966 * (b - a), v = a + 0.618034 * (b - a);
    (value(u) < value(v) ? b : a) = value(u) < value(v) ? v : u;
  }
  return std::min(best, value(0.5 * (a + b))) / field.field().traits().lipschitz;
}

}  // namespace limn::test
