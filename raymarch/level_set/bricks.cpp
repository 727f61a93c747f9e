#include "raymarch/level_set/bricks.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <span>

#include "raymarch/level_set/brick_layout.h"
#include "raymarch/level_set/quantise.h"
#include "raymarch/level_set/surface_bound.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

using Accessor = nanovdb::FloatGrid::AccessorType;

// Offsets in bytes have to fit in 31 bits, and so do the numbers of cells (BrickHits::cell).
constexpr size_t kMostBricks = (size_t{1} << 31) / 512 - 1;
constexpr std::int64_t kMostRows = (std::int64_t{1} << 31) / (kBrickNodes * static_cast<std::int64_t>(sizeof(std::int16_t))) - 1;
constexpr float kLargestStep = 32767.0f;
// A crossed brick whose values span fewer steps than this in its crossed cells would lose digits of its normals.
constexpr int kFewestSteps = 1000;

/// Left unset, so that each thread touches first what it measures.
using BrickShapes = std::vector<BrickShape, LargePageAllocator<BrickShape>>;

bool is_addressable(const BrickLayout& layout) { return layout.row_count <= kMostRows && layout.crossed.size() <= kMostBricks; }

/// Of a brick, as brick_element() has them.
const std::int16_t* values_of(const BrickLayout& layout, size_t brick, const RayBricks& bricks) {
  return bricks.values.data() + layout.first_row[brick] * kBrickNodes;
}

/// Groups of 2^shift cells to a side of the crossed bricks.
BrickGroups group_bricks(const BrickLayout& layout, const BrickShapes& shapes, const RayBricks& bricks, int shift) {
  const int per_side = 1 << (shift - 3), parts = per_side * per_side * per_side;
  std::vector<std::pair<std::uint64_t, std::int32_t>> members(layout.crossed.size());
  parallel_for(size_t{0}, members.size(), [&](size_t i) {
    members[i] = {key_of((layout.crossed[i].origin >> shift) << 3), static_cast<std::int32_t>(i)};
  });
  parallel_sort(members.begin(), members.end());
  std::vector<size_t> first;
  for (size_t i = 0; i < members.size(); ++i) {
    if (i == 0 || members[i].first != members[i - 1].first) first.push_back(i);
  }
  BrickGroups groups{.shift = shift, .bounds = std::vector<SurfaceBound>(first.size()), .bricks = {}};
  groups.bricks.assign(first.size() * static_cast<size_t>(parts), -1);
  first.push_back(members.size());
  parallel_parts(groups.bounds.size(), size_t{16}, [&](const IndexRange<size_t>& range) {
    std::vector<BrickInCube> inside;
    for (size_t g = range.begin(); g < range.end(); ++g) {
      const glm::ivec3 origin = (layout.crossed[static_cast<size_t>(members[first[g]].second)].origin >> shift) << shift;
      inside.clear();
      for (size_t k = first[g]; k < first[g + 1]; ++k) {
        const auto brick = static_cast<size_t>(members[k].second);
        const glm::ivec3 place = layout.crossed[brick].origin - origin, slot = place >> 3;
        inside.push_back({place, values_of(layout, brick, bricks), &shapes[brick]});
        groups.bricks[g * static_cast<size_t>(parts) + static_cast<size_t>((slot.x * per_side + slot.y) * per_side + slot.z)] =
            members[k].second;
      }
      groups.bounds[g] = bound_surface(origin, inside);
    }
  });
  return groups;
}

/// World units to steps, such that whatever a stencil reads near the surface is held; 0 where no scale serves all bricks.
float scale_for(const BrickLayout& layout, float background) {
  float largest = 0.0f, least = 1e30f;
  for (const Candidate& candidate : layout.crossed) {
    largest = std::max(largest, candidate.largest);
    least = std::min(least, candidate.largest);
  }
  // Stencils reach two cells beyond a crossed one, so to three cells' worth of change; eight leaves room for one that steepens.
  const float held = std::min(8.0f * largest, std::max(background, largest));
  if (!(held > 0.0f) || !std::isfinite(held)) return 0.0f;
  const float scale = kLargestStep / held;
  return least * scale >= static_cast<float>(kFewestSteps) ? scale : 0.0f;
}

