#include "raymarch/files/exr_lanes.h"

#include <algorithm>

#include "sdf/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raymarch/files/exr_lanes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace limn {
namespace HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, 16>;
using BitTag = hn::RebindToUnsigned<Tag>;
using HalfTag = hn::Rebind<std::uint16_t, BitTag>;
using Bits = hn::Vec<BitTag>;
using ByteTag = hn::CappedTag<std::uint8_t, 64>;

HWY_INLINE Bits bits(std::uint32_t value) { return hn::Set(BitTag(), value); }

/// Highway's own conversion cuts off where the machine has no instruction for it (1.0.3); this one rounds alike everywhere.
/// Below 2^-14 a half has steps of 2^-24, as floats from 1/2 to 1 have: adding 1/2 rounds to them. Above, the exponents differ by 112, and
/// 13 bits are rounded away.
HWY_INLINE Bits half_of(Bits value) {
  const BitTag tag;
  const Bits sign = hn::And(hn::ShiftRight<16>(value), bits(0x8000)), size = hn::And(value, bits(0x7fffffff));
  const auto with_half = hn::Add(hn::BitCast(Tag(), size), hn::Set(Tag(), 0.5f));
  const Bits small = hn::Sub(hn::BitCast(tag, with_half), bits(0x3f000000));
  const Bits odd = hn::And(hn::ShiftRight<13>(size), bits(1));
  const Bits normal = hn::ShiftRight<13>(hn::Sub(hn::Add(hn::Add(size, bits(0xfff)), odd), bits(0x38000000)));
  const Bits kept = hn::ShiftRight<13>(hn::And(size, bits(0x7fffff)));
  const Bits no_number = hn::Or(bits(0x7c00), hn::IfThenElse(hn::Eq(kept, hn::Zero(tag)), bits(1), kept));
  Bits half = hn::IfThenElse(hn::Lt(size, bits(0x38800000)), small, normal);
  half = hn::IfThenElse(hn::Lt(size, bits(0x47800000)), half, bits(0x7c00));
  half = hn::IfThenElse(hn::Gt(size, bits(0x7f800000)), no_number, half);
  return hn::Or(half, sign);
}

void convert(const float* values, size_t count, std::uint16_t* halves) {
  const BitTag tag;
  const size_t width = hn::Lanes(tag);
  for (size_t i = 0; i + width <= count; i += width)
    hn::StoreU(hn::TruncateTo(HalfTag(), half_of(hn::BitCast(tag, hn::LoadU(Tag(), values + i)))), HalfTag(), halves + i);
  const size_t left = count % width, first = count - left;
  if (left == 0) return;
  float last[16] = {};
  std::uint16_t of_last[16];
  std::copy_n(values + first, left, last);
  hn::StoreU(hn::TruncateTo(HalfTag(), half_of(hn::BitCast(tag, hn::LoadU(Tag(), last)))), HalfTag(), of_last);
  std::copy_n(of_last, left, halves + first);
}

void differences(const std::uint8_t* row, size_t pairs, std::uint8_t* even, std::uint8_t* odd) {
  const ByteTag tag;
  const size_t width = hn::Lanes(tag);
  const auto middle = hn::Set(tag, std::uint8_t{128});
  size_t i = 1;
  for (; i + width <= pairs; i += width) {
    hn::Vec<ByteTag> evens, odds, evens_before, odds_before;
    hn::LoadInterleaved2(tag, row + 2 * i, evens, odds);
    hn::LoadInterleaved2(tag, row + 2 * i - 2, evens_before, odds_before);
    hn::StoreU(hn::Add(hn::Sub(evens, evens_before), middle), tag, even + i);
    hn::StoreU(hn::Add(hn::Sub(odds, odds_before), middle), tag, odd + i);
  }
  for (; i < pairs; ++i) {
    even[i] = static_cast<std::uint8_t>(row[2 * i] - row[2 * i - 2] + 128);
    odd[i] = static_cast<std::uint8_t>(row[2 * i + 1] - row[2 * i - 1] + 128);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace limn
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace limn {
namespace {
HWY_EXPORT(convert);
HWY_EXPORT(differences);
}  // namespace

void to_halves(const float* values, std::size_t count, std::uint16_t* halves) { HWY_DYNAMIC_DISPATCH(convert)(values, count, halves); }

void split_differences(const std::uint8_t* row, std::size_t pairs, std::uint8_t* even, std::uint8_t* odd) {
  HWY_DYNAMIC_DISPATCH(differences)(row, pairs, even, odd);
}

}  // namespace limn
#endif
