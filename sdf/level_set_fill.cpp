#include "sdf/level_set_fill.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <optional>

#include "sdf/level_set_band.h"
#include "sdf/nearest_place.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

// Nodes that a stencil reads lie within 4.2 voxels of the surface; beyond this many nothing is looked for.
constexpr int kReach = 6;
// Of the block and what is about it: nodes -8..15.
constexpr int kSide = 24;
constexpr double kFarthest = 5.5;  // of the longest side of a voxel

// ---- which nodes are missing

/// Adds what the stencils of a block's cells read outside the band, each node to the block that it lies in.
void collect_missing(const LeafWindow& window, const CrossedCells& lacking, const ActiveRows& rows, const Stencil& stencil,
                     std::vector<MissingBlock>& out) {
  std::array<std::array<std::uint32_t, 13>, 13> read{};
  for (size_t x = 0; x < 8; ++x)
    for (size_t y = 0; y < 8; ++y)
      for (std::uint32_t bits = lacking.cells[x][y]; bits != 0; bits &= bits - 1)
        for (size_t dx = 0; dx < 6; ++dx)
          for (size_t dy = 0; dy < 6; ++dy) read[x + dx][y + dy] |= static_cast<std::uint32_t>(stencil[dx][dy]) << std::countr_zero(bits);
  std::array<MissingBlock, 27> blocks;
  std::array<bool, 27> any{};
  for (int x = -2; x <= 10; ++x)
    for (int y = -2; y <= 10; ++y) {
      const size_t i = static_cast<size_t>(x) + 2, j = static_cast<size_t>(y) + 2;
      for (std::uint32_t bits = read[i][j] & ~rows[i][j]; bits != 0; bits &= bits - 1) {
        const int z = std::countr_zero(bits) - 2;
        const size_t block =
            9 * static_cast<size_t>((x + 8) >> 3) + 3 * static_cast<size_t>((y + 8) >> 3) + static_cast<size_t>((z + 8) >> 3);
        any[block] = true;
        blocks[block].nodes[static_cast<size_t>(x & 7)] |= std::uint64_t{1} << ((y & 7) << 3 | (z & 7));
      }
    }
  for (int block = 0; block < 27; ++block) {
    if (!any[static_cast<size_t>(block)]) continue;
    MissingBlock& found = blocks[static_cast<size_t>(block)];
    const nanovdb::Coord at = window.origin().offsetBy(8 * (block / 9 - 1), 8 * (block / 3 % 3 - 1), 8 * (block % 3 - 1));
    found.origin = {at[0], at[1], at[2]};
    out.push_back(found);
  }
}

bool before(const MissingBlock& a, const MissingBlock& b) {
  if (a.origin.x != b.origin.x) return a.origin.x < b.origin.x;
  if (a.origin.y != b.origin.y) return a.origin.y < b.origin.y;
  return a.origin.z < b.origin.z;
}

std::vector<MissingBlock> merged(std::vector<MissingBlock> parts) {
  std::sort(parts.begin(), parts.end(), before);
  std::vector<MissingBlock> blocks;
  for (const MissingBlock& part : parts) {
    if (blocks.empty() || blocks.back().origin != part.origin)
      blocks.push_back(part);
    else
      for (size_t word = 0; word < 8; ++word) blocks.back().nodes[word] |= part.nodes[word];
  }
  return blocks;
}

// ---- values for them

/// The nodes about a block: values, and which of them are in the band. Places are from the block's first node.
class Surroundings {
 public:
  Surroundings(const NanoAccessor& accessor, const glm::ivec3& origin) {
    for (int block = 0; block < 27; ++block) {
      const glm::ivec3 from(block / 9, block / 3 % 3, block % 3);
      const nanovdb::Coord at(origin.x + 8 * from.x - 8, origin.y + 8 * from.y - 8, origin.z + 8 * from.z - 8);
      const NanoLeaf* leaf = accessor.probeLeaf(at);
      const float tile = leaf ? 0.0f : accessor.getValue(at);
      const bool tile_active = !leaf && accessor.isActive(at);
      for (int n = 0; n < 64; ++n) {
        const size_t to = index(glm::ivec3(8 * from.x - 8 + (n >> 3), 8 * from.y - 8 + (n & 7), 8 * from.z - 8));
        if (leaf)
          std::copy_n(leaf->data()->mValues + 8 * n, 8, &values_[to]);
        else
          std::fill_n(&values_[to], 8, tile);
        const std::uint32_t octet = leaf ? leaf->valueMask().template getWord<std::uint8_t>(n) : tile_active ? 0xffu : 0u;
        for (size_t z = 0; z < 8; ++z) active_[to + z] = (octet >> z & 1u) != 0;
      }
    }
  }

