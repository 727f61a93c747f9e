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

HWY_INLINE Reals with_sign(Reals size, Reals sign) { return {hn::CopySign(size.v, sign.v)}; }

void divide_far(const LanePoints& points, double lipschitz, double half_width, LaneNumbers& values, LaneNumbers& no_less, LaneFlags& near) {
  for (size_t i = 0; i < points.count; i += kLanes) {
    unsigned bits = 0;
    for (int part = 0; part < kParts; ++part) {
      const size_t at = i + static_cast<size_t>(part * kWidth);
      const Reals value = load(values.at + at), least = abs(value) / reals(lipschitz);
      const LaneMask far = least > reals(half_width);
      store(select(far, with_sign(least, value), value), values.at + at);
      store(least, no_less.at + at);
      bits |= bits_of(no(far)) << (part * kWidth);
    }
    near[i / kLanes] = static_cast<std::uint16_t>(bits);
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
HWY_EXPORT(divide_far);
HWY_EXPORT(find_within);
HWY_EXPORT(put_distances);
}  // namespace

void select_near(const LanePoints& points, double lipschitz, double half_width, LaneNumbers& values, NearPoints& near) {
  LaneNumbers no_less;
  LaneFlags flags;
  HWY_DYNAMIC_DISPATCH(divide_far)(points, lipschitz, half_width, values, no_less, flags);
  size_t count = 0;
  const auto take = [&](size_t i) {
    for (size_t axis = 0; axis < 3; ++axis) near.points.at[axis][count] = points.at[axis][i];
    near.no_less[count] = no_less[i];
    near.index[count++] = static_cast<std::uint16_t>(i);
  };
  for (size_t i = 0; i < points.count; i += 16) {
    const unsigned wanted = flags[i / 16] & (points.count - i < 16 ? (1u << (points.count - i)) - 1u : 0xffffu);
    if (wanted == 0xffffu) {
      for (size_t k = i; k < i + 16; ++k) take(k);
    } else {
      for (unsigned bits = wanted; bits != 0; bits &= bits - 1) take(i + static_cast<size_t>(std::countr_zero(bits)));
    }
  }
  near.points.count = count;
  near.points.fill_up();
}
void find_within(const LaneNumbers& numbers, size_t count, double limit, LaneFlags& within) {
  HWY_DYNAMIC_DISPATCH(find_within)(numbers, count, limit, within);
}
void put_distances(const LaneNumbers& distances, std::span<const std::uint16_t> first, double half_width, LevelSetBlock& block) {
  HWY_DYNAMIC_DISPATCH(put_distances)(distances, first, half_width, block);
}

}  // namespace limn
#endif
