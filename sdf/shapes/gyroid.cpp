// g = sin x cos y + sin y cos z + sin z cos x with x = 2 pi p / period: Schoen 1970, in its first-order Fourier form.
// By Cauchy-Schwarz each component of grad g, cos x cos y - sin z sin x and its like, is at most sqrt(cos^2 y + sin^2 z), and the squares
// of these add up to 3: |grad g| <= sqrt 3. Divided by sqrt(3) 2 pi / period the field is therefore no steeper than 1; on g = 0 its slope
// is between 0.7 and 1, so the wall is `thickness` wide where g is steepest and up to 1.4 times that elsewhere.

#include <numbers>

#include "sdf/shapes/entry.h"

namespace limn {
namespace {

struct Gyroid {
  double frequency;  // 2 pi / period
  double inverse_slope;
  double half_thickness;
  double bound;

  template <class T>
  T operator()(const Vector3<T>& p) const {
    const auto f = scalar<T>(frequency);
    const T x = p.x * f, y = p.y * f, z = p.z * f;
    const T g = sine(x) * cosine(y) + sine(y) * cosine(z) + sine(z) * cosine(x);
    const T sheet = abs(g) * scalar<T>(inverse_slope) - scalar<T>(half_thickness);
    return maximum(sheet, norm(p) - scalar<T>(bound));
  }
  double support(const glm::dvec3& direction, double level) const { return (bound + level) * glm::length(direction); }
};

Field make(const Parameters& p) {
  const double frequency = 2.0 * std::numbers::pi / p.number("period");
  return field_from_shape(Gyroid{frequency, 1.0 / (std::numbers::sqrt3 * frequency), 0.5 * p.number("thickness"), p.number("bound")}, 1.0,
                          false);
}

}  // namespace

ShapeDescriptor describe_gyroid() {
  return {{"gyroid", "a ball cut out of the gyroid's endless wall", "Schoen 1970"},
          {length_parameter("period", 1.0, "side of the repeated cube"),
           length_parameter("thickness", 0.12, "of the wall where it is thinnest; up to 1.4 times that elsewhere"),
           length_parameter("bound", 1.0, "radius of the ball that cuts the lattice")},
          make};
}

}  // namespace limn
