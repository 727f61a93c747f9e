// Internal: gradients at hits, sixteen or fewer at a time. Included once for each SIMD target.

#if defined(LIMN_RAYMARCH_LEVEL_SET_GRADIENTS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LIMN_RAYMARCH_LEVEL_SET_GRADIENTS_INL_H
#undef LIMN_RAYMARCH_LEVEL_SET_GRADIENTS_INL_H
#else
#define LIMN_RAYMARCH_LEVEL_SET_GRADIENTS_INL_H
#endif

#include "raymarch/level_set/pairs-inl.h"

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
  const VI base = hn::GatherIndex(di, bricks.first.data(), brick);
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
  constexpr int kStep[3] = {kStepX, kStepY, 2};
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
  const FourPairs rows = pairs_along_y(values, cells.self, hn::Add(cells.self, hn::Set(I(), kStepX)));
  const Pair &p00 = rows.p[0], &p01 = rows.p[1], &p10 = rows.p[2], &p11 = rows.p[3];
  const VF x = cells.local.x, y = cells.local.y, z = cells.local.z;
  const VF z00 = lerp(p00.low, p00.high, z), z01 = lerp(p01.low, p01.high, z), z10 = lerp(p10.low, p10.high, z),
           z11 = lerp(p11.low, p11.high, z);
  const VF dz0 = lerp(hn::Sub(p00.high, p00.low), hn::Sub(p01.high, p01.low), y);
  const VF dz1 = lerp(hn::Sub(p10.high, p10.low), hn::Sub(p11.high, p11.low), y);
  return {hn::Sub(lerp(z10, z11, y), lerp(z00, z01, y)), lerp(hn::Sub(z01, z00), hn::Sub(z11, z10), x), lerp(dz0, dz1, x)};
}

/// The 32 nodes that central differences about a cell read, as pairs along z: two rows beyond each face across x and y, and the cell's own
/// four columns from -1 to 2.
struct CentralStencil {
  FourPairs beside_x, beside_y;  ///< Two before the cell, two behind it.
  FourPairs below, above;        ///< Columns x 2 + y: nodes -1 and 0, 1 and 2.
};

/// Of the lanes `hit`, at least one, each distinct cell is loaded once. A packet covers few cells where voxels are larger than pixels;
/// where they are smaller this takes no longer than a load for each lane and turning the lanes' words round in registers.
HWY_INLINE CentralStencil load_central(const std::int16_t* values, const Cells& cells, VI number, MF hit) {
  const I di;
  alignas(64) std::int32_t at[6][hn::MaxLanes(di)], numbers[hn::MaxLanes(di)];
  hn::Store(number, di, numbers);
  for (int axis = 0; axis < 3; ++axis) {
    hn::Store(cells.minus[axis], di, at[axis]);
    hn::Store(cells.plus[axis], di, at[3 + axis]);
  }
  VI words[16];
  for (VI& word : words) word = hn::Zero(di);
  for (auto rest = hn::RebindMask(di, hit); !hn::AllFalse(di, rest);) {
    const auto lane = static_cast<size_t>(hn::FindKnownFirstTrue(di, rest));
    const auto same = hn::And(rest, hn::Eq(number, hn::Set(di, numbers[lane])));
    rest = hn::AndNot(same, rest);
    const auto take = [&](size_t word, std::int32_t a, std::int32_t b, std::int32_t step) {
      words[word] = hn::IfThenElse(same, word_at(values, a), words[word]);
      words[word + 1] = hn::IfThenElse(same, word_at(values, a + step), words[word + 1]);
      words[word + 2] = hn::IfThenElse(same, word_at(values, b), words[word + 2]);
      words[word + 3] = hn::IfThenElse(same, word_at(values, b + step), words[word + 3]);
    };
    const std::int32_t below = at[2][lane], above = at[5][lane] - 2;
    take(0, at[0][lane], at[3][lane], kStepY);
    take(4, at[1][lane], at[4][lane], kStepX);
    take(8, below, below + kStepX, kStepY);
    take(12, above, above + kStepX, kStepY);
  }
  const auto four = [&](size_t word) {
    return FourPairs{{pair_of(words[word]), pair_of(words[word + 1]), pair_of(words[word + 2]), pair_of(words[word + 3])}};
  };
  return {four(0), four(4), four(8), four(12)};
}

