#include "raymarch/border/angle_ink.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "raymarch/border/surface_notes.h"
#include "sdf/error.h"
#include "sdf/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raymarch/border/angle_ink.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace limn::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

/// Returns how many pixels it did: as many as fill whole registers.
size_t HardInk(float first_clear, std::span<const float> n_dot_v, std::span<const std::int32_t> id, std::span<float> coverage) {
  const hn::ScalableTag<float> f;
  const hn::RebindToSigned<decltype(f)> i32;
  const size_t lanes = hn::Lanes(f);
  const auto one = hn::Set(f, 1.0f), clear = hn::Set(f, first_clear);
  size_t i = 0;
  for (; i + lanes <= coverage.size(); i += lanes) {
    const auto hit = hn::RebindMask(f, hn::Ne(hn::LoadU(i32, id.data() + i), hn::Zero(i32)));
    const auto inked = hn::Not(hn::Ge(hn::LoadU(f, n_dot_v.data() + i), clear));
    hn::StoreU(hn::IfThenElseZero(hn::And(hit, inked), one), f, coverage.data() + i);
  }
  return i;
}

/// The same of a fading edge.
size_t SoftInk(double edge0, double edge1, std::span<const float> n_dot_v, std::span<const std::int32_t> id, std::span<float> coverage) {
  const hn::CappedTag<double, 8> d;
  const hn::Rebind<float, decltype(d)> f;
  const hn::RebindToSigned<decltype(f)> i32;
  const size_t lanes = hn::Lanes(f);
  const auto from = hn::Set(d, edge0), width = hn::Set(d, edge1 - edge0), one = hn::Set(d, 1.0);
  size_t i = 0;
  for (; i + lanes <= coverage.size(); i += lanes) {
    const auto hit = hn::RebindMask(f, hn::Ne(hn::LoadU(i32, id.data() + i), hn::Zero(i32)));
    const auto x = hn::PromoteTo(d, hn::LoadU(f, n_dot_v.data() + i));
    const auto t = hn::Min(hn::Max(hn::Div(hn::Sub(x, from), width), hn::Zero(d)), one);
    const auto step = hn::Mul(hn::Mul(t, t), hn::Sub(hn::Set(d, 3.0), hn::Mul(hn::Set(d, 2.0), t)));
    hn::StoreU(hn::IfThenElseZero(hit, hn::DemoteTo(f, hn::Sub(one, step))), f, coverage.data() + i);
  }
  return i;
}

}  // namespace
}  // namespace limn::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace limn {
namespace {
HWY_EXPORT(HardInk);
HWY_EXPORT(SoftInk);

/// The least float that is not below `edge`: floats compare with it as doubles do with the edge.
float least_float_from(double edge) {
  const auto near = static_cast<float>(edge);
  return static_cast<double>(near) < edge ? std::nextafter(near, std::numeric_limits<float>::infinity()) : near;
}

}  // namespace

void rim_ink(double edge, double half, std::span<const float> n_dot_v, std::span<const std::int32_t> id, std::span<float> coverage) {
  LIMN_CHECK(n_dot_v.size() == coverage.size() && id.size() == coverage.size());
  const double edge0 = edge - half, edge1 = edge + half;
  size_t i = edge1 > edge0 ? HWY_DYNAMIC_DISPATCH(SoftInk)(edge0, edge1, n_dot_v, id, coverage)
                           : HWY_DYNAMIC_DISPATCH(HardInk)(least_float_from(edge1), n_dot_v, id, coverage);
  for (; i < coverage.size(); ++i) coverage[i] = id[i] != 0 ? static_cast<float>(1.0 - smoothstep(edge0, edge1, double{n_dot_v[i]})) : 0.0f;
}

}  // namespace limn
#endif
