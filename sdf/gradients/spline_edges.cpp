#include "sdf/gradients/spline_edges.h"

#include "sdf/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sdf/gradients/spline_edges.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace limn::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, kEdgeLanes>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;

constexpr int kMostSteps = 4;

V of_all(double x) { return hn::Set(D(), x); }
V of(const OfEdges& numbers, size_t first) { return hn::LoadU(D(), numbers.data() + first); }

/// spline_weights() without the second derivatives.
struct Weights {
  V value[4], first[4];
};
HWY_INLINE Weights weights_at(V u) {
  const V v = hn::Sub(of_all(1.0), u), sixth = of_all(1.0 / 6.0), half = of_all(0.5), two = of_all(2.0), most = of_all(2.0 / 3.0);
  const auto inner = [&](V x) { return hn::Sub(most, hn::Mul(hn::Mul(x, x), hn::Sub(of_all(1.0), hn::Mul(half, x)))); };
  const auto slope = [&](V x) { return hn::Mul(x, hn::Sub(hn::Mul(of_all(1.5), x), two)); };
  return {{hn::Mul(sixth, hn::Mul(v, hn::Mul(v, v))), inner(u), inner(v), hn::Mul(sixth, hn::Mul(u, hn::Mul(u, u)))},
          {hn::Neg(hn::Mul(half, hn::Mul(v, v))), slope(u), hn::Neg(slope(v)), hn::Mul(half, hn::Mul(u, u))}};
}

struct Slopes {
  V value, x, y, z;
};
HWY_INLINE Slopes spline_at(const SplineCoefficients& c, V x, V y, V z) {
  const Weights of_x = weights_at(x), of_y = weights_at(y), of_z = weights_at(z);
  const V zero = hn::Zero(D());
  Slopes sum{zero, zero, zero, zero};
  for (size_t i = 0; i < 4; ++i) {
    V value = zero, along_y = zero, along_z = zero;
    for (size_t j = 0; j < 4; ++j) {
      V row = zero, row_slope = zero;
      for (size_t k = 0; k < 4; ++k) {
        const V at = of_all(c[spline_place(static_cast<int>(i), static_cast<int>(j), static_cast<int>(k))]);
        row = hn::Add(row, hn::Mul(of_z.value[k], at));
        row_slope = hn::Add(row_slope, hn::Mul(of_z.first[k], at));
      }
      value = hn::Add(value, hn::Mul(of_y.value[j], row));
      along_y = hn::Add(along_y, hn::Mul(of_y.first[j], row));
      along_z = hn::Add(along_z, hn::Mul(of_y.value[j], row_slope));
    }
    sum.value = hn::Add(sum.value, hn::Mul(of_x.value[i], value));
    sum.x = hn::Add(sum.x, hn::Mul(of_x.first[i], value));
    sum.y = hn::Add(sum.y, hn::Mul(of_x.value[i], along_y));
    sum.z = hn::Add(sum.z, hn::Mul(of_x.value[i], along_z));
  }
  return sum;
}

/// Of one vector of edges.
HWY_INLINE void find_some(const SplineCoefficients& c, const EdgesOfCell& edges, double close, size_t first, EdgeRoots& roots) {
  const D d;
  const V a = of(edges.at_start, first), b = of(edges.at_end, first), zero = hn::Zero(d), one = of_all(1.0);
  const V way_x = of(edges.way[0], first), way_y = of(edges.way[1], first), way_z = of(edges.way[2], first);
  const M is_below = hn::Lt(a, zero);
  V t = hn::Div(a, hn::Sub(a, b)), low = zero, high = one, root = zero, gx = zero, gy = zero, gz = zero;
  M open = hn::FirstN(d, edges.count - first), found = hn::Lt(one, zero);
  for (int step = 0; step < kMostSteps && !hn::AllFalse(d, open); ++step) {
    const auto place = [&](size_t axis, V way) { return hn::Add(of(edges.from[axis], first), hn::Mul(t, way)); };
    const Slopes at = spline_at(c, place(0, way_x), place(1, way_y), place(2, way_z));
    const M before = hn::Not(hn::Xor(hn::Lt(at.value, zero), is_below));
    low = hn::IfThenElse(before, t, low);
    high = hn::IfThenElse(before, high, t);
    const V slope = hn::Add(hn::Add(hn::Mul(at.x, way_x), hn::Mul(at.y, way_y)), hn::Mul(at.z, way_z));
    const V next = hn::Sub(t, hn::Div(at.value, slope));
    open = hn::And(open, hn::And(hn::Ge(next, low), hn::Le(next, high)));
    const M done = hn::And(open, hn::Lt(hn::Abs(hn::Sub(next, t)), of_all(close)));
    root = hn::IfThenElse(done, next, root);
    gx = hn::IfThenElse(done, at.x, gx), gy = hn::IfThenElse(done, at.y, gy), gz = hn::IfThenElse(done, at.z, gz);
    found = hn::Or(found, done);
    open = hn::AndNot(done, open);
    t = hn::IfThenElse(open, next, t);
  }
  hn::StoreU(root, d, roots.share.data() + first);
  hn::StoreU(gx, d, roots.gradient[0].data() + first);
  hn::StoreU(gy, d, roots.gradient[1].data() + first);
  hn::StoreU(gz, d, roots.gradient[2].data() + first);
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(d, found, bits);
  roots.found |= static_cast<std::uint32_t>(bits[0]) << first;
}

void FindRoots(const SplineCoefficients& c, const EdgesOfCell& edges, double close, EdgeRoots& roots) {
  roots.found = 0;
  for (size_t first = 0; first < edges.count; first += hn::Lanes(D())) find_some(c, edges, close, first, roots);
}

}  // namespace
}  // namespace limn::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace limn {
HWY_EXPORT(FindRoots);
void find_roots(const SplineCoefficients& c, const EdgesOfCell& edges, double close, EdgeRoots& roots) {
  HWY_DYNAMIC_DISPATCH(FindRoots)(c, edges, close, roots);
}
}  // namespace limn
#endif
