#include "raymarch/curves/segment_grid.h"

#include <algorithm>

namespace limn {
namespace {

constexpr double kMostCells = 4e6;

template <class Visit>
void for_cells(const SegmentGrid& grid, const SegmentEnds& s, const Visit& visit) {
  const int first_column = grid.column_of(std::min(s.a.x, s.b.x)), last_column = grid.column_of(std::max(s.a.x, s.b.x));
  const int first_row = grid.row_of(std::min(s.a.y, s.b.y)), last_row = grid.row_of(std::max(s.a.y, s.b.y));
  for (int row = first_row; row <= last_row; ++row)
    for (int column = first_column; column <= last_column; ++column)
      visit(static_cast<size_t>(row) * static_cast<size_t>(grid.columns) + static_cast<size_t>(column));
}

}  // namespace

// Where nothing is negative, the conversion rounds down.
int SegmentGrid::column_of(double x) const {
  return static_cast<int>(std::clamp((x - origin.x) / cell_px, 0.0, static_cast<double>(columns - 1)));
}
int SegmentGrid::row_of(double y) const {
  return static_cast<int>(std::clamp((y - origin.y) / cell_px, 0.0, static_cast<double>(rows - 1)));
}

SegmentGrid segment_grid(std::span<const SegmentEnds> segments) {
  SegmentGrid grid;
  if (segments.empty()) return grid;
  glm::dvec2 low = segments.front().a, high = low;
  for (const SegmentEnds& segment : segments) {
    low = glm::min(low, glm::min(segment.a, segment.b));
    high = glm::max(high, glm::max(segment.a, segment.b));
  }
  grid.origin = low;
  const glm::dvec2 size = high - low;
  while ((size.x / grid.cell_px + 1.0) * (size.y / grid.cell_px + 1.0) > kMostCells) grid.cell_px *= 2.0;
  grid.columns = static_cast<int>(size.x / grid.cell_px) + 1;
  grid.rows = static_cast<int>(size.y / grid.cell_px) + 1;
  grid.first.assign(static_cast<size_t>(grid.columns) * static_cast<size_t>(grid.rows) + 1, 0);
  for (const SegmentEnds& segment : segments) for_cells(grid, segment, [&](size_t cell) { ++grid.first[cell + 1]; });
  for (size_t i = 1; i < grid.first.size(); ++i) grid.first[i] += grid.first[i - 1];
  grid.members.resize(grid.first.back());
  std::vector<std::uint32_t> fill(grid.first.begin(), grid.first.end() - 1);
  for (size_t i = 0; i < segments.size(); ++i)
    for_cells(grid, segments[i], [&](size_t cell) { grid.members[fill[cell]++] = static_cast<std::uint32_t>(i); });
  return grid;
}

}  // namespace limn
