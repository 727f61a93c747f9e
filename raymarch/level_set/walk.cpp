#include "raymarch/level_set/walk.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "raymarch/level_set/bricks.h"
#include "raymarch/level_set/level_set_marcher.h"
#include "sdf/level_set_band.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

using Accessor = nanovdb::FloatGrid::AccessorType;
using Leaf = nanovdb::FloatGrid::TreeType::LeafNodeType;

/// A ray in index space. `t` keeps its meaning (world units along the render-space ray), so `direction` is not unit.
struct IndexRay {
  glm::dvec3 origin, direction, inverse;

  glm::dvec3 at(double t) const { return origin + t * direction; }
  /// Where the ray meets the plane of index `plane` across `axis`; never for a ray along the plane. Computed from the plane's number
  /// each time, so that nothing accumulates and neighbouring cells agree on the last bit.
  double meets(int axis, int plane) const {
    if (direction[axis] == 0.0) return std::numeric_limits<double>::infinity();
    return (static_cast<double>(plane) - origin[axis]) * inverse[axis];
  }
};

/// A stretch of the grid in which the ray is: cells from `lower` on, `size` to a side.
struct Block {
  glm::ivec3 lower;
  int size;
};

/// The walk's next whole step: leaves `block` at time `t` through a face of `axis`, towards the cell `next`.
struct Exit {
  double t;
  int axis;
};

/// `leaves`: where it meets the faces ahead, by their axes.
Exit first_of(const glm::dvec3& leaves) {
  Exit exit{std::numeric_limits<double>::infinity(), 0};
  for (int axis = 0; axis < 3; ++axis)
    if (leaves[axis] < exit.t) exit = {leaves[axis], axis};
  return exit;
}

Exit exit_of(const IndexRay& ray, const Block& block) {
  glm::dvec3 leaves;
  for (int axis = 0; axis < 3; ++axis) leaves[axis] = ray.meets(axis, block.lower[axis] + (ray.direction[axis] > 0.0 ? block.size : 0));
  return first_of(leaves);
}

/// The cell at time `t` within `block`, exactly the one beyond the face on the axis just crossed.
glm::ivec3 cell_within(const IndexRay& ray, double t, const Block& block) {
  glm::ivec3 cell;
  const glm::dvec3 p = ray.at(t);
  for (int axis = 0; axis < 3; ++axis) {
    const auto lowest = static_cast<double>(block.lower[axis]);
    cell[axis] = static_cast<int>(glm::clamp(std::floor(p[axis]), lowest, lowest + block.size - 1));
  }
  return cell;
}

/// The trilinear interpolant along the ray's stretch [t0, t1] in a cell, as a cubic in s = (t - t0) / (t1 - t0) (Parker et al. 1998).
std::array<double, 4> cubic_along(const std::array<double, 8>& v, const glm::dvec3& from, const glm::dvec3& to) {
  const glm::dvec3 d = to - from;
  // Products of linear functions of s, one axis after the other: x joins pairs of corners, then y, then z.
  std::array<std::array<double, 4>, 4> line{};
  for (size_t k = 0; k < 4; ++k) {
    const double difference = v[2 * k + 1] - v[2 * k];
    line[k] = {v[2 * k] + from.x * difference, d.x * difference, 0.0, 0.0};
  }
  const auto join = [](const std::array<double, 4>& a, const std::array<double, 4>& b, double start, double slope) {
    std::array<double, 4> result{};
    for (size_t k = 0; k < 4; ++k) {
      const double difference = b[k] - a[k];
      result[k] += a[k] + start * difference;
      if (k < 3) result[k + 1] += slope * difference;
    }
    return result;
  };
  return join(join(line[0], line[1], from.y, d.y), join(line[2], line[3], from.y, d.y), from.z, d.z);
}

/// Signs as Walk::subtract_level() has them: far to either side the level does not matter. `nodes` is changed.
LevelCells cells_of_level(const WalkedGrid& grid, const nanovdb::Coord& origin, NodeWindow& nodes) {
  for (size_t x = 1; x < 10; ++x) {
    for (size_t y = 1; y < 10; ++y) {
      for (size_t z = 1; z < 10; ++z) {
        float& value = nodes[x][y][z];
        if (value < 0.0f || double{value} > grid.largest_level) continue;
        const glm::dvec3 node = glm::dvec3(origin[0], origin[1], origin[2]) + glm::dvec3(x, y, z) - 1.0;
        const double level = grid.grid_from_render_length * grid.level.at(grid.render_from_index.point(node));
        value = double{value} - level < 0.0 ? -1.0f : 1.0f;
      }
    }
  }
  LevelCells cells{cells_crossed(nodes)};
  for (size_t x = 0; x < 8; ++x) {
    for (size_t y = 0; y < 8; ++y) {
      unsigned bits = 0;
      for (size_t z = 0; z < 8; ++z) bits |= (nodes[x + 1][y + 1][z + 1] < 0.0f ? 1u : 0u) << z;
      cells.inside[x][y] = static_cast<std::uint8_t>(bits);
    }
  }
  return cells;
}

