// Internal: rays wait until a packet of them is full, and a full packet solves a cell each. Included once for each SIMD target.

#if defined(LIMN_RAYMARCH_LEVEL_SET_WAITING_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LIMN_RAYMARCH_LEVEL_SET_WAITING_INL_H
#undef LIMN_RAYMARCH_LEVEL_SET_WAITING_INL_H
#else
#define LIMN_RAYMARCH_LEVEL_SET_WAITING_INL_H
#endif

#include <algorithm>
#include <cmath>
#include <cstring>

#include "raymarch/level_set/roots-inl.h"
#include "sdf/packing-inl.h"

HWY_BEFORE_NAMESPACE();
namespace limn::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

/// Rays that may meet the surface in a cell of a brick, waiting until a packet of them is full. Places are local to the brick.
struct Waiting {
  // A block of 16 rays adds at most 16, a packet puts back at most as many as it takes.
  static constexpr size_t kCapacity = 64;
  alignas(64) float origin[3][kCapacity], direction[3][kCapacity], inverse[3][kCapacity];
  alignas(64) float cell[3][kCapacity];
  alignas(64) float near[kCapacity], far[kCapacity];
  alignas(64) std::int32_t lane[kCapacity];
  alignas(64) std::int32_t group[kCapacity];
  alignas(64) std::int32_t box[kCapacity];  ///< First and last of the crossed cells along x, y and z, five bits each.
  size_t count = 0;
};

/// A packet of Waiting.
struct Candidates {
  V3 origin, direction, inverse, cell;
  VF near, far;
  VI lane, group, box;
};

HWY_INLINE void push(const Candidates& c, MF which, Waiting& waiting) {
  const F d;
  const I di;
  const size_t at = waiting.count;
  const auto packing = packing_of(d, which);
  const auto put = [&](VF v, float* to) { hn::StoreU(packed(v, packing), d, to + at); };
  const auto put3 = [&](const V3& v, float(*to)[Waiting::kCapacity]) {
    put(v.x, to[0]);
    put(v.y, to[1]);
    put(v.z, to[2]);
  };
  const auto puti = [&](VI v, std::int32_t* to) { hn::StoreU(packed(v, packing), di, to + at); };
  put3(c.origin, waiting.origin);
  put3(c.direction, waiting.direction);
  put3(c.inverse, waiting.inverse);
  put3(c.cell, waiting.cell);
  put(c.near, waiting.near);
  put(c.far, waiting.far);
  puti(c.lane, waiting.lane);
  puti(c.group, waiting.group);
  puti(c.box, waiting.box);
  waiting.count += hn::CountTrue(d, which);
}

/// What bounds the surface in a brick or group, for a packet of rays.
struct Bound {
  V3 origin, lower, upper;  ///< The box with the slack about it, local.
  V3 first, last;           ///< Crossed cells, local.
  V3 normal;
  VF offset, slab;
  VI group, box;
};

HWY_INLINE Bound bound_of(const SurfaceBound& bound, std::int32_t group, float slack) {
  const I di;
  const auto each = [](const auto& value) { return V3{set(value(0)), set(value(1)), set(value(2))}; };
  const float steepest = std::abs(bound.normal[0]) + std::abs(bound.normal[1]) + std::abs(bound.normal[2]);
  return {each([&](size_t axis) { return static_cast<float>(bound.origin[axis]); }),
          each([&](size_t axis) { return static_cast<float>(bound.lower[axis]) - slack; }),
          each([&](size_t axis) { return static_cast<float>(bound.upper[axis]) + slack; }),
          each([&](size_t axis) { return static_cast<float>(bound.lower[axis]); }),
          each([&](size_t axis) { return static_cast<float>(bound.upper[axis] - 1); }),
          each([&](size_t axis) { return bound.normal[axis]; }),
          set(bound.offset),
          set(bound.slab + slack * steepest),
          hn::Set(di, group),
          hn::Set(di, bound.lower[0] | (bound.upper[0] - 1) << 5 | bound.lower[1] << 10 | (bound.upper[1] - 1) << 15 |
                          bound.lower[2] << 20 | (bound.upper[2] - 1) << 25)};
}

