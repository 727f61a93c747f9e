// Hits: the first root of the trilinear interpolant along each ray. In the slab that bounds the surface in a brick the ray is walked cell
// by cell, and in each the interpolant along the ray is a cubic whose first root is found exactly (Hansson-Soderlund, Evans,
// Akenine-Moller, "Ray Tracing of Signed Distance Function Grids", JCGT 2022), by Newton's iteration with a bracket.
// Every lane's arithmetic is its own: hits depend neither on the packet nor on the SIMD target.

#include "raymarch/level_set/trace.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "sdf/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raymarch/level_set/trace.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace limn::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using F = hn::CappedTag<float, 16>;
using I = hn::RebindToSigned<F>;
using VF = hn::Vec<F>;
using VI = hn::Vec<I>;
using MF = hn::Mask<F>;

HWY_INLINE VF set(float v) { return hn::Set(F(), v); }
HWY_INLINE VF lerp(VF a, VF b, VF u) { return hn::Add(a, hn::Mul(u, hn::Sub(b, a))); }

struct V3 {
  VF x, y, z;
};

/// Rays of the tile by index coordinates. `t` keeps its meaning, so directions are not unit.
struct IndexRays {
  alignas(64) float origin[3][kRayBatchSize], direction[3][kRayBatchSize], inverse[3][kRayBatchSize];
};

HWY_INLINE V3 load3(const float (*from)[kRayBatchSize], size_t i) {
  return {hn::Load(F(), from[0] + i), hn::Load(F(), from[1] + i), hn::Load(F(), from[2] + i)};
}

void to_index_space(const Affine& index_from_render, const RayBatch& rays, size_t count, IndexRays& out) {
  const F d;
  for (int row = 0; row < 3; ++row) {
    const VF mx = set(static_cast<float>(index_from_render.linear[0][row])), my = set(static_cast<float>(index_from_render.linear[1][row])),
             mz = set(static_cast<float>(index_from_render.linear[2][row])),
             c = set(static_cast<float>(index_from_render.translation[row]));
    for (size_t i = 0; i < count; i += hn::Lanes(d)) {
      const VF o = hn::Add(hn::Add(hn::Mul(mx, hn::Load(d, rays.origin_x + i)), hn::Mul(my, hn::Load(d, rays.origin_y + i))),
                           hn::Add(hn::Mul(mz, hn::Load(d, rays.origin_z + i)), c));
      VF v = hn::Add(hn::Add(hn::Mul(mx, hn::Load(d, rays.direction_x + i)), hn::Mul(my, hn::Load(d, rays.direction_y + i))),
                     hn::Mul(mz, hn::Load(d, rays.direction_z + i)));
      // A ray along a grid plane: so small a slope that it never leaves its cell through it, and still has an inverse.
      v = hn::IfThenElse(hn::Lt(hn::Abs(v), set(1e-18f)), set(1e-18f), v);
      hn::Store(o, d, out.origin[row] + i);
      hn::Store(v, d, out.direction[row] + i);
      hn::Store(hn::Div(set(1.0f), v), d, out.inverse[row] + i);
    }
  }
}

/// A brick's numbers in every lane's reach.
struct Brick {
  const std::int16_t* values;
  const BrickHeader* header;
  std::int32_t index;
};

/// The pair of neighbours along z from `offset` (bytes) on, as floats.
struct Pair {
  VF low, high;
};
HWY_INLINE Pair gather_pair(const std::int16_t* base, VI offset) {
  const I i;
  const VI both = hn::GatherOffset(i, reinterpret_cast<const std::int32_t*>(base), offset);
  return {hn::ConvertTo(F(), hn::ShiftRight<16>(hn::ShiftLeft<16>(both))), hn::ConvertTo(F(), hn::ShiftRight<16>(both))};
}

struct Cubic {
  VF c0, c1, c2, c3;
  HWY_INLINE VF at(VF s) const { return hn::Add(c0, hn::Mul(s, hn::Add(c1, hn::Mul(s, hn::Add(c2, hn::Mul(s, c3)))))); }
  HWY_INLINE VF slope(VF s) const { return hn::Add(c1, hn::Mul(s, hn::Add(hn::Mul(set(2.0f), c2), hn::Mul(hn::Mul(set(3.0f), s), c3)))); }
};