/// Walks one ray through the tree.
class Walk {
 public:
  Walk(const WalkedGrid& grid, const Accessor& accessor, const CrossedLeaves* crossed, const glm::dvec3& origin,
       const glm::dvec3& direction, double t_min, double t_max)
      : grid_(grid), accessor_(accessor), crossed_(crossed), t_(t_min), t_max_(t_max) {
    ray_.origin = grid.index_from_render.point(origin);
    ray_.direction = grid.index_from_render.vector(direction);
    ray_.inverse = 1.0 / ray_.direction;
  }

  HitStatus run(GridRoot& root) {
    if (!enter()) return HitStatus::miss;
    while (t_ < t_max_) {
      if (++steps_ > grid_.max_steps) return HitStatus::out_of_steps;
      const nanovdb::Coord at(cell_.x, cell_.y, cell_.z);
      const Leaf* leaf = accessor_.probeLeaf(at);
      // getDim takes a ray that it does not look at.
      const int size = leaf ? Leaf::DIM : static_cast<int>(accessor_.getDim(at, 0));
      const Block block{{cell_.x & ~(size - 1), cell_.y & ~(size - 1), cell_.z & ~(size - 1)}, size};
      if (leaf && !passes_leaf(*leaf)) {
        const HitStatus status = walk_cells(block, *leaf, root);
        if (status != HitStatus::miss) return status;
        if (t_ >= t_max_) break;
      } else if (!leaf) {
        known_ = false;
      }
      if (!leave(block)) return HitStatus::miss;
    }
    return HitStatus::miss;
  }

 private:
  /// Clips to the cells that may hold the surface; the first cell.
  bool enter() {
    double exit = t_max_;
    for (int axis = 0; axis < 3; ++axis) {
      const int lower = grid_.lower[axis], upper = grid_.upper[axis];
      if (ray_.direction[axis] == 0.0) {
        if (ray_.origin[axis] < lower || ray_.origin[axis] > upper) return false;
        continue;
      }
      const bool forward = ray_.direction[axis] > 0.0;
      t_ = std::max(t_, ray_.meets(axis, forward ? lower : upper));
      exit = std::min(exit, ray_.meets(axis, forward ? upper : lower));
    }
    if (!(t_ <= exit)) return false;
    const glm::dvec3 p = glm::floor(ray_.at(t_));
    cell_ = glm::ivec3(glm::clamp(p, glm::dvec3(grid_.lower), glm::dvec3(grid_.upper - 1)));
    return true;
  }

  /// To the cell beyond the face through which the ray leaves `block`. The crossed axis moves by whole numbers, the others stay within
  /// the block, so that every step makes headway whatever the rounding.
  bool leave(const Block& block) {
    const Exit exit = exit_of(ray_, block);
    if (!std::isfinite(exit.t)) return false;
    t_ = std::max(t_, exit.t);
    cell_ = cell_within(ray_, t_, block);
    // Only the axis just crossed tells that the range lies behind: on the others a ray that starts on the range's very border may stand
    // one cell outside it for no length at all.
    if (ray_.direction[exit.axis] > 0.0) {
      cell_[exit.axis] = block.lower[exit.axis] + block.size;
      return cell_[exit.axis] < grid_.upper[exit.axis];
    }
    cell_[exit.axis] = block.lower[exit.axis] - 1;
    return cell_[exit.axis] >= grid_.lower[exit.axis];
  }

  /// True where nothing of the leaf need be looked at. Else finds what bounds the surface in it.
  bool passes_leaf(const Leaf& leaf) {
    bound_ = nullptr;
    cells_ = nullptr;
    if (crossed_ == nullptr) return false;
    const auto number = static_cast<size_t>(&leaf - crossed_->first_leaf);
    if (!crossed_->cells.empty()) {
      cells_ = &crossed_->cells[number];
      return !cells_->crossed.any && is_on_side(leaf);
    }
    const std::int32_t brick = crossed_->brick_of_leaf[number];
    if (brick < 0) return is_on_side(leaf);
    bound_ = &crossed_->bounds[static_cast<size_t>(brick)];
    return false;
  }

