// Hits: the first root of the trilinear interpolant along each ray. In the slab that bounds the surface in a brick the ray is walked cell
// by cell, and in each the interpolant along the ray is a cubic whose first root is found exactly (Hansson-Soderlund, Evans,
// Akenine-Moller, "Ray Tracing of Signed Distance Function Grids", JCGT 2022), by Newton's iteration with a bracket.
// Every lane's arithmetic is its own: hits depend neither on the packet nor on the SIMD target.

#include "raymarch/level_set/trace.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "sdf/error.h"
#include "sdf/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raymarch/level_set/trace.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "raymarch/level_set/gradients-inl.h"
#include "raymarch/level_set/waiting-inl.h"

HWY_BEFORE_NAMESPACE();
namespace limn::HWY_NAMESPACE {
namespace {
/// Rays first to end - 1, whole packets.
HWY_NOINLINE void to_index_space(const Affine& index_from_render, const RayBatch& rays, size_t first, size_t end, IndexRays& out) {
  const F d;
  for (int row = 0; row < 3; ++row) {
    const VF mx = set(static_cast<float>(index_from_render.linear[0][row])), my = set(static_cast<float>(index_from_render.linear[1][row])),
             mz = set(static_cast<float>(index_from_render.linear[2][row])),
             c = set(static_cast<float>(index_from_render.translation[row]));
    for (size_t i = first; i < end; i += hn::Lanes(d)) {
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

HWY_INLINE Settled settle(BrickGradient gradient, const RayBricks& bricks, const Cells& cells, VI number, MF hit, const IndexRays& rays,
                          size_t i, VF side) {
  if (gradient == BrickGradient::cell) return {cell_gradient(bricks.values.data(), cells), hn::Zero(F())};
  const V3 direction = load3(rays.direction, i);
  return gradient == BrickGradient::central ? central_gradient(bricks.values.data(), cells, number, hit, direction, side)
                                            : cubic_gradient(bricks.spline, cells, number, direction, side);
}

/// Where the band breaks off beside a hit's cell, the gradient that the cell takes instead.
HWY_NOINLINE void settle_lowered(const BrickTrace& what, const IndexRays& rays, size_t i, VF root, VI number, Settled& settled) {
  const F d;
  const I di;
  alignas(64) std::int32_t cells[hn::MaxLanes(di)], kinds[hn::MaxLanes(di)];
  hn::Store(number, di, cells);
  for (size_t k = 0; k < hn::Lanes(di); ++k) kinds[k] = what.lowered[cells[k]];
  const VI kind = hn::Load(di, kinds);
  const RayBricks& bricks = *what.view->bricks;
  for (const BrickGradient gradient : {BrickGradient::cell, BrickGradient::central}) {
    const auto taken = hn::Eq(kind, hn::Set(di, 1 + static_cast<std::int32_t>(gradient)));
    if (hn::AllFalse(di, taken)) continue;
    const Cells at = cells_of(bricks, rays, i, root, number, gradient == BrickGradient::central);
    const Settled other = settle(gradient, bricks, at, number, hn::RebindMask(d, taken), rays, i, set(what.view->side));
    const MF mask = hn::RebindMask(d, taken);
    settled.gradient = {hn::IfThenElse(mask, other.gradient.x, settled.gradient.x),
                        hn::IfThenElse(mask, other.gradient.y, settled.gradient.y),
                        hn::IfThenElse(mask, other.gradient.z, settled.gradient.z)};
    settled.move = hn::IfThenElse(mask, other.move, settled.move);
  }
}

HWY_NOINLINE void write_packet(const BrickTrace& what, const IndexRays& rays, const RayBatch& batch, size_t i, const BrickHits& found,
                               HitBatch& hits) {
  const F d;
  const I di;
  const VI cell = hn::Load(di, found.cell + i);
  const auto hit = hn::Gt(cell, hn::Set(di, -1));
  if (hn::AllFalse(di, hit)) return;
  const VF root = hn::Load(d, found.t + i);
  const RayBricks& bricks = *what.view->bricks;
  const Cells cells = cells_of(bricks, rays, i, hn::IfThenElseZero(hn::RebindMask(d, hit), root), hn::Max(cell, hn::Zero(di)),
                               what.gradient == BrickGradient::central);
  Settled settled =
      settle(what.gradient, bricks, cells, hn::Max(cell, hn::Zero(di)), hn::RebindMask(d, hit), rays, i, set(what.view->side));
  if (what.lowered != nullptr)
    settle_lowered(what, rays, i, hn::IfThenElseZero(hn::RebindMask(d, hit), root), hn::Max(cell, hn::Zero(di)), settled);
  const V3& g = settled.gradient;
  const VF place = hn::Add(root, settled.move);
  const MF allowed = hn::And(hn::Ge(place, hn::Load(d, batch.t_min + i)), hn::Lt(place, hn::Load(d, batch.t_max + i)));
  const VF t = hn::IfThenElse(allowed, place, root);
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
bool blocks_of(const GroupInTile& entry, int x, int y, const PixelTile& tile, BlockRange& out) {
  const int x0 = std::max(entry.x0 + x - tile.x, 0), x1 = std::min(entry.x1 + x - tile.x, tile.width - 1);
  const int y0 = std::max(entry.y0 + y - tile.y, 0), y1 = std::min(entry.y1 + y - tile.y, tile.height - 1);
  out = {x0 >> 2, y0 >> 2, x1 >> 2, y1 >> 2};
  return x0 <= x1 && y0 <= y1;
}

void fetch(const std::int16_t* values, size_t count) {
  constexpr size_t kLine = 64 / sizeof(std::int16_t);
  for (size_t at = 0; at < count; at += kLine) __builtin_prefetch(values + at, 0, 2);
}

/// Asks for a group's values before they are needed: most are not in a cache yet.
void fetch(const RayBricks& bricks, bool spline, const BrickGroups& groups, std::uint32_t group) {
  const auto fetch_brick = [&](size_t brick) {
    __builtin_prefetch(bricks.neighbors.data() + brick, 0, 2);
    fetch(bricks.values.data() + bricks.first[brick] / 2, kBrickElements);
    if (spline) fetch(bricks.spline.rests.data() + brick * kSplineStride, kSplineStride);
  };
  if (groups.shift == 3) return fetch_brick(group);
  const size_t parts = size_t{1} << (3 * (groups.shift - 3));
  for (size_t k = group * parts; k < (group + 1) * parts; ++k) {
    if (groups.bricks[k] >= 0) fetch_brick(static_cast<size_t>(groups.bricks[k]));
  }
}

/// What is found of a batch so far, in bricks of one size after the other.
struct Search {
  IndexRays rays;  ///< By the index coordinates of the size that is searched.
  BrickHits found;
  Waiting waiting;
  alignas(64) std::int32_t cell[kRayBatchSize];  ///< Of all sizes.
  alignas(64) std::int32_t size[kRayBatchSize];  ///< Whose cell it is.
};

void start(const RayBatch& rays, Search& search) {
  const auto count = static_cast<size_t>(rays.count);
  std::copy_n(rays.t_max, count, search.found.t);
  std::fill_n(search.found.cell, count, -1);
  std::fill_n(search.cell, count, -1);
  std::fill_n(search.size, count, -1);
}

/// Roots in bricks of one size, nearer than those found before.
HWY_NOINLINE void search_tile(const BrickTrace& what, const PixelTile& tile, const RayBatch& rays, Search& search) {
  const F d;
  const BrickView& view = *what.view;
  const RayBricks& bricks = *view.bricks;
  const BrickGroups& groups = *view.groups;
  const size_t lanes = hn::Lanes(d);
  const VF side = set(view.side);
  const int across = (tile.width + 3) / 4;
  for (int row = tile.y / kViewTile_px; row <= (tile.y + tile.height - 1) / kViewTile_px; ++row) {
    for (int column = tile.x / kViewTile_px; column <= (tile.x + tile.width - 1) / kViewTile_px; ++column) {
      const std::span<const GroupInTile> entries = view.tile(column, row);
      const std::span<const GroupInTile> next = column + 1 < view.columns ? view.tile(column + 1, row) : std::span<const GroupInTile>();
      for (size_t k = 0; k < entries.size(); ++k) {
        if (k < next.size()) fetch(bricks, what.gradient == BrickGradient::cubic, groups, next[k].group);
        const GroupInTile& entry = entries[k];
        BlockRange range;
        if (!blocks_of(entry, column * kViewTile_px, row * kViewTile_px, tile, range)) continue;
        const Bound bound = bound_of(groups.bounds[entry.group], static_cast<std::int32_t>(entry.group), view.slack_voxels);
        for (int y = range.y0; y <= range.y1; ++y) {
          for (int x = range.x0; x <= range.x1; ++x) {
            const size_t first = static_cast<size_t>(y * across + x) * 16;
            for (size_t i = first; i < first + 16; i += lanes) {
              enter_packet(bound, search.rays, rays, i, search.found, search.waiting);
              while (search.waiting.count >= lanes) advance_packet(bricks, groups, side, search.waiting, search.found);
            }
          }
        }
      }
    }
  }
  while (search.waiting.count > 0) advance_packet(bricks, groups, side, search.waiting, search.found);
}

/// Whether a ray of the packet meets the box before its root so far.
HWY_INLINE bool meets(const BrickTree::Node& node, float slack, const RayBatch& batch, const Search& search, size_t i) {
  const F d;
  VF near = hn::Load(d, batch.t_min + i), far = hn::Min(hn::Load(d, batch.t_max + i), hn::Load(d, search.found.t + i));
  for (size_t axis = 0; axis < 3; ++axis) {
    const VF from = hn::Load(d, search.rays.origin[axis] + i), inverse = hn::Load(d, search.rays.inverse[axis] + i);
    const VF a = hn::Mul(hn::Sub(set(static_cast<float>(node.lower[axis]) - slack), from), inverse);
    const VF b = hn::Mul(hn::Sub(set(static_cast<float>(node.upper[axis]) + slack), from), inverse);
    near = hn::Max(near, hn::Min(a, b));
    far = hn::Min(far, hn::Max(a, b));
  }
  return !hn::AllFalse(d, hn::Le(near, far));
}

/// The first lane of a packet that has a ray; the packet's end where none has.
size_t leading_lane(const RayBatch& rays, size_t first, size_t end) {
  while (first < end && !(rays.t_min[first] < rays.t_max[first])) ++first;
  return first;
}

/// Whether the second of two boxes lies farther along a ray than the first.
bool is_farther(const BrickTree::Node& first, const BrickTree::Node& second, const IndexRays& rays, size_t i) {
  float along = 0.0f;
  for (size_t axis = 0; axis < 3; ++axis) {
    const std::int32_t from = first.lower[axis] + first.upper[axis], to = second.lower[axis] + second.upper[axis];
    along += rays.direction[axis][i] * static_cast<float>(to - from);
  }
  return along > 0.0f;
}

/// As search_tile, for rays of any kind; nearer boxes first, so that roots spare the boxes behind them.
HWY_NOINLINE void search_tree(const BrickTrace& what, const BrickTree& tree, const RayBatch& rays, Search& search) {
  const F d;
  const BrickView& view = *what.view;
  const RayBricks& bricks = *view.bricks;
  const BrickGroups& groups = bricks.groups.front();
  const size_t lanes = hn::Lanes(d), count = static_cast<size_t>(rays.count);
  const VF side = set(view.side);
  // Wider than bricks are entered by more than rounding: no order leaves out a brick whose root is as near as one that is found already.
  const float slack = 1.5f * view.slack_voxels;
  for (size_t i = 0; i < count; i += lanes) {
    const size_t leader = leading_lane(rays, i, i + lanes);
    if (leader == i + lanes) continue;
    std::uint32_t stack[BrickTree::kMostDepth + 1];
    size_t waiting = 0;
    stack[waiting++] = 0;
    while (waiting > 0) {
      const BrickTree::Node& node = tree.nodes[stack[--waiting]];
      if (!meets(node, slack, rays, search, i)) continue;
      if (node.brick < 0) {
        const bool in_order = is_farther(tree.nodes[node.first], tree.nodes[node.first + 1], search.rays, leader);
        stack[waiting++] = node.first + (in_order ? 1 : 0);
        stack[waiting++] = node.first + (in_order ? 0 : 1);
        continue;
      }
      const Bound bound = bound_of(groups.bounds[static_cast<size_t>(node.brick)], node.brick, view.slack_voxels);
      enter_packet(bound, search.rays, rays, i, search.found, search.waiting);
      while (search.waiting.count >= lanes) advance_packet(bricks, groups, side, search.waiting, search.found);
    }
    // What is behind a root need not be looked at by the packets to come.
    while (search.waiting.count > 0) advance_packet(bricks, groups, side, search.waiting, search.found);
  }
}

/// Roots found last lie nearer than those of the sizes before, or on a face with one of smaller voxels.
void take(std::int32_t size, size_t count, Search& search) {
  const I di;
  const VI none = hn::Set(di, -1);
  for (size_t i = 0; i < count; i += hn::Lanes(di)) {
    const VI cell = hn::Load(di, search.found.cell + i);
    const auto found = hn::Gt(cell, none);
    hn::BlendedStore(cell, found, di, search.cell + i);
    hn::BlendedStore(hn::Set(di, size), found, di, search.size + i);
    hn::Store(none, di, search.found.cell + i);
  }
}

/// A packet's cells of one size; false where there are none.
HWY_INLINE bool select(std::int32_t size, size_t i, Search& search) {
  const I di;
  const auto own = hn::Eq(hn::Load(di, search.size + i), hn::Set(di, size));
  if (hn::AllFalse(di, own)) return false;
  hn::Store(hn::IfThenElse(own, hn::Load(di, search.cell + i), hn::Set(di, -1)), di, search.found.cell + i);
  return true;
}

void write(const BrickTrace* sizes, size_t number, const RayBatch& rays, Search& search, HitBatch& hits) {
  const size_t count = static_cast<size_t>(rays.count), lanes = hn::Lanes(F());
  for (size_t k = 0; k < number; ++k) {
    if (!sizes[k].view->groups) continue;
    for (size_t i = 0; i < count; i += lanes) {
      if (number > 1) {
        if (!select(static_cast<std::int32_t>(k), i, search)) continue;
        to_index_space(sizes[k].view->index_from_render, rays, i, i + lanes, search.rays);
      }
      write_packet(sizes[k], search.rays, rays, i, search.found, hits);
    }
  }
}

void TraceBricks(const BrickTrace* sizes, size_t number, const BrickTree* const* trees, const PixelTile& tile, const RayBatch& rays,
                 HitBatch& hits) {
  Search search;
  const auto count = static_cast<size_t>(rays.count);
  start(rays, search);
  for (size_t k = 0; k < number; ++k) {
    const BrickView& view = *sizes[k].view;
    if (!view.groups || (!trees && !touches(view, tile))) continue;
    to_index_space(view.index_from_render, rays, 0, count, search.rays);
    if (trees)
      search_tree(sizes[k], *trees[k], rays, search);
    else
      search_tile(sizes[k], tile, rays, search);
    if (number > 1) take(static_cast<std::int32_t>(k), count, search);
  }
  write(sizes, number, rays, search, hits);
}

}  // namespace
}  // namespace limn::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace limn {
HWY_EXPORT(TraceBricks);
void trace_bricks(std::span<const BrickTrace> sizes, const PixelTile& tile, const RayBatch& rays, HitBatch& hits) {
  LIMN_CHECK(sizes.size() <= kMostBrickSizes);
  HWY_DYNAMIC_DISPATCH(TraceBricks)(sizes.data(), sizes.size(), nullptr, tile, rays, hits);
}
void trace_bricks_singly(std::span<const BrickTrace> sizes, std::span<const BrickTree* const> trees, const RayBatch& rays, HitBatch& hits) {
  LIMN_CHECK(sizes.size() <= kMostBrickSizes && trees.size() == sizes.size());
  HWY_DYNAMIC_DISPATCH(TraceBricks)(sizes.data(), sizes.size(), trees.data(), PixelTile{}, rays, hits);
}
}  // namespace limn
#endif
