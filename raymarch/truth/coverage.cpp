#include <algorithm>
#include <cmath>
#include <functional>

#include "raymarch/truth/parts.h"
#include "raymarch/truth/untouched_regions.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr double kLeastSide = 1e-7;  // thinner trapezoids weigh nothing
constexpr size_t kLattice = 4;       // px between the pixels looked at where no curve is
constexpr size_t kMostCrossed = 24;  // pieces in a pixel beyond which their crossings are left to the trapezoids' middles

/// A piece of a border curve within one pixel.
struct Piece {
  std::uint64_t pixel = 0;
  glm::dvec2 a{0.0}, b{0.0};
};

/// A pixel's upper left one, px.
glm::dvec2 corner_of(size_t pixel, size_t width) {
  const size_t x = pixel % width, y = pixel / width;
  return {static_cast<double>(x), static_cast<double>(y)};
}

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

/// Where a batch's faces are looked at, what they weigh, and for which pixel.
struct Faces {
  std::vector<glm::dvec2> places{};
  std::vector<double> areas{};
  std::vector<std::uint64_t> pixels{};
};

/// Between two neighbouring pieces along a row, over a height.
struct Trapezoid {
  glm::dvec2 middle{0.0};
  double area = 0.0;
  double left_top = 0.0, right_top = 0.0, left_bottom = 0.0, right_bottom = 0.0;
  size_t row = 0;
  size_t face = 0;
};

struct Edge {
  double x = 0.0, top = 0.0, bottom = 0.0;  ///< Along the row's middle, its upper and its lower end.
};

Edge edge_of(const Piece& piece, double y, double top, double bottom, double left) {
  const auto at = [&](double height) {
    const double t = std::clamp((height - piece.a.y) / (piece.b.y - piece.a.y), 0.0, 1.0);
    return std::clamp(piece.a.x + t * (piece.b.x - piece.a.x), left, left + 1.0);
  };
  return {at(y), at(top), at(bottom)};
}

std::vector<Trapezoid> trapezoids_of(std::span<const Piece> pieces, int width) {
  const glm::dvec2 corner = corner_of(pieces[0].pixel, static_cast<size_t>(width));
  const double left = corner.x;
  const std::vector<double> cuts = row_cuts(pieces, corner.y);
  std::vector<Trapezoid> result;
  std::vector<Edge> edges;
  for (size_t k = 0; k + 1 < cuts.size(); ++k) {
    const double height = cuts[k + 1] - cuts[k], y = 0.5 * (cuts[k] + cuts[k + 1]);
    if (height < kLeastSide) continue;
    edges = {{left, left, left}, {left + 1.0, left + 1.0, left + 1.0}};
    for (const Piece& piece : pieces) {
      if ((piece.a.y < y) != (piece.b.y < y)) edges.push_back(edge_of(piece, y, cuts[k], cuts[k + 1], left));
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) { return a.x < b.x; });
    for (size_t i = 0; i + 1 < edges.size(); ++i) {
      const double length = edges[i + 1].x - edges[i].x;
      if (length < kLeastSide) continue;
      result.push_back({{0.5 * (edges[i].x + edges[i + 1].x), y},
                        height * length,
                        edges[i].top,
                        edges[i + 1].top,
                        edges[i].bottom,
                        edges[i + 1].bottom,
                        k,
                        result.size()});
    }
  }
  return result;
}

bool on_frame(const glm::dvec2& p, double left, double top) {
  const double x = std::min(std::fabs(p.x - left), std::fabs(p.x - left - 1.0)),
               y = std::min(std::fabs(p.y - top), std::fabs(p.y - top - 1.0));
  return std::min(x, y) < 1e-9;
}

/// One polyline goes through the pixel from side to side: what touches along a row is then one face.
bool is_chain(std::span<const Piece> pieces, int width) {
  for (size_t i = 1; i < pieces.size(); ++i) {
    if (pieces[i].a != pieces[i - 1].b) return false;
  }
  const glm::dvec2 corner = corner_of(pieces[0].pixel, static_cast<size_t>(width));
  return on_frame(pieces.front().a, corner.x, corner.y) && on_frame(pieces.back().b, corner.x, corner.y);
}

void join_faces(std::vector<Trapezoid>& trapezoids) {
  for (size_t i = 0; i < trapezoids.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      Trapezoid &below = trapezoids[i], &above = trapezoids[j];
      const double overlap = std::min(below.right_top, above.right_bottom) - std::max(below.left_top, above.left_bottom);
      if (above.row + 1 != below.row || overlap < kLeastSide || above.face == below.face) continue;
      const size_t from = below.face, to = above.face;
      for (Trapezoid& t : trapezoids) t.face = t.face == from ? to : t.face;
    }
  }
}

