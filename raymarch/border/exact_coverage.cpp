#include "raymarch/border/exact_coverage.h"

#include <algorithm>
#include <boost/polygon/polygon.hpp>
#include <cmath>

namespace limn {
namespace {

namespace bp = boost::polygon;

constexpr double kGrid = 65536.0;  // per px: 16,384 px and what lies beside them fit into 32 bits

/// Of each pixel, what edges to its left, and within it, add to its coverage; the sum along a row up to a pixel is its coverage.
struct Accumulator {
  int width = 0, height = 0;
  std::vector<double> added{};

  /// A piece of an edge within one row of pixels that goes down by `down` px.
  void add_row(double x0, double x1, double down, int row) {
    double* const cells = added.data() + static_cast<size_t>(row) * static_cast<size_t>(width + 1);
    const double low = std::min(x0, x1), high = std::max(x0, x1), across = high - low;
    const double right = static_cast<double>(width);
    if (low >= right) return;
    if (high <= 0.0) {
      cells[0] += down;
      return;
    }
    if (across < 1e-12) {
      add_cell(cells, low, down);
      return;
    }
    if (low < 0.0) cells[0] += down * -low / across;
    for (double from = std::max(low, 0.0); from < std::min(high, right);) {
      const double to = std::min({high, right, std::floor(from) + 1.0});
      add_cell(cells, 0.5 * (from + to), down * (to - from) / across);
      from = to;
    }
  }

  /// An upright piece at `x`: all of the pixels to its right, and of its own the part to its right.
  void add_cell(double* cells, double x, double down) const {
    const int column = std::min(static_cast<int>(x), width - 1);
    const double left = x - column;
    cells[column] += down * (1.0 - left);
    cells[column + 1] += down * left;
  }

  void add_edge(glm::dvec2 a, glm::dvec2 b) {
    if (a.y == b.y) return;
    const double sense = a.y < b.y ? 1.0 : -1.0;
    if (sense < 0.0) std::swap(a, b);
    const double slope = (b.x - a.x) / (b.y - a.y), bottom = std::min(b.y, static_cast<double>(height));
    for (double top = std::max(a.y, 0.0); top < bottom;) {
      const double next = std::min(bottom, std::floor(top) + 1.0);
      add_row(a.x + (top - a.y) * slope, a.x + (next - a.y) * slope, sense * (next - top), static_cast<int>(top));
      top = next;
    }
  }

  template <class Points>
  void add_loop(Points begin, Points end) {
    if (begin == end) return;
    const auto place = [](const auto& p) { return glm::dvec2(p.x(), p.y()) / kGrid; };
    glm::dvec2 before = place(*begin);
    const glm::dvec2 first = before;
    for (auto at = std::next(begin); at != end; ++at) {
      const glm::dvec2 here = place(*at);
      add_edge(before, here);
      before = here;
    }
    add_edge(before, first);
  }
};

/// Loops that neither cross nor overlap.
std::vector<bp::polygon_with_holes_data<int>> united(const std::vector<Outline>& outlines) {
  bp::polygon_set_data<int> all;
  std::vector<bp::point_data<int>> corners;
  for (const Outline& outline : outlines) {
    corners.clear();
    for (const glm::dvec2& corner : outline)
      corners.emplace_back(static_cast<int>(std::lround(corner.x * kGrid)), static_cast<int>(std::lround(corner.y * kGrid)));
    if (corners.size() > 2) all.insert(bp::polygon_data<int>(corners.begin(), corners.end()));
  }
  std::vector<bp::polygon_with_holes_data<int>> loops;
  all.get(loops);
  return loops;
}

}  // namespace

Image<float> covered_by(const std::vector<Outline>& outlines, int width_px, int height_px) {
  Accumulator sums{width_px, height_px, std::vector<double>(static_cast<size_t>(width_px + 1) * static_cast<size_t>(height_px), 0.0)};
  for (const auto& loop : united(outlines)) {
    sums.add_loop(loop.begin(), loop.end());
    for (auto hole = loop.begin_holes(); hole != loop.end_holes(); ++hole) sums.add_loop(hole->begin(), hole->end());
  }
  Image<float> coverage(width_px, height_px, 0.0f);
  for (int y = 0; y < height_px; ++y) {
    const double* const row = sums.added.data() + static_cast<size_t>(y) * static_cast<size_t>(width_px + 1);
    double sum = 0.0;
    for (int x = 0; x < width_px; ++x) {
      sum += row[x];
      coverage.at(x, y) = static_cast<float>(std::clamp(std::fabs(sum), 0.0, 1.0));
    }
  }
  return coverage;
}

}  // namespace limn
