// Internal: gradients at hits, sixteen or fewer at a time. Included once for each SIMD target.

#if defined(LIMN_RAYMARCH_LEVEL_SET_GRADIENTS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LIMN_RAYMARCH_LEVEL_SET_GRADIENTS_INL_H
#undef LIMN_RAYMARCH_LEVEL_SET_GRADIENTS_INL_H
#else
#define LIMN_RAYMARCH_LEVEL_SET_GRADIENTS_INL_H
#endif

#include "raymarch/level_set/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace limn::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

struct Cells {
  VI self;               ///< Byte offset of the cell's first node in all bricks' values.
  V3 local;              ///< Place in the cell, 0..1.
  VI minus[3], plus[3];  ///< The same node shifted by one along an axis, and by two: where they lie.
};

/// Where the stencils of hits lie: `t` along the rays, `number` as BrickHits::cell. Lanes without a hit are given any cell.
HWY_INLINE Cells cells_of(const RayBricks& bricks, const IndexRays& rays, size_t i, VF t, VI number, bool with_neighbors) {
  const F d;
  const I di;
  constexpr int kFaces = 6;
  const auto* faces = reinterpret_cast<const std::int32_t*>(bricks.neighbors.data());
  const VI brick = hn::ShiftRight<9>(number), digit = hn::Set(di, 7);
  const VI base = hn::Mul(brick, hn::Set(di, kBrickBytes));
  const VI node[3] = {hn::And(hn::ShiftRight<6>(number), digit), hn::And(hn::ShiftRight<3>(number), digit), hn::And(number, digit)};
  Cells cells;
  const V3 o = load3(rays.origin, i), v = load3(rays.direction, i);
  // Bricks start at multiples of eight, so that the place in the cell is told without the brick's own origin.
  const auto place = [&](int axis, VF from, VF slope) {
    const VF p = hn::Sub(hn::Add(from, hn::Mul(t, slope)), hn::ConvertTo(d, node[axis]));
    const VF origin = hn::Mul(set(8.0f), hn::Floor(hn::Add(hn::Mul(p, set(0.125f)), set(0.25f))));
    return hn::Min(hn::Max(hn::Sub(p, origin), hn::Zero(d)), set(1.0f));
  };
  cells.local.x = place(0, o.x, v.x);
  cells.local.y = place(1, o.y, v.y);
  cells.local.z = place(2, o.z, v.z);
  constexpr int kStep[3] = {162, 18, 2};
  cells.self = base;
  for (int axis = 0; axis < 3; ++axis) cells.self = hn::Add(cells.self, hn::Mul(node[axis], hn::Set(di, kStep[axis])));
  if (!with_neighbors) return cells;
  for (int axis = 0; axis < 3; ++axis) {
    const auto first = hn::Eq(node[axis], hn::Zero(di)), last = hn::Eq(node[axis], hn::Set(di, 7));
    const VI before = hn::Set(di, -kStep[axis]), behind = hn::Set(di, 2 * kStep[axis]);
    cells.minus[axis] = hn::Add(cells.self, before);
    cells.plus[axis] = hn::Add(cells.self, behind);
    if (hn::AllFalse(di, hn::Or(first, last))) continue;
    const VI face = hn::Add(hn::Mul(brick, hn::Set(di, kFaces)), hn::IfThenElse(last, hn::Set(di, 2 * axis + 1), hn::Set(di, 2 * axis)));
    const VI beyond = hn::GatherIndex(di, faces, face);
    cells.minus[axis] = hn::Add(cells.self, hn::IfThenElse(first, beyond, before));
    cells.plus[axis] = hn::Add(cells.self, hn::IfThenElse(last, beyond, behind));
  }
  return cells;
}

/// The cell's own gradient.
HWY_INLINE V3 cell_gradient(const std::int16_t* values, const Cells& cells) {
  const I di;
  const auto row = [&](int element) { return gather_pair(values, hn::Add(cells.self, hn::Set(di, 2 * element))); };
  const Pair p00 = row(0), p01 = row(9), p10 = row(81), p11 = row(90);
  const VF x = cells.local.x, y = cells.local.y, z = cells.local.z;
  const VF z00 = lerp(p00.low, p00.high, z), z01 = lerp(p01.low, p01.high, z), z10 = lerp(p10.low, p10.high, z),
           z11 = lerp(p11.low, p11.high, z);
  const VF dz0 = lerp(hn::Sub(p00.high, p00.low), hn::Sub(p01.high, p01.low), y);
  const VF dz1 = lerp(hn::Sub(p10.high, p10.low), hn::Sub(p11.high, p11.low), y);
  return {hn::Sub(lerp(z10, z11, y), lerp(z00, z01, y)), lerp(hn::Sub(z01, z00), hn::Sub(z11, z10), x), lerp(dz0, dz1, x)};
}

struct Column {
  VF here, slope;
};

