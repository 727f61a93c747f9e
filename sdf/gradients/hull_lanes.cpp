#include "sdf/gradients/hull_lanes.h"

#include "sdf/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sdf/gradients/hull_lanes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace limn::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, kHullCells>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;

constexpr float kRounding = 1e-5f;  // of the greatest coefficient, well above what the sums round by
constexpr float kThird = 1.0f / 3.0f, kSixth = 1.0f / 6.0f;
constexpr size_t kPlaces = 64;

/// Bernstein coefficients of the cells of one vector, or what is made of them: as many floats at each place as it has lanes.
struct Hull {
  alignas(64) float of[kPlaces * kHullCells];

  V at(size_t place) const { return hn::Load(D(), of + place * hn::Lanes(D())); }
  void set(size_t place, V value) { hn::Store(value, D(), of + place * hn::Lanes(D())); }
  void add(size_t place, V value) { set(place, hn::Add(at(place), value)); }
};

V of_all(float x) { return hn::Set(D(), x); }
V sum_of(V x, V y, V z) { return hn::Add(hn::Add(x, y), z); }

/// Calls `visit(first place)` of each row of four along the axis with that stride: 16 along x, 4 along y, 1 along z.
template <size_t stride, class Visit>
HWY_INLINE void for_rows(const Visit& visit) {
  for (size_t outer = 0; outer < kPlaces; outer += 4 * stride)
    for (size_t i = outer; i < outer + stride; ++i) visit(i);
}

template <size_t stride>
HWY_INLINE void convert_along(Hull& c) {
  const V sixth = of_all(kSixth), third = of_all(kThird), two = of_all(2.0f), four = of_all(4.0f);
  for_rows<stride>([&](size_t i) {
    const V c0 = c.at(i), c1 = c.at(i + stride), c2 = c.at(i + 2 * stride), c3 = c.at(i + 3 * stride);
    c.set(i, hn::Mul(sixth, sum_of(c0, hn::Mul(four, c1), c2)));
    c.set(i + stride, hn::Mul(third, hn::Add(hn::Mul(two, c1), c2)));
    c.set(i + 2 * stride, hn::Mul(third, hn::Add(c1, hn::Mul(two, c2))));
    c.set(i + 3 * stride, hn::Mul(sixth, sum_of(c1, hn::Mul(four, c2), c3)));
  });
}

/// Returns the greatest of the B-spline coefficients.
HWY_INLINE V load_bernstein(const HullCells& cells, size_t first, Hull& b) {
  V most = hn::Zero(D());
  for (size_t i = 0; i < kPlaces; ++i) {
    const V c = hn::LoadU(D(), cells.coefficients[i].data() + first);
    most = hn::Max(most, hn::Abs(c));
    b.set(i, c);
  }
  convert_along<16>(b);
  convert_along<4>(b);
  convert_along<1>(b);
  return most;
}

/// A third of the derivative along an axis, its degree raised to that of the others.
template <size_t stride>
HWY_INLINE void slope_along(const Hull& b, Hull& slope) {
  const V third = of_all(kThird), two = of_all(2.0f);
  for_rows<stride>([&](size_t i) {
    const V b1 = b.at(i + stride), b2 = b.at(i + 2 * stride), d0 = hn::Sub(b1, b.at(i)), d1 = hn::Sub(b2, b1),
            d2 = hn::Sub(b.at(i + 3 * stride), b2);
    slope.set(i, d0);
    slope.set(i + stride, hn::Mul(third, hn::Add(d0, hn::Mul(two, d1))));
    slope.set(i + 2 * stride, hn::Mul(third, hn::Add(hn::Mul(two, d1), d2)));
    slope.set(i + 3 * stride, d2);
  });
}