/// The interpolant of the cell at `offset` from local place `from` on, along `step`, for s in [0, 1]; turned by `side`.
HWY_INLINE Cubic cubic_along(const std::int16_t* values, VI offset, const V3& from, const V3& step, VF side) {
  const I i;
  const auto row = [&](int element) { return gather_pair(values, hn::Add(offset, hn::Set(i, 2 * element))); };
  const Pair p00 = row(0), p01 = row(kBrickNodes), p10 = row(kBrickNodes * kBrickNodes), p11 = row(kBrickNodes * kBrickNodes + kBrickNodes);
  const auto along_z = [&](const Pair& p) {
    const VF difference = hn::Sub(p.high, p.low);
    return Pair{hn::Add(p.low, hn::Mul(from.z, difference)), hn::Mul(step.z, difference)};
  };
  struct Quadratic {
    VF c0, c1, c2;
  };
  const auto along_y = [&](const Pair& a, const Pair& b) {
    const VF d0 = hn::Sub(b.low, a.low), d1 = hn::Sub(b.high, a.high);
    return Quadratic{hn::Add(a.low, hn::Mul(from.y, d0)), hn::Add(hn::Add(a.high, hn::Mul(from.y, d1)), hn::Mul(step.y, d0)),
                     hn::Mul(step.y, d1)};
  };
  const Quadratic a = along_y(along_z(p00), along_z(p01)), b = along_y(along_z(p10), along_z(p11));
  const VF d0 = hn::Sub(b.c0, a.c0), d1 = hn::Sub(b.c1, a.c1), d2 = hn::Sub(b.c2, a.c2);
  return {hn::Mul(side, hn::Add(a.c0, hn::Mul(from.x, d0))),
          hn::Mul(side, hn::Add(hn::Add(a.c1, hn::Mul(from.x, d1)), hn::Mul(step.x, d0))),
          hn::Mul(side, hn::Add(hn::Add(a.c2, hn::Mul(from.x, d2)), hn::Mul(step.x, d1))), hn::Mul(side, hn::Mul(step.x, d2))};
}

/// Lanes of `active` whose cubic is <= 0 somewhere in [0, 1], and the first such place.
HWY_INLINE MF first_root(const Cubic& c, MF active, VF& root) {
  const VF zero = hn::Zero(F()), one = set(1.0f);
  // Where f falls, turns and rises again: the local minimum, in the form without cancellation.
  const VF discriminant = hn::Sub(hn::Mul(c.c2, c.c2), hn::Mul(set(3.0f), hn::Mul(c.c3, c.c1)));
  const VF radical = hn::Sqrt(hn::Max(discriminant, zero));
  const MF turned = hn::Gt(c.c2, zero);
  const VF minimum = hn::Div(hn::IfThenElse(turned, c.c1, hn::Sub(radical, c.c2)),
                             hn::IfThenElse(turned, hn::Sub(hn::Neg(c.c2), radical), hn::Mul(set(3.0f), c.c3)));
  const MF dips = hn::And(hn::And(hn::Gt(discriminant, zero), hn::Gt(minimum, zero)), hn::Lt(minimum, one));
  const VF at_minimum = c.at(hn::IfThenElse(dips, minimum, zero));
  const VF end = hn::IfThenElse(hn::And(dips, hn::Le(at_minimum, zero)), minimum, one);
  const VF at_end = c.at(end);
  const MF starts_inside = hn::Le(c.c0, zero);
  const MF found = hn::And(active, hn::Or(starts_inside, hn::Le(at_end, zero)));
  if (hn::AllFalse(F(), found)) return found;
  // f > 0 at `low`, f <= 0 at `high`, and one root between.
  VF low = zero, high = end;
  VF s = hn::Mul(end, hn::Div(c.c0, hn::Sub(c.c0, at_end)));
  MF open = hn::AndNot(starts_inside, found);
  for (int i = 0; i < 24 && !hn::AllFalse(F(), open); ++i) {
    const VF f = c.at(s);
    const MF before = hn::Gt(f, zero);
    low = hn::IfThenElse(hn::And(open, before), s, low);
    high = hn::IfThenElse(hn::AndNot(before, open), s, high);
    const VF newton = hn::Sub(s, hn::Div(f, c.slope(s)));
    const MF inside = hn::And(hn::Ge(newton, low), hn::Le(newton, high));
    const VF next = hn::IfThenElse(inside, newton, hn::Mul(set(0.5f), hn::Add(low, high)));
    const MF moved = hn::Gt(hn::Abs(hn::Sub(next, s)), set(1e-6f));
    s = hn::IfThenElse(open, next, s);
    open = hn::And(open, moved);
  }
  root = hn::IfThenElse(starts_inside, zero, s);
  return found;
}

