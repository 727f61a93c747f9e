#include "sdf/field_from_functions.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "sdf/error.h"
#include "sdf/field_program.h"

namespace limn {
namespace {

using Points = std::vector<glm::dvec3>;

/// f(p + d) and f(p - d) for d along each axis: differences of what lies at `first` and after, six a point.
template <class T>
std::array<T, 3> differences(const T* first, double twice_step) {
  return {(first[0] - first[1]) / twice_step, (first[2] - first[3]) / twice_step, (first[4] - first[5]) / twice_step};
}

/// Six a point: a step along each axis, forth and back.
void add_steps(const glm::dvec3& point, double step, Points& points) {
  for (int i = 0; i < 3; ++i) {
    glm::dvec3 d(0.0);
    d[i] = step;
    points.push_back(point + d);
    points.push_back(point - d);
  }
}

struct OpaqueShape {
  FieldFunctions of{};
  double step = 1e-5;

  void values(const Points& points, double* out) const {
    if (of.values) return of.values(points, {out, points.size()});
    for (size_t i = 0; i < points.size(); ++i) out[i] = of.value(points[i]);
  }
  Points gradients(const Points& points) const {
    Points found(points.size());
    if (of.gradients) {
      of.gradients(points, found);
    } else if (of.gradient) {
      for (size_t i = 0; i < points.size(); ++i) found[i] = of.gradient(points[i]);
    } else {
      Points about;
      for (const glm::dvec3& p : points) add_steps(p, step, about);
      std::vector<double> values_about(about.size());
      values(about, values_about.data());
      for (size_t i = 0; i < points.size(); ++i) {
        const std::array<double, 3> g = differences(&values_about[6 * i], 2.0 * step);
        found[i] = {g[0], g[1], g[2]};
      }
    }
    return found;
  }
  std::vector<glm::dmat3> hessians(const Points& points) const {
    // Of differences: longer, since rounding is divided twice.
    const double h = of.gradient || of.gradients ? step : 30.0 * step;
    Points about;
    for (const glm::dvec3& p : points) add_steps(p, h, about);
    const Points gradients_about = gradients(about);
    std::vector<glm::dmat3> found(points.size());
    for (size_t i = 0; i < points.size(); ++i) {
      const std::array<glm::dvec3, 3> columns = differences(&gradients_about[6 * i], 2.0 * h);
      const glm::dmat3 m(columns[0], columns[1], columns[2]);
      found[i] = 0.5 * (m + glm::transpose(m));
    }
    return found;
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

  /// Without bounds of its own the whole line: the evaluator cuts it down by the Lipschitz constant.
  Interval bounds(const Interval& x, const Interval& y, const Interval& z) const {
    if (!of.bounds) return {};
    const Interval found = of.bounds({{x.lower, y.lower, z.lower}, {x.upper, y.upper, z.upper}});
    return found.lower <= found.upper ? found : Interval{};
  }
};

const OpaqueShape& shape_at(const void* shape) { return *static_cast<const OpaqueShape*>(shape); }

template <class T>
Points points_of(const T* x, const T* y, const T* z, size_t count) {
  const auto number = [](const T& coordinate) {
    if constexpr (std::is_floating_point_v<T>)
      return double{coordinate};
    else
      return coordinate.value;
  };
  Points points(count);
  for (size_t i = 0; i < count; ++i) points[i] = {number(x[i]), number(y[i]), number(z[i])};
  return points;
}

void evaluate_numbers(const void* shape, const double* x, const double* y, const double* z, double* values, size_t count) {
  shape_at(shape).values(points_of(x, y, z, count), values);
}
void evaluate_floats(const void* shape, const float* x, const float* y, const float* z, float* values, size_t count) {
  std::vector<double> found(count);
  shape_at(shape).values(points_of(x, y, z, count), found.data());
  for (size_t i = 0; i < count; ++i) values[i] = static_cast<float>(found[i]);
}

void evaluate_duals(const void* shape, const Dual* x, const Dual* y, const Dual* z, Dual* values, size_t count) {
  const Points points = points_of(x, y, z, count), gradients = shape_at(shape).gradients(points);
  std::vector<double> found(count);
  shape_at(shape).values(points, found.data());
  for (size_t k = 0; k < count; ++k) {
    const glm::dvec3& g = gradients[k];
    Dual r{found[k], {}};
    for (size_t i = 0; i < 3; ++i) r.gradient[i] = g.x * x[k].gradient[i] + g.y * y[k].gradient[i] + g.z * z[k].gradient[i];
    values[k] = r;
  }
}

/// Points come through rigid maps: their own second derivatives are 0.
Jet jet_of(double value, const glm::dvec3& g, const glm::dmat3& h, const Jet& x, const Jet& y, const Jet& z) {
  const std::array<const std::array<double, 3>*, 3> by{&x.gradient, &y.gradient, &z.gradient};
  Jet r{value, {}, {}};
  constexpr std::array<std::pair<size_t, size_t>, 6> kPairs{{{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}}};
  for (size_t i = 0; i < 3; ++i)
    for (int a = 0; a < 3; ++a) r.gradient[i] += g[a] * (*by[static_cast<size_t>(a)])[i];
  for (size_t k = 0; k < 6; ++k)
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        r.hessian[k] += h[a][b] * (*by[static_cast<size_t>(a)])[kPairs[k].first] * (*by[static_cast<size_t>(b)])[kPairs[k].second];
  return r;
}
void evaluate_jets(const void* shape, const Jet* x, const Jet* y, const Jet* z, Jet* values, size_t count) {
  const Points points = points_of(x, y, z, count), gradients = shape_at(shape).gradients(points);
  const std::vector<glm::dmat3> hessians = shape_at(shape).hessians(points);
  std::vector<double> found(count);
  shape_at(shape).values(points, found.data());
  for (size_t k = 0; k < count; ++k) values[k] = jet_of(found[k], gradients[k], hessians[k], x[k], y[k], z[k]);
}

template <bool kTogether>
constexpr ShapeFunctions kFunctions{
    .evaluate = {evaluate_floats, evaluate_numbers, evaluate_duals, evaluate_jets, evaluate_shape<OpaqueShape, Interval>,
                 evaluate_shape<OpaqueShape, Slope>, evaluate_shape<OpaqueShape, BoxSlope>},
    .support = [](const void* shape, const glm::dvec3& direction, double level) { return shape_at(shape).support(direction, level); },
    .record = nullptr,  // nobody knows what its steps are
    .ball_from_object = nullptr,
    .faces = nullptr,
    .tip = nullptr,
    .together = kTogether};

}  // namespace

Field field_from_functions(const FieldFunctions& functions) {
  if (!functions.value && !functions.values) throw InputError({"", "value", "", "the field has no values", "a function of a point"});
  if ((functions.value && functions.values) || (functions.gradient && functions.gradients))
    throw InputError({"", "values", "", "the field has two functions for the same", "one of a point or one of many"});
  if (!(functions.lipschitz > 0.0) || !std::isfinite(functions.lipschitz))
    throw InputError({"", "lipschitz", fmt::format("{}", functions.lipschitz), "no bound on the slope", "a number above 0"});
  if (functions.extent.empty() || !functions.extent.finite())
    throw InputError({"", "extent", "", "the box does not hold a surface", "a finite box around it"});
  FieldLeaf leaf;
  leaf.shape = std::make_shared<const OpaqueShape>(OpaqueShape{functions, 1e-5 * functions.extent.longest_side()});
  leaf.functions = functions.values ? &kFunctions<true> : &kFunctions<false>;
  leaf.lipschitz = functions.lipschitz;
  return field_from_leaf(std::move(leaf), false);
}

}  // namespace limn
