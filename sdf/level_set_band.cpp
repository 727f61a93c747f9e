#include "sdf/level_set_band.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "sdf/error.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

// The widths of the band are counted in steps of a 256th of the background, up to twice that.
constexpr size_t kWidthSteps = 512;
constexpr size_t kMostGradients = 8;

/// What one pass over the leaves finds out; whole numbers, minima and maxima, so that the order of the leaves does not matter.
struct Counts {
  std::int64_t active = 0;
  Box crossings{};
  std::array<std::array<std::uint32_t, kWidthSteps>, 2> widths{};  ///< At the band's edges: outside, inside.
  double largest = 0.0;
  SlopeSums slopes{};
  std::int64_t crossed_cells = 0;
  std::array<std::int64_t, kMostGradients> lacking{};
  std::int64_t near_nodes = 0, unsigned_nodes = 0;
  std::vector<CrossedBlock> crossed{};  ///< In the order of the blocks.

  void join(const Counts& other) {
    active += other.active;
    crossings = merge(crossings, other.crossings);
    for (size_t side = 0; side < 2; ++side)
      for (size_t k = 0; k < kWidthSteps; ++k) widths[side][k] += other.widths[side][k];
    largest = std::max(largest, other.largest);
    for (size_t k = 0; k < 2; ++k) {
      slopes.sum[k] += other.slopes.sum[k];
      slopes.count[k] += other.slopes.count[k];
    }
    crossed_cells += other.crossed_cells;
    for (size_t k = 0; k < kMostGradients; ++k) lacking[k] += other.lacking[k];
    near_nodes += other.near_nodes;
    unsigned_nodes += other.unsigned_nodes;
    crossed.insert(crossed.end(), other.crossed.begin(), other.crossed.end());
  }
};

/// A block as the pass sees it.
struct Block {
  NodeWindow nodes;
  ActiveRows active;

  float value(const glm::ivec3& p) const {
    return nodes[static_cast<size_t>(p.x) + 1][static_cast<size_t>(p.y) + 1][static_cast<size_t>(p.z) + 1];
  }
  bool in_band(const glm::ivec3& p) const {
    return (active[static_cast<size_t>(p.x) + 2][static_cast<size_t>(p.y) + 2] >> (p.z + 2) & 1u) != 0;
  }
};

glm::ivec3 step_along(int axis) {
  glm::ivec3 step(0);
  step[axis] = 1;
  return step;
}

void include_crossings(const Block& block, const glm::ivec3& here, const glm::dvec3& node, Box& crossings) {
  const double a = static_cast<double>(block.value(here));
  for (int axis = 0; axis < 3; ++axis) {
    const double b = static_cast<double>(block.value(here + step_along(axis)));
    if ((a < 0.0) == (b < 0.0)) continue;
    glm::dvec3 crossing = node;
    crossing[axis] += a / (a - b);
    crossings = include(crossings, crossing);
  }
}

/// The distance at a node outside the band next to one in it, carried on from inside: the width that the band really has there.
double width_beyond(const Block& block, const glm::ivec3& inner, const glm::ivec3& step) {
  const double value = std::abs(static_cast<double>(block.value(inner)));
  if (!block.in_band(inner - step)) return value;
  return std::max(value, 2.0 * value - std::abs(static_cast<double>(block.value(inner - step))));
}

void count_widths(const Block& block, const glm::ivec3& here, double background, Counts& found) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const glm::ivec3& step : {step_along(axis), -step_along(axis)}) {
      if (block.in_band(here + step)) continue;
      const double width = width_beyond(block, here, step) / background;
      const auto bin = static_cast<size_t>(std::min(width * kWidthSteps / 2, static_cast<double>(kWidthSteps - 1)));
      ++found.widths[block.value(here) < 0.0f ? 1 : 0][bin];
    }
  }
}