/// Adds a third of the derivative along an axis times what is linear along it: `l0` at the cell's lower side, `l1` at its upper one.
template <size_t stride>
HWY_INLINE void add_slope(const Hull& b, V l0, V l1, Hull& sum) {
  const V third = of_all(kThird), two = of_all(2.0f);
  for_rows<stride>([&](size_t i) {
    const V b1 = b.at(i + stride), b2 = b.at(i + 2 * stride), d0 = hn::Sub(b1, b.at(i)), d1 = hn::Sub(b2, b1),
            d2 = hn::Sub(b.at(i + 3 * stride), b2);
    sum.add(i, hn::Mul(d0, l0));
    sum.add(i + stride, hn::Mul(third, hn::Add(hn::Mul(d0, l1), hn::Mul(hn::Mul(two, d1), l0))));
    sum.add(i + 2 * stride, hn::Mul(third, hn::Add(hn::Mul(hn::Mul(two, d1), l1), hn::Mul(d2, l0))));
    sum.add(i + 3 * stride, hn::Mul(d2, l1));
  });
}

/// All of one sign, for certain. `size`: how large what was summed up is.
HWY_INLINE M have_one_sign(const Hull& b, V size) {
  V least = b.at(0), most = least;
  for (size_t i = 1; i < kPlaces; ++i) least = hn::Min(least, b.at(i)), most = hn::Max(most, b.at(i));
  const V rounding = hn::Mul(of_all(kRounding), size);
  return hn::Or(hn::Gt(least, rounding), hn::Lt(most, hn::Neg(rounding)));
}

/// The multiple of `b` that leaves the least variation of `a`.
HWY_INLINE V common_part(const Hull& a, const Hull& b) {
  const V zero = hn::Zero(D()), share = of_all(1.0f / static_cast<float>(kPlaces));
  V sum_a = zero, sum_b = zero, ab = zero, bb = zero;
  for (size_t i = 0; i < kPlaces; ++i) sum_a = hn::Add(sum_a, a.at(i)), sum_b = hn::Add(sum_b, b.at(i));
  const V mean_a = hn::Mul(sum_a, share), mean_b = hn::Mul(sum_b, share);
  for (size_t i = 0; i < kPlaces; ++i) {
    const V off_b = hn::Sub(b.at(i), mean_b);
    ab = hn::Add(ab, hn::Mul(hn::Sub(a.at(i), mean_a), off_b));
    bb = hn::Add(bb, hn::Mul(off_b, off_b));
  }
  return hn::IfThenElseZero(hn::Gt(bb, zero), hn::Div(ab, bb));
}

CellBits bits_of(M mask, size_t first) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(D(), mask, bytes);
  return (static_cast<CellBits>(bytes[0]) | static_cast<CellBits>(bytes[1]) << 8u) << first;
}

CellBits of_count(size_t count) { return (CellBits{1} << count) - 1; }

/// Thirds of gradients by index coordinates.
struct Slopes {
  Hull x, y, z;
};

/// Of one vector of cells.
HWY_INLINE void find_cones(const Hull& b, const glm::mat3& m, size_t first, NormalCones& cones) {
  Slopes slopes;
  slope_along<16>(b, slopes.x);
  slope_along<4>(b, slopes.y);
  slope_along<1>(b, slopes.z);
  const auto turned = [&](int row, V x, V y, V z) {
    return sum_of(hn::Mul(of_all(m[0][row]), x), hn::Mul(of_all(m[1][row]), y), hn::Mul(of_all(m[2][row]), z));
  };
  V sum_x = hn::Zero(D()), sum_y = sum_x, sum_z = sum_x;
  for (size_t i = 0; i < kPlaces; ++i) {
    sum_x = hn::Add(sum_x, slopes.x.at(i));
    sum_y = hn::Add(sum_y, slopes.y.at(i));
    sum_z = hn::Add(sum_z, slopes.z.at(i));
  }
  const V mean_x = turned(0, sum_x, sum_y, sum_z), mean_y = turned(1, sum_x, sum_y, sum_z), mean_z = turned(2, sum_x, sum_y, sum_z);
  const V length = hn::Sqrt(sum_of(hn::Mul(mean_x, mean_x), hn::Mul(mean_y, mean_y), hn::Mul(mean_z, mean_z)));
  const V nx = hn::Div(mean_x, length), ny = hn::Div(mean_y, length), nz = hn::Div(mean_z, length);
  M bounded = hn::Gt(length, hn::Zero(D()));
  V most = hn::Zero(D());
  for (size_t i = 0; i < kPlaces; ++i) {
    const V x = slopes.x.at(i), y = slopes.y.at(i), z = slopes.z.at(i), u = turned(0, x, y, z), v = turned(1, x, y, z),
            w = turned(2, x, y, z), squared = sum_of(hn::Mul(u, u), hn::Mul(v, v), hn::Mul(w, w)),
            along = sum_of(hn::Mul(nx, u), hn::Mul(ny, v), hn::Mul(nz, w));
    bounded = hn::And(bounded, hn::Gt(along, hn::Zero(D())));
    most = hn::Max(most, hn::Sub(of_all(1.0f), hn::Div(hn::Mul(along, along), squared)));
  }
  cones.bounded |= bits_of(bounded, first);
  hn::StoreU(nx, D(), cones.normal[0].data() + first);
  hn::StoreU(ny, D(), cones.normal[1].data() + first);
  hn::StoreU(nz, D(), cones.normal[2].data() + first);
  hn::StoreU(most, D(), cones.sine_squared.data() + first);
}

