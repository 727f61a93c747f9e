// Internal: lanes of rays and what they read from bricks. Included once for each SIMD target.

#if defined(LIMN_RAYMARCH_LEVEL_SET_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LIMN_RAYMARCH_LEVEL_SET_LANES_INL_H
#undef LIMN_RAYMARCH_LEVEL_SET_LANES_INL_H
#else
#define LIMN_RAYMARCH_LEVEL_SET_LANES_INL_H
#endif

#include <hwy/highway.h>

#include <cstring>

#include "raymarch/level_set/bricks.h"
#include "raymarch/surface.h"

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

HWY_INLINE VF dot(const V3& a, const V3& b) { return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z)); }

/// Rays of the tile by index coordinates. `t` keeps its meaning, so directions are not unit.
struct IndexRays {
  alignas(64) float origin[3][kRayBatchSize], direction[3][kRayBatchSize], inverse[3][kRayBatchSize];
};

HWY_INLINE V3 load3(const float (*from)[kRayBatchSize], size_t i) {
  return {hn::Load(F(), from[0] + i), hn::Load(F(), from[1] + i), hn::Load(F(), from[2] + i)};
}

/// The pair of neighbours along z from `offset` (bytes) on, as floats.
struct Pair {
  VF low, high;
};
HWY_INLINE Pair pair_of(VI both) {
  return {hn::ConvertTo(F(), hn::ShiftRight<16>(hn::ShiftLeft<16>(both))), hn::ConvertTo(F(), hn::ShiftRight<16>(both))};
}
/// The word at `offset` (bytes), in every lane.
HWY_INLINE VI word_at(const std::int16_t* base, std::int32_t offset) {
  std::int32_t both;
  std::memcpy(&both, reinterpret_cast<const char*>(base) + offset, sizeof both);
  return hn::Set(I(), both);
}
HWY_INLINE Pair gather_pair(const std::int16_t* base, VI offset) {
  return pair_of(hn::GatherOffset(I(), reinterpret_cast<const std::int32_t*>(base), offset));
}

}  // namespace
}  // namespace limn::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