void add_faces(std::span<const Piece> pieces, int width, Faces& out) {
  std::vector<Trapezoid> trapezoids = trapezoids_of(pieces, width);
  if (is_chain(pieces, width)) join_faces(trapezoids);
  for (size_t face = 0; face < trapezoids.size(); ++face) {
    double area = 0.0, largest = 0.0;
    glm::dvec2 place(0.0);
    for (const Trapezoid& t : trapezoids) {
      if (t.face != face) continue;
      area += t.area;
      if (t.area > largest) {
        largest = t.area;
        place = t.middle;
      }
    }
    if (area == 0.0) continue;
    out.places.push_back(place);
    out.areas.push_back(area);
    out.pixels.push_back(pieces[0].pixel);
  }
}

void fill_touched(const std::vector<Piece>& pieces, const std::vector<size_t>& groups, const SeenInk& seen, Image<float>& share) {
  parallel_parts(groups.size() - 1, size_t{64}, [&](const IndexRange<size_t>& range) {
    Faces faces;
    for (size_t g = range.begin(); g < range.end(); ++g) {
      add_faces(std::span(pieces).subspan(groups[g], groups[g + 1] - groups[g]), share.width, faces);
    }
    std::vector<std::uint8_t> ink(faces.places.size());
    seen(faces.places, ink);
    for (size_t i = 0; i < ink.size();) {
      const std::uint64_t pixel = faces.pixels[i];
      double covered = 0.0, whole = 0.0;
      for (; i < ink.size() && faces.pixels[i] == pixel; ++i) {
        whole += faces.areas[i];
        covered += ink[i] ? faces.areas[i] : 0.0;
      }
      share.pixels[pixel] = static_cast<float>(whole > 0.0 ? covered / whole : 0.0);
    }
  });
}

void look(const std::vector<size_t>& pixels, const SeenInk& seen, Image<float>& share, const ExecutionSettings& how) {
  parallel_parts(pixels.size(), size_t{256}, [&](const IndexRange<size_t>& range) {
    if (how.cancelled && how.cancelled()) throw Cancelled{};
    std::vector<glm::dvec2> centers;
    for (size_t i = range.begin(); i < range.end(); ++i) {
      centers.push_back(corner_of(pixels[i], static_cast<size_t>(share.width)) + 0.5);
    }
    std::vector<std::uint8_t> ink(centers.size());
    seen(centers, ink);
    for (size_t i = 0; i < ink.size(); ++i) share.pixels[pixels[range.begin() + i]] = ink[i] ? 1.0f : 0.0f;
  });
}

/// A region that no curve enters is of one kind: a lattice of its pixels is looked at, and all of them where those disagree.
void fill_untouched(const std::vector<std::uint8_t>& touched, const SeenInk& seen, const ExecutionSettings& how, Image<float>& share) {
  const std::vector<PixelRegion> regions = untouched_regions(touched, share.width, share.height);
  const auto width = static_cast<size_t>(share.width);
  std::vector<size_t> lattice;
  std::vector<size_t> ends;
  for (const PixelRegion& region : regions) {
    lattice.push_back(region.front().first);
    for (const UntouchedRun& run : region) {
      const size_t row = run.first / width;
      if (row % kLattice != 0) continue;
      const size_t column = (run.first - row * width + kLattice - 1) / kLattice * kLattice;
      for (size_t at = row * width + column; at < run.last; at += kLattice) lattice.push_back(at);
    }
    ends.push_back(lattice.size());
  }
  look(lattice, seen, share, how);
  std::vector<size_t> unclear;
  for (size_t r = 0, first = 0; r < regions.size(); first = ends[r++]) {
    const float ink = share.pixels[lattice[first]];
    const bool agree =
        std::all_of(lattice.begin() + static_cast<std::ptrdiff_t>(first), lattice.begin() + static_cast<std::ptrdiff_t>(ends[r]),
                    [&](size_t pixel) { return share.pixels[pixel] == ink; });
    for (const UntouchedRun& run : regions[r]) {
      std::fill_n(share.pixels.begin() + static_cast<std::ptrdiff_t>(run.first), run.last - run.first, ink);
      for (size_t pixel = run.first; !agree && pixel < run.last; ++pixel) unclear.push_back(pixel);
    }
  }
  look(unclear, seen, share, how);
}

std::int64_t count_disputed(const std::vector<std::uint8_t>& touched, const Image<float>& share) {
  const auto differ = [&](size_t a, size_t b) { return !touched[a] && !touched[b] && share.pixels[a] != share.pixels[b]; };
  const auto in_rows = [&](const IndexRange<int>& rows, std::int64_t disputed) {
    for (int y = rows.first; y < rows.last; ++y) {
      for (int x = 0; x < share.width; ++x) {
        if (x + 1 < share.width) disputed += differ(share.index(x, y), share.index(x + 1, y));
        if (y + 1 < share.height) disputed += differ(share.index(x, y), share.index(x, y + 1));
      }
    }
    return disputed;
  };
  return parallel_reduce(share.height, 16, std::int64_t{0}, in_rows, std::plus<>());
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