/// A node within half a voxel of the surface has a neighbour beyond it, as the normal there has a component of 0.577 at least. Of
/// neighbours outside the band the difference counts for nothing.
void count_near(const Block& block, const glm::ivec3& here, Counts& found) {
  const float value = block.value(here);
  float largest = 0.0f;
  bool beyond = false;
  for (int axis = 0; axis < 3; ++axis) {
    for (const glm::ivec3& step : {step_along(axis), -step_along(axis)}) {
      const float other = block.value(here + step);
      beyond = beyond || (other < 0.0f) != (value < 0.0f);
      if (block.in_band(here + step)) largest = std::max(largest, std::abs(other - value));
    }
  }
  if (!(std::abs(value) < 0.5f * largest)) return;
  ++found.near_nodes;
  found.unsigned_nodes += beyond ? 0 : 1;
}

/// Bits 0..7: nodes of a row that have a neighbour of the other sign.
std::uint32_t beside_crossing(const NodeBits& inside, size_t x, size_t y) {
  const std::uint32_t row = inside.row(x + 1, y + 1), own = row >> 1;
  const auto other = [&](std::uint32_t beside) { return own ^ beside; };
  return (other(inside.row(x, y + 1) >> 1) | other(inside.row(x + 2, y + 1) >> 1) | other(inside.row(x + 1, y) >> 1) |
          other(inside.row(x + 1, y + 2) >> 1) | other(row) | other(own >> 1)) &
         0xffu;
}

/// Bits 2..9 of a row stand for the block's own nodes.
std::uint32_t at_edge_of_band(const ActiveRows& active, size_t x, size_t y) {
  const std::uint32_t all =
      active[x][y] & active[x - 1][y] & active[x + 1][y] & active[x][y - 1] & active[x][y + 1] & active[x][y] << 1 & active[x][y] >> 1;
  return active[x][y] & ~all;
}

/// Calls `visit` with the place of each of a block's nodes whose bit `bits(x, y)` sets, z being the bit.
template <class Bits, class Visit>
void for_each_place(const Bits& bits, const Visit& visit) {
  for (size_t x = 0; x < 8; ++x)
    for (size_t y = 0; y < 8; ++y)
      for (std::uint32_t left = bits(x, y); left != 0; left &= left - 1) visit(glm::ivec3(x, y, std::countr_zero(left)));
}

/// Nodes whose neighbour behind along an axis has the other sign.
std::uint32_t before_crossing(const NodeBits& inside, size_t x, size_t y) {
  const std::uint32_t own = inside.row(x + 1, y + 1) >> 1;
  return ((own ^ inside.row(x + 2, y + 1) >> 1) | (own ^ inside.row(x + 1, y + 2) >> 1) | (own ^ own >> 1)) & 0xffu;
}

std::int64_t count_of(const CrossedCells& cells) {
  std::int64_t count = 0;
  for (const auto& rows : cells.cells) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, rows, sizeof bits);
    count += std::popcount(bits);
  }
  return count;
}

/// Active nodes in every row of a block: bits 2..9 of its rows.
std::uint32_t active_at(const ActiveRows& active, size_t x, size_t y) { return active[x + 2][y + 2] >> 2 & 0xffu; }

void count_band(const Block& block, double background, Counts& found) {
  for_each_place([&](size_t x, size_t y) { return at_edge_of_band(block.active, x + 2, y + 2) >> 2 & 0xffu; },
                 [&](const glm::ivec3& at) { count_widths(block, at, background, found); });
  for_each_place([&](size_t x, size_t y) { return active_at(block.active, x, y); },
                 [&](const glm::ivec3& at) { found.largest = std::max(found.largest, std::abs(static_cast<double>(block.value(at)))); });
}

float largest_at(const Block& block, const CrossedCells& crossed) {
  NodeBits nodes;
  for_each_node_row(
      crossed, [&](int x, int y, std::uint32_t row) { nodes.set_row(static_cast<size_t>(x) + 1, static_cast<size_t>(y) + 1, row << 1); });
  return largest_value(block.nodes, nodes);
}

bool reads_all_of(const Stencil& wider, const Stencil& stencil) {
  for (size_t x = 0; x < stencil.size(); ++x)
    for (size_t y = 0; y < stencil.size(); ++y)
      if ((stencil[x][y] & ~wider[x][y]) != 0) return false;
  return true;
}

