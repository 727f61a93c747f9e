#include "raymarch/border/jump_flood_pass.h"

#include <algorithm>

#if LIMN_SIMD && defined(__x86_64__) && defined(__GNUC__)
#define LIMN_FLOOD_X86 1
#include <immintrin.h>
#else
#define LIMN_FLOOD_X86 0
#endif

namespace limn {
namespace {

std::int16_t add_saturated(std::int16_t a, std::int16_t b) { return static_cast<std::int16_t>(std::clamp(a + b, -32768, 32767)); }

void flood_scalar(const Offset* own, const BlockSources& sources, std::ptrdiff_t stride, Offset* out) {
  for (int y = 0; y < kBlockHeight_px; ++y) {
    for (std::ptrdiff_t i = y * stride; i < y * stride + kBlockWidth_px; ++i) {
      Offset best = own[i];
      for (size_t k = 0; k < static_cast<size_t>(sources.count); ++k) {
        const Offset theirs = sources.from[k][i], move = sources.move[k];
        const Offset offer{add_saturated(theirs.x, move.x), add_saturated(theirs.y, move.y)};
        if (square(offer) < square(best)) best = offer;
      }
      out[i] = best;
    }
  }
}

#if LIMN_FLOOD_X86

int packed(Offset move) {
  return static_cast<int>(static_cast<std::uint16_t>(move.x) | std::uint32_t{static_cast<std::uint16_t>(move.y)} << 16);
}

void flood_sse2(const Offset* own, const BlockSources& sources, std::ptrdiff_t stride, Offset* out) {
  __m128i moves[8];
  for (size_t k = 0; k < 8; ++k) moves[k] = _mm_set1_epi32(packed(sources.move[k]));
  const auto count = static_cast<size_t>(sources.count);
  for (int y = 0; y < kBlockHeight_px; ++y) {
    for (std::ptrdiff_t i = y * stride; i < y * stride + kBlockWidth_px; i += 4) {
      __m128i best = _mm_loadu_si128(reinterpret_cast<const __m128i*>(own + i));
      __m128i best_square = _mm_madd_epi16(best, best);
      for (size_t k = 0; k < count; ++k) {
        const __m128i offer = _mm_adds_epi16(_mm_loadu_si128(reinterpret_cast<const __m128i*>(sources.from[k] + i)), moves[k]);
        const __m128i offer_square = _mm_madd_epi16(offer, offer);
        const __m128i nearer = _mm_cmplt_epi32(offer_square, best_square);
        best_square = _mm_xor_si128(best_square, _mm_and_si128(nearer, _mm_xor_si128(best_square, offer_square)));
        best = _mm_xor_si128(best, _mm_and_si128(nearer, _mm_xor_si128(best, offer)));
      }
      _mm_storeu_si128(reinterpret_cast<__m128i*>(out + i), best);
    }
  }
}

/// Two registers at a time, so that a neighbour's address and move are fetched once for both.
__attribute__((target("avx2"))) void flood_avx2(const Offset* own, const BlockSources& sources, std::ptrdiff_t stride, Offset* out) {
  __m256i moves[8];
  for (size_t k = 0; k < 8; ++k) moves[k] = _mm256_set1_epi32(packed(sources.move[k]));
  const auto count = static_cast<size_t>(sources.count);
  for (int y = 0; y < kBlockHeight_px; ++y) {
    for (std::ptrdiff_t i = y * stride; i < y * stride + kBlockWidth_px; i += 16) {
      __m256i best_a = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(own + i));
      __m256i best_b = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(own + i + 8));
      __m256i square_a = _mm256_madd_epi16(best_a, best_a), square_b = _mm256_madd_epi16(best_b, best_b);
      for (size_t k = 0; k < count; ++k) {
        const Offset* theirs = sources.from[k] + i;
        const __m256i offer_a = _mm256_adds_epi16(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(theirs)), moves[k]);
        const __m256i offer_b = _mm256_adds_epi16(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(theirs + 8)), moves[k]);
        const __m256i offer_square_a = _mm256_madd_epi16(offer_a, offer_a), offer_square_b = _mm256_madd_epi16(offer_b, offer_b);
        best_a = _mm256_blendv_epi8(best_a, offer_a, _mm256_cmpgt_epi32(square_a, offer_square_a));
        best_b = _mm256_blendv_epi8(best_b, offer_b, _mm256_cmpgt_epi32(square_b, offer_square_b));
        square_a = _mm256_min_epi32(square_a, offer_square_a);
        square_b = _mm256_min_epi32(square_b, offer_square_b);
      }
      _mm256_storeu_si256(reinterpret_cast<__m256i*>(out + i), best_a);
      _mm256_storeu_si256(reinterpret_cast<__m256i*>(out + i + 8), best_b);
    }
  }
}

#endif

}  // namespace

std::vector<FloodKernel> flood_kernels() {
  std::vector<FloodKernel> kernels{{"scalar", flood_scalar}};
#if LIMN_FLOOD_X86
  kernels.push_back({"SSE2", flood_sse2});
  if (__builtin_cpu_supports("avx2")) kernels.push_back({"AVX2", flood_avx2});
#endif
  return kernels;
}

}  // namespace limn