/// Central differences at the cell's nodes, interpolated: the same as differences of the interpolant itself, taken one voxel to either
/// side at the same place in the cells there.
HWY_INLINE V3 central_gradient(const std::int16_t* values, const Cells& cells) {
  const I di;
  const VF x = cells.local.x, y = cells.local.y, z = cells.local.z;
  const auto pair = [&](VI offset) { return gather_pair(values, offset); };
  const VI sy = hn::Set(di, 18), sx = hn::Set(di, 162), sz = hn::Set(di, 2);
  const auto value = [&](VI offset) {
    const Pair p = pair(offset);
    return lerp(p.low, p.high, z);
  };
  const VF ax = lerp(value(cells.minus[0]), value(hn::Add(cells.minus[0], sy)), y);
  const VF bx = lerp(value(cells.plus[0]), value(hn::Add(cells.plus[0], sy)), y);
  const VF ay = lerp(value(cells.minus[1]), value(hn::Add(cells.minus[1], sx)), x);
  const VF by = lerp(value(cells.plus[1]), value(hn::Add(cells.plus[1], sx)), x);
  // The cell's own four columns along z, from -1 to 2: a pair below, a pair above.
  const auto column = [&](VI across) {
    Column c;
    const Pair below = pair(hn::Add(cells.minus[2], across)), above = pair(hn::Add(hn::Sub(cells.plus[2], sz), across));
    c.here = lerp(below.high, above.low, z);
    c.slope = lerp(hn::Sub(above.low, below.low), hn::Sub(above.high, below.high), z);
    return c;
  };
  const auto c00 = column(hn::Zero(di)), c01 = column(sy), c10 = column(sx), c11 = column(hn::Add(sx, sy));
  const VF x0 = lerp(c00.here, c01.here, y), x1 = lerp(c10.here, c11.here, y);
  const VF y0 = lerp(c00.here, c10.here, x), y1 = lerp(c01.here, c11.here, x);
  // (f(p + e) - f(p - e)) with f(p + e) between the cell's far face and the one beyond it.
  return {hn::Sub(lerp(x1, bx, x), lerp(ax, x0, x)), hn::Sub(lerp(y1, by, y), lerp(ay, y0, y)),
          lerp(lerp(c00.slope, c01.slope, y), lerp(c10.slope, c11.slope, y), x)};
}

/// A uniform cubic B-spline's weights at local place u, and their derivatives, for the nodes -1, 0, 1 and 2.
struct SplineWeights {
  VF value[4], slope[4];
};
HWY_INLINE SplineWeights spline_weights(VF u) {
  const VF v = hn::Sub(set(1.0f), u), sixth = set(1.0f / 6.0f), half = set(0.5f), two = set(2.0f), more = set(1.5f),
           third = set(2.0f / 3.0f);
  const VF u2 = hn::Mul(u, u), v2 = hn::Mul(v, v);
  return {{hn::Mul(sixth, hn::Mul(v2, v)), hn::Sub(third, hn::Mul(u2, hn::Sub(set(1.0f), hn::Mul(half, u)))),
           hn::Sub(third, hn::Mul(v2, hn::Sub(set(1.0f), hn::Mul(half, v)))), hn::Mul(sixth, hn::Mul(u2, u))},
          {hn::Neg(hn::Mul(half, v2)), hn::Mul(u, hn::Sub(hn::Mul(more, u), two)), hn::Mul(v, hn::Sub(two, hn::Mul(more, v))),
           hn::Mul(half, u2)}};
}

/// The gradient of the cubic B-spline, in the brick's own steps.
HWY_INLINE V3 cubic_gradient(const SplineBricks& bricks, const Cells& cells, VI number) {
  const I di;
  const SplineWeights wx = spline_weights(cells.local.x), wy = spline_weights(cells.local.y), wz = spline_weights(cells.local.z);
  const VI seven = hn::Set(di, 7), side = hn::Set(di, kSplineNodes);
  const VI x0 = hn::And(hn::ShiftRight<6>(number), seven), y0 = hn::And(hn::ShiftRight<3>(number), seven), z0 = hn::And(number, seven);
  const VI corner = hn::Add(hn::Mul(hn::Add(hn::Mul(x0, side), y0), side), z0);
  const VI brick = hn::ShiftRight<9>(number), self = hn::Add(hn::Mul(brick, hn::Set(di, kSplineStride)), corner);
  const VI twice = hn::Add(self, self), plane = hn::Mul(brick, hn::Set(di, 3));
  const auto slope = [&](int axis) { return hn::GatherIndex(F(), bricks.planes.data()->slope, hn::Add(plane, hn::Set(di, axis))); };
  V3 g{slope(0), slope(1), slope(2)};
  for (int x = 0; x < 4; ++x) {
    VF across = set(0.0f), slope_y = set(0.0f), slope_z = set(0.0f);
    for (int y = 0; y < 4; ++y) {
      const VI row = hn::Add(twice, hn::Set(di, 2 * (x * kSplineNodes + y) * kSplineNodes));
      const Pair below = gather_pair(bricks.rests.data(), row), above = gather_pair(bricks.rests.data(), hn::Add(row, hn::Set(di, 4)));
      const auto weigh = [&](const VF* w) {
        return hn::Add(hn::Add(hn::Mul(w[0], below.low), hn::Mul(w[1], below.high)),
                       hn::Add(hn::Mul(w[2], above.low), hn::Mul(w[3], above.high)));
      };
      const VF here = weigh(wz.value);
      across = hn::Add(across, hn::Mul(wy.value[y], here));
      slope_y = hn::Add(slope_y, hn::Mul(wy.slope[y], here));
      slope_z = hn::Add(slope_z, hn::Mul(wy.value[y], weigh(wz.slope)));
    }
    g.x = hn::Add(g.x, hn::Mul(wx.slope[x], across));
    g.y = hn::Add(g.y, hn::Mul(wx.value[x], slope_y));
    g.z = hn::Add(g.z, hn::Mul(wx.value[x], slope_z));
  }
  return g;
}

}  // namespace
}  // namespace limn::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