/// The interpolant on the line through a place along one axis, where it meets the faces of the cell and of those beside it: at -1, 0, 1, 2.
struct Section {
  VF before, near, far, after;
  /// Its difference over two voxels about the place u.
  HWY_INLINE VF slope(VF u) const { return hn::Sub(lerp(far, after, u), lerp(before, near, u)); }
  /// By how much twice a curve through the four stands off twice its chord at u: of the second differences about 0 and 1 the one nearer to
  /// zero (Harten, Engquist, Osher, Chakravarthy 1987), so that no kink beside the cell is felt in it.
  HWY_INLINE VF sag(VF u) const {
    const VF zero = hn::Zero(F()), across = hn::Sub(far, near);
    const VF at_near = hn::Sub(across, hn::Sub(near, before)), at_far = hn::Sub(hn::Sub(after, far), across);
    const VF bend = hn::Add(hn::Max(hn::Min(at_near, at_far), zero), hn::Min(hn::Max(at_near, at_far), zero));
    return hn::Mul(hn::Mul(u, hn::Sub(set(1.0f), u)), bend);
  }
};
struct Sections {
  Section x, y, z;
};

HWY_INLINE Sections sections(const CentralStencil& s, const V3& at) {
  const auto along_z = [&](const Pair& p) { return lerp(p.low, p.high, at.z); };
  const auto across = [&](VF c00, VF c01, VF c10, VF c11) { return lerp(lerp(c00, c01, at.y), lerp(c10, c11, at.y), at.x); };
  VF here[4];
  for (int k = 0; k < 4; ++k) here[k] = lerp(s.below.p[k].high, s.above.p[k].low, at.z);
  return {{lerp(along_z(s.beside_x.p[0]), along_z(s.beside_x.p[1]), at.y), lerp(here[0], here[1], at.y), lerp(here[2], here[3], at.y),
           lerp(along_z(s.beside_x.p[2]), along_z(s.beside_x.p[3]), at.y)},
          {lerp(along_z(s.beside_y.p[0]), along_z(s.beside_y.p[1]), at.x), lerp(here[0], here[2], at.x), lerp(here[1], here[3], at.x),
           lerp(along_z(s.beside_y.p[2]), along_z(s.beside_y.p[3]), at.x)},
          {across(s.below.p[0].low, s.below.p[1].low, s.below.p[2].low, s.below.p[3].low),
           across(s.below.p[0].high, s.below.p[1].high, s.below.p[2].high, s.below.p[3].high),
           across(s.above.p[0].low, s.above.p[1].low, s.above.p[2].low, s.above.p[3].low),
           across(s.above.p[0].high, s.above.p[1].high, s.above.p[2].high, s.above.p[3].high)}};
}

/// Along the ray. Beyond the cell its polynomials go on: by so little that on smooth surfaces they are still the next cell's.
HWY_INLINE V3 moved(const V3& at, const V3& direction, VF t) {
  return {hn::Add(at.x, hn::Mul(t, direction.x)), hn::Add(at.y, hn::Mul(t, direction.y)), hn::Add(at.z, hn::Mul(t, direction.z))};
}

/// Newton's step along the ray towards the root of what has this value and gradient, by a quarter of a voxel at most, so that hits in one
/// cell and the next go on from each other. `side`: the sign of the values before the trilinear root, from which the value falls (towards
/// the other sign). A ray that grazes is taken to fall a sixteenth as steeply as it could: the step's theory is of first order. Where it
/// rises, which at sharp edges it may, it has no root near here to go to: the step, however long it may be, fades out, and jumps nowhere
/// between. Faded before it is cut off it would go from a quarter of a voxel to none within a few thousandths of one.
HWY_INLINE VF newton_step(VF value, const V3& gradient, const V3& direction, VF side) {
  const V3 product{hn::Mul(gradient.x, direction.x), hn::Mul(gradient.y, direction.y), hn::Mul(gradient.z, direction.z)};
  const VF fall = hn::Neg(hn::Mul(side, hn::Add(hn::Add(product.x, product.y), product.z)));
  const VF steepest = hn::Add(hn::Add(hn::Abs(product.x), hn::Abs(product.y)), hn::Abs(product.z));
  const MF flat = hn::Eq(steepest, hn::Zero(F()));
  const VF most_fall = hn::IfThenElse(flat, set(1.0f), steepest), least_fall = hn::Mul(set(1.0f / 16.0f), most_fall);
  const VF share = hn::Min(hn::Add(set(1.0f), hn::Div(fall, most_fall)), set(1.0f));
  const VF most = hn::Div(set(0.25f), hn::Max(hn::Abs(direction.x), hn::Max(hn::Abs(direction.y), hn::Abs(direction.z))));
  const VF step = hn::IfThenElse(flat, hn::Zero(F()), hn::Div(hn::Mul(side, value), hn::Max(fall, least_fall)));
  return hn::Mul(share, hn::Max(hn::Min(step, most), hn::Neg(most)));
}

/// A hit's gradient, and how far along the ray it lies from the trilinear root.
struct Settled {
  V3 gradient;
  VF move;
};

