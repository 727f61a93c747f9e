#pragma once
// Internal: constants written past the caches, where memory has such stores.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

#if LIMN_SIMD && defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace limn {

/// std::fill_n of plain values whose bytes repeat every 16 (each of its 32-bit words is the same, or its bytes are).
template <class T>
void stream_fill(T* to, size_t count, const T& value) {
#if LIMN_SIMD && defined(__SSE2__)
  unsigned char pattern[16];
  for (size_t k = 0; k < sizeof pattern; ++k)
    pattern[k] = reinterpret_cast<const unsigned char*>(&value)[k % std::min<size_t>(sizeof(T), 4)];
  auto* at = reinterpret_cast<unsigned char*>(to);
  unsigned char* const end = at + count * sizeof(T);
  const size_t head = std::min<size_t>((16 - reinterpret_cast<std::uintptr_t>(at) % 16) % 16, static_cast<size_t>(end - at));
  // Elements lie at multiples of their words, so the pattern starts anew at every 16-byte boundary as it does at `to`.
  std::memcpy(at, pattern, head);
  const __m128i words = _mm_loadu_si128(reinterpret_cast<const __m128i*>(pattern));
  for (at += head; at + 16 <= end; at += 16) _mm_stream_si128(reinterpret_cast<__m128i*>(at), words);
  std::memcpy(at, pattern, static_cast<size_t>(end - at));
#else
  std::fill_n(to, count, value);
#endif
}

}  // namespace limn