  /// Of a cell that the surface does not cross: all its values have the sign of its first node's. False where the ray comes from the other
  /// side: then rounding has put a root on neither side of the cell's face.
  bool is_on_side(const Leaf& leaf) {
    const bool inside =
        cells_ != nullptr ? holds_cell(cells_->inside) : leaf.data()->mValues[Leaf::CoordToOffset({cell_.x, cell_.y, cell_.z})] < 0.0f;
    if (!known_) inside_ = inside;
    known_ = true;
    return inside == inside_;
  }

  bool holds_cell(const std::uint8_t (&cells)[8][8]) const { return (cells[cell_.x & 7][cell_.y & 7] >> (cell_.z & 7) & 1) != 0; }

  /// True where the ray meets no surface in the cell, t_ to t1: beside the crossed cells, or, where its side is known, beside the slab that
  /// holds the surface. Bricks' values are rounded to steps, so that their slab is widened by some.
  bool passes_cell(const Leaf& leaf, double t1) {
    if (cells_ != nullptr) return !holds_cell(cells_->crossed.cells) && is_on_side(leaf);
    if (bound_ == nullptr) return false;
    for (int axis = 0; axis < 3; ++axis) {
      const int place = cell_[axis] - bound_->origin[axis];
      if (place < bound_->lower[axis] || place >= bound_->upper[axis]) return is_on_side(leaf);
    }
    return beside_slab(t1);
  }

  /// True where the ray's stretch t_ to t1 lies on its own side of the slab that holds the surface in the leaf. It is straight: its ends
  /// tell.
  bool beside_slab(double t1) const {
    if (bound_ == nullptr || !known_) return false;
    constexpr double kSteps = 16.0;
    const glm::dvec3 normal(bound_->normal[0], bound_->normal[1], bound_->normal[2]);
    const glm::dvec3 origin(bound_->origin[0], bound_->origin[1], bound_->origin[2]);
    const double slab = double{bound_->slab} + kSteps, offset = double{bound_->offset};
    const double at_t = glm::dot(normal, ray_.at(t_) - origin) - offset, at_t1 = glm::dot(normal, ray_.at(t1) - origin) - offset;
    return inside_ ? at_t < -slab && at_t1 < -slab : at_t > slab && at_t1 > slab;
  }

  HitStatus walk_cells(const Block& leaf, const Leaf& node, GridRoot& root) {
    // Most rays pass most leaves beside the surface: no cell would tell more than the leaf does.
    if (beside_slab(std::max(t_, std::min(exit_of(ray_, leaf).t, t_max_)))) return HitStatus::miss;
    // Only the plane across the axis just crossed changes from cell to cell.
    glm::dvec3 leaves;
    for (int axis = 0; axis < 3; ++axis) leaves[axis] = leaves_cell(axis);
    while (true) {
      const Exit exit = first_of(leaves);
      const double until = std::max(t_, std::min(exit.t, t_max_));
      if (!passes_cell(node, until) && hit_in_cell(until, root)) return root.t < t_max_ ? HitStatus::hit : HitStatus::miss;
      t_ = std::max(t_, exit.t);
      if (t_ >= t_max_) return HitStatus::miss;
      const int next = cell_[exit.axis] + (ray_.direction[exit.axis] > 0.0 ? 1 : -1);
      if (next < leaf.lower[exit.axis] || next >= leaf.lower[exit.axis] + leaf.size) return HitStatus::miss;
      cell_[exit.axis] = next;
      leaves[exit.axis] = leaves_cell(exit.axis);
      if (++steps_ > grid_.max_steps) return HitStatus::out_of_steps;
    }
  }

  double leaves_cell(int axis) const { return ray_.meets(axis, cell_[axis] + (ray_.direction[axis] > 0.0 ? 1 : 0)); }

  /// Taking it at the nodes is exact for a constant, and for pixels good to the second order of a voxel seen from the eye.
  void subtract_level(const glm::ivec3& cell, std::array<double, 8>& values) const {
    const auto [least, greatest] = std::minmax_element(values.begin(), values.end());
    // Far to either side only the sign counts.
    if (*greatest < 0.0 || *least > grid_.largest_level) {
      for (double& value : values) value -= *greatest < 0.0 ? 0.0 : grid_.largest_level;
      return;
    }
    for (size_t k = 0; k < values.size(); ++k) {
      const glm::ivec3 node = cell + glm::ivec3(k & 1, (k >> 1) & 1, (k >> 2) & 1);
      values[k] -= grid_.grid_from_render_length * grid_.level.at(grid_.render_from_index.point(glm::dvec3(node)));
    }
  }

