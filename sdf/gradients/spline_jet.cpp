#include "sdf/gradients/spline_jet.h"

#include "sdf/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sdf/gradients/spline_jet.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace limn::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

/// Adds up four planes of a block, or rows of a plane, of `size` numbers each.
template <class D, size_t size>
HWY_INLINE void contract(const std::array<double, 4>& weights, const double* from, double* to) {
  const D d;
  for (size_t at = 0; at < size; at += hn::Lanes(d)) {
    const auto part = [&](size_t i) { return hn::Mul(hn::Set(d, weights[i]), hn::LoadU(d, from + i * size + at)); };
    hn::Store(hn::Add(hn::Add(part(0), part(1)), hn::Add(part(2), part(3))), d, to + at);
  }
}

HWY_INLINE double dot(const std::array<double, 4>& weights, const double* row) {
  return (weights[0] * row[0] + weights[1] * row[1]) + (weights[2] * row[2] + weights[3] * row[3]);
}

/// One axis after the other, each for all that the next ones need.
void FindJet(const SplineCoefficients& c, const glm::dvec3& local, FieldJet& jet) {
  const SplineWeights x = spline_weights(local.x), y = spline_weights(local.y), z = spline_weights(local.z);
  alignas(64) double of_x[3][16];  // planes of y and z
  contract<hn::CappedTag<double, 8>, 16>(x.value, c.data(), of_x[0]);
  contract<hn::CappedTag<double, 8>, 16>(x.first, c.data(), of_x[1]);
  contract<hn::CappedTag<double, 8>, 16>(x.second, c.data(), of_x[2]);
  alignas(64) double plain[4], along_x[4], along_y[4], xx[4], yy[4], xy[4];  // rows of z
  using Row = hn::CappedTag<double, 4>;
  contract<Row, 4>(y.value, of_x[0], plain);
  contract<Row, 4>(y.first, of_x[0], along_y);
  contract<Row, 4>(y.second, of_x[0], yy);
  contract<Row, 4>(y.value, of_x[1], along_x);
  contract<Row, 4>(y.first, of_x[1], xy);
  contract<Row, 4>(y.value, of_x[2], xx);
  jet.value = dot(z.value, plain);
  jet.gradient = {dot(z.value, along_x), dot(z.value, along_y), dot(z.first, plain)};
  const double of_xy = dot(z.value, xy), of_xz = dot(z.first, along_x), of_yz = dot(z.first, along_y);
  jet.hessian = {{dot(z.value, xx), of_xy, of_xz}, {of_xy, dot(z.value, yy), of_yz}, {of_xz, of_yz, dot(z.second, plain)}};
}

double FindValue(const SplineCoefficients& c, const glm::dvec3& local) {
  alignas(64) double of_x[16], plain[4];
  contract<hn::CappedTag<double, 8>, 16>(spline_weights(local.x).value, c.data(), of_x);
  contract<hn::CappedTag<double, 4>, 4>(spline_weights(local.y).value, of_x, plain);
  return dot(spline_weights(local.z).value, plain);
}

}  // namespace
}  // namespace limn::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace limn {
HWY_EXPORT(FindJet);
FieldJet spline_jet(const SplineCoefficients& coefficients, const glm::dvec3& local) {
  FieldJet jet;
  HWY_DYNAMIC_DISPATCH(FindJet)(coefficients, local, jet);
  return jet;
}

HWY_EXPORT(FindValue);
double spline_value(const SplineCoefficients& coefficients, const glm::dvec3& local) {
  return HWY_DYNAMIC_DISPATCH(FindValue)(coefficients, local);
}
}  // namespace limn
#endif