/// One packet against one brick: shortens t and notes the brick where the ray meets the surface in it.
HWY_INLINE void trace_packet(const Brick& brick, const IndexRays& rays, const RayBatch& batch, size_t i, VF side, float slack,
                             BrickHits& hits) {
  const F d;
  const I di;
  const BrickHeader& header = *brick.header;
  const V3 o = load3(rays.origin, i), v = load3(rays.direction, i), inverse = load3(rays.inverse, i);
  const V3 local{hn::Sub(o.x, set(static_cast<float>(header.origin[0]))), hn::Sub(o.y, set(static_cast<float>(header.origin[1]))),
                 hn::Sub(o.z, set(static_cast<float>(header.origin[2])))};
  VF near = hn::Load(d, batch.t_min + i), far = hn::Load(d, batch.t_max + i);
  // Nearer hits only decide what is not looked at any more, never how a root is found: the order of the bricks does not matter.
  const VF before = hn::Load(d, hits.t + i);
  const auto clip = [&](size_t axis, VF from, VF slope) {
    const VF a = hn::Mul(hn::Sub(set(static_cast<float>(header.lower[axis]) - slack), from), slope);
    const VF b = hn::Mul(hn::Sub(set(static_cast<float>(header.upper[axis]) + slack), from), slope);
    near = hn::Max(near, hn::Min(a, b));
    far = hn::Min(far, hn::Max(a, b));
  };
  clip(0, local.x, inverse.x);
  clip(1, local.y, inverse.y);
  clip(2, local.z, inverse.z);
  if (hn::AllFalse(d, hn::Le(near, hn::Min(far, before)))) return;
  const VF nx = set(header.normal[0]), ny = set(header.normal[1]), nz = set(header.normal[2]);
  const VF height = hn::Sub(hn::Add(hn::Add(hn::Mul(nx, local.x), hn::Mul(ny, local.y)), hn::Mul(nz, local.z)), set(header.offset));
  const VF fall = hn::Add(hn::Add(hn::Mul(nx, v.x), hn::Mul(ny, v.y)), hn::Mul(nz, v.z));
  const float steepest = std::abs(header.normal[0]) + std::abs(header.normal[1]) + std::abs(header.normal[2]);
  const VF slab = set(header.slab + slack * steepest);
  const VF safe = hn::IfThenElse(hn::Lt(hn::Abs(fall), set(1e-12f)), set(1e-12f), fall);
  const VF per = hn::Div(set(1.0f), safe);
  const VF a = hn::Mul(hn::Sub(slab, height), per), b = hn::Mul(hn::Sub(hn::Neg(slab), height), per);
  near = hn::Max(near, hn::Min(a, b));
  far = hn::Min(far, hn::Max(a, b));
  MF active = hn::Le(near, hn::Min(far, before));
  if (hn::AllFalse(d, active)) return;
  const auto first_cell = [&](size_t axis, VF from, VF slope) {
    const VF p = hn::Floor(hn::Add(from, hn::Mul(near, slope)));
    return hn::Min(hn::Max(p, set(static_cast<float>(header.lower[axis]))), set(static_cast<float>(header.upper[axis] - 1)));
  };
  V3 cell{first_cell(0, local.x, v.x), first_cell(1, local.y, v.y), first_cell(2, local.z, v.z)};
  const VF one = set(1.0f), zero = hn::Zero(d);
  const MF right = hn::Gt(v.x, zero), up = hn::Gt(v.y, zero), back = hn::Gt(v.z, zero);
  while (true) {
    const auto leaves = [&](VF c, MF forward, VF from, VF slope) {
      return hn::Mul(hn::Sub(hn::Add(c, hn::IfThenElseZero(forward, one)), from), slope);
    };
    const VF tx = leaves(cell.x, right, local.x, inverse.x), ty = leaves(cell.y, up, local.y, inverse.y),
             tz = leaves(cell.z, back, local.z, inverse.z);
    const VF exit = hn::Min(tx, hn::Min(ty, tz));
    const VF end = hn::Max(near, hn::Min(exit, far));
    const VF length = hn::Sub(end, near);
    const V3 from{hn::Sub(hn::Add(local.x, hn::Mul(near, v.x)), cell.x), hn::Sub(hn::Add(local.y, hn::Mul(near, v.y)), cell.y),
                  hn::Sub(hn::Add(local.z, hn::Mul(near, v.z)), cell.z)};
    const V3 step{hn::Mul(length, v.x), hn::Mul(length, v.y), hn::Mul(length, v.z)};
    const VF node = hn::Add(hn::Add(hn::Mul(cell.x, set(162.0f)), hn::Mul(cell.y, set(18.0f))), hn::Add(cell.z, cell.z));
    const VI offset = hn::ConvertTo(di, hn::IfThenElseZero(active, node));
    VF s = zero;
    const MF found = first_root(cubic_along(brick.values, offset, from, step, side), active, s);
    if (!hn::AllFalse(d, found)) {
      const VF t = hn::Add(near, hn::Mul(s, length));
      const VF best = hn::Load(d, hits.t + i);
      const VI owner = hn::Load(di, hits.brick + i), own = hn::Set(di, brick.index);
      // Two bricks that share a face may both find a root on it: the one of the lower number, whatever the order.
      const MF nearer = hn::And(found, hn::Or(hn::Lt(t, best), hn::And(hn::Eq(t, best), hn::RebindMask(d, hn::Lt(own, owner)))));
      hn::Store(hn::IfThenElse(nearer, t, best), d, hits.t + i);
      hn::Store(hn::IfThenElse(hn::RebindMask(di, nearer), own, owner), di, hits.brick + i);
    }
    active = hn::And(hn::AndNot(found, active), hn::Lt(end, hn::Min(far, before)));
    if (hn::AllFalse(d, active)) return;
    // Through the face that is met first; by whole numbers, so that every step makes headway whatever the rounding.
    const MF by_x = hn::And(hn::Le(tx, ty), hn::Le(tx, tz)), by_y = hn::AndNot(by_x, hn::Le(ty, tz)), by_z = hn::Not(hn::Or(by_x, by_y));
    const auto advance = [&](VF c, MF by, MF forward, size_t axis) {
      const VF next = hn::Add(c, hn::IfThenElseZero(by, hn::IfThenElse(forward, one, set(-1.0f))));
      const MF within =
          hn::And(hn::Ge(next, set(static_cast<float>(header.lower[axis]))), hn::Lt(next, set(static_cast<float>(header.upper[axis]))));
      active = hn::And(active, within);
      return next;
    };
    cell.x = advance(cell.x, by_x, right, 0);
    cell.y = advance(cell.y, by_y, up, 1);
    cell.z = advance(cell.z, by_z, back, 2);
    if (hn::AllFalse(d, active)) return;
    near = end;
  }
}

