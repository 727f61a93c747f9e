#include "raymarch/border/line_raster.h"

#include <cmath>
#include <vector>

#include "raymarch/gbuffer/picture_rows.h"
#include "sdf/segment.h"

namespace limn {
namespace {

double reach_of(const LinePiece& piece) { return 0.5 * std::max(piece.width_a, piece.width_b) + 0.5; }

/// First and last line of pixels that the piece may touch.
std::pair<int, int> rows_of(const LinePiece& piece, int height) {
  const double reach = reach_of(piece);
  const double top = std::clamp(std::floor(std::min(piece.a.y, piece.b.y) - reach - 0.5), -1.0, static_cast<double>(height));
  const double bottom = std::clamp(std::ceil(std::max(piece.a.y, piece.b.y) + reach), -1.0, static_cast<double>(height));
  return {std::max(0, static_cast<int>(top)), std::min(height - 1, static_cast<int>(bottom))};
}

/// The pixels of line `y` that lie within reach: those about the stretch of the segment that passes near the line.
std::pair<int, int> columns_of(const LinePiece& piece, int y, int width) {
  const double reach = reach_of(piece), center = y + 0.5;
  const glm::dvec2 along = piece.b - piece.a;
  double low = 0.0, high = 1.0;
  if (along.y != 0.0) {
    const double u = (center - reach - piece.a.y) / along.y, v = (center + reach - piece.a.y) / along.y;
    low = std::clamp(std::min(u, v), 0.0, 1.0);
    high = std::clamp(std::max(u, v), 0.0, 1.0);
  }
  const double x0 = piece.a.x + low * along.x, x1 = piece.a.x + high * along.x;
  const double left = std::clamp(std::floor(std::min(x0, x1) - reach - 0.5), -1.0, static_cast<double>(width));
  const double right = std::clamp(std::ceil(std::max(x0, x1) + reach), -1.0, static_cast<double>(width));
  return {std::max(0, static_cast<int>(left)), std::min(width - 1, static_cast<int>(right))};
}

void draw_row(const LinePiece& piece, int y, Image<float>& coverage) {
  const glm::dvec2 along = piece.b - piece.a;
  const auto [first, last] = columns_of(piece, y, coverage.width);
  for (int x = first; x <= last; ++x) {
    const glm::dvec2 from_a = glm::dvec2(x + 0.5, y + 0.5) - piece.a;
    const double s = closest_share(from_a, along);
    const double ink = line_coverage(glm::length(from_a - s * along), piece.width_a + s * (piece.width_b - piece.width_a));
    float& pixel = coverage.at(x, y);
    pixel = std::max(pixel, static_cast<float>(ink));
  }
}

}  // namespace

double line_coverage(double distance_px, double width_px) {
  const double half = 0.5 * width_px;
  return std::clamp(std::min(distance_px + 0.5, half) - std::max(distance_px - 0.5, -half), 0.0, 1.0);
}

void draw_lines(std::span<const LinePiece> pieces, Image<float>& coverage) {
  if (coverage.height == 0) return;
  const int bands = (coverage.height + kBandRows - 1) / kBandRows;
  std::vector<std::vector<std::uint32_t>> of_band(static_cast<size_t>(bands));
  for (size_t i = 0; i < pieces.size(); ++i) {
    const auto [top, bottom] = rows_of(pieces[i], coverage.height);
    for (int band = top / kBandRows; top <= bottom && band <= bottom / kBandRows; ++band)
      of_band[static_cast<size_t>(band)].push_back(static_cast<std::uint32_t>(i));
  }
  for_each_band(coverage.height, [&](int y0, int y1) {
    for (const std::uint32_t i : of_band[static_cast<size_t>(y0 / kBandRows)]) {
      const auto [top, bottom] = rows_of(pieces[i], coverage.height);
      for (int y = std::max(top, y0); y <= std::min(bottom, y1 - 1); ++y) draw_row(pieces[i], y, coverage);
    }
  });
}

}  // namespace limn
