#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "raymarch/truth/parts.h"

namespace limn {
namespace {

constexpr double kLeastSide = 1e-7;  // thinner trapezoids weigh nothing
constexpr size_t kMostCrossed = 24;  // pieces in a pixel beyond which their crossings are left to the trapezoids' middles

/// A piece of a border curve within one pixel.
struct Piece {
  std::uint64_t pixel = 0;
  glm::dvec2 a{0.0}, b{0.0};
};

/// Cuts a step at the lines between pixels.
void cut_at_pixels(const glm::dvec2& a, const glm::dvec2& b, int width, int height, std::vector<Piece>& pieces) {
  std::vector<double> at = {0.0, 1.0};
  for (int axis = 0; axis < 2; ++axis) {
    const double low = std::min(a[axis], b[axis]), high = std::max(a[axis], b[axis]);
    for (double line = std::floor(low) + 1.0; line < high; line += 1.0) at.push_back((line - a[axis]) / (b[axis] - a[axis]));
  }
  std::sort(at.begin(), at.end());
  for (size_t i = 0; i + 1 < at.size(); ++i) {
    if (!(at[i + 1] > at[i])) continue;
    const glm::dvec2 start = glm::mix(a, b, at[i]), end = glm::mix(a, b, at[i + 1]);
    const glm::dvec2 pixel = glm::floor(0.5 * (start + end));
    if (!(pixel.x >= 0.0 && pixel.y >= 0.0 && pixel.x < width && pixel.y < height)) continue;
    const auto index = static_cast<std::uint64_t>(pixel.y) * static_cast<std::uint64_t>(width) + static_cast<std::uint64_t>(pixel.x);
    pieces.push_back({index, start, end});
  }
}

std::vector<Piece> pieces_of(const BorderCurves& border, int width, int height) {
  std::vector<Piece> pieces;
  for (const BorderCurve& curve : border.curves) {
    const size_t n = curve.points.size();
    for (size_t i = 0; i + (curve.closed ? 0 : 1) < n; ++i) {
      cut_at_pixels(curve.points[i].px, curve.points[(i + 1) % n].px, width, height, pieces);
    }
  }
  std::stable_sort(pieces.begin(), pieces.end(), [](const Piece& a, const Piece& b) { return a.pixel < b.pixel; });
  return pieces;
}

/// The heights at which the order of the pieces along a row may change: their ends and where they cross.
std::vector<double> row_cuts(std::span<const Piece> pieces, double top) {
  std::vector<double> cuts = {top, top + 1.0};
  const auto add = [&](double y) {
    if (y > top && y < top + 1.0) cuts.push_back(y);
  };
  for (const Piece& piece : pieces) {
    add(piece.a.y);
    add(piece.b.y);
  }
  if (pieces.size() <= kMostCrossed) {
    for (size_t i = 0; i < pieces.size(); ++i) {
      for (size_t j = i + 1; j < pieces.size(); ++j) {
        const glm::dvec2 d = pieces[i].b - pieces[i].a, e = pieces[j].b - pieces[j].a, between = pieces[j].a - pieces[i].a;
        const double determinant = d.x * e.y - d.y * e.x;
        if (determinant == 0.0) continue;
        const double t = (between.x * e.y - between.y * e.x) / determinant, u = (between.x * d.y - between.y * d.x) / determinant;
        if (t > 0.0 && t < 1.0 && u > 0.0 && u < 1.0) add(pieces[i].a.y + t * d.y);
      }
    }
  }
  std::sort(cuts.begin(), cuts.end());
  return cuts;
}

/// The middles of a batch's trapezoids, and which pixel each weighs for.
struct Trapezoids {
  std::vector<glm::dvec2> middles{};
  std::vector<double> areas{};
  std::vector<std::uint64_t> pixels{};
};

void add_trapezoids(std::span<const Piece> pieces, int width, Trapezoids& out) {
  const std::uint64_t pixel = pieces[0].pixel;
  const double left = static_cast<double>(pixel % static_cast<std::uint64_t>(width));
  const std::vector<double> cuts = row_cuts(pieces, static_cast<double>(pixel / static_cast<std::uint64_t>(width)));
  std::vector<double> crossings;
  for (size_t k = 0; k + 1 < cuts.size(); ++k) {
    const double height = cuts[k + 1] - cuts[k], y = 0.5 * (cuts[k] + cuts[k + 1]);
    if (height < kLeastSide) continue;
    crossings = {left, left + 1.0};
    for (const Piece& piece : pieces) {
      if ((piece.a.y < y) == (piece.b.y < y)) continue;
      const double x = piece.a.x + (y - piece.a.y) / (piece.b.y - piece.a.y) * (piece.b.x - piece.a.x);
      crossings.push_back(std::clamp(x, left, left + 1.0));
    }
    std::sort(crossings.begin(), crossings.end());
    for (size_t i = 0; i + 1 < crossings.size(); ++i) {
      const double length = crossings[i + 1] - crossings[i];
      if (length < kLeastSide) continue;
      out.middles.push_back({0.5 * (crossings[i] + crossings[i + 1]), y});
      out.areas.push_back(height * length);
      out.pixels.push_back(pixel);
    }
  }
}

void fill_touched(const std::vector<Piece>& pieces, const std::vector<size_t>& groups, const SeenInk& seen, Image<float>& share) {
  tbb::parallel_for(tbb::blocked_range<size_t>(0, groups.size() - 1, 64), [&](const tbb::blocked_range<size_t>& range) {
    Trapezoids trapezoids;
    for (size_t g = range.begin(); g < range.end(); ++g) {
      add_trapezoids(std::span(pieces).subspan(groups[g], groups[g + 1] - groups[g]), share.width, trapezoids);
    }
    std::vector<std::uint8_t> ink(trapezoids.middles.size());
    seen(trapezoids.middles, ink);
    for (size_t i = 0; i < ink.size();) {
      const std::uint64_t pixel = trapezoids.pixels[i];
      double covered = 0.0, whole = 0.0;
      for (; i < ink.size() && trapezoids.pixels[i] == pixel; ++i) {
        whole += trapezoids.areas[i];
        covered += ink[i] ? trapezoids.areas[i] : 0.0;
      }
      share.pixels[pixel] = static_cast<float>(whole > 0.0 ? covered / whole : 0.0);
    }
  });
}

void fill_untouched(const std::vector<std::uint8_t>& touched, const SeenInk& seen, const ExecutionSettings& how, Image<float>& share) {
  tbb::parallel_for(0, share.height, [&](int y) {
    if (how.cancelled && how.cancelled()) throw Cancelled{};
    std::vector<glm::dvec2> centers;
    for (int x = 0; x < share.width; ++x) {
      if (!touched[share.index(x, y)]) centers.push_back({x + 0.5, y + 0.5});
    }
    std::vector<std::uint8_t> ink(centers.size());
    seen(centers, ink);
    for (size_t i = 0; i < centers.size(); ++i) share.at(static_cast<int>(centers[i].x), y) = ink[i] ? 1.0f : 0.0f;
  });
}

std::int64_t count_disputed(const std::vector<std::uint8_t>& touched, const Image<float>& share) {
  std::int64_t disputed = 0;
  const auto differ = [&](size_t a, size_t b) { return !touched[a] && !touched[b] && share.pixels[a] != share.pixels[b]; };
  for (int y = 0; y < share.height; ++y) {
    for (int x = 0; x < share.width; ++x) {
      if (x + 1 < share.width) disputed += differ(share.index(x, y), share.index(x + 1, y));
      if (y + 1 < share.height) disputed += differ(share.index(x, y), share.index(x, y + 1));
    }
  }
  return disputed;
}

}  // namespace

Coverage coverage_of(const BorderCurves& border, int width_px, int height_px, const SeenInk& seen, const ExecutionSettings& how) {
  Coverage result;
  result.share = Image<float>(width_px, height_px, 0.0f);
  const std::vector<Piece> pieces = pieces_of(border, width_px, height_px);
  std::vector<std::uint8_t> touched(result.share.size(), 0);
  std::vector<size_t> groups;
  for (size_t i = 0; i < pieces.size(); ++i) {
    if (i == 0 || pieces[i].pixel != pieces[i - 1].pixel) groups.push_back(i);
    touched[pieces[i].pixel] = 1;
  }
  result.touched = static_cast<std::int64_t>(groups.size());
  groups.push_back(pieces.size());
  fill_touched(pieces, groups, seen, result.share);
  fill_untouched(touched, seen, how, result.share);
  result.disputed = count_disputed(touched, result.share);
  return result;
}

}  // namespace limn