  static size_t index(const glm::ivec3& p) {
    constexpr size_t kRow = kSide;
    return ((static_cast<size_t>(p.x) + 8) * kRow + static_cast<size_t>(p.y) + 8) * kRow + static_cast<size_t>(p.z) + 8;
  }
  double value(const glm::ivec3& p) const { return static_cast<double>(values_[index(p)]); }
  bool in_band(const glm::ivec3& p) const { return active_[index(p)]; }

  /// visit(node, axis, its value, the value at the next node along the axis) for all pairs of nodes in the band whose signs differ.
  template <class Visit>
  void for_each_crossing(const Visit& visit) const {
    constexpr std::array<size_t, 3> kNext{size_t{kSide} * kSide, kSide, 1};
    for (int x = -kReach; x < 8 + kReach; ++x)
      for (int y = -kReach; y < 8 + kReach; ++y) {
        const size_t row = index({x, y, -kReach});
        for (size_t i = row; i < row + 8 + 2 * kReach; ++i) {
          if (!active_[i]) continue;
          const bool inside = values_[i] < 0.0f;
          for (int axis = 0; axis < 3; ++axis) {
            const size_t j = i + kNext[static_cast<size_t>(axis)];
            if ((values_[j] < 0.0f) != inside && active_[j])
              visit(glm::ivec3(x, y, static_cast<int>(i - row) - kReach), axis, double{values_[i]}, double{values_[j]});
          }
        }
      }
  }

 private:
  std::array<float, kSide * kSide * kSide> values_;
  std::array<bool, kSide * kSide * kSide> active_;
};

/// What the interpolant tells at a place.
struct Sample {
  double value = 0.0;
  glm::dvec3 gradient{0.0};  ///< By index coordinates.
};

/// Linear along each axis in the cell at `place`, less the sag of its chords where the nodes beside it are in the band too. False where the
/// cell has a node outside the band, or lies beyond the surroundings.
bool sample(const Surroundings& nodes, const glm::dvec3& place, Sample& out) {
  const glm::dvec3 base = glm::floor(place), u = place - base;
  const glm::ivec3 cell(base);
  for (int axis = 0; axis < 3; ++axis)
    if (cell[axis] < -7 || cell[axis] > 13) return false;
  std::array<double, 8> v;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::ivec3 node = cell + glm::ivec3(corner & 1, corner >> 1 & 1, corner >> 2);
    if (!nodes.in_band(node)) return false;
    v[static_cast<size_t>(corner)] = nodes.value(node);
  }
  out = {};
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 upper(corner & 1, corner >> 1 & 1, corner >> 2);
    const glm::dvec3 w = upper * u + (1.0 - upper) * (1.0 - u), side = 2.0 * upper - 1.0;
    const double value = v[static_cast<size_t>(corner)];
    out.value += w.x * w.y * w.z * value;
    out.gradient += value * glm::dvec3(side.x * w.y * w.z, w.x * side.y * w.z, w.x * w.y * side.z);
  }
  for (int axis = 0; axis < 3; ++axis) {
    double sag = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
      // The four edges along the axis, by the weights across it; of the two second differences at an edge's ends the one nearer to zero.
      if (corner >> axis & 1) continue;
      glm::ivec3 node = cell + glm::ivec3(corner & 1, corner >> 1 & 1, corner >> 2), step(0);
      step[axis] = 1;
      if (!nodes.in_band(node - step) || !nodes.in_band(node + 2 * step)) {
        sag = 0.0;
        break;
      }
      double weight = 1.0;
      for (int across = 0; across < 3; ++across)
        if (across != axis) weight *= corner >> across & 1 ? u[across] : 1.0 - u[across];
      const double f[4] = {nodes.value(node - step), nodes.value(node), nodes.value(node + step), nodes.value(node + 2 * step)};
      const double near = f[2] - 2.0 * f[1] + f[0], far = f[3] - 2.0 * f[2] + f[1];
      sag += weight * (std::max(std::min(near, far), 0.0) + std::min(std::max(near, far), 0.0));
    }
    out.value -= 0.5 * u[axis] * (1.0 - u[axis]) * sag;
  }
  return true;
}