struct Cells {
  VI self;               ///< Byte offset of the cell's first node in all bricks' values.
  V3 local;              ///< Place in the cell, 0..1.
  VI minus[3], plus[3];  ///< The same node shifted by one along an axis, and by two: where they lie.
};

/// Where the stencil of each hit's cell lies; lanes without a hit are given the first brick's first cell.
HWY_INLINE Cells cells_of(const RayBricks& bricks, const IndexRays& rays, size_t i, VF t, VI brick, bool with_neighbors) {
  const F d;
  const I di;
  constexpr int kHeader = sizeof(BrickHeader) / 4, kFaces = 6;
  static_assert(sizeof(BrickHeader) % 4 == 0);
  const VI header = hn::Mul(brick, hn::Set(di, kHeader));
  const auto* words = reinterpret_cast<const std::int32_t*>(bricks.headers.data());
  const auto* faces = reinterpret_cast<const std::int32_t*>(bricks.neighbors.data());
  const VI base = hn::Mul(brick, hn::Set(di, static_cast<int>(kBrickStride * sizeof(std::int16_t))));
  Cells cells;
  const V3 o = load3(rays.origin, i), v = load3(rays.direction, i);
  VI node[3];
  const auto place = [&](int axis, VF from, VF slope) {
    const VF origin = hn::ConvertTo(d, hn::GatherIndex(di, words + axis, header));
    const VF p = hn::Add(hn::Sub(from, origin), hn::Mul(t, slope));
    const VF cell = hn::Min(hn::Max(hn::Floor(p), hn::Zero(d)), set(7.0f));
    node[axis] = hn::ConvertTo(di, cell);
    return hn::Min(hn::Max(hn::Sub(p, cell), hn::Zero(d)), set(1.0f));
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
    cells.minus[axis] = hn::Sub(cells.self, hn::Set(di, kStep[axis]));
    cells.plus[axis] = hn::Add(cells.self, hn::Set(di, 2 * kStep[axis]));
    if (hn::AllFalse(di, hn::Or(first, last))) continue;
    const VI face = hn::Add(hn::Mul(brick, hn::Set(di, kFaces)), hn::IfThenElse(last, hn::Set(di, 2 * axis + 1), hn::Set(di, 2 * axis)));
    const VI beside = hn::Max(hn::GatherIndex(di, faces, face), hn::Zero(di));
    const VI shift = hn::Mul(hn::Sub(beside, brick), hn::Set(di, static_cast<int>(kBrickStride * sizeof(std::int16_t))));
    // Node -1 is node 7 of the brick before, node 9 is node 1 of the one behind.
    cells.minus[axis] = hn::Add(cells.minus[axis], hn::IfThenElseZero(first, hn::Add(shift, hn::Set(di, 8 * kStep[axis]))));
    cells.plus[axis] = hn::Add(cells.plus[axis], hn::IfThenElseZero(last, hn::Sub(shift, hn::Set(di, 8 * kStep[axis]))));
  }
  return cells;
}