/// The widest stencil comes last: what lacks nothing for it lacks nothing for those that it holds.
void count_lacking(const CrossedCells& crossed, const ActiveRows& active, Counts& found) {
  const Stencil* whole = nullptr;
  size_t k = gradients().size();
  for (auto gradient = gradients().end(); gradient != gradients().begin();) {
    --gradient;
    --k;
    if (whole != nullptr && reads_all_of(*whole, gradient->stencil)) continue;
    const CrossedCells lacking = cells_outside(crossed, active, gradient->stencil);
    found.lacking[k] += count_of(lacking);
    if (!lacking.any) whole = &gradient->stencil;
  }
}

void count_near(const Block& block, const NodeBits& inside, const NodeBits& steep, Counts& found) {
  for (size_t x = 0; x < 8; ++x)
    for (size_t y = 0; y < 8; ++y) {
      const std::uint32_t near = steep.row(x + 1, y + 1) >> 1 & active_at(block.active, x, y);
      if (near == 0) continue;
      const std::uint32_t edge = at_edge_of_band(block.active, x + 2, y + 2) >> 2, whole = near & ~edge;
      found.near_nodes += std::popcount(whole);
      found.unsigned_nodes += std::popcount(whole & ~beside_crossing(inside, x, y));
      for (std::uint32_t left = near & edge; left != 0; left &= left - 1) count_near(block, {x, y, std::countr_zero(left)}, found);
    }
}

void count_surface(const Block& block, const NodeBits& inside, const glm::ivec3& origin, const SlopeScale& scale, Counts& found) {
  // In most blocks no crossing can move the bounds.
  const glm::dvec3 first(origin), last(origin + 8);
  if (!glm::all(glm::lessThan(found.crossings.lower, first)) || !glm::all(glm::lessThan(last, found.crossings.upper)))
    for_each_place([&](size_t x, size_t y) { return before_crossing(inside, x, y); },
                   [&](const glm::ivec3& at) { include_crossings(block, at, glm::dvec3(origin + at), found.crossings); });
  add_slopes(block.nodes, inside, block.active, scale, found.slopes);
  const CrossedCells crossed = cells_crossed(inside);
  if (!crossed.any) return;
  found.crossed_cells += count_of(crossed);
  found.crossed.push_back({origin, largest_at(block, crossed), crossed});
  count_lacking(crossed, block.active, found);
}

std::int64_t active_nodes(const NanoLeaf& leaf) {
  std::int64_t count = 0;
  for (int word = 0; word < 8; ++word) count += std::popcount(leaf.valueMask().template getWord<std::uint64_t>(word));
  return count;
}

void count_block(const NanoAccessor& accessor, const nanovdb::Coord& origin, const SlopeScale& scale, bool of_others, Counts& found) {
  const LeafWindow window(accessor, origin);
  Block block;
  load_nodes(window, block.nodes);
  // A block of a tile: all of its nodes are in the band, or none is.
  found.active += window.leaf() ? active_nodes(*window.leaf()) : accessor.isActive(origin) ? 512 : 0;
  NodeBits inside, steep;
  const bool crossed = find_inside(block.nodes, inside),
             near = of_others && find_steep(block.nodes, static_cast<float>(0.5 * scale.background), steep);
  if (!crossed && !near && !of_others) return;
  block.active = active_rows(window);
  if (crossed) count_surface(block, inside, {origin[0], origin[1], origin[2]}, scale, found);
  if (near) count_near(block, inside, steep, found);
  if (of_others) count_band(block, scale.background, found);
}

Counts count_blocks(const nanovdb::FloatGrid& grid, std::span<const nanovdb::Coord> blocks, const glm::dmat3& per_side, bool of_others) {
  const SlopeScale scale{std::abs(static_cast<double>(grid.tree().background())), per_side};
  return parallel_reduce(
      blocks.size(), size_t{64}, Counts{},
      [&](const IndexRange<size_t>& range, Counts found) {
        const NanoAccessor accessor = grid.getAccessor();
        for (size_t i = range.begin(); i < range.end(); ++i) count_block(accessor, blocks[i], scale, of_others, found);
        return found;
      },
      [](Counts a, const Counts& b) {
        a.join(b);
        return a;
      });
}

