#include "sdf/field_from_functions.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "sdf/error.h"
#include "sdf/field_program.h"

namespace limn {
namespace {

glm::dvec3 point_of(double x, double y, double z) { return {x, y, z}; }

struct OpaqueShape {
  static constexpr bool kBranches = true;  // nobody knows what its steps are
  FieldFunctions of{};
  double step = 1e-5;

  double operator()(const Vector3<double>& p) const { return of.value(point_of(p.x, p.y, p.z)); }
  float operator()(const Vector3<float>& p) const { return static_cast<float>(of.value(point_of(double{p.x}, double{p.y}, double{p.z}))); }
  Dual operator()(const Vector3<Dual>& p) const {
    const glm::dvec3 at = point_of(p.x.value, p.y.value, p.z.value), g = gradient(at);
    Dual r{of.value(at), {}};
    for (size_t i = 0; i < 3; ++i) r.gradient[i] = g.x * p.x.gradient[i] + g.y * p.y.gradient[i] + g.z * p.z.gradient[i];
    return r;
  }
  /// Points come through rigid maps: their own second derivatives are 0.
  Jet operator()(const Vector3<Jet>& p) const {
    const glm::dvec3 at = point_of(p.x.value, p.y.value, p.z.value), g = gradient(at);
    const glm::dmat3 h = hessian(at);
    const std::array<const std::array<double, 3>*, 3> by{&p.x.gradient, &p.y.gradient, &p.z.gradient};
    Jet r{of.value(at), {}, {}};
    constexpr std::array<std::pair<size_t, size_t>, 6> kPairs{{{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}}};
    for (size_t i = 0; i < 3; ++i)
      for (int a = 0; a < 3; ++a) r.gradient[i] += g[a] * (*by[static_cast<size_t>(a)])[i];
    for (size_t k = 0; k < 6; ++k)
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
          r.hessian[k] += h[a][b] * (*by[static_cast<size_t>(a)])[kPairs[k].first] * (*by[static_cast<size_t>(b)])[kPairs[k].second];
    return r;
  }
  Interval operator()(const Vector3<Interval>& p) const { return bounds(p.x, p.y, p.z); }
  Slope operator()(const Vector3<Slope>& p) const {
    const auto largest = [](const Interval& slope) { return std::max(std::fabs(slope.lower), std::fabs(slope.upper)); };
    const double most = of.lipschitz * std::hypot(largest(p.x.slope), largest(p.y.slope), largest(p.z.slope));
    return {bounds(p.x.value, p.y.value, p.z.value), {-most, most}};
  }
  BoxSlope operator()(const Vector3<BoxSlope>& p) const {
    return by_axis(p.x, p.y, p.z, [this](const Slope& x, const Slope& y, const Slope& z) { return (*this)(Vector3<Slope>{x, y, z}); });
  }

  double support(const glm::dvec3& direction, double level) const {
    // Beyond the extent the field may rise as slowly as it likes: only its surface is known to lie there.
    if (level > 0.0) return std::numeric_limits<double>::infinity();
    return glm::dot(direction, of.extent.center()) + 0.5 * glm::dot(glm::abs(direction), of.extent.size());
  }

  glm::dvec3 gradient(const glm::dvec3& p) const {
    if (of.gradient) return of.gradient(p);
    glm::dvec3 g;
    for (int i = 0; i < 3; ++i) {
      glm::dvec3 d(0.0);
      d[i] = step;
      g[i] = (of.value(p + d) - of.value(p - d)) / (2.0 * step);
    }
    return g;
  }
  glm::dmat3 hessian(const glm::dvec3& p) const {
    // Of differences: longer, since rounding is divided twice.
    const double h = of.gradient ? step : 30.0 * step;
    glm::dmat3 m;
    for (int i = 0; i < 3; ++i) {
      glm::dvec3 d(0.0);
      d[i] = h;
      m[i] = (gradient(p + d) - gradient(p - d)) / (2.0 * h);
    }
    return 0.5 * (m + glm::transpose(m));
  }
  /// Without bounds of its own the whole line: the evaluator cuts it down by the Lipschitz constant.
  Interval bounds(const Interval& x, const Interval& y, const Interval& z) const {
    if (!of.bounds) return {};
    const Interval found = of.bounds({{x.lower, y.lower, z.lower}, {x.upper, y.upper, z.upper}});
    return found.lower <= found.upper ? found : Interval{};
  }
};

}  // namespace

Field field_from_functions(const FieldFunctions& functions) {
  if (!functions.value) throw InputError({"", "value", "", "the field has no values", "a function of a point"});
  if (!(functions.lipschitz > 0.0) || !std::isfinite(functions.lipschitz))
    throw InputError({"", "lipschitz", fmt::format("{}", functions.lipschitz), "no bound on the slope", "a number above 0"});
  if (functions.extent.empty() || !functions.extent.finite())
    throw InputError({"", "extent", "", "the box does not hold a surface", "a finite box around it"});
  OpaqueShape shape{functions, 1e-5 * functions.extent.longest_side()};
  return field_from_shape(std::move(shape), functions.lipschitz, false);
}

}  // namespace limn
