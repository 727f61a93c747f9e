// Cells that the surface of a level set's spline may go through, with bounds of its normals there.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "sdf/gradients/hull_lanes.h"
#include "sdf/gradients/spline_cell.h"
#include "sdf/leaf_window.h"
#include "sdf/level_set_data.h"
#include "sdf/level_set_reconstruction.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

// Of a voxel: the spline of sharp edges differs from a node's value by less.
constexpr float kNearCorner = 0.35f;
constexpr float kTurnRounding = 1e-4f;  // radians

constexpr int kBlock = 8;
constexpr float kSixth = 1.0f / 6.0f;

/// Values by nodes from `first` to `last` along each axis, of a block whose first node is 0.
template <int first, int last>
struct Nodes {
  static constexpr int kRow = last - first + 1;
  std::array<float, static_cast<size_t>(kRow* kRow* kRow)> values;
  static constexpr size_t place(int x, int y, int z) {
    const int at = ((x - first) * kRow + y - first) * kRow + z - first;
    return static_cast<size_t>(at);
  }
  float* row(int x, int y) { return &values[place(x, y, first)]; }
  const float* at(int x, int y, int z) const { return &values[place(x, y, z)]; }
};

/// The spline's coefficients at the nodes -2 to 9 about a block, from values at -3 to 10 (spline_coefficient()).
class BlockSpline {
 public:
  void load(const LeafWindow& window) {
    window.for_each_column(-3, 10, [&](const LeafWindow::Column& column, int x, int y) { column.load_wide_row(x, y, values_.row(x, y)); });
    constexpr int kX = decltype(values_)::kRow * decltype(values_)::kRow, kY = decltype(values_)::kRow;
    for (int x = -2; x <= 9; ++x)
      for (int y = -2; y <= 9; ++y) {
        const float* const f = values_.at(x, y, -2);
        float* const c = coefficients_.row(x, y);
        for (int z = 0; z < 12; ++z) c[z] = 2.0f * f[z] - kSixth * (f[z - kX] + f[z + kX] + f[z - kY] + f[z + kY] + f[z - 1] + f[z + 1]);
      }
  }
  float value(int x, int y, int z) const { return *values_.at(x, y, z); }
  /// Of the 4 x 4 x 4 nodes about the cell from that node on.
  void add_cell(int x, int y, int z, HullCells& cells) const {
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) {
        const float* const row = coefficients_.at(x - 1 + i, y - 1 + j, z - 1);
        for (int k = 0; k < 4; ++k) cells.coefficients[spline_place(i, j, k)][cells.count] = row[k];
      }
    ++cells.count;
  }

 private:
  Nodes<-3, 10> values_;
  Nodes<-2, 9> coefficients_;
};

class CellFinder {
 public:
  explicit CellFinder(const LevelSetData& data)
      : data_(data),
        world_from_slope_(glm::transpose(data.index_from_world.linear)),
        near_(kNearCorner * static_cast<float>(data.per_voxel)) {}

  void find(const nanovdb::Coord& origin, std::vector<SurfaceCell>& cells) {
    const auto accessor = data_.accessor();
    const LeafWindow window(accessor, origin);
    load_nodes(window);
    bool loaded = false;
    // Cells reach a node beyond the block, and one may begin a node before it where that block is not there.
    for (int x = -1; x < kBlock; ++x) {
      for (int y = -1; y < kBlock; ++y) {
        for (int z = -1; z < kBlock; ++z) {
          if (!is_near(x, y, z)) continue;
          const nanovdb::Coord node = origin.offsetBy(x, y, z);
          if ((x < 0 || y < 0 || z < 0) && accessor.isActive(node)) continue;  // Another block's.
          if (!loaded) spline_.load(window);
          loaded = true;
          nodes_to_bound_[to_bound_.count] = {node[0], node[1], node[2]};
          spline_.add_cell(x, y, z, to_bound_);
          if (to_bound_.count == kHullCells) add_bounded(cells);
        }
      }
    }
    add_bounded(cells);
  }

 private:
  static constexpr std::uint8_t kInside = 1, kOutside = 2, kBoth = 3;

  void load_nodes(const LeafWindow& window) {
    Nodes<-1, 8>& f = nodes_;
    window.for_each_column(-1, kBlock, [&](const LeafWindow::Column& column, int x, int y) { column.load_row(x, y, f.row(x, y)); });
    // Near the surface a node may lie on either side of the spline's.
    for (size_t i = 0; i < f.values.size(); ++i)
      sides_[i] = std::fabs(f.values[i]) < near_ ? kBoth : f.values[i] < 0.0f ? kInside : kOutside;
  }
  bool is_near(int x, int y, int z) const {
    int sides = 0;
    for (int i = 0; i < 4; ++i) {
      const std::uint8_t* const row = &sides_[Nodes<-1, 8>::place(x + (i & 1), y + (i >> 1), z)];
      sides |= row[0] | row[1];
    }
    return sides == kBoth;
  }
  /// Those whose surface may go through them.
  void add_bounded(std::vector<SurfaceCell>& cells) {
    find_normal_cones(to_bound_, world_from_slope_, cones_);
    for (size_t k = 0; k < to_bound_.count; ++k) {
      if ((cones_.may_hold_zero >> k & 1u) == 0) continue;
      SurfaceCell cell;
      cell.node = nodes_to_bound_[k];
      if ((cones_.bounded >> k & 1u) != 0) {
        cell.normal = {cones_.normal[0][k], cones_.normal[1][k], cones_.normal[2][k]};
        // What a sine rounds by counts for more the smaller it is.
        cell.spread = std::asin(std::min(1.0f, std::sqrt(cones_.sine_squared[k] + 1e-6f))) + kTurnRounding;
      }
      cells.push_back(cell);
    }
    to_bound_.count = 0;
  }

  const LevelSetData& data_;
  glm::mat3 world_from_slope_;
  float near_;
  Nodes<-1, 8> nodes_;
  std::array<std::uint8_t, std::tuple_size_v<decltype(nodes_.values)>> sides_;
  BlockSpline spline_;
  HullCells to_bound_{};
  std::array<glm::ivec3, kHullCells> nodes_to_bound_{};
  NormalCones cones_{};
};

}  // namespace

std::vector<SurfaceCell> surface_cells(const LevelSet& completed) {
  const LevelSetData& data = completed.data();
  const auto leaves = static_cast<size_t>(data.grid->tree().nodeCount(0));
  const auto* const first = data.grid->tree().getFirstNode<0>();
  std::vector<std::vector<SurfaceCell>> parts(leaves);
  parallel_parts(leaves, size_t{8}, [&](const IndexRange<size_t>& range) {
    CellFinder finder(data);
    for (size_t l = range.begin(); l < range.end(); ++l) finder.find(first[l].origin(), parts[l]);
  });
  std::vector<size_t> begins(leaves + 1, 0);
  for (size_t l = 0; l < leaves; ++l) begins[l + 1] = begins[l] + parts[l].size();
  std::vector<SurfaceCell> cells(begins.back());
  parallel_for(size_t{0}, leaves,
               [&](size_t l) { std::copy(parts[l].begin(), parts[l].end(), cells.begin() + static_cast<std::ptrdiff_t>(begins[l])); });
  return cells;
}

}  // namespace limn
