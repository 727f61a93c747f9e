// Which triangles may cover pixels, as many at a time as a vector has lanes.

#include <algorithm>

#include "raymarch/mesh/mesh_view.h"
#include "sdf/error.h"
#include "sdf/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raymarch/mesh/seen.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "raymarch/mesh/edges-inl.h"

HWY_BEFORE_NAMESPACE();
namespace limn::HWY_NAMESPACE {
namespace {

constexpr size_t kMost = 8;

/// One corner of as many triangles as fit.
struct Corners {
  V x, y, nearness;
};

/// The boxes of as many triangles, in whole pixels.
struct Boxes {
  V x0, y0, x1, y1;
};

HWY_INLINE Corners load(const ScreenVertex* corners) {
  V x, y, nearness, weight;
  hn::LoadInterleaved4(D(), &corners->x, x, y, nearness, weight);
  return {x, y, nearness};
}

HWY_INLINE Boxes boxes_of(const Corners& a, const Corners& b, const Corners& c, int width, int height) {
  const D d;
  const auto first = [&](V p, V q, V r) { return hn::Max(hn::Ceil(hn::Min(hn::Min(p, q), r)), hn::Zero(d)); };
  const auto last = [&](V p, V q, V r, int size) { return hn::Min(hn::Floor(hn::Max(hn::Max(p, q), r)), hn::Set(d, size - 1.0)); };
  return {first(a.x, b.x, c.x), first(a.y, b.y, c.y), last(a.x, b.x, c.x, width), last(a.y, b.y, c.y, height)};
}

/// Triangles that may cover pixels of their boxes: boxes of up to 2 x 2 pixels have no others than their corners.
HWY_INLINE M may_cover(const Corners& a, const Corners& b, const Corners& c, const Boxes& box) {
  const V one = hn::Set(D(), 1.0);
  const auto at = [&](V x, V y) {
    const EdgeWeights weights = edge_weights(about(a.x, a.y, x, y), about(b.x, b.y, x, y), about(c.x, c.y, x, y));
    return meets(weights, sum_of(weights));
  };
  const M larger = hn::Or(hn::Gt(hn::Sub(box.x1, box.x0), one), hn::Gt(hn::Sub(box.y1, box.y0), one));
  const M met = hn::Or(hn::Or(at(box.x0, box.y0), at(box.x1, box.y0)), hn::Or(at(box.x0, box.y1), at(box.x1, box.y1)));
  return hn::And(hn::Or(larger, met), hn::And(hn::Le(box.x0, box.x1), hn::Le(box.y0, box.y1)));
}

/// Triangles from .. from + count - 1, at most as many as a vector has lanes; returns how many were found.
HWY_INLINE size_t find_in_vector(const MeshView& view, size_t from, size_t count, int width, int height, SeenTriangle* seen) {
  const D d;
  const hn::Rebind<float, D> f;
  const hn::Rebind<std::int32_t, D> i;
  ScreenVertex corners[3][kMost];
  for (size_t k = 0; k < hn::Lanes(d); ++k) {
    const glm::uvec3& of = view.mesh->triangles[from + std::min(k, count - 1)];
    corners[0][k] = view.vertices[of.x], corners[1][k] = view.vertices[of.y], corners[2][k] = view.vertices[of.z];
  }
  const Corners a = load(corners[0]), b = load(corners[1]), c = load(corners[2]);
  const Boxes box = boxes_of(a, b, c, width, height);
  const M found = may_cover(a, b, c, box);
  if (hn::AllFalse(d, found)) return 0;
  // Rows run downwards: corners that run counter-clockwise in the world do so here too, y pointing down, with a positive area.
  const M away = hn::Lt(edge(about(b.x, b.y, a.x, a.y), about(c.x, c.y, a.x, a.y)), hn::Zero(d));
  alignas(64) std::int32_t x0[kMost], y0[kMost], x1[kMost], y1[kMost];
  alignas(64) float nearest[kMost];
  std::uint8_t found_bits[8] = {}, away_bits[8] = {};
  hn::StoreMaskBits(d, found, found_bits);
  hn::StoreMaskBits(d, away, away_bits);
  // Where none is found they may be beyond what fits.
  const auto whole = [&](V v, std::int32_t* to) { hn::Store(hn::DemoteTo(i, hn::IfThenElseZero(found, v)), i, to); };
  whole(box.x0, x0), whole(box.y0, y0), whole(box.x1, x1), whole(box.y1, y1);
  const V most = hn::Max(hn::Max(a.nearness, b.nearness), c.nearness);
  // Rounded up beyond what rounding to float takes away.
  hn::Store(hn::DemoteTo(f, hn::Add(most, hn::Mul(hn::Abs(most), hn::Set(d, 1e-6)))), f, nearest);
  size_t number = 0;
  for (size_t k = 0; k < count; ++k) {
    const auto pixel = [](std::int32_t v) { return static_cast<std::int16_t>(v); };
    seen[number] = {static_cast<std::uint32_t>(from + k),
                    pixel(x0[k]),
                    pixel(y0[k]),
                    pixel(x1[k]),
                    pixel(y1[k]),
                    nearest[k],
                    static_cast<std::uint32_t>(away_bits[0] >> k & 1)};
    number += found_bits[0] >> k & 1u;
  }
  return number;
}

size_t FindSeen(const MeshView& view, size_t from, size_t to, int width, int height, std::span<SeenTriangle> seen) {
  const size_t lanes = hn::Lanes(D());
  size_t number = 0;
  // A place is written before it is known whether it counts: there is one for each triangle so far.
  for (size_t i = from; i < to; i += lanes) number += find_in_vector(view, i, std::min(lanes, to - i), width, height, &seen[number]);
  return number;
}

}  // namespace
}  // namespace limn::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace limn {

HWY_EXPORT(FindSeen);
size_t find_seen(const MeshView& view, size_t from, size_t to, int width, int height, std::span<SeenTriangle> seen) {
  LIMN_CHECK(seen.size() >= to - from);
  return HWY_DYNAMIC_DISPATCH(FindSeen)(view, from, to, width, height, seen);
}

}  // namespace limn
#endif
