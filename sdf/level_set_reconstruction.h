#pragma once
// Internal: the smooth surface that a level set's cubic gradients are those of, as a field, and the cells that hold it.

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "sdf/level_set.h"

namespace limn {

class SplineBlocks;  // sdf/gradients/spline_blocks.h

/// A cell that the surface of the spline may go through.
struct SurfaceCell {
  glm::ivec3 node{0};      ///< Of its first corner, index coordinates.
  glm::vec3 normal{0.0f};  ///< World, unit; 0 where nothing is known of its normals.
  float spread = 0.0f;     ///< No normal in the cell is farther from that, radians.
};

/// Cells of a level set's spline. Safe to ask from many threads at once.
class SplineCells {
 public:
  SplineCells(LevelSet completed, std::shared_ptr<const SplineBlocks> blocks)
      : level_set_(std::move(completed)), blocks_(std::move(blocks)) {}
  /// Without those of which bounds show that the surface does not go through them, or that all of it in them faces the eye, or none. Quick
  /// where neighbours follow each other. `eye`: index coordinates; with `w` 0 the direction towards it.
  std::vector<SurfaceCell> that_may_hold_contours(std::span<const SurfaceCell> cells, const glm::dvec3& eye, double w) const;

 private:
  friend class SplineCellReader;
  LevelSet level_set_;  ///< Whose values the blocks are made of.
  std::shared_ptr<const SplineBlocks> blocks_;
};

/// A line between two corners of a cell: 0 to 7, bit 0 along x, bit 1 along y, bit 2 along z.
struct CellEdge {
  std::uint8_t from = 0, to = 0;
};
/// About where the surface meets it.
struct EdgePoint {
  bool found = false;
  double share = 0.0;        ///< Of the way.
  glm::dvec3 gradient{0.0};  ///< World, from beside that place.
};

/// One cell after the other, by one thread; quick where they lie near each other. Keeps a reference to the cells.
class SplineCellReader {
 public:
  explicit SplineCellReader(const SplineCells& cells);
  ~SplineCellReader();
  /// `node`: of the cell's first corner, index coordinates.
  void read(const glm::ivec3& node);
  /// By corners. Cells that share one tell the same of it, to the bit.
  std::array<double, 8> corner_values() const;
  /// Of edges whose ends have values of different signs: to within `close` of an edge's length, where Newton's iteration gets there.
  void find_on_edges(std::span<const CellEdge> edges, double close, std::span<EdgePoint> points) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The cubic spline through the grid's values. Its band is completed where it has no room for that. Values mean something within a voxel of
/// the surface, and have the right sign elsewhere; there are no interval bounds.
struct Reconstruction {
  Field field;
  LevelSet completed;
  SplineCells cells;
};
Reconstruction reconstruct(const LevelSet& level_set);

/// All cells that the surface may go through, of a level set whose band is complete, in an order that does not depend on threads: near each
/// other one after the other.
std::vector<SurfaceCell> surface_cells(const LevelSet& completed);

}  // namespace limn
