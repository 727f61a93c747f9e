#pragma once
// Internal: constants written sixteen bytes at a time, past the caches where that is wanted and memory has such stores.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "raymarch/surface.h"
#include "sdf/image.h"

#if LIMN_SIMD && defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace limn {

/// std::fill_n of plain values whose bytes repeat every 16: each of its 32-bit words is the same, or its bytes are, or it is 16 bytes long
/// and lies at a multiple of them.
template <class T>
void fill_words(T* to, size_t count, const T& value, bool past_caches) {
#if LIMN_SIMD && defined(__SSE2__)
  constexpr size_t period = sizeof(T) == 16 ? 16 : std::min<size_t>(sizeof(T), 4);
  if (reinterpret_cast<std::uintptr_t>(to) % period != 0) {
    std::fill_n(to, count, value);
    return;
  }
  unsigned char pattern[16];
  for (size_t k = 0; k < sizeof pattern; ++k) pattern[k] = reinterpret_cast<const unsigned char*>(&value)[k % period];
  auto* at = reinterpret_cast<unsigned char*>(to);
  unsigned char* const end = at + count * sizeof(T);
  const size_t head = std::min<size_t>((16 - reinterpret_cast<std::uintptr_t>(at) % 16) % 16, static_cast<size_t>(end - at));
  // Elements lie at multiples of their words, so the pattern starts anew at every 16-byte boundary as it does at `to`.
  std::memcpy(at, pattern, head);
  const __m128i words = _mm_loadu_si128(reinterpret_cast<const __m128i*>(pattern));
  at += head;
  if (past_caches)
    for (; at + 16 <= end; at += 16) _mm_stream_si128(reinterpret_cast<__m128i*>(at), words);
  else
    for (; at + 16 <= end; at += 16) _mm_store_si128(reinterpret_cast<__m128i*>(at), words);
  std::memcpy(at, pattern, static_cast<size_t>(end - at));
#else
  static_cast<void>(past_caches);
  std::fill_n(to, count, value);
#endif
}

template <class T>
void stream_fill(T* to, size_t count, const T& value) {
  fill_words(to, count, value, true);
}

/// Pictures of more pixels than this do not stay in a cache until somebody reads them.
inline constexpr size_t kLargePicture = size_t{1} << 20;

/// Gives the tile's pixels one value, in large pictures past the caches; nothing where the image has no pixels.
template <class T>
void fill_rows(Image<T>& image, const PixelTile& tile, const T& value) {
  if (image.pixels.empty()) return;
  const bool past_caches = image.size() >= kLargePicture;
  for (int y = tile.y; y < tile.y + tile.height; ++y)
    fill_words(&image.pixels[image.index(tile.x, y)], static_cast<size_t>(tile.width), value, past_caches);
}

}  // namespace limn