/// Lengths in voxels (the smallest of the three), whatever the transform.
struct Metric {
  glm::dmat3 length_from_index{1.0}, index_from_length{1.0};
  double per_voxel = 1.0;  ///< What values change by over one.
  double farthest = kFarthest;
};

/// Where the grid's edges cross the surface between two nodes of the band: places that the file is sure of. In voxels.
void find_crossings(const Surroundings& nodes, const Metric& metric, Places& crossings) {
  crossings.clear();
  nodes.for_each_crossing([&](const glm::ivec3& from, int axis, double a, double b) {
    glm::dvec3 crossing(from);
    crossing[axis] += a / (a - b);
    const glm::vec3 place(metric.length_from_index * crossing);
    crossings.add(place.x, place.y, place.z);
  });
  if (!crossings.empty()) crossings.pad();
}

/// The crossing nearest to a place; none where there is none.
std::optional<glm::dvec3> nearest_crossing(const Places& crossings, const glm::dvec3& place) {
  if (crossings.empty()) return std::nullopt;
  const glm::vec3 p(place);
  const size_t k = nearest_place(crossings, {p.x, p.y, p.z});
  return glm::dvec3(crossings.at[0][k], crossings.at[1][k], crossings.at[2][k]);
}

struct NodeValue {
  double size = 0.0;     ///< |value|.
  bool told = false;     ///< False where there is no surface near enough.
  bool against = false;  ///< The band's own distances say the other sign: there is no surface between, only the band's torn edge.
};

/// The distance at a node: by the triangle inequality no more than the distance at a place in the band and the way there, and as much where
/// that place lies on the way to the nearest point of the surface. Its direction comes from the nearest crossing, then from the gradient.
NodeValue distance_at(const Surroundings& nodes, const Places& crossings, const Metric& metric, const glm::ivec3& node) {
  const glm::dvec3 p(node), place = metric.length_from_index * p;
  NodeValue result;
  const std::optional<glm::dvec3> foot = nearest_crossing(crossings, place);
  if (!foot) return result;
  const double nearest = glm::distance(*foot, place);
  if (nearest > metric.farthest) return result;
  result.told = true;
  const double side = nodes.value(node) < 0.0 ? -1.0 : 1.0;
  double best = nearest * metric.per_voxel;
  glm::dvec3 way = nearest > 0.0 ? metric.index_from_length * (*foot - place) / nearest : glm::dvec3(0.0);
  // As near to the node as the band is: there the error of the direction counts least.
  for (double step = 1.0; step < nearest; step += 0.25) {
    Sample at;
    if (!sample(nodes, p + step * way, at)) continue;
    if (side * at.value < 0.0) {
      result.against = true;
      break;
    }
    best = std::min(best, side * at.value + step * metric.per_voxel);
    for (int turn = 0; turn < 2; ++turn) {
      const glm::dvec3 slope = glm::transpose(metric.index_from_length) * at.gradient;
      const double length = glm::length(slope);
      if (!(length > 0.0)) break;
      way = metric.index_from_length * (slope * (-side / length));
      if (!sample(nodes, p + step * way, at) || side * at.value < 0.0) break;
      best = std::min(best, side * at.value + step * metric.per_voxel);
    }
    break;
  }
  result.size = best;
  return result;
}

/// A neighbour in the band has the other sign, and is farther from the surface than the step between the two.
bool jumps(const Surroundings& nodes, const Metric& metric, const glm::ivec3& node) {
  const bool inside = nodes.value(node) < 0.0;
  for (int axis = 0; axis < 3; ++axis)
    for (const int step : {-1, 1}) {
      glm::ivec3 other = node;
      other[axis] += step;
      if (!nodes.in_band(other) || (nodes.value(other) < 0.0) == inside) continue;
      if (std::abs(nodes.value(other)) > 1.25 * metric.per_voxel * glm::length(metric.length_from_index[axis])) return true;
    }
  return false;
}