/// That no smaller bricks hold. Bits as of cells_within().
std::array<std::uint64_t, 8> open_cells(std::uint64_t covered) {
  std::array<std::uint64_t, 8> open;
  open.fill(~std::uint64_t{0});
  if (covered == 0) return open;
  CrossedCells all{.cells = {}, .any = true};
  std::memset(all.cells, 0xff, sizeof all.cells);
  const CrossedCells left = without_covered(all, covered);
  static_assert(sizeof left.cells == sizeof open);
  std::memcpy(open.data(), left.cells, sizeof left.cells);
  return open;
}

/// The rows that are read.
void fill_rows(const NodeSteps& steps, const BrickRows& rows, std::int16_t* to) {
  for (int row = 0; row < kBrickRows; ++row) {
    const int first = row * kBrickNodes;
    if (rows.has(row)) std::copy_n(&steps[static_cast<size_t>(first)], kBrickNodes, to + first);
  }
}

/// `first`: where the layer's nodes would begin if it were a brick.
template <class Reader>
void fill_layer(const Reader& reader, const BrickLayer& layer, const glm::ivec3& origin, std::int16_t* first) {
  const int axis = layer.face / 2;
  glm::ivec3 from(0);
  from[axis] = layer.first_node();
  const int count = axis == 2 ? layer_depth(axis) : kBrickNodes;
  for (int row = 0; row < kBrickRows; ++row) {
    if (!layer.rows.has(row)) continue;
    const glm::ivec3 node = origin + from + glm::ivec3(row / kBrickNodes, row % kBrickNodes, 0);
    for (int z = 0; z < count; ++z) first[row * kBrickNodes + layer.slot + z] = reader.steps(node + glm::ivec3(0, 0, z));
  }
}

/// `reader()` makes what one thread reads nodes with.
template <class MakeReader>
BrickShapes fill(const MakeReader& reader, const BrickLayout& layout, RayBricks& bricks) {
  const size_t crossed = layout.crossed.size();
  BrickShapes shapes(crossed);
  parallel_parts(crossed, size_t{64}, [&](const IndexRange<size_t>& range) {
    const auto nodes = reader();
    NodeSteps steps;
    for (size_t i = range.begin(); i < range.end(); ++i) {
      const Candidate& candidate = layout.crossed[i];
      nodes.load(candidate, steps);
      bricks.first[i] = static_cast<std::int32_t>(layout.first_row[i] * kBrickNodes * static_cast<std::int64_t>(sizeof(std::int16_t)));
      fill_rows(steps, layout.rows[i], bricks.values.data() + layout.first_row[i] * kBrickNodes);
      const std::array<std::uint64_t, 8> cells = cells_within(layout.rows[i]), open = open_cells(candidate.covered);
      for (size_t word = 0; word < 8; ++word) bricks.kept[8 * i + word] = cells[word] & open[word];
      shapes[i] = shape_of(steps.data(), candidate.cells);  // quantised() keeps signs
      const BrickInCube whole{glm::ivec3(0), steps.data(), &shapes[i]};
      bricks.groups[0].bounds[i] = bound_surface(candidate.origin, std::span(&whole, 1));
      bricks.neighbors[i] = layout.neighbors_of(i);
    }
  });
  parallel_parts(layout.layers.size(), size_t{64}, [&](const IndexRange<size_t>& range) {
    const auto nodes = reader();
    for (size_t i = range.begin(); i < range.end(); ++i) {
      const BrickLayer& layer = layout.layers[i];
      fill_layer(nodes, layer, layout.crossed[layer.brick].origin, bricks.values.data() + layer.first_row * kBrickNodes);
    }
  });
  return shapes;
}

