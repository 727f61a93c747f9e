// Triangles against the pixels of a tile, in double precision. As in the watertight test of Woop, Benthin and Wald (2013), edge functions
// are made of the corners' places about the ray, which are the same in all triangles with that corner, and nothing is fused: the sign of
// each is right or 0, and 0 counts as inside on both sides of an edge, so that no ray slips between two triangles.

#include "raymarch/mesh/cover.h"

#include <algorithm>
#include <limits>

#include "sdf/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raymarch/mesh/cover.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace limn::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;

/// Columns and rows of the lanes of a block.
alignas(64) constexpr double kColumn[16] = {0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};
alignas(64) constexpr double kRow[16] = {0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};

struct Corner {
  V x, y;
};
HWY_INLINE Corner about(const ScreenVertex& vertex, V x, V y) {
  const D d;
  return {hn::Sub(hn::Set(d, vertex.x), x), hn::Sub(hn::Set(d, vertex.y), y)};
}
/// Twice the area of the triangle between the ray and two corners; swapped corners give exactly its negative.
HWY_INLINE V edge(const Corner& from, const Corner& to) { return hn::Sub(hn::Mul(to.x, from.y), hn::Mul(to.y, from.x)); }

struct Triangle {
  const ScreenVertex &a, &b, &c;
  std::uint32_t index;
};

/// Lanes from `lane` on, whose first pixel is that of kColumn and kRow about (x, y).
HWY_INLINE void cover_lanes(const Triangle& triangle, double x, double y, size_t lane, TileCover& cover) {
  const D d;
  const size_t within = lane & 15;
  const V px = hn::Add(hn::Set(d, x), hn::Load(d, kColumn + within)), py = hn::Add(hn::Set(d, y), hn::Load(d, kRow + within));
  const Corner a = about(triangle.a, px, py), b = about(triangle.b, px, py), c = about(triangle.c, px, py);
  const V at_a = edge(b, c), at_b = edge(c, a), at_c = edge(a, b), zero = hn::Zero(d);
  const V sum = hn::Add(hn::Add(at_a, at_b), at_c);
  const auto inside = hn::Or(hn::Ge(hn::Min(hn::Min(at_a, at_b), at_c), zero), hn::Le(hn::Max(hn::Max(at_a, at_b), at_c), zero));
  // Seen edge on: its neighbours stop the ray.
  const auto met = hn::And(inside, hn::Ne(sum, zero));
  if (hn::AllFalse(d, met)) return;
  const auto mean = [&](double of_a, double of_b, double of_c) {
    return hn::Add(hn::Add(hn::Mul(at_a, hn::Set(d, of_a)), hn::Mul(at_b, hn::Set(d, of_b))), hn::Mul(at_c, hn::Set(d, of_c)));
  };
  const V nearness = hn::Div(mean(triangle.a.nearness, triangle.b.nearness, triangle.c.nearness), sum);
  const V best = hn::Load(d, cover.nearness + lane), index = hn::Set(d, static_cast<double>(triangle.index));
  const auto tied = hn::And(hn::Eq(nearness, best), hn::Lt(index, hn::Load(d, cover.triangle + lane)));
  const auto nearer = hn::And(met, hn::Or(hn::Gt(nearness, best), tied));
  if (hn::AllFalse(d, nearer)) return;
  hn::BlendedStore(nearness, nearer, d, cover.nearness + lane);
  hn::BlendedStore(index, nearer, d, cover.triangle + lane);
  hn::BlendedStore(hn::Mul(at_b, hn::Set(d, triangle.b.weight)), nearer, d, cover.weight_b + lane);
  hn::BlendedStore(hn::Mul(at_c, hn::Set(d, triangle.c.weight)), nearer, d, cover.weight_c + lane);
  hn::BlendedStore(mean(triangle.a.weight, triangle.b.weight, triangle.c.weight), nearer, d, cover.weight_sum + lane);
}

/// Pixels of the tile, first to last inclusive, from its corner.
struct Pixels {
  int x0, y0, x1, y1;
};

HWY_INLINE void cover_triangle(const Triangle& triangle, const Pixels& pixels, const PixelTile& tile, TileCover& cover) {
  const int across = (tile.width + 3) >> 2;
  constexpr int kLanes = static_cast<int>(hn::MaxLanes(D()));
  constexpr int kRows = std::max(1, kLanes / 4), kSteps = std::max(1, 4 / kLanes);  // rows a vector, vectors a row
  for (int by = pixels.y0 >> 2; by <= pixels.y1 >> 2; ++by) {
    const int first_row = std::max(pixels.y0 - 4 * by, 0) / kRows * kRows, last_row = std::min(pixels.y1 - 4 * by, 3);
    for (int bx = pixels.x0 >> 2; bx <= pixels.x1 >> 2; ++bx) {
      const double x = tile.x + 4 * bx, y = tile.y + 4 * by;
      for (int row = first_row; row <= last_row; row += kRows) {
        for (int step = 0; step < kSteps; ++step)
          cover_lanes(triangle, x, y, static_cast<size_t>((by * across + bx) * 16 + row * 4 + step * kLanes), cover);
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

void CoverTile(const MeshView& view, const PixelTile& tile, int lanes, TileCover& cover) {
  std::fill_n(cover.nearness, lanes, -std::numeric_limits<double>::infinity());
  std::fill_n(cover.triangle, lanes, 0.0);
  for (int row = tile.y / kMeshTile_px; row <= (tile.y + tile.height - 1) / kMeshTile_px; ++row) {
    for (int column = tile.x / kMeshTile_px; column <= (tile.x + tile.width - 1) / kMeshTile_px; ++column) {
      const std::span<const TriangleInTile> entries = view.tile(column, row);
      const int x = column * kMeshTile_px - tile.x, y = row * kMeshTile_px - tile.y;
      for (size_t k = 0; k < entries.size(); ++k) {
        fetch_ahead(view, entries, k);
        const TriangleInTile& entry = entries[k];
        const Pixels pixels{std::max(entry.x0 + x, 0), std::max(entry.y0 + y, 0), std::min(entry.x1 + x, tile.width - 1),
                            std::min(entry.y1 + y, tile.height - 1)};
        if (pixels.x0 > pixels.x1 || pixels.y0 > pixels.y1) continue;
        const glm::uvec3& corners = view.mesh->triangles[entry.triangle];
        cover_triangle({view.vertices[corners.x], view.vertices[corners.y], view.vertices[corners.z], entry.triangle}, pixels, tile, cover);
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