/// The width that the band has at half of its edge, in units of the background; infinite where it has no edge on that side. One node at a
/// medial axis, where the distance turns before it is as large as the width, tells nothing about the others.
double usual_width(const std::array<std::uint32_t, kWidthSteps>& widths) {
  std::int64_t all = 0, so_far = 0;
  for (const std::uint32_t count : widths) all += count;
  if (all == 0) return std::numeric_limits<double>::infinity();
  size_t bin = 0;
  while (so_far + widths[bin] <= all / 2) so_far += widths[bin++];
  return (static_cast<double>(bin) + 0.5) * 2.0 / kWidthSteps;
}

/// Grids that were scaled after they were made, or that hold no true distances, are measured by their own slope at the surface; a slope
/// within a tenth of the voxel size is the voxel size.
double change_per_voxel(const Counts& found, double background, double voxel_size) {
  const size_t kind = found.slopes.count[0] > 0 ? 0 : 1;
  const double counted = static_cast<double>(std::max<std::int64_t>(found.slopes.count[kind], 1));
  const double slope = static_cast<double>(found.slopes.sum[kind]) / counted / kSlopeUnits * background;
  return slope > 0.0 && std::abs(slope / voxel_size - 1.0) > 0.1 ? slope : voxel_size;
}

/// What the grid says of itself (its background) holds unless the values at the band's edge say otherwise by half a voxel.
double measured_width(const Counts& found, double background, double per_voxel) {
  const double seen = background * std::min(usual_width(found.widths[0]), usual_width(found.widths[1]));
  const double measured = (std::isfinite(seen) ? seen : found.largest) / per_voxel;
  const double said = background / per_voxel;
  return measured > said - 0.5 ? said : measured;
}

}  // namespace

std::vector<CrossedBlock> crossed_blocks(const nanovdb::FloatGrid& grid) {
  const std::vector<nanovdb::Coord> blocks = blocks_with_cells(grid);
  using Found = std::vector<CrossedBlock>;
  return parallel_reduce(
      blocks.size(), size_t{64}, Found{},
      [&](const IndexRange<size_t>& range, Found found) {
        const NanoAccessor accessor = grid.getAccessor();
        Block block;
        for (size_t i = range.begin(); i < range.end(); ++i) {
          load_nodes(LeafWindow(accessor, blocks[i]), block.nodes);
          NodeBits inside;
          if (!find_inside(block.nodes, inside)) continue;
          const CrossedCells cells = cells_crossed(inside);
          if (cells.any) found.push_back({{blocks[i][0], blocks[i][1], blocks[i][2]}, largest_at(block, cells), cells});
        }
        return found;
      },
      [](Found a, const Found& b) {
        a.insert(a.end(), b.begin(), b.end());
        return a;
      });
}

BandSurvey survey_band(const nanovdb::FloatGrid& grid, const glm::dmat3& world_from_index, double voxel_size, bool of_others) {
  LIMN_CHECK(gradients().size() <= kMostGradients);
  const std::vector<nanovdb::Coord> blocks = blocks_with_cells(grid);
  Counts found = count_blocks(grid, blocks, voxel_size * glm::transpose(glm::inverse(world_from_index)), of_others);
  const double background = std::abs(static_cast<double>(grid.tree().background()));
  BandSurvey survey;
  survey.active = found.active;
  survey.crossings = found.crossings;
  survey.per_voxel = change_per_voxel(found, background, voxel_size);
  if (of_others) survey.half_width_voxels = measured_width(found, background, survey.per_voxel);
  survey.facts.crossed_cells = found.crossed_cells;
  survey.facts.lacking.assign(found.lacking.begin(), found.lacking.begin() + static_cast<std::ptrdiff_t>(gradients().size()));
  survey.facts.near_nodes = found.near_nodes;
  survey.facts.unsigned_nodes = found.unsigned_nodes;
  survey.crossed = std::move(found.crossed);
  return survey;
}

}  // namespace limn