  /// A change of sign in [t_, t1]. The side is carried from cell to cell: were it asked for anew at every face, a root that rounding
  /// puts on neither side of the face would be lost.
  bool hit_in_cell(double t1, GridRoot& root) {
    std::array<double, 8> v = cell_values(accessor_, nanovdb::Coord(cell_.x, cell_.y, cell_.z));
    if (!grid_.level.zero()) subtract_level(cell_, v);
    bool any_inside = false, any_outside = false;
    for (const double value : v) (value < 0.0 ? any_inside : any_outside) = true;
    if (known_ && !(inside_ ? any_outside : any_inside)) return false;
    const glm::dvec3 corner(cell_), zero(0.0), one(1.0);
    const std::array<double, 4> c =
        cubic_along(v, glm::clamp(ray_.at(t_) - corner, zero, one), glm::clamp(ray_.at(t1) - corner, zero, one));
    if (!known_) {
      inside_ = c[0] < 0.0;
      known_ = true;
    }
    const double s = first_sign_change(c, inside_);
    if (s < 0.0) return false;
    root = {t_ + s * (t1 - t_), inside_};
    return true;
  }

  const WalkedGrid& grid_;
  const Accessor& accessor_;
  const CrossedLeaves* crossed_;
  const SurfaceBound* bound_ = nullptr;  ///< Of the leaf that is walked; null: its cells are all looked at.
  const LevelCells* cells_ = nullptr;    ///< The same of another level.
  IndexRay ray_;
  double t_, t_max_;
  glm::ivec3 cell_{0};
  bool inside_ = false;
  bool known_ = false;  ///< Whether inside_ has been told, since the ray came out of empty space.
  int steps_ = 0;
};

}  // namespace

CrossedLeaves crossed_leaves(const nanovdb::FloatGrid& grid, std::span<const SurfaceBound> bounds) {
  CrossedLeaves crossed;
  crossed.bounds = bounds;
  crossed.first_leaf = grid.tree().getFirstLeaf();
  crossed.brick_of_leaf.assign(grid.tree().nodeCount(0), -1);
  const Accessor accessor = grid.getAccessor();
  for (size_t i = 0; i < bounds.size(); ++i) {
    const Leaf* leaf = accessor.probeLeaf({bounds[i].origin[0], bounds[i].origin[1], bounds[i].origin[2]});
    if (leaf != nullptr) crossed.brick_of_leaf[static_cast<size_t>(leaf - crossed.first_leaf)] = static_cast<std::int32_t>(i);
  }
  return crossed;
}

CrossedLeaves leaves_of_level(const LevelSetData& data, const WalkedGrid& grid) {
  CrossedLeaves crossed;
  crossed.first_leaf = data.grid->tree().getFirstLeaf();
  crossed.cells.resize(data.grid->tree().nodeCount(0));
  parallel_parts(crossed.cells.size(), size_t{32}, [&](const IndexRange<size_t>& range) {
    const Accessor accessor = data.accessor();
    NodeWindow nodes;
    for (size_t i = range.begin(); i < range.end(); ++i) {
      const LeafWindow window(accessor, crossed.first_leaf[i].origin());
      load_nodes(window, nodes);
      crossed.cells[i] = cells_of_level(grid, window.origin(), nodes);
    }
  });
  return crossed;
}

HitStatus walk_grid(const WalkedGrid& grid, const Accessor& accessor, const CrossedLeaves* crossed, const glm::dvec3& origin,
                    const glm::dvec3& direction, double t_min, double t_max, GridRoot& root) {
  return Walk(grid, accessor, crossed, origin, direction, t_min, t_max).run(root);
}

bool is_inside(const Accessor& accessor, const glm::dvec3& place) {
  const CellPoint at = cell_point(place);
  // Most places asked for lie far off, where a block without a leaf has one value.
  constexpr int kLast = static_cast<int>(Leaf::DIM) - 1;
  const auto has_next = [](int node) { return (node & kLast) < kLast; };
  if (has_next(at.node[0]) && has_next(at.node[1]) && has_next(at.node[2]) && !accessor.probeLeaf(at.node))
    return accessor.getValue(at.node) < 0.0f;
  return cubic_along(cell_values(accessor, at.node), at.local, at.local)[0] < 0.0;
}

double interpolated(const Accessor& accessor, const glm::dvec3& place) {
  const CellPoint at = cell_point(place);
  return cubic_along(cell_values(accessor, at.node), at.local, at.local)[0];
}

}  // namespace limn
