#include "sdf/node_bits.h"

#include <algorithm>

#include "sdf/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sdf/node_bits.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace limn {
namespace HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, 16>;
using Floats = hn::Vec<Tag>;
// Asked of the tag: HWY_SCALAR has one lane, though HWY_MAX_BYTES would hold two.
constexpr size_t kNodes = 1000, kWidth = hn::MaxLanes(Tag());

HWY_INLINE void set_bits(hn::Mask<Tag> mask, size_t first, NodeBits& bits) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(Tag(), mask, bytes);
  const std::uint64_t found = (bytes[0] | static_cast<std::uint64_t>(bytes[1]) << 8) & ((1u << kWidth) - 1u);
  const size_t word = first >> 6, bit = first & 63;
  bits.words[word] |= found << bit;
  if (bit + kWidth > 64) bits.words[word + 1] |= found >> (64 - bit);
}

void find_inside(const float* nodes, NodeBits& inside) {
  const Floats zero = hn::Zero(Tag());
  // The last vector overlaps the one before.
  for (size_t i = 0; i < kNodes; i += kWidth) {
    const size_t first = std::min(i, kNodes - kWidth);
    set_bits(hn::Lt(hn::LoadU(Tag(), nodes + first), zero), first, inside);
  }
}

/// Written so that a neighbour that is no number counts for nothing.
HWY_INLINE Floats larger_difference(Floats largest, Floats value, const float* neighbor) {
  const Floats difference = hn::Abs(hn::Sub(hn::LoadU(Tag(), neighbor), value));
  return hn::IfThenElse(hn::Lt(largest, difference), difference, largest);
}

void find_steep(const float* nodes, float most, NodeBits& steep) {
  constexpr size_t kFirst = 100, kLast = 899;  // what has neighbours in memory on both sides; the block's own are 111..888
  const Floats half = hn::Set(Tag(), 0.5f), limit = hn::Set(Tag(), most);
  for (size_t i = kFirst; i <= kLast; i += kWidth) {
    const size_t first = std::min(i, kLast + 1 - kWidth);
    const float* const at = nodes + first;
    const Floats value = hn::LoadU(Tag(), at);
    Floats largest = hn::Zero(Tag());
    for (const std::ptrdiff_t step : {-100, 100, -10, 10, -1, 1}) largest = larger_difference(largest, value, at + step);
    set_bits(hn::Lt(hn::Abs(value), hn::Min(hn::Mul(half, largest), limit)), first, steep);
  }
}

float largest_value(const float* nodes, const NodeBits& which) {
  Floats largest = hn::Zero(Tag());
  for (size_t i = 0; i < kNodes; i += kWidth) {
    const size_t first = std::min(i, kNodes - kWidth), word = first >> 6, bit = first & 63;
    const std::uint64_t bits = (which.words[word] >> bit | which.words[word + 1] << 1 << (63 - bit)) & ((1u << kWidth) - 1u);
    if (bits == 0) continue;
    const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(bits & 0xffu), static_cast<std::uint8_t>(bits >> 8)};
    const Floats size = hn::Abs(hn::LoadU(Tag(), nodes + first));
    largest = hn::IfThenElse(hn::And(hn::LoadMaskBits(Tag(), bytes), hn::Lt(largest, size)), size, largest);
  }
  return hn::GetLane(hn::MaxOfLanes(Tag(), largest));
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace limn
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace limn {
namespace {
HWY_EXPORT(find_inside);
HWY_EXPORT(find_steep);
HWY_EXPORT(largest_value);
}  // namespace

bool find_inside(const NodeWindow& nodes, NodeBits& inside) {
  HWY_DYNAMIC_DISPATCH(find_inside)(nodes.front().front().data(), inside);
  constexpr std::uint64_t kAll = ~std::uint64_t{0}, kRest = (std::uint64_t{1} << 40) - 1;  // 1000 = 15 * 64 + 40
  std::uint64_t some = inside.words[15], every = inside.words[15] | ~kRest;
  for (size_t k = 0; k < 15; ++k) {
    some |= inside.words[k];
    every &= inside.words[k];
  }
  return some != 0 && every != kAll;
}

float largest_value(const NodeWindow& nodes, const NodeBits& which) {
  return HWY_DYNAMIC_DISPATCH(largest_value)(nodes.front().front().data(), which);
}

bool find_steep(const NodeWindow& nodes, float most, NodeBits& steep) {
  HWY_DYNAMIC_DISPATCH(find_steep)(nodes.front().front().data(), most, steep);
  std::uint64_t some = 0;
  for (const std::uint64_t word : steep.words) some |= word;
  return some != 0;
}

}  // namespace limn
#endif