void FindNormalCones(const HullCells& cells, const glm::mat3& world_from_slope, NormalCones& cones) {
  cones.may_hold_zero = cones.bounded = 0;
  Hull b;
  for (size_t first = 0; first < cells.count; first += hn::Lanes(D())) {
    load_bernstein(cells, first, b);
    V size = hn::Zero(D());
    for (size_t i = 0; i < kPlaces; ++i) size = hn::Max(size, hn::Abs(b.at(i)));
    const CellBits may = ~bits_of(have_one_sign(b, size), first) & bits_of(hn::FirstN(D(), cells.count - first), first);
    cones.may_hold_zero |= may;
    if (may != 0) find_cones(b, world_from_slope, first, cones);
  }
}

CellBits MayTurnFrom(const HullCells& cells, const WaysToTarget& ways) {
  CellBits clear = 0;
  Hull b, slope;
  const auto way = [](const std::array<OfCells, 3>& of, size_t axis, size_t first) { return hn::LoadU(D(), of[axis].data() + first); };
  for (size_t first = 0; first < cells.count; first += hn::Lanes(D())) {
    const V size = load_bernstein(cells, first, b);
    M told = have_one_sign(b, size);
    V longest = hn::Zero(D());
    for (size_t i = 0; i < kPlaces; ++i) slope.set(i, longest);
    for (size_t axis = 0; axis < 3; ++axis)
      longest = hn::Add(longest, hn::Max(hn::Abs(way(ways.from_low, axis, first)), hn::Abs(way(ways.from_high, axis, first))));
    add_slope<16>(b, way(ways.from_low, 0, first), way(ways.from_high, 0, first), slope);
    add_slope<4>(b, way(ways.from_low, 1, first), way(ways.from_high, 1, first), slope);
    add_slope<1>(b, way(ways.from_low, 2, first), way(ways.from_high, 2, first), slope);
    const V slope_size = hn::Mul(hn::Mul(of_all(2.0f), size), longest);
    told = hn::Or(told, have_one_sign(slope, slope_size));
    // Both have zeros, but where surface and slope change along the same way not at one place: where both vanish, so do all sums of theirs.
    const V times = common_part(slope, b);
    for (size_t i = 0; i < kPlaces; ++i) slope.set(i, hn::Sub(slope.at(i), hn::Mul(times, b.at(i))));
    const M rest = have_one_sign(slope, hn::Add(slope_size, hn::Mul(hn::Abs(times), size)));
    told = hn::Or(told, hn::And(rest, hn::IsFinite(times)));
    clear |= bits_of(told, first);
  }
  return ~clear & of_count(cells.count);
}

}  // namespace
}  // namespace limn::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace limn {
HWY_EXPORT(FindNormalCones);
void find_normal_cones(const HullCells& cells, const glm::mat3& world_from_slope, NormalCones& cones) {
  HWY_DYNAMIC_DISPATCH(FindNormalCones)(cells, world_from_slope, cones);
}
HWY_EXPORT(MayTurnFrom);
CellBits may_turn_from(const HullCells& cells, const WaysToTarget& ways) { return HWY_DYNAMIC_DISPATCH(MayTurnFrom)(cells, ways); }
}  // namespace limn
#endif
