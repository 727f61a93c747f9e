#include "sdf/level_set_lanes.h"

#include <algorithm>
#include <bit>

#include "sdf/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sdf/level_set_lanes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "sdf/lane_real-inl.h"

HWY_BEFORE_NAMESPACE();
namespace limn {
namespace HWY_NAMESPACE {
namespace {

constexpr size_t kLanes = 16;
constexpr unsigned kAll = (1u << kWidth) - 1u;

HWY_INLINE Reals with_sign(Reals size, Reals sign) { return {hn::CopySign(size.v, sign.v)}; }

void select_near(const LanePoints& points, double lipschitz, double half_width, LaneNumbers& values, NearPoints& near) {
  size_t count = 0;
  for (size_t i = 0; i < points.count; i += kLanes) {
    for (int part = 0; part < kParts; ++part) {
      const size_t at = i + static_cast<size_t>(part * kWidth);
      const Reals value = load(values.at + at), least = lipschitz == 1.0 ? abs(value) : abs(value) / reals(lipschitz);
      const LaneMask far = least > reals(half_width);
      store(select(far, with_sign(least, value), value), values.at + at);
      unsigned bits = bits_of(no(far));
      if (at + static_cast<size_t>(kWidth) > points.count) bits &= at < points.count ? (1u << (points.count - at)) - 1u : 0u;
      if (bits == kAll) {
        for (size_t axis = 0; axis < 3; ++axis) hn::StoreU(load(points.at[axis] + at).v, RealTag(), near.points.at[axis] + count);
        hn::StoreU(value.v, RealTag(), near.value.at + count);
        hn::StoreU(least.v, RealTag(), near.no_less.at + count);
        for (size_t k = 0; k < static_cast<size_t>(kWidth); ++k) near.index[count + k] = static_cast<std::uint16_t>(at + k);
        count += static_cast<size_t>(kWidth);
        continue;
      }
      if (bits == 0) continue;
      HWY_ALIGN double of_value[kLanes], of_least[kLanes];
      store(value, of_value);
      store(least, of_least);
      for (; bits != 0; bits &= bits - 1) {
        const auto k = static_cast<size_t>(std::countr_zero(bits));
        for (size_t axis = 0; axis < 3; ++axis) near.points.at[axis][count] = points.at[axis][at + k];
        near.value[count] = of_value[k];
        near.no_less[count] = of_least[k];
        near.index[count++] = static_cast<std::uint16_t>(at + k);
      }
    }
  }
  near.points.count = count;
}

void sign_sizes(const NearPoints& near, LaneNumbers& sizes) {
  for (size_t i = 0; i < near.points.count; i += static_cast<size_t>(kWidth)) {
    const Reals size = maximum(abs(load(sizes.at + i)), load(near.no_less.at + i));
    store(with_sign(size, load(near.value.at + i)), sizes.at + i);
  }
}

void find_within(const LaneNumbers& numbers, size_t count, double limit, LaneFlags& within) {
  for (size_t i = 0; i < count; i += kLanes) {
    unsigned bits = 0;
    for (int part = 0; part < kParts; ++part)
      bits |= bits_of(abs(load(numbers.at + i + static_cast<size_t>(part * kWidth))) <= reals(limit)) << (part * kWidth);
    within[i / kLanes] = static_cast<std::uint16_t>(bits);
  }
}

void put_distances(const LaneNumbers& distances, std::span<const std::uint16_t> first, double half_width, LevelSetBlock& block) {
  using Float = hn::Rebind<float, RealTag>;
  const Reals limit = reals(half_width);
  for (size_t k = 0; k < first.size(); ++k) {
    HWY_ALIGN float values[kLanes];
    unsigned bits = 0;
    for (int part = 0; part < kParts; ++part) {
      const Reals distance = load(distances.at + k * kLanes + static_cast<size_t>(part * kWidth));
      const LaneMask active = abs(distance) <= limit;
      bits |= bits_of(active) << (part * kWidth);
      hn::Store(hn::DemoteTo(Float(), select(active, distance, with_sign(limit, distance)).v), Float(), values + part * kWidth);
    }
    for (size_t row = 0; row < 4; ++row) {
      const size_t node = first[k] + 8 * row;
      std::copy_n(values + 4 * row, 4, block.values + node);
      block.active[node >> 6] |= std::uint64_t{bits >> (4 * row) & 0xfu} << (node & 63);
    }
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace limn
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace limn {
namespace {
HWY_EXPORT(select_near);
HWY_EXPORT(sign_sizes);
HWY_EXPORT(find_within);
HWY_EXPORT(put_distances);
}  // namespace

void select_near(const LanePoints& points, double lipschitz, double half_width, LaneNumbers& values, NearPoints& near) {
  HWY_DYNAMIC_DISPATCH(select_near)(points, lipschitz, half_width, values, near);
  near.points.fill_up();
}
void sign_sizes(const NearPoints& near, LaneNumbers& sizes) { HWY_DYNAMIC_DISPATCH(sign_sizes)(near, sizes); }
void find_within(const LaneNumbers& numbers, size_t count, double limit, LaneFlags& within) {
  HWY_DYNAMIC_DISPATCH(find_within)(numbers, count, limit, within);
}
void put_distances(const LaneNumbers& distances, std::span<const std::uint16_t> first, double half_width, LevelSetBlock& block) {
  HWY_DYNAMIC_DISPATCH(put_distances)(distances, first, half_width, block);
}

}  // namespace limn
#endif
