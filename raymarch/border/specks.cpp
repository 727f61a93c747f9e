#include "raymarch/border/specks.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <vector>

#include "raymarch/gbuffer/picture_rows.h"

namespace limn {
namespace {

bool is_inked(const Image<float>& coverage, size_t i) { return coverage.pixels[i] > 0.5f; }

/// The piece that pixel `start` belongs to, as far as `least_px` pixels; empty where it has a pixel before `start`, which finds it instead.
void piece_from(const Image<float>& coverage, size_t start, int least_px, std::vector<size_t>& piece) {
  const int width = coverage.width;
  piece.assign(1, start);
  for (size_t next = 0; next < piece.size() && static_cast<int>(piece.size()) < least_px; ++next) {
    const int x = static_cast<int>(piece[next] % static_cast<size_t>(width)),
              y = static_cast<int>(piece[next] / static_cast<size_t>(width));
    for (int v = std::max(0, y - 1); v <= std::min(coverage.height - 1, y + 1); ++v) {
      for (int u = std::max(0, x - 1); u <= std::min(width - 1, x + 1); ++u) {
        const size_t i = coverage.index(u, v);
        if (!is_inked(coverage, i) || std::find(piece.begin(), piece.end(), i) != piece.end()) continue;
        if (i < start) return piece.clear();
        piece.push_back(i);
      }
    }
  }
}

/// Calls `visit(pixels)` for each speck, on any thread.
template <class Visit>
void for_each_speck(const Image<float>& coverage, int least_px, const std::function<bool(size_t)>& counts, const Visit& visit) {
  for_each_band(coverage.height, [&](int y0, int y1) {
    std::vector<size_t> piece;
    const size_t begin = coverage.index(0, y0), end = begin + static_cast<size_t>(y1 - y0) * static_cast<size_t>(coverage.width);
    for (size_t i = begin; i < end; ++i) {
      if (!is_inked(coverage, i)) continue;
      piece_from(coverage, i, least_px, piece);
      if (!piece.empty() && static_cast<int>(piece.size()) < least_px && std::all_of(piece.begin(), piece.end(), counts)) visit(piece);
    }
  });
}

}  // namespace

std::int64_t count_specks(const Image<float>& coverage, int least_px, const std::function<bool(size_t)>& counts) {
  std::atomic<std::int64_t> specks{0};
  for_each_speck(coverage, least_px, counts, [&](const std::vector<size_t>&) { ++specks; });
  return specks;
}

void drop_specks(int least_px, const std::function<bool(size_t)>& counts, Image<float>& coverage) {
  // All are found before any is taken away: a speck may reach into the lines of another task.
  std::vector<size_t> pixels;
  std::mutex adding;
  for_each_speck(coverage, least_px, counts, [&](const std::vector<size_t>& speck) {
    const std::lock_guard lock(adding);
    pixels.insert(pixels.end(), speck.begin(), speck.end());
  });
  for (const size_t i : pixels) coverage.pixels[i] = 0.0f;
}

}  // namespace limn
