#include "raymarch/level_set/quantise.h"

#include <cmath>

#include "raymarch/level_set/bricks.h"
#include "sdf/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raymarch/level_set/quantise.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace limn {
namespace HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using F = hn::CappedTag<float, 16>;
using VF = hn::Vec<F>;

/// In the order of quantised(), whose comparisons decide what becomes of what is no number until the end.
HWY_INLINE VF steps_of(VF value, VF steps_per_unit) {
  const F d;
  const VF largest = hn::Set(d, 32767.0f), half = hn::Set(d, 0.5f), one = hn::Set(d, 1.0f);
  const VF size = hn::Abs(hn::Mul(value, steps_per_unit));
  const VF rounded = hn::Add(hn::IfThenElse(hn::Lt(largest, size), largest, size), half);
  const VF steps = hn::IfThenElse(hn::Lt(rounded, one), one, rounded);
  const VF with_sign = hn::IfThenElse(hn::Lt(value, hn::Zero(d)), hn::Neg(steps), steps);
  return hn::IfThenElseZero(hn::Eq(steps, steps), with_sign);
}

size_t quantise_most(std::span<const float> values, float steps_per_unit, std::int16_t* steps) {
  const F d;
  const hn::RebindToSigned<F> whole;
  const hn::Rebind<std::int16_t, F> narrow;
  const VF per_unit = hn::Set(d, steps_per_unit);
  size_t i = 0;
  for (; i + hn::Lanes(d) <= values.size(); i += hn::Lanes(d))
    hn::StoreU(hn::DemoteTo(narrow, hn::ConvertTo(whole, steps_of(hn::LoadU(d, values.data() + i), per_unit))), narrow, steps + i);
  return i;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace limn
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace limn {
namespace {
HWY_EXPORT(quantise_most);
}  // namespace

void quantise(std::span<const float> values, float steps_per_unit, std::int16_t* steps) {
  for (size_t i = HWY_DYNAMIC_DISPATCH(quantise_most)(values, steps_per_unit, steps); i < values.size(); ++i)
    steps[i] = std::isnan(values[i]) ? std::int16_t{0} : quantised(values[i], steps_per_unit);
}

}  // namespace limn
#endif
