#include "raymarch/border/broken_lines.h"

#include <fmt/core.h>

#include <algorithm>
#include <atomic>

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

}  // namespace

std::int64_t count_specks(const Image<float>& coverage, int least_px, const std::function<bool(size_t)>& counts) {
  std::atomic<std::int64_t> specks{0};
  for_each_band(coverage.height, [&](int y0, int y1) {
    std::vector<size_t> piece;
    const size_t begin = coverage.index(0, y0), end = begin + static_cast<size_t>(y1 - y0) * static_cast<size_t>(coverage.width);
    std::int64_t own = 0;
    for (size_t i = begin; i < end; ++i) {
      if (!is_inked(coverage, i)) continue;
      piece_from(coverage, i, least_px, piece);
      own += !piece.empty() && static_cast<int>(piece.size()) < least_px && std::all_of(piece.begin(), piece.end(), counts);
    }
    specks += own;
  });
  return specks;
}

std::string broken_lines_note(const std::string& name, const BorderInput& input, const Image<float>& coverage) {
  const std::vector<Surface>& surfaces = input.model.surfaces;
  if (std::none_of(surfaces.begin(), surfaces.end(), [](const Surface& surface) { return surface.info.voxel_size > 0.0; })) return {};
  const GBuffer& seen = input.gbuffer;
  const auto voxel_px = [&](size_t i) {
    const std::int32_t id = seen.id.pixels[i];
    if (id == 0) return 0.0;
    return surfaces[static_cast<size_t>(id - 1)].info.voxel_size * pixels_per_unit_at(input.camera, double{seen.depth.pixels[i]});
  };
  const std::int64_t specks = count_specks(coverage, kSpeckPx, [&](size_t i) { return voxel_px(i) > 1.0; });
  if (specks == 0) return {};
  return fmt::format(
      "{}: {} piece{} of line on level sets {} shorter than {} px: the grid turns its creases over a voxel or two, which cover several "
      "pixels here; a finer grid draws the lines whole",
      name, specks, specks == 1 ? "" : "s", specks == 1 ? "is" : "are", kSpeckPx);
}

}  // namespace limn
