// Internal: the lanes of a mask, brought together at the front of a vector. Included once a SIMD target, after <hwy/highway.h>.
// For AVX2 Highway 1.0's Compress has its table in the function, and GCC copies all of it (a kilobyte) to the stack each time: level sets
// took two and a half times as long to draw.
#if defined(LIMN_PACKING_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LIMN_PACKING_INL_H
#undef LIMN_PACKING_INL_H
#else
#define LIMN_PACKING_INL_H
#endif

#include <array>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace limn {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_AVX2
/// For each mask of eight lanes a byte a lane, the lowest first: which lane comes there.
constexpr std::array<std::uint64_t, 256> packing_orders() {
  std::array<std::uint64_t, 256> orders{};
  for (std::uint64_t mask = 0; mask < orders.size(); ++mask) {
    std::uint64_t count = 0;
    for (std::uint64_t lane = 0; lane < 8; ++lane)
      if (mask >> lane & 1) orders[mask] |= lane << (8 * count++);
  }
  return orders;
}
alignas(64) inline constexpr std::array<std::uint64_t, 256> kPackingOrders = packing_orders();

/// How lanes of four bytes are packed.
struct Packing {
  hn::Vec<hn::Full256<std::int32_t>> order;
};

template <class D>
HWY_INLINE Packing packing_of(D d, hn::Mask<D> which) {
  static_assert(sizeof(hn::TFromD<D>) == 4 && hn::MaxLanes(D()) == 8);
  std::uint8_t bits[8];
  hn::StoreMaskBits(d, which, bits);
  const hn::Rebind<std::uint8_t, D> bytes;
  return {hn::PromoteTo(hn::Full256<std::int32_t>(), hn::LoadU(bytes, reinterpret_cast<const std::uint8_t*>(&kPackingOrders[bits[0]])))};
}

/// What lies behind the packed lanes is any of them.
template <class V>
HWY_INLINE V packed(V v, const Packing& packing) {
  return hn::TableLookupLanes(v, hn::IndicesFromVec(hn::DFromV<V>(), packing.order));
}
#else
template <class M>
struct Packing {
  M which;
};

template <class D>
HWY_INLINE Packing<hn::Mask<D>> packing_of(D, hn::Mask<D> which) {
  return {which};
}

template <class V, class M>
HWY_INLINE V packed(V v, const Packing<M>& packing) {
  return hn::Compress(v, hn::RebindMask(hn::DFromV<V>(), packing.which));
}
#endif

}  // namespace HWY_NAMESPACE
}  // namespace limn
HWY_AFTER_NAMESPACE();

#endif