/// A packet of a tile's rays against one brick: those that come near the surface in it join the waiting ones. Box and slab are asked
/// together: a branch between them is so often foreseen wrongly that it takes longer than the slab.
HWY_INLINE void enter_packet(const Bound& bound, const IndexRays& rays, const RayBatch& batch, size_t i, const BrickHits& hits,
                             Waiting& waiting) {
  const F d;
  const V3 o = load3(rays.origin, i);
  Candidates c;
  c.direction = load3(rays.direction, i);
  c.inverse = load3(rays.inverse, i);
  c.origin = {hn::Sub(o.x, bound.origin.x), hn::Sub(o.y, bound.origin.y), hn::Sub(o.z, bound.origin.z)};
  c.near = hn::Load(d, batch.t_min + i);
  c.far = hn::Load(d, batch.t_max + i);
  const auto clip = [&](VF lower, VF upper, VF from, VF inverse) {
    const VF a = hn::Mul(hn::Sub(lower, from), inverse), b = hn::Mul(hn::Sub(upper, from), inverse);
    c.near = hn::Max(c.near, hn::Min(a, b));
    c.far = hn::Min(c.far, hn::Max(a, b));
  };
  clip(bound.lower.x, bound.upper.x, c.origin.x, c.inverse.x);
  clip(bound.lower.y, bound.upper.y, c.origin.y, c.inverse.y);
  clip(bound.lower.z, bound.upper.z, c.origin.z, c.inverse.z);
  // Nearer hits only decide what is not looked at any more, never how a root is found: the order of the bricks does not matter.
  const VF before = hn::Load(d, hits.t + i);
  const VF height = hn::Sub(dot(bound.normal, c.origin), bound.offset), slope = dot(bound.normal, c.direction);
  const VF per = hn::Div(set(1.0f), hn::IfThenElse(hn::Lt(hn::Abs(slope), set(1e-12f)), set(1e-12f), slope));
  const VF a = hn::Mul(hn::Sub(bound.slab, height), per), b = hn::Mul(hn::Sub(hn::Neg(bound.slab), height), per);
  c.near = hn::Max(c.near, hn::Min(a, b));
  c.far = hn::Min(c.far, hn::Max(a, b));
  const MF active = hn::Le(c.near, hn::Min(c.far, before));
  if (hn::AllFalse(d, active)) return;
  const auto first_cell = [&](VF first, VF last, VF from, VF slope_of) {
    return hn::Min(hn::Max(hn::Floor(hn::Add(from, hn::Mul(c.near, slope_of))), first), last);
  };
  c.cell = {first_cell(bound.first.x, bound.last.x, c.origin.x, c.direction.x),
            first_cell(bound.first.y, bound.last.y, c.origin.y, c.direction.y),
            first_cell(bound.first.z, bound.last.z, c.origin.z, c.direction.z)};
  c.lane = hn::Iota(I(), static_cast<std::int32_t>(i));
  c.group = bound.group;
  c.box = bound.box;
  push(c, active, waiting);
}

/// Takes the last ones, a packet at most.
HWY_INLINE Candidates pop(Waiting& waiting, MF& active) {
  const F d;
  const I di;
  const size_t number = std::min(waiting.count, hn::Lanes(d)), at = waiting.count - number;
  waiting.count = at;
  active = hn::FirstN(d, number);
  const auto get3 = [&](const float(*from)[Waiting::kCapacity]) {
    return V3{hn::LoadU(d, from[0] + at), hn::LoadU(d, from[1] + at), hn::LoadU(d, from[2] + at)};
  };
  return {get3(waiting.origin),
          get3(waiting.direction),
          get3(waiting.inverse),
          get3(waiting.cell),
          hn::LoadU(d, waiting.near + at),
          hn::LoadU(d, waiting.far + at),
          hn::LoadU(di, waiting.lane + at),
          hn::LoadU(di, waiting.group + at),
          hn::LoadU(di, waiting.box + at)};
}

/// Two bricks that share a face may both find a root on it: that of the lower number counts, whatever the order.
HWY_INLINE void note(VF t, VI lane, VI cell, MF found, BrickHits& hits) {
  const F d;
  const I di;
  HWY_ALIGN float ts[16];
  HWY_ALIGN std::int32_t lanes[16], cells[16];
  const auto packing = packing_of(d, found);
  hn::Store(packed(t, packing), d, ts);
  hn::Store(packed(lane, packing), di, lanes);
  hn::Store(packed(cell, packing), di, cells);
  const size_t count = hn::CountTrue(d, found);
  for (size_t k = 0; k < count; ++k) {
    const std::int32_t to = lanes[k];
    if (ts[k] > hits.t[to] || (ts[k] == hits.t[to] && hits.cell[to] >= 0 && hits.cell[to] <= cells[k])) continue;
    hits.t[to] = ts[k];
    hits.cell[to] = cells[k];
  }
}

/// A packet's cells: numbers as in BrickHits, and where their values lie.
struct CellsOfBricks {
  VI number, offset;
  MF there;  ///< The cell is kept.
};

