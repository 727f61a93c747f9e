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

#include "raymarch/level_set/gradients-inl.h"
#include "raymarch/level_set/roots-inl.h"

HWY_BEFORE_NAMESPACE();
namespace limn::HWY_NAMESPACE {
namespace {
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

/// Rays that may meet the surface in a cell of a brick, waiting until a packet of them is full. Places are local to the brick.
struct Waiting {
  // A block of 16 rays adds at most 16, a packet puts back at most as many as it takes.
  static constexpr size_t kCapacity = 64;
  alignas(64) float origin[3][kCapacity], direction[3][kCapacity], inverse[3][kCapacity];
  alignas(64) float cell[3][kCapacity];
  alignas(64) float near[kCapacity], far[kCapacity];
  alignas(64) std::int32_t lane[kCapacity];
  alignas(64) std::int32_t brick[kCapacity];
  alignas(64) std::int32_t box[kCapacity];  ///< Lower and upper bounds of the crossed cells, four bits each.
  size_t count = 0;
};

/// A packet of Waiting.
struct Candidates {
  V3 origin, direction, inverse, cell;
  VF near, far;
  VI lane, brick, box;
};

HWY_INLINE void push(const Candidates& c, MF which, Waiting& waiting) {
  const F d;
  const I di;
  const size_t at = waiting.count;
  const auto put = [&](VF v, float* to) { hn::StoreU(hn::Compress(v, which), d, to + at); };
  const auto put3 = [&](const V3& v, float(*to)[Waiting::kCapacity]) {
    put(v.x, to[0]);
    put(v.y, to[1]);
    put(v.z, to[2]);
  };
  const auto puti = [&](VI v, std::int32_t* to) { hn::StoreU(hn::Compress(v, hn::RebindMask(di, which)), di, to + at); };
  put3(c.origin, waiting.origin);
  put3(c.direction, waiting.direction);
  put3(c.inverse, waiting.inverse);
  put3(c.cell, waiting.cell);
  put(c.near, waiting.near);
  put(c.far, waiting.far);
  puti(c.lane, waiting.lane);
  puti(c.brick, waiting.brick);
  puti(c.box, waiting.box);
  waiting.count += hn::CountTrue(d, which);
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
          hn::LoadU(di, waiting.brick + at),
          hn::LoadU(di, waiting.box + at)};
}

/// Two bricks that share a face may both find a root on it: that of the lower number counts, whatever the order.
HWY_INLINE void note(VF t, VI lane, VI cell, MF found, BrickHits& hits) {
  const F d;
  const I di;
  HWY_ALIGN float ts[16];
  HWY_ALIGN std::int32_t lanes[16], cells[16];
  hn::Store(hn::Compress(t, found), d, ts);
  hn::Store(hn::Compress(lane, hn::RebindMask(di, found)), di, lanes);
  hn::Store(hn::Compress(cell, hn::RebindMask(di, found)), di, cells);
  const size_t count = hn::CountTrue(d, found);
  for (size_t k = 0; k < count; ++k) {
    const std::int32_t to = lanes[k];
    if (ts[k] > hits.t[to] || (ts[k] == hits.t[to] && hits.cell[to] >= 0 && hits.cell[to] <= cells[k])) continue;
    hits.t[to] = ts[k];
    hits.cell[to] = cells[k];
  }
}

/// One cell for each of a packet of waiting rays: hits are noted, the others wait for their next cell where there is one.
void advance_packet(const RayBricks& bricks, VF side, Waiting& waiting, BrickHits& hits) {
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
  const VF node = hn::Add(hn::Add(hn::Mul(c.cell.x, set(162.0f)), hn::Mul(c.cell.y, set(18.0f))), hn::Add(c.cell.z, c.cell.z));
  const VI offset = hn::Add(hn::ConvertTo(di, node), hn::Mul(c.brick, hn::Set(di, kBrickBytes)));
  VF s = zero;
  const MF found =
      first_root(cubic_along(bricks.values.data(), hn::IfThenElseZero(hn::RebindMask(di, active), offset), from, step, side), active, s);
  if (!hn::AllFalse(d, found)) {
    const VF number = hn::Add(hn::Add(hn::Mul(c.cell.x, set(64.0f)), hn::Mul(c.cell.y, set(8.0f))), c.cell.z);
    const VI cell = hn::Add(hn::ShiftLeft<9>(c.brick), hn::ConvertTo(di, number));
    note(hn::Add(c.near, hn::Mul(s, length)), c.lane, cell, found, hits);
  }
  active = hn::And(hn::AndNot(found, active), hn::Lt(end, c.far));
  if (hn::AllFalse(d, active)) return;
  // Through the face that is met first; by whole numbers, so that every step makes headway whatever the rounding.
  const MF by_x = hn::And(hn::Le(tx, ty), hn::Le(tx, tz)), by_y = hn::AndNot(by_x, hn::Le(ty, tz)), by_z = hn::Not(hn::Or(by_x, by_y));
  const auto next = [&](VF cell, MF by, MF forward, VI lower, VI upper) {
    const VF moved = hn::Add(cell, hn::IfThenElseZero(by, hn::IfThenElse(forward, one, set(-1.0f))));
    active = hn::And(active, hn::And(hn::Ge(moved, hn::ConvertTo(d, lower)), hn::Lt(moved, hn::ConvertTo(d, upper))));
    return moved;
  };
  const VI digit = hn::Set(di, 15);
  c.cell.x = next(c.cell.x, by_x, right, hn::And(c.box, digit), hn::And(hn::ShiftRight<4>(c.box), digit));
  c.cell.y = next(c.cell.y, by_y, up, hn::And(hn::ShiftRight<8>(c.box), digit), hn::And(hn::ShiftRight<12>(c.box), digit));
  c.cell.z = next(c.cell.z, by_z, back, hn::And(hn::ShiftRight<16>(c.box), digit), hn::And(hn::ShiftRight<20>(c.box), digit));
  if (hn::AllFalse(d, active)) return;
  c.near = end;
  push(c, active, waiting);
}

/// A packet of a tile's rays against one brick: those that come near the surface in it join the waiting ones.
HWY_INLINE void enter_packet(const BrickHeader& header, std::int32_t index, const IndexRays& rays, const RayBatch& batch, size_t i,
                             float slack, const BrickHits& hits, Waiting& waiting) {
  const F d;
  const I di;
  const V3 o = load3(rays.origin, i);
  Candidates c;
  c.direction = load3(rays.direction, i);
  c.inverse = load3(rays.inverse, i);
  c.origin = {hn::Sub(o.x, set(static_cast<float>(header.origin[0]))), hn::Sub(o.y, set(static_cast<float>(header.origin[1]))),
              hn::Sub(o.z, set(static_cast<float>(header.origin[2])))};
  c.near = hn::Load(d, batch.t_min + i);
  c.far = hn::Load(d, batch.t_max + i);
  const auto clip = [&](size_t axis, VF from, VF inverse) {
    const VF a = hn::Mul(hn::Sub(set(static_cast<float>(header.lower[axis]) - slack), from), inverse);
    const VF b = hn::Mul(hn::Sub(set(static_cast<float>(header.upper[axis]) + slack), from), inverse);
    c.near = hn::Max(c.near, hn::Min(a, b));
    c.far = hn::Min(c.far, hn::Max(a, b));
  };
  clip(0, c.origin.x, c.inverse.x);
  clip(1, c.origin.y, c.inverse.y);
  clip(2, c.origin.z, c.inverse.z);
  // Nearer hits only decide what is not looked at any more, never how a root is found: the order of the bricks does not matter.
  const VF before = hn::Load(d, hits.t + i);
  if (hn::AllFalse(d, hn::Le(c.near, hn::Min(c.far, before)))) return;
  const VF nx = set(header.normal[0]), ny = set(header.normal[1]), nz = set(header.normal[2]);
  const auto dot = [&](const V3& v) { return hn::Add(hn::Add(hn::Mul(nx, v.x), hn::Mul(ny, v.y)), hn::Mul(nz, v.z)); };
  const VF height = hn::Sub(dot(c.origin), set(header.offset)), slope = dot(c.direction);
  const float steepest = std::abs(header.normal[0]) + std::abs(header.normal[1]) + std::abs(header.normal[2]);
  const VF slab = set(header.slab + slack * steepest);
  const VF per = hn::Div(set(1.0f), hn::IfThenElse(hn::Lt(hn::Abs(slope), set(1e-12f)), set(1e-12f), slope));
  const VF a = hn::Mul(hn::Sub(slab, height), per), b = hn::Mul(hn::Sub(hn::Neg(slab), height), per);
  c.near = hn::Max(c.near, hn::Min(a, b));
  c.far = hn::Min(c.far, hn::Max(a, b));
  const MF active = hn::Le(c.near, hn::Min(c.far, before));
  if (hn::AllFalse(d, active)) return;
  const auto first_cell = [&](size_t axis, VF from, VF slope_of) {
    const VF p = hn::Floor(hn::Add(from, hn::Mul(c.near, slope_of)));
    return hn::Min(hn::Max(p, set(static_cast<float>(header.lower[axis]))), set(static_cast<float>(header.upper[axis] - 1)));
  };
  c.cell = {first_cell(0, c.origin.x, c.direction.x), first_cell(1, c.origin.y, c.direction.y), first_cell(2, c.origin.z, c.direction.z)};
  c.lane = hn::Iota(di, static_cast<std::int32_t>(i));
  c.brick = hn::Set(di, index);
  c.box = hn::Set(di, header.lower[0] | header.upper[0] << 4 | header.lower[1] << 8 | header.upper[1] << 12 | header.lower[2] << 16 |
                          header.upper[2] << 20);
  push(c, active, waiting);
}

void write_packet(const BrickTrace& what, const IndexRays& rays, const RayBatch& batch, size_t i, const BrickHits& found, HitBatch& hits) {
  const F d;
  const I di;
  const VI cell = hn::Load(di, found.cell + i);
  const auto hit = hn::Gt(cell, hn::Set(di, -1));
  if (hn::AllFalse(di, hit)) return;
  const VF t = hn::Load(d, found.t + i);
  const RayBricks& bricks = *what.view->bricks;
  const Cells cells = cells_of(bricks, rays, i, hn::IfThenElseZero(hn::RebindMask(d, hit), t), hn::Max(cell, hn::Zero(di)),
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
    if (found.cell[k] >= 0) hits.status[k] = HitStatus::hit;
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

/// Asks for a brick's values before they are needed: most are not in a cache yet.
void fetch(const RayBricks& bricks, std::uint32_t brick) {
  const auto* values = reinterpret_cast<const char*>(bricks.values.data() + size_t{brick} * kBrickStride);
  for (std::int32_t at = 0; at < kBrickBytes; at += 64) __builtin_prefetch(values + at);
}

void TraceBricks(const BrickTrace& what, const PixelTile& tile, const RayBatch& rays, HitBatch& hits) {
  const F d;
  const BrickView& view = *what.view;
  const RayBricks& bricks = *view.bricks;
  const size_t lanes = hn::Lanes(d), count = static_cast<size_t>(rays.count);
  IndexRays index_rays;
  BrickHits found;
  Waiting waiting;
  const size_t kFull = lanes;
  to_index_space(view.index_from_render, rays, count, index_rays);
  std::copy_n(rays.t_max, count, found.t);
  std::fill_n(found.cell, count, -1);
  const VF side = set(view.side);
  const int across = (tile.width + 3) / 4;
  for (int row = tile.y / kViewTile_px; row <= (tile.y + tile.height - 1) / kViewTile_px; ++row) {
    for (int column = tile.x / kViewTile_px; column <= (tile.x + tile.width - 1) / kViewTile_px; ++column) {
      const std::span<const BrickInTile> entries = view.tile(column, row);
      for (size_t k = 0; k < entries.size(); ++k) {
        if (k + 1 < entries.size()) fetch(bricks, entries[k + 1].brick);
        const BrickInTile& entry = entries[k];
        BlockRange range;
        if (!blocks_of(entry, column * kViewTile_px, row * kViewTile_px, tile, range)) continue;
        const BrickHeader& header = bricks.headers[entry.brick];
        const auto index = static_cast<std::int32_t>(entry.brick);
        for (int y = range.y0; y <= range.y1; ++y) {
          for (int x = range.x0; x <= range.x1; ++x) {
            const size_t first = static_cast<size_t>(y * across + x) * 16;
            for (size_t i = first; i < first + 16; i += lanes) {
              enter_packet(header, index, index_rays, rays, i, view.slack_voxels, found, waiting);
              while (waiting.count >= kFull) advance_packet(bricks, side, waiting, found);
            }
          }
        }
      }
    }
  }
  while (waiting.count > 0) advance_packet(bricks, side, waiting, found);
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