void fill_block(const LevelSetData& data, const Metric& metric, const NanoAccessor& accessor, const MissingBlock& missing,
                Places& crossings, FilledBlock& block) {
  const Surroundings nodes(accessor, missing.origin);
  const double background = std::abs(static_cast<double>(data.grid->tree().background()));
  find_crossings(nodes, metric, crossings);
  block.origin = missing.origin;
  for (size_t word = 0; word < 8; ++word)
    for (std::uint64_t bits = missing.nodes[word]; bits != 0; bits &= bits - 1) {
      const int n = std::countr_zero(bits);
      const glm::ivec3 node(word, n >> 3, n & 7);
      const NodeValue found = distance_at(nodes, crossings, metric, node);
      const double size = found.told ? found.size : background;
      const bool sure = found.told && !found.against && !jumps(nodes, metric, node);
      (sure ? block.filled : block.kept_out)[word] |= bits & ~(bits - 1);
      // A node inside is below zero, however near.
      block.values[word * 64 + static_cast<size_t>(n)] =
          static_cast<float>(nodes.value(node) < 0.0 ? -std::max(size, 1e-6 * metric.per_voxel) : size);
    }
}

std::int64_t node_count(const std::vector<FilledBlock>& blocks) {
  std::int64_t count = 0;
  for (const FilledBlock& block : blocks)
    for (const std::uint64_t word : block.filled) count += std::popcount(word);
  return count;
}

}  // namespace

std::vector<MissingBlock> missing_nodes(const LevelSetData& data, const Stencil& stencil) {
  const std::vector<nanovdb::Coord> blocks = blocks_with_cells(*data.grid);
  using Parts = std::vector<MissingBlock>;
  Parts parts = parallel_reduce(
      blocks.size(), size_t{64}, Parts{},
      [&](const IndexRange<size_t>& range, Parts found) {
        const NanoAccessor accessor = data.accessor();
        NodeWindow nodes;
        for (size_t i = range.begin(); i < range.end(); ++i) {
          const LeafWindow window(accessor, blocks[i]);
          load_nodes(window, nodes);
          const CrossedCells crossed = cells_crossed(nodes);
          if (!crossed.any) continue;
          const ActiveRows rows = active_rows(window);
          const CrossedCells lacking = cells_outside(crossed, rows, stencil);
          if (lacking.any) collect_missing(window, lacking, rows, stencil, found);
        }
        return found;
      },
      [](Parts a, const Parts& b) {
        a.insert(a.end(), b.begin(), b.end());
        return a;
      });
  return merged(std::move(parts));
}

std::vector<FilledBlock> fill_nodes(const LevelSetData& data, const std::vector<MissingBlock>& missing) {
  Metric metric;
  metric.length_from_index = data.info.world_from_index.linear / data.info.voxel_size;
  metric.index_from_length = glm::inverse(metric.length_from_index);
  metric.per_voxel = data.per_voxel;
  const glm::dmat3& axes = metric.length_from_index;
  metric.farthest = kFarthest * std::max({glm::length(axes[0]), glm::length(axes[1]), glm::length(axes[2])});
  std::vector<FilledBlock> filled(missing.size());
  parallel_parts(missing.size(), size_t{16}, [&](const IndexRange<size_t>& range) {
    const NanoAccessor accessor = data.accessor();
    Places crossings;
    for (size_t i = range.begin(); i < range.end(); ++i) fill_block(data, metric, accessor, missing[i], crossings, filled[i]);
  });
  return filled;
}

LevelSet complete_band(const LevelSet& level_set, const GradientDescriptor& gradient) {
  const std::int64_t lacking = cells_lacking(level_set, gradient);
  if (lacking == 0) return level_set;
  const auto started = std::chrono::steady_clock::now();
  const std::vector<FilledBlock> filled = fill_nodes(level_set.data(), missing_nodes(level_set.data(), gradient.stencil));
  const std::shared_ptr<LevelSetData> data = with_filled_nodes(level_set, filled);
  const double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - started).count();
  data->info.build_ms += ms;
  data->completed = true;
  LevelSet completed(data);
  const std::int64_t left = cells_lacking(completed, gradient), nodes = node_count(filled);
  const std::int64_t crossed = level_set.info().band.crossed_cells;
  std::string text = fmt::format(
      "the narrow band lacks distances beside {} of the {} cells that the surface crosses (half width {:.2f} "
      "voxels; the gradient {} needs {:.2f})",
      lacking, crossed, level_set.info().half_width_voxels, gradient.about.name, gradient.half_width_voxels);
  if (nodes > 0) text += fmt::format("; {} nodes are filled in from the surface in the file, in {:.0f} ms", nodes, ms);
  if (left > 0)
    text += fmt::format(
        "; {} of these cells lie where the band breaks off: there the surface is where the signs change, and the next lower "
        "gradient is taken",
        left);
  data->info.warnings.push_back(text);
  return completed;
}

}  // namespace limn
