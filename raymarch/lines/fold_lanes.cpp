#include "raymarch/lines/fold_lanes.h"

#include <algorithm>

#include "sdf/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raymarch/lines/fold_lanes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "sdf/packing-inl.h"

HWY_BEFORE_NAMESPACE();
namespace limn::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, kFoldPadding>;
using V = hn::Vec<D>;

/// Of the step and its reach, in every lane.
struct Asked {
  V low_x, high_x, low_y, high_y, from_x, from_y, across_x, across_y, within, depth;
};

Asked asked_of(const FoldSearch& search) {
  const D d;
  const glm::vec2 low = glm::min(search.from, search.to) - search.within, high = glm::max(search.from, search.to) + search.within;
  return {hn::Set(d, low.x),         hn::Set(d, high.x),        hn::Set(d, low.y),           hn::Set(d, high.y),
          hn::Set(d, search.from.x), hn::Set(d, search.from.y), hn::Set(d, search.across.x), hn::Set(d, search.across.y),
          hn::Set(d, search.within), hn::Set(d, search.depth)};
}

HWY_INLINE hn::Mask<D> out_of_reach(const FoldLanes& folds, const Asked& asked, size_t at) {
  const D d;
  const V ax = hn::LoadU(d, &folds.ax[at]), ay = hn::LoadU(d, &folds.ay[at]), bx = hn::LoadU(d, &folds.bx[at]),
          by = hn::LoadU(d, &folds.by[at]), margin = hn::LoadU(d, &folds.margin[at]);
  const auto apart = [&](V a, V b, V low, V high) {
    return hn::Or(hn::Gt(hn::Sub(hn::Min(a, b), margin), high), hn::Lt(hn::Add(hn::Max(a, b), margin), low));
  };
  const auto side = [&](V x, V y) {
    return hn::Add(hn::Mul(hn::Sub(x, asked.from_x), asked.across_x), hn::Mul(hn::Sub(y, asked.from_y), asked.across_y));
  };
  const V of_a = side(ax, ay), of_b = side(bx, by), most = hn::Add(asked.within, margin);
  const auto beside = hn::Or(hn::Gt(hn::Min(of_a, of_b), most), hn::Lt(hn::Max(of_a, of_b), hn::Neg(most)));
  const auto behind = hn::Gt(hn::LoadU(d, &folds.depth[at]), asked.depth);
  return hn::Or(hn::Or(apart(ax, bx, asked.low_x, asked.high_x), apart(ay, by, asked.low_y, asked.high_y)), hn::Or(beside, behind));
}

size_t FindInReach(const FoldLanes& folds, const FoldSearch& search, std::uint32_t begin, std::uint32_t end, std::uint32_t* found) {
  const D d;
  const hn::Rebind<std::uint32_t, D> u;
  const Asked asked = asked_of(search);
  const auto lanes = hn::Iota(u, 0);
  size_t count = 0;
  for (std::uint32_t at = begin; at < end; at += static_cast<std::uint32_t>(hn::Lanes(d))) {
    const auto reach = hn::AndNot(out_of_reach(folds, asked, at), hn::FirstN(d, end - at));
    // A store that compresses on its way takes many times as long on some processors.
    hn::StoreU(packed(hn::Add(lanes, hn::Set(u, at)), packing_of(d, reach)), u, found + count);
    count += hn::CountTrue(d, reach);
  }
  return count;
}

}  // namespace
}  // namespace limn::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace limn {
HWY_EXPORT(FindInReach);
size_t folds_in_reach(const FoldLanes& folds, const FoldSearch& search, std::uint32_t begin, std::uint32_t end, std::uint32_t* found) {
  return HWY_DYNAMIC_DISPATCH(FindInReach)(folds, search, begin, end, found);
}
}  // namespace limn
#endif