HWY_INLINE CellsOfBricks cells_in_bricks(const RayBricks& bricks, const BrickGroups& groups, const Candidates& c, MF active) {
  const F d;
  const I di;
  const hn::RebindToUnsigned<I> du;
  const VI x = hn::ConvertTo(di, c.cell.x), y = hn::ConvertTo(di, c.cell.y), z = hn::ConvertTo(di, c.cell.z), seven = hn::Set(di, 7);
  VI brick = c.group;
  if (groups.shift > 3) {
    const int bits = groups.shift - 3;
    const auto slot = [&](VI v) { return hn::ShiftRight<3>(v); };
    const VI part = hn::Or(hn::Or(hn::ShiftLeftSame(slot(x), 2 * bits), hn::ShiftLeftSame(slot(y), bits)), slot(z));
    brick = hn::GatherIndex(di, groups.bricks.data(), hn::Add(hn::ShiftLeftSame(c.group, 3 * bits), part));
    // -1: the surface crosses none of the brick's cells.
    active = hn::And(active, hn::RebindMask(d, hn::Gt(brick, hn::Set(di, -1))));
  }
  brick = hn::IfThenElseZero(hn::RebindMask(di, active), brick);
  const VI lx = hn::And(x, seven), ly = hn::And(y, seven), lz = hn::And(z, seven);
  CellsOfBricks cells;
  cells.number = hn::Add(hn::ShiftLeft<9>(brick), hn::Or(hn::Or(hn::ShiftLeft<6>(lx), hn::ShiftLeft<3>(ly)), lz));
  const VI row = hn::Add(hn::Mul(lx, hn::Set(di, 81)), hn::Add(hn::Add(hn::ShiftLeft<3>(ly), ly), lz));
  const VI bits = hn::GatherIndex(di, reinterpret_cast<const std::int32_t*>(bricks.kept.data()), hn::ShiftRight<5>(cells.number));
  const auto bit = hn::And(hn::Shr(hn::BitCast(du, bits), hn::BitCast(du, hn::And(cells.number, hn::Set(di, 31)))), hn::Set(du, 1u));
  cells.there = hn::And(active, hn::RebindMask(d, hn::Ne(hn::BitCast(di, bit), hn::Zero(di))));
  const VI first = hn::GatherIndex(di, bricks.first.data(), brick);
  cells.offset = hn::IfThenElseZero(hn::RebindMask(di, cells.there), hn::Add(first, hn::Add(row, row)));
  return cells;
}

/// One cell for each of a packet of waiting rays: hits are noted, the others wait for their next cell where there is one.
HWY_NOINLINE void advance_packet(const RayBricks& bricks, const BrickGroups& groups, VF side, Waiting& waiting, BrickHits& hits) {
  const F d;
  const I di;
  const VF zero = hn::Zero(d), one = set(1.0f);
  MF active;
  Candidates c = pop(waiting, active);
  const MF right = hn::Gt(c.direction.x, zero), up = hn::Gt(c.direction.y, zero), back = hn::Gt(c.direction.z, zero);
  const auto leaves = [&](VF cell, MF forward, VF from, VF inverse) {
    return hn::Mul(hn::Sub(hn::Add(cell, hn::IfThenElseZero(forward, one)), from), inverse);
  };
  const VF tx = leaves(c.cell.x, right, c.origin.x, c.inverse.x), ty = leaves(c.cell.y, up, c.origin.y, c.inverse.y),
           tz = leaves(c.cell.z, back, c.origin.z, c.inverse.z);
  const VF end = hn::Max(c.near, hn::Min(hn::Min(tx, hn::Min(ty, tz)), c.far));
  const VF length = hn::Sub(end, c.near);
  const auto place = [&](VF from, VF slope, VF cell) { return hn::Sub(hn::Add(from, hn::Mul(c.near, slope)), cell); };
  const V3 from{place(c.origin.x, c.direction.x, c.cell.x), place(c.origin.y, c.direction.y, c.cell.y),
                place(c.origin.z, c.direction.z, c.cell.z)};
  const V3 step{hn::Mul(length, c.direction.x), hn::Mul(length, c.direction.y), hn::Mul(length, c.direction.z)};
  const CellsOfBricks at = cells_in_bricks(bricks, groups, c, active);
  VF s = zero;
  const MF found = first_root(cubic_along(bricks.values.data(), at.offset, from, step, side), at.there, s);
  if (!hn::AllFalse(d, found)) note(hn::Add(c.near, hn::Mul(s, length)), c.lane, at.number, found, hits);
  active = hn::And(hn::AndNot(found, active), hn::Lt(end, c.far));
  if (hn::AllFalse(d, active)) return;
  // Through the face that is met first; by whole numbers, so that every step makes headway whatever the rounding.
  const MF by_x = hn::And(hn::Le(tx, ty), hn::Le(tx, tz)), by_y = hn::AndNot(by_x, hn::Le(ty, tz)), by_z = hn::Not(hn::Or(by_x, by_y));
  const auto next = [&](VF cell, MF by, MF forward, VI first, VI last) {
    const VF moved = hn::Add(cell, hn::IfThenElseZero(by, hn::IfThenElse(forward, one, set(-1.0f))));
    active = hn::And(active, hn::And(hn::Ge(moved, hn::ConvertTo(d, first)), hn::Le(moved, hn::ConvertTo(d, last))));
    return moved;
  };
  const VI digit = hn::Set(di, 31);
  c.cell.x = next(c.cell.x, by_x, right, hn::And(c.box, digit), hn::And(hn::ShiftRight<5>(c.box), digit));
  c.cell.y = next(c.cell.y, by_y, up, hn::And(hn::ShiftRight<10>(c.box), digit), hn::And(hn::ShiftRight<15>(c.box), digit));
  c.cell.z = next(c.cell.z, by_z, back, hn::And(hn::ShiftRight<20>(c.box), digit), hn::And(hn::ShiftRight<25>(c.box), digit));
  if (hn::AllFalse(d, active)) return;
  c.near = end;
  push(c, active, waiting);
}

}  // namespace
}  // namespace limn::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
