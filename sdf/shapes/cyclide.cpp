// The ring cyclide as the border of the union of the balls about E(u) = (a cos u, 0, b sin u) with radius d - c cos u, c^2 = a^2 - b^2
// (Maxwell, "On the cyclide", 1868; Chandru, Dutta & Hoffmann, "On the geometry of Dupin cyclides", 1989; its quartic, there with y and z
// exchanged: (x^2 + y^2 + z^2 + b^2 - d^2)^2 = 4 (a x - c d)^2 + 4 b^2 z^2). Adding the same length to all radii gives the parallel
// surface, so the signed distance is
//   f(p) = min over u of |p - E(u)| + c cos u, less d,
// exact inside as well: the medial axis on the outer side is a branch of the focal hyperbola, on which f >= a - d > 0.
// The minimum D is the largest zero of
//   h(D) = |p|^2 + b^2 - D^2 - 2 |(a x - c D, b z)|,
// a concave function (the length of an affine map is convex), so Newton's method from the right comes down to it without overshooting.

#include <algorithm>
#include <cmath>

#include "sdf/shapes/entry.h"

namespace limn {
namespace {

struct Cyclide {
  static constexpr bool kBranches = true;
  double a, b, c, d;

  template <class T>
  T operator()(const Vector3<T>& p) const {
    if constexpr (Bounding<T>) {
      return bounds(p);
    } else {
      return value(p);
    }
  }

  double support(const glm::dvec3& direction, double level) const {
    const double length = glm::length(direction);
    return norm(a * direction.x - c * length, b * direction.z) + (d + level) * length;
  }

 private:
  template <class R>
  struct Spine {  // the nearest ball: cos u, sin u
    R cosine, sine;
  };

  template <Real R>
  static Spine<R> spine_of(R x, R z) {
    const R n = norm(x, z);
    return n > R(0) ? Spine<R>{x / n, z / n} : Spine<R>{R(1), R(0)};
  }

  template <class T>
  T from_spine(const Vector3<T>& p, const Spine<T>& u) const {
    return norm(p.x - u.cosine * scalar<T>(a), p.y, p.z - u.sine * scalar<T>(b)) + u.cosine * scalar<T>(c);
  }

  template <Real R>
  Spine<R> nearest_spine(const Vector3<R>& p) const {
    const R ra = static_cast<R>(a), rb = static_cast<R>(b), rc = static_cast<R>(c);
    const R sum = square(norm(p)) + rb * rb;
    Spine<R> u = spine_of(ra * p.x, rb * p.z);
    R distance = from_spine(p, u);  // that of one ball: on the right of the zero
    // On the focal ellipse, deep inside, the zero is double and Newton only halves the error; the balls are all but equal there.
    for (int step = 0; step < 60; ++step) {
      u = spine_of(ra * p.x - rc * distance, rb * p.z);
      const R h = sum - distance * distance - R(2) * norm(ra * p.x - rc * distance, rb * p.z);
      const R slope = R(2) * (rc * u.cosine - distance);
      if (!(slope < R(0))) break;
      const R next = distance - h / slope;
      if (!(next < distance)) break;
      const bool settled = distance - next <= R(4) * std::numeric_limits<R>::epsilon() * std::fabs(distance);
      distance = next;
      if (settled) break;
    }
    return spine_of(ra * p.x - rc * distance, rb * p.z);
  }

  template <class T>
  T value(const Vector3<T>& p) const {
    const auto u = nearest_spine(Vector3<Scalar<T>>{value_of(p.x), value_of(p.y), value_of(p.z)});
    if constexpr (Real<T>) {
      return from_spine(p, u) - scalar<T>(d);
    } else {
      // At the minimum the derivative by u vanishes: u as a constant gives the gradient, and u to first order the Hessian.
      const T first = from_spine(p, Spine<T>{constant<T>(u.cosine), constant<T>(u.sine)});
      if constexpr (std::is_same_v<T, Dual>) return first - d;
      const T x = p.x * a - first * c, z = p.z * b;
      const T n = norm(x, z);
      if (n.value == 0.0) return first - d;
      const T inverse = chain(n, 1.0 / n.value, -1.0 / square(n.value), 2.0 / (n.value * square(n.value)));
      return from_spine(p, Spine<T>{x * inverse, z * inverse}) - d;
    }
  }

  Interval bounds(const Vector3<Interval>& p) const {
    const Vector3<double> middle{0.5 * (p.x.lower + p.x.upper), 0.5 * (p.y.lower + p.y.upper), 0.5 * (p.z.lower + p.z.upper)};
    const double reach = 0.5000001 * norm(p.x.width(), p.y.width(), p.z.width());
    const double center = value(middle);
    const double slack = 1e-13 * (std::fabs(center) + a + magnitude(p.x) + magnitude(p.y) + magnitude(p.z));
    return {center - reach - slack, center + reach + slack};
  }

  /// The gradient is the unit vector from the nearest ball's centre, which lies within bounds of its own.
  template <class S>
  SlopeOf<S> bounds(const Vector3<SlopeOf<S>>& p) const {
    const Interval value = bounds(Vector3<Interval>{p.x.value, p.y.value, p.z.value});
    const Interval x = p.x.value * a - (value + d) * c, z = p.z.value * b;
    const Interval from_x = p.x.value - unit_component(x, z) * a;
    const Interval from_z = p.z.value - unit_component(z, x) * b;
    const Interval& from_y = p.y.value;
    const S slope = unit_component(from_x, norm(from_y, from_z)) * p.x.slope + unit_component(from_y, norm(from_x, from_z)) * p.y.slope +
                    unit_component(from_z, norm(from_x, from_y)) * p.z.slope;
    return {value, slope};
  }
};

Field make(const Parameters& p) {
  const double a = p.number("a"), b = p.number("b"), d = p.number("d");
  if (b > a) combination_fault("cyclide.b", b, "longer than a", fmt::format("at most a = {}", a));
  const double c = std::sqrt((a - b) * (a + b));
  if (!(d > c && d < a)) {
    combination_fault("cyclide.d", d, "not a ring", fmt::format("between sqrt(a^2 - b^2) = {:.6g} and a = {}, ends excluded", c, a));
  }
  return field_from_shape(Cyclide{a, b, c, d}, 1.0, true);
}

}  // namespace

ShapeDescriptor describe_cyclide() {
  return {{"cyclide", "Dupin's ring cyclide: a ring about the y axis, thick on one side", "Maxwell 1868; Chandru, Dutta & Hoffmann 1989"},
          {length_parameter("a", 1.0, "greater half axis of the ring's middle ellipse, along x"),
           length_parameter("b", 0.97, "lesser half axis, along z; equal to a: a torus"),
           length_parameter("d", 0.4, "mean radius of the tube, between sqrt(a^2 - b^2) and a")},
          make};
}

}  // namespace limn
