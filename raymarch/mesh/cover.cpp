// Triangles against the pixels of a tile, in double precision.

#include "raymarch/mesh/cover.h"

#include <algorithm>
#include <limits>

#include "sdf/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raymarch/mesh/cover.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "raymarch/mesh/edges-inl.h"

HWY_BEFORE_NAMESPACE();
namespace limn::HWY_NAMESPACE {
namespace {
/// Columns and rows of the lanes of a block.
alignas(64) constexpr double kColumn[16] = {0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};
alignas(64) constexpr double kRow[16] = {0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};

struct Triangle {
  const ScreenVertex &a, &b, &c;
  std::uint32_t index;
};

HWY_INLINE Corner corner_at(const ScreenVertex& vertex, V x, V y) {
  const D d;
  return about(hn::Set(d, vertex.x), hn::Set(d, vertex.y), x, y);
}

/// Of three corners' values; by the weights' sum it is still to be divided.
HWY_INLINE V mean(const EdgeWeights& at, double of_a, double of_b, double of_c) {
  const D d;
  return hn::Add(hn::Add(hn::Mul(at.a, hn::Set(d, of_a)), hn::Mul(at.b, hn::Set(d, of_b))), hn::Mul(at.c, hn::Set(d, of_c)));
}

/// Lanes from `lane` on, whose first pixel is that of kColumn and kRow about (x, y).
HWY_INLINE void cover_lanes(const Triangle& triangle, double x, double y, size_t lane, TileCover& cover) {
  const D d;
  const size_t within = lane & 15;
  const V px = hn::Add(hn::Set(d, x), hn::Load(d, kColumn + within)), py = hn::Add(hn::Set(d, y), hn::Load(d, kRow + within));
  const EdgeWeights at = edge_weights(corner_at(triangle.a, px, py), corner_at(triangle.b, px, py), corner_at(triangle.c, px, py));
  const V sum = sum_of(at);
  const M met = meets(at, sum);
  if (hn::AllFalse(d, met)) return;
  const V nearness = hn::Div(mean(at, triangle.a.nearness, triangle.b.nearness, triangle.c.nearness), sum);
  const V best = hn::Load(d, cover.nearness + lane), holder = hn::Load(d, cover.triangle + lane);
  const V index = hn::Set(d, static_cast<double>(triangle.index));
  const M tied = hn::And(hn::Eq(nearness, best), hn::Lt(index, holder));
  const M nearer = hn::And(met, hn::Or(hn::Gt(nearness, best), tied));
  if (hn::AllFalse(d, nearer)) return;
  // Whole vectors: what is stored in part is slow to read again, and the next triangle most often lies in the same lanes.
  const auto take = [&](V value, V before, double* to) { hn::Store(hn::IfThenElse(nearer, value, before), d, to + lane); };
  take(nearness, best, cover.nearness);
  take(index, holder, cover.triangle);
  take(hn::Mul(at.b, hn::Set(d, triangle.b.weight)), hn::Load(d, cover.weight_b + lane), cover.weight_b);
  take(hn::Mul(at.c, hn::Set(d, triangle.c.weight)), hn::Load(d, cover.weight_c + lane), cover.weight_c);
  take(mean(at, triangle.a.weight, triangle.b.weight, triangle.c.weight), hn::Load(d, cover.weight_sum + lane), cover.weight_sum);
}

/// Pixels of the tile, first to last inclusive, from its corner.
struct Pixels {
  int x0, y0, x1, y1;
};

/// Calls `visit(x, y, lane)` for the vectors of lanes that the pixels lie in; x and y are those of the block.
template <class Visit>
HWY_INLINE void for_each_vector(const Pixels& pixels, const PixelTile& tile, const Visit& visit) {
  const int across = (tile.width + 3) >> 2;
  constexpr int kLanes = static_cast<int>(hn::MaxLanes(D()));
  constexpr int kRows = std::max(1, kLanes / 4), kSteps = std::max(1, 4 / kLanes);  // rows a vector, vectors a row
  for (int by = pixels.y0 >> 2; by <= pixels.y1 >> 2; ++by) {
    const int first_row = std::max(pixels.y0 - 4 * by, 0) / kRows * kRows, last_row = std::min(pixels.y1 - 4 * by, 3);
    for (int bx = pixels.x0 >> 2; bx <= pixels.x1 >> 2; ++bx) {
      const double x = tile.x + 4 * bx, y = tile.y + 4 * by;
      for (int row = first_row; row <= last_row; row += kRows) {
        for (int step = 0; step < kSteps; ++step) visit(x, y, static_cast<size_t>((by * across + bx) * 16 + row * 4 + step * kLanes));
      }
    }
  }
}

/// Asks for what an entry will need, its corners' numbers before their places.
HWY_INLINE void fetch_ahead(const MeshView& view, std::span<const TriangleInTile> entries, size_t k) {
  constexpr size_t kFar = 24, kNear = 8;
  const TriangleMesh& mesh = *view.mesh;
  if (k + kFar < entries.size()) __builtin_prefetch(&mesh.triangles[entries[k + kFar].triangle]);
  if (k + kNear >= entries.size()) return;
  const glm::uvec3& corners = mesh.triangles[entries[k + kNear].triangle];
  __builtin_prefetch(&view.vertices[corners.x]);
  __builtin_prefetch(&view.vertices[corners.y]);
  __builtin_prefetch(&view.vertices[corners.z]);
}

/// The pixels of a list's entry that lie in the tile, the list's tile beginning at (x, y) from the other's corner.
HWY_INLINE Pixels pixels_of(const TriangleInTile& entry, int x, int y, const PixelTile& tile) {
  return {std::max(entry.x0 + x, 0), std::max(entry.y0 + y, 0), std::min(entry.x1 + x, tile.width - 1),
          std::min(entry.y1 + y, tile.height - 1)};
}

HWY_INLINE Triangle triangle_of(const MeshView& view, std::uint32_t index) {
  const glm::uvec3& corners = view.mesh->triangles[index];
  return {view.vertices[corners.x], view.vertices[corners.y], view.vertices[corners.z], index};
}

/// `hidden`: most triangles are expected to lie behind what was found before.
template <bool hidden>
HWY_INLINE void cover_list(const MeshView& view, std::span<const TriangleInTile> entries, int x, int y, const PixelTile& tile,
                           TileCover& cover) {
  const D d;
  for (size_t k = 0; k < entries.size(); ++k) {
    if (!hidden) fetch_ahead(view, entries, k);
    const Pixels pixels = pixels_of(entries[k], x, y, tile);
    if (pixels.x0 > pixels.x1 || pixels.y0 > pixels.y1) continue;
    for_each_vector(pixels, tile, [&](double block_x, double block_y, size_t lane) {
      if (hidden && hn::AllFalse(d, hn::Le(hn::Load(d, cover.nearness + lane), hn::Set(d, static_cast<double>(entries[k].nearest)))))
        return;
      cover_lanes(triangle_of(view, entries[k].triangle), block_x, block_y, lane, cover);
    });
  }
}

void CoverTile(const MeshView& view, const PixelTile& tile, int lanes, TileCover& cover) {
  std::fill_n(cover.nearness, lanes, -std::numeric_limits<double>::infinity());
  std::fill_n(cover.triangle, lanes, 0.0);
  for (double* weights : {cover.weight_b, cover.weight_c, cover.weight_sum}) std::fill_n(weights, lanes, 0.0);
  for (const int away : {0, 1}) {
    for (int row = tile.y / kMeshTile_px; row <= (tile.y + tile.height - 1) / kMeshTile_px; ++row) {
      for (int column = tile.x / kMeshTile_px; column <= (tile.x + tile.width - 1) / kMeshTile_px; ++column) {
        const std::span<const TriangleInTile> entries = view.list(column, row, away);
        const int x = column * kMeshTile_px - tile.x, y = row * kMeshTile_px - tile.y;
        if (away)
          cover_list<true>(view, entries, x, y, tile, cover);
        else
          cover_list<false>(view, entries, x, y, tile, cover);
      }
    }
  }
}

}  // namespace
}  // namespace limn::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace limn {

HWY_EXPORT(CoverTile);
void cover_tile(const MeshView& view, const PixelTile& tile, int lanes, TileCover& cover) {
  HWY_DYNAMIC_DISPATCH(CoverTile)(view, tile, lanes, cover);
}

}  // namespace limn
#endif
