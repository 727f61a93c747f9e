#pragma once
// Internal: which segments touch which cells of a uniform grid over them all.

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace limn {

struct SegmentEnds {
  glm::dvec2 a{0.0}, b{0.0};
};

struct SegmentGrid {
  glm::dvec2 origin{0.0};
  double cell_px = 4.0;
  int columns = 0, rows = 0;  ///< 0 without segments.
  std::vector<std::uint32_t> first{}, members{};

  /// The cell that holds the coordinate, or the nearest one.
  int column_of(double x) const;
  int row_of(double y) const;

  /// The segments of a cell, in the order that they were given in; none of cells outside.
  std::span<const std::uint32_t> in_cell(int column, int row) const {
    if (column < 0 || row < 0 || column >= columns || row >= rows) return {};
    const size_t cell = static_cast<size_t>(row) * static_cast<size_t>(columns) + static_cast<size_t>(column);
    return std::span(members).subspan(first[cell], first[cell + 1] - first[cell]);
  }
};

/// Cells of 4 px, larger where there would be more than four million. A segment is in every cell that its bounding box touches.
SegmentGrid segment_grid(std::span<const SegmentEnds> segments);

}  // namespace limn
