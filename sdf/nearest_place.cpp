#include "sdf/nearest_place.h"

#include <limits>

#include "sdf/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sdf/nearest_place.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace limn {
namespace HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, 16>;
using Floats = hn::Vec<Tag>;

struct Query {
  const float *x, *y, *z;
  Floats px, py, pz;

  HWY_INLINE Floats squared(size_t first) const {
    const Tag tag;
    const Floats dx = hn::Sub(hn::LoadU(tag, x + first), px), dy = hn::Sub(hn::LoadU(tag, y + first), py),
                 dz = hn::Sub(hn::LoadU(tag, z + first), pz);
    return hn::Add(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)), hn::Mul(dz, dz));
  }
};

size_t nearest(const float* x, const float* y, const float* z, size_t count, float px, float py, float pz) {
  const Tag tag;
  const Query query{x, y, z, hn::Set(tag, px), hn::Set(tag, py), hn::Set(tag, pz)};
  Floats least = hn::Set(tag, std::numeric_limits<float>::infinity());
  for (size_t i = 0; i < count; i += hn::Lanes(tag)) least = hn::Min(least, query.squared(i));
  const Floats best = hn::MinOfLanes(tag, least);
  for (size_t i = 0; i < count; i += hn::Lanes(tag)) {
    const auto found = hn::Eq(query.squared(i), best);
    if (!hn::AllFalse(tag, found)) return i + hn::FindKnownFirstTrue(tag, found);
  }
  return 0;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace limn
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace limn {
namespace {
HWY_EXPORT(nearest);
constexpr size_t kWidest = 16;  // lanes
}  // namespace

void Places::clear() {
  for (std::vector<float>& axis : at) axis.clear();
}

void Places::add(float x, float y, float z) {
  at[0].push_back(x);
  at[1].push_back(y);
  at[2].push_back(z);
}

void Places::pad() {
  for (std::vector<float>& axis : at) axis.resize((axis.size() + kWidest - 1) / kWidest * kWidest, axis.back());
}

std::size_t nearest_place(const Places& places, const std::array<float, 3>& p) {
  return HWY_DYNAMIC_DISPATCH(nearest)(places.at[0].data(), places.at[1].data(), places.at[2].data(), places.at[0].size(), p[0], p[1],
                                       p[2]);
}

}  // namespace limn
#endif
