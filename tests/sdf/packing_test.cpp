// Lanes of a mask brought together, in every SIMD target, against a loop.

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <vector>

#include "sdf/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/sdf/packing_test.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "sdf/packing-inl.h"

HWY_BEFORE_NAMESPACE();
namespace limn::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, 16>;
using Integers = hn::RebindToSigned<Floats>;

size_t CountLanes() { return hn::Lanes(Floats()); }

/// Numbers of lanes, of those that `taken` is not 0 for first; as floats and as integers.
void PackNumbers(const float* taken, float* floats, std::int32_t* integers) {
  const Floats d;
  const Integers di;
  const auto which = hn::Ne(hn::LoadU(d, taken), hn::Zero(d));
  const auto packing = packing_of(d, which);
  hn::StoreU(packed(hn::Iota(d, 0.0f), packing), d, floats);
  hn::StoreU(packed(hn::Iota(di, 0), packing), di, integers);
}

}  // namespace
}  // namespace limn::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "tests/simd_targets.h"

namespace limn {
namespace {
HWY_EXPORT(CountLanes);
HWY_EXPORT(PackNumbers);

TEST(Packing, BringsTheLanesOfEveryMaskTogether) {
  test::for_each_simd_target([](const char* target) {
    const size_t lanes = HWY_DYNAMIC_DISPATCH(CountLanes)();
    for (std::uint32_t mask = 0; mask < 1u << lanes; ++mask) {
      std::array<float, 16> taken{}, floats{};
      std::array<std::int32_t, 16> integers{};
      std::vector<std::int32_t> expected;
      for (std::uint32_t lane = 0; lane < lanes; ++lane) {
        if ((mask >> lane & 1) == 0) continue;
        taken[lane] = 1.0f;
        expected.push_back(static_cast<std::int32_t>(lane));
      }
      HWY_DYNAMIC_DISPATCH(PackNumbers)(taken.data(), floats.data(), integers.data());
      const auto count = static_cast<std::ptrdiff_t>(expected.size());
      ASSERT_EQ(std::vector<std::int32_t>(integers.begin(), integers.begin() + count), expected) << target << ", mask " << mask;
      ASSERT_EQ(std::vector<std::int32_t>(floats.begin(), floats.begin() + count), expected) << target << ", mask " << mask;
    }
  });
}

}  // namespace
}  // namespace limn
#endif
