// Internal: several pairs of neighbouring values for each lane at once. Included once for each SIMD target.

#if defined(LIMN_RAYMARCH_LEVEL_SET_PAIRS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LIMN_RAYMARCH_LEVEL_SET_PAIRS_INL_H
#undef LIMN_RAYMARCH_LEVEL_SET_PAIRS_INL_H
#else
#define LIMN_RAYMARCH_LEVEL_SET_PAIRS_INL_H
#endif

#include <cstring>

#include "raymarch/level_set/lanes-inl.h"

#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3
#include <immintrin.h>
#endif

HWY_BEFORE_NAMESPACE();
namespace limn::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

struct FourPairs {
  Pair p[4];
};
struct FourValues {
  VF v[4];
};

/// Bytes from a node to the next one along x and along y.
inline constexpr std::int32_t kStepX = kBrickNodes * kBrickNodes * static_cast<std::int32_t>(sizeof(std::int16_t));
inline constexpr std::int32_t kStepY = kBrickNodes * static_cast<std::int32_t>(sizeof(std::int16_t));
/// The same along y of a spline's brick.
inline constexpr std::int32_t kSplineStepY = kSplineNodes * static_cast<std::int32_t>(sizeof(std::int16_t));

#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3
// A gather takes as long as the loads of its lanes one by one, and asks for four bytes at a time. Here a load brings two pairs, and the
// lanes' vectors are turned round in registers.

/// Elements that a load brings.
inline constexpr int kBroughtAlong = 16;

struct FourWords {
  VI w[4];
};

/// part(k): four words of lane k.
template <class Part>
HWY_INLINE FourWords turned_round(const Part& part) {
  __m512i rows[4];
  for (int j = 0; j < 4; ++j) {
    const __m512i first = _mm512_inserti32x4(_mm512_castsi128_si512(part(j)), part(4 + j), 1);
    rows[j] = _mm512_inserti32x4(_mm512_inserti32x4(first, part(8 + j), 2), part(12 + j), 3);
  }
  const __m512i a = _mm512_unpacklo_epi32(rows[0], rows[1]), b = _mm512_unpacklo_epi32(rows[2], rows[3]);
  const __m512i c = _mm512_unpackhi_epi32(rows[0], rows[1]), d = _mm512_unpackhi_epi32(rows[2], rows[3]);
  return {
      {VI{_mm512_unpacklo_epi64(a, b)}, VI{_mm512_unpackhi_epi64(a, b)}, VI{_mm512_unpacklo_epi64(c, d)}, VI{_mm512_unpackhi_epi64(c, d)}}};
}

HWY_INLINE FourPairs pairs_of(const FourWords& words) {
  return {{pair_of(words.w[0]), pair_of(words.w[1]), pair_of(words.w[2]), pair_of(words.w[3])}};
}

/// Pairs along z at the offsets `a` and `b` (bytes), and at the nodes behind those along y: a, a + y, b, b + y. Up to 32 bytes from the
/// offsets on are read.
HWY_INLINE FourPairs pairs_along_y(const std::int16_t* base, VI a, VI b) {
  const I i;
  alignas(64) std::int32_t at_a[16], at_b[16];
  hn::Store(a, i, at_a);
  hn::Store(b, i, at_b);
  static_assert(kStepY == 18);
  static_assert(brick_element(8, 7, 8) + kBroughtAlong <= kBrickElements + kReadBeyond);
  const __m256i words = _mm256_setr_epi16(0, 1, 9, 10, 16, 17, 25, 26, 0, 0, 0, 0, 0, 0, 0, 0);
  const char* const bytes = reinterpret_cast<const char*>(base);
  return pairs_of(turned_round([&](int k) {
    const __m256i p = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(bytes + at_a[k]));
    const __m256i q = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(bytes + at_b[k]));
    return _mm256_castsi256_si128(_mm256_permutex2var_epi16(p, words, q));
  }));
}

/// Four values along z of a spline's brick from `at` (bytes) on, and four of the next row along y: as two pairs each.
HWY_INLINE FourPairs spline_rows(const std::int16_t* base, VI at) {
  alignas(64) std::int32_t offsets[16];
  hn::Store(at, I(), offsets);
  static_assert(kSplineStepY == 22);
  static_assert((10 * kSplineNodes + 9) * kSplineNodes + 7 + kBroughtAlong <= kSplineStride);
  const __m256i words = _mm256_setr_epi16(0, 1, 2, 3, 11, 12, 13, 14, 0, 0, 0, 0, 0, 0, 0, 0);
  const char* const bytes = reinterpret_cast<const char*>(base);
  return pairs_of(turned_round([&](int k) {
    const __m256i rows = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(bytes + offsets[k]));
    return _mm256_castsi256_si128(_mm256_permutexvar_epi16(words, rows));
  }));
}

/// Four values from element `at` on.
HWY_INLINE FourValues four_values(const float* base, VI at) {
  alignas(64) std::int32_t elements[16];
  hn::Store(at, I(), elements);
  const FourWords words = turned_round([&](int k) { return _mm_loadu_si128(reinterpret_cast<const __m128i*>(base + elements[k])); });
  const F d;
  return {{hn::BitCast(d, words.w[0]), hn::BitCast(d, words.w[1]), hn::BitCast(d, words.w[2]), hn::BitCast(d, words.w[3])}};
}
#else
HWY_INLINE FourPairs pairs_along_y(const std::int16_t* base, VI a, VI b) {
  const VI behind = hn::Set(I(), kStepY);
  return {{gather_pair(base, a), gather_pair(base, hn::Add(a, behind)), gather_pair(base, b), gather_pair(base, hn::Add(b, behind))}};
}
HWY_INLINE FourPairs spline_rows(const std::int16_t* base, VI at) {
  const VI next = hn::Add(at, hn::Set(I(), kSplineStepY)), four = hn::Set(I(), 4);
  return {{gather_pair(base, at), gather_pair(base, hn::Add(at, four)), gather_pair(base, next), gather_pair(base, hn::Add(next, four))}};
}
HWY_INLINE FourValues four_values(const float* base, VI at) {
  const auto element = [&](int k) { return hn::GatherIndex(F(), base, hn::Add(at, hn::Set(I(), k))); };
  return {{element(0), element(1), element(2), element(3)}};
}
#endif

}  // namespace
}  // namespace limn::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