/// Everything but the spline.
template <class MakeReader>
void make_from(const MakeReader& reader, const BrickLayout& layout, float scale, RayBricks& bricks) {
  bricks.world_per_step = 1.0 / static_cast<double>(scale);
  bricks.groups.push_back({.shift = 3, .bounds = std::vector<SurfaceBound>(layout.crossed.size()), .bricks = {}});
  bricks.neighbors.resize(layout.crossed.size());
  bricks.first.resize(layout.crossed.size());
  bricks.kept.resize(8 * layout.crossed.size());
  bricks.values.resize(static_cast<size_t>(layout.row_count * kBrickNodes) + kReadBeyond);
  const BrickShapes shapes = fill(reader, layout, bricks);
  for (const int shift : {4, 5}) bricks.groups.push_back(group_bricks(layout, shapes, bricks, shift));
  bricks.lower = glm::ivec3(std::numeric_limits<int>::max());
  bricks.upper = glm::ivec3(std::numeric_limits<int>::lowest());
  for (const SurfaceBound& header : bricks.groups[0].bounds) {
    for (int axis = 0; axis < 3; ++axis) {
      bricks.lower[axis] = std::min(bricks.lower[axis], header.origin[axis] + header.lower[axis]);
      bricks.upper[axis] = std::max(bricks.upper[axis], header.origin[axis] + header.upper[axis]);
    }
  }
}

struct GridReader {
  Accessor accessor;
  float steps_per_unit = 0.0f;
  void load(const Candidate& brick, NodeSteps& steps) const {
    NodeValues values;
    load_nodes(accessor, brick.origin, values);
    quantise(values, steps_per_unit, steps.data());
  }
  std::int16_t steps(const glm::ivec3& node) const {
    return quantised(accessor.getValue(nanovdb::Coord(node.x, node.y, node.z)), steps_per_unit);
  }
};

std::vector<glm::ivec3> origins_of(const BrickLayout& layout) {
  std::vector<glm::ivec3> origins;
  for (const Candidate& candidate : layout.crossed) origins.push_back(candidate.origin);
  return origins;
}

double ms_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

std::int64_t RayBricks::bytes() const {
  size_t sum = neighbors.size() * sizeof(BrickNeighbors) + values.size() * sizeof(std::int16_t) + first.size() * sizeof(std::int32_t) +
               kept.size() * sizeof(std::uint64_t);
  for (const BrickGroups& of : groups) sum += of.bounds.size() * sizeof(SurfaceBound) + of.bricks.size() * sizeof(std::int32_t);
  return static_cast<std::int64_t>(sum) + spline.bytes();
}

std::shared_ptr<const RayBricks> make_bricks(const LevelSet& level_set, bool with_spline) {
  const auto start = std::chrono::steady_clock::now();
  const LevelSetData& data = level_set.data();
  const BrickLayout layout = lay_out_bricks(data);
  if (!is_addressable(layout) || (with_spline && layout.crossed.size() > kMostSplineBricks)) return nullptr;
  auto bricks = std::make_shared<RayBricks>();
  bricks->world_from_index = level_set.info().world_from_index;
  bricks->voxel_size = level_set.info().voxel_size;
  bricks->half_width_voxels = level_set.info().half_width_voxels;
  if (!layout.crossed.empty()) {
    const float scale = scale_for(layout, std::abs(data.grid->tree().background()));
    if (scale == 0.0f) return nullptr;
    make_from([&] { return GridReader{data.accessor(), scale}; }, layout, scale, *bricks);
    if (with_spline) bricks->spline = make_spline_bricks(data, origins_of(layout));
  }
  bricks->prepare_ms = ms_since(start);
  return bricks;
}

std::shared_ptr<RayBricks> make_bricks(const NodeReader& nodes, std::span<const BrickPlace> places, float steps_per_unit) {
  const auto start = std::chrono::steady_clock::now();
  const BrickLayout layout = lay_out_bricks(nodes, places);
  if (!is_addressable(layout)) return nullptr;
  auto bricks = std::make_shared<RayBricks>();
  if (!layout.crossed.empty()) make_from([&nodes] { return nodes; }, layout, steps_per_unit, *bricks);
  bricks->prepare_ms = ms_since(start);
  return bricks;
}

}  // namespace limn