/// The cell's own gradient.
HWY_INLINE V3 cell_gradient(const std::int16_t* values, const Cells& cells) {
  const I di;
  const auto row = [&](int element) { return gather_pair(values, hn::Add(cells.self, hn::Set(di, 2 * element))); };
  const Pair p00 = row(0), p01 = row(9), p10 = row(81), p11 = row(90);
  const auto& [x, y, z] = cells.local;
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
  const auto& [x, y, z] = cells.local;
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

void write_packet(const BrickTrace& what, const IndexRays& rays, const RayBatch& batch, size_t i, const BrickHits& found, HitBatch& hits) {
  const F d;
  const I di;
  const VI brick = hn::Load(di, found.brick + i);
  const auto hit = hn::Gt(brick, hn::Set(di, -1));
  if (hn::AllFalse(di, hit)) return;
  const VF t = hn::Load(d, found.t + i);
  const RayBricks& bricks = *what.view->bricks;
  const Cells cells = cells_of(bricks, rays, i, hn::IfThenElseZero(hn::RebindMask(d, hit), t), hn::Max(brick, hn::Zero(di)),
                               what.gradient == BrickGradient::central);
  const V3 g =
      what.gradient == BrickGradient::central ? central_gradient(bricks.values.data(), cells) : cell_gradient(bricks.values.data(), cells);
  const float* const m = what.normal_from_index;
  const auto row = [&](int k) {
    return hn::Add(hn::Add(hn::Mul(set(m[k]), g.x), hn::Mul(set(m[k + 3]), g.y)), hn::Mul(set(m[k + 6]), g.z));
  };
  const VF x = row(0), y = row(1), z = row(2);
  const VF length2 = hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
  const MF degenerate = hn::Not(hn::Gt(length2, hn::Zero(d)));
  const VF per = hn::Div(set(1.0f), hn::Sqrt(hn::IfThenElse(degenerate, set(1.0f), length2)));
  // A kink whose sides cancel out: the ray's own direction shows the surface face on.
  const auto write = [&](VF n, const float* direction, float* to) {
    const VF v = hn::IfThenElse(degenerate, hn::Neg(hn::Load(d, direction + i)), hn::Mul(n, per));
    hn::BlendedStore(v, hn::RebindMask(d, hit), d, to + i);
  };
  write(x, batch.direction_x, hits.normal_x);
  write(y, batch.direction_y, hits.normal_y);
  write(z, batch.direction_z, hits.normal_z);
  hn::BlendedStore(t, hn::RebindMask(d, hit), d, hits.t + i);
  hn::BlendedStore(hn::Set(di, -1), hit, di, hits.face + i);
  hn::BlendedStore(hn::Zero(di), hit, di, hits.material + i);
  for (size_t k = i; k < i + hn::Lanes(d); ++k) {
    if (found.brick[k] >= 0) hits.status[k] = HitStatus::hit;
  }
}

/// Pixels of `tile` that an entry of the list's tile at (x, y) covers, as blocks; false where none.
struct BlockRange {
  int x0, y0, x1, y1;
};
bool blocks_of(const BrickInTile& entry, int x, int y, const PixelTile& tile, BlockRange& out) {
  const int x0 = std::max(entry.x0 + x - tile.x, 0), x1 = std::min(entry.x1 + x - tile.x, tile.width - 1);
  const int y0 = std::max(entry.y0 + y - tile.y, 0), y1 = std::min(entry.y1 + y - tile.y, tile.height - 1);
  out = {x0 >> 2, y0 >> 2, x1 >> 2, y1 >> 2};
  return x0 <= x1 && y0 <= y1;
}

void TraceBricks(const BrickTrace& what, const PixelTile& tile, const RayBatch& rays, HitBatch& hits) {
  const F d;
  const BrickView& view = *what.view;
  const RayBricks& bricks = *view.bricks;
  const size_t lanes = hn::Lanes(d), count = static_cast<size_t>(rays.count);
  IndexRays index_rays;
  BrickHits found;
  to_index_space(view.index_from_render, rays, count, index_rays);
  std::copy_n(rays.t_max, count, found.t);
  std::fill_n(found.brick, count, -1);
  const VF side = set(view.side);
  const int across = (tile.width + 3) / 4;
  for (int row = tile.y / kViewTile_px; row <= (tile.y + tile.height - 1) / kViewTile_px; ++row) {
    for (int column = tile.x / kViewTile_px; column <= (tile.x + tile.width - 1) / kViewTile_px; ++column) {
      for (const BrickInTile& entry : view.tile(column, row)) {
        BlockRange range;
        if (!blocks_of(entry, column * kViewTile_px, row * kViewTile_px, tile, range)) continue;
        const Brick brick{bricks.values.data() + size_t{entry.brick} * kBrickStride, &bricks.headers[entry.brick],
                          static_cast<std::int32_t>(entry.brick)};
        for (int y = range.y0; y <= range.y1; ++y) {
          for (int x = range.x0; x <= range.x1; ++x) {
            const size_t first = static_cast<size_t>(y * across + x) * 16;
            for (size_t i = first; i < first + 16; i += lanes) trace_packet(brick, index_rays, rays, i, side, view.slack_voxels, found);
          }
        }
      }
    }
  }
  for (size_t i = 0; i < count; i += lanes) write_packet(what, index_rays, rays, i, found, hits);
}

}  // namespace
}  // namespace limn::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace limn {
HWY_EXPORT(TraceBricks);
void trace_bricks(const BrickTrace& what, const PixelTile& tile, const RayBatch& rays, HitBatch& hits) {
  HWY_DYNAMIC_DISPATCH(TraceBricks)(what, tile, rays, hits);
}
}  // namespace limn
#endif