/// Central differences at the cell's nodes, interpolated: the same as differences of the interpolant itself, taken one voxel to either
/// side at the same place in the cells there. The hit goes to where the interpolant, less its chords' sag, has its root.
HWY_INLINE Settled central_gradient(const std::int16_t* values, const Cells& cells, VI number, MF hit, const V3& direction, VF side) {
  const CentralStencil stencil = load_central(values, cells, number, hit);
  const auto gradient = [](const Sections& s, const V3& at) { return V3{s.x.slope(at.x), s.y.slope(at.y), s.z.slope(at.z)}; };
  const Sections first = sections(stencil, cells.local);
  const V3& at = cells.local;
  const VF sag = hn::Add(hn::Add(first.x.sag(at.x), first.y.sag(at.y)), first.z.sag(at.z));
  const VF move = newton_step(hn::Neg(sag), gradient(first, at), direction, side);
  const V3 there = moved(at, direction, move);
  return {gradient(sections(stencil, there), there), move};
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

/// The 4^3 coefficients that a cell reads, row by row along z, and the plane that they are less.
struct SplineStencil {
  Pair below[16], above[16];
  V3 slope;
  VF offset;  ///< Of the plane at the cell's first node.
};

HWY_INLINE SplineStencil gather_spline(const SplineBricks& bricks, VI number) {
  const I di;
  const F d;
  const VI seven = hn::Set(di, 7), side = hn::Set(di, kSplineNodes);
  const VI x0 = hn::And(hn::ShiftRight<6>(number), seven), y0 = hn::And(hn::ShiftRight<3>(number), seven), z0 = hn::And(number, seven);
  const VI corner = hn::Add(hn::Mul(hn::Add(hn::Mul(x0, side), y0), side), z0);
  const VI brick = hn::ShiftRight<9>(number), self = hn::Add(hn::Mul(brick, hn::Set(di, kSplineStride)), corner);
  const VI twice = hn::Add(self, self), plane = hn::ShiftLeft<2>(brick);
  SplineStencil stencil;
  for (int k = 0; k < 16; k += 2) {
    const VI row = hn::Add(twice, hn::Set(di, 2 * (k / 4 * kSplineNodes + k % 4) * kSplineNodes));
    const FourPairs rows = spline_rows(bricks.rests.data(), row);
    stencil.below[k] = rows.p[0];
    stencil.above[k] = rows.p[1];
    stencil.below[k + 1] = rows.p[2];
    stencil.above[k + 1] = rows.p[3];
  }
  const FourValues of_plane = four_values(bricks.planes.data()->slope, plane);
  stencil.slope = {of_plane.v[0], of_plane.v[1], of_plane.v[2]};
  const V3 node = {hn::ConvertTo(d, x0), hn::ConvertTo(d, y0), hn::ConvertTo(d, z0)};
  stencil.offset = hn::Add(of_plane.v[3], dot(stencil.slope, node));
  return stencil;
}

struct SplinePoint {
  V3 gradient;
  VF value;
};

HWY_INLINE SplinePoint spline_at(const SplineStencil& stencil, const V3& at) {
  const SplineWeights wx = spline_weights(at.x), wy = spline_weights(at.y), wz = spline_weights(at.z);
  SplinePoint p{stencil.slope, hn::Add(stencil.offset, dot(stencil.slope, at))};
  for (int x = 0; x < 4; ++x) {
    VF across = set(0.0f), slope_y = set(0.0f), slope_z = set(0.0f);
    for (int y = 0; y < 4; ++y) {
      const Pair below = stencil.below[4 * x + y], above = stencil.above[4 * x + y];
      const auto weigh = [&](const VF* w) {
        return hn::Add(hn::Add(hn::Mul(w[0], below.low), hn::Mul(w[1], below.high)),
                       hn::Add(hn::Mul(w[2], above.low), hn::Mul(w[3], above.high)));
      };
      const VF here = weigh(wz.value);
      across = hn::Add(across, hn::Mul(wy.value[y], here));
      slope_y = hn::Add(slope_y, hn::Mul(wy.slope[y], here));
      slope_z = hn::Add(slope_z, hn::Mul(wy.value[y], weigh(wz.slope)));
    }
    p.value = hn::Add(p.value, hn::Mul(wx.value[x], across));
    p.gradient.x = hn::Add(p.gradient.x, hn::Mul(wx.slope[x], across));
    p.gradient.y = hn::Add(p.gradient.y, hn::Mul(wx.value[x], slope_y));
    p.gradient.z = hn::Add(p.gradient.z, hn::Mul(wx.value[x], slope_z));
  }
  return p;
}

/// The gradient of the cubic B-spline, in the brick's own steps, where the spline has its root.
HWY_INLINE Settled cubic_gradient(const SplineBricks& bricks, const Cells& cells, VI number, const V3& direction, VF side) {
  const SplineStencil stencil = gather_spline(bricks, number);
  const SplinePoint first = spline_at(stencil, cells.local);
  const VF move = newton_step(first.value, first.gradient, direction, side);
  return {spline_at(stencil, moved(cells.local, direction, move)).gradient, move};
}

}  // namespace
}  // namespace limn::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
