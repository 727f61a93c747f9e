#include "raymarch/level_set/bricks.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <span>

#include "raymarch/level_set/brick_layout.h"

namespace limn {
namespace {

using Accessor = nanovdb::FloatGrid::AccessorType;

// Offsets in bytes have to fit in 31 bits.
constexpr size_t kMostBricks = (size_t{1} << 31) / (kBrickStride * sizeof(std::int16_t)) - 1;
constexpr float kLargestStep = 32767.0f;
// A crossed brick whose values span fewer steps than this in its crossed cells would lose digits of its normals.
constexpr int kFewestSteps = 1000;

size_t at(int x, int y, int z) { return static_cast<size_t>(brick_element(x, y, z)); }

void quantise(const NodeValues& values, float steps_per_unit, std::int16_t* out) {
  for (size_t i = 0; i < values.size(); ++i) {
    const float steps = std::clamp(values[i] * steps_per_unit, -kLargestStep, kLargestStep);
    const auto nearest = static_cast<int>(steps + (steps < 0.0f ? -0.5f : 0.5f));
    // No node lies on the surface itself: half a step to its side keeps its sign.
    out[i] = static_cast<std::int16_t>(values[i] < 0.0f ? std::min(nearest, -1) : std::max(nearest, 1));
  }
}

/// Hulls of the interpolant's partial derivatives over the crossed cells: along an edge each is constant, within a cell it lies between
/// those of the four parallel edges.
struct GradientHull {
  float lower[3] = {1e30f, 1e30f, 1e30f}, upper[3] = {-1e30f, -1e30f, -1e30f};
  void add(size_t axis, int difference) {
    lower[axis] = std::min(lower[axis], static_cast<float>(difference));
    upper[axis] = std::max(upper[axis], static_cast<float>(difference));
  }
};

/// A brick of the cube that is described, and where in it.
struct Part {
  glm::ivec3 place{0};
  const std::int16_t* values = nullptr;
  CrossedCells crossed{};
};

void bound_gradient(std::span<const Part> parts, SurfaceBound& bound) {
  int lower[3] = {32, 32, 32}, upper[3] = {0, 0, 0};
  GradientHull hull;
  std::int64_t sum[3] = {0, 0, 0}, edges = 0;
  for (const Part& part : parts) {
    for_each_cell(part.crossed, [&](int x, int y, int z) {
      const int cell[3] = {part.place.x + x, part.place.y + y, part.place.z + z};
      const std::int16_t* base = part.values + at(x, y, z);
      constexpr int step[3] = {81, 9, 1};
      for (size_t axis = 0; axis < 3; ++axis) {
        lower[axis] = std::min(lower[axis], cell[axis]);
        upper[axis] = std::max(upper[axis], cell[axis] + 1);
        const int u = step[(axis + 1) % 3], v = step[(axis + 2) % 3];
        for (const int edge : {0, u, v, u + v}) {
          const int difference = base[edge + step[axis]] - base[edge];
          hull.add(axis, difference);
          sum[axis] += difference;
        }
      }
      edges += 4;
    });
  }
  // Sides that cancel out leave no plane: then the slab is the whole cube.
  const bool cancels = sum[0] == 0 && sum[1] == 0 && sum[2] == 0;
  for (size_t axis = 0; axis < 3; ++axis) {
    bound.lower[axis] = static_cast<std::uint8_t>(lower[axis]);
    bound.upper[axis] = static_cast<std::uint8_t>(upper[axis]);
    bound.normal[axis] = cancels ? 1.0f : static_cast<float>(static_cast<double>(sum[axis]) / static_cast<double>(edges));
    bound.spread[axis] = std::max(hull.upper[axis] - bound.normal[axis], bound.normal[axis] - hull.lower[axis]);
  }
}

void bound_values(std::span<const Part> parts, SurfaceBound& bound) {
  const glm::dvec3 normal(bound.normal[0], bound.normal[1], bound.normal[2]);
  double least = 1e30, greatest = -1e30;
  for (const Part& part : parts) {
    for_each_node(part.crossed, [&](int x, int y, int z) {
      const double rest = part.values[at(x, y, z)] - glm::dot(normal, glm::dvec3(part.place + glm::ivec3(x, y, z)));
      least = std::min(least, rest);
      greatest = std::max(greatest, rest);
    });
  }
  bound.offset = static_cast<float>(-0.5 * (least + greatest));
  // Rounded outwards: both numbers are stored as float.
  bound.slab = static_cast<float>(0.5 * (greatest - least) * (1.0 + 1e-5) + 1e-5 * std::abs(static_cast<double>(bound.offset)) + 1e-3);
}

SurfaceBound bound_surface(const glm::ivec3& origin, std::span<Part> parts) {
  SurfaceBound bound;
  for (size_t axis = 0; axis < 3; ++axis) bound.origin[axis] = origin[static_cast<int>(axis)];
  for (Part& part : parts) part.crossed = crossed_cells_of(part.values);
  bound_gradient(parts, bound);
  bound_values(parts, bound);
  return bound;
}

/// Groups of 2^shift cells to a side of the crossed bricks.
BrickGroups group_bricks(const BrickLayout& layout, const RayBricks& bricks, int shift) {
  const int per_side = 1 << (shift - 3), parts = per_side * per_side * per_side;
  std::vector<std::pair<std::uint64_t, std::int32_t>> members;
  for (size_t i = 0; i < layout.crossed.size(); ++i)
    members.emplace_back(key_of((layout.crossed[i].origin >> shift) << 3), static_cast<std::int32_t>(i));
  std::sort(members.begin(), members.end());
  std::vector<size_t> first;
  for (size_t i = 0; i < members.size(); ++i) {
    if (i == 0 || members[i].first != members[i - 1].first) first.push_back(i);
  }
  BrickGroups groups{.shift = shift, .bounds = std::vector<SurfaceBound>(first.size()), .bricks = {}};
  groups.bricks.assign(first.size() * static_cast<size_t>(parts), -1);
  first.push_back(members.size());
  tbb::parallel_for(tbb::blocked_range<size_t>(0, groups.bounds.size(), 16), [&](const tbb::blocked_range<size_t>& range) {
    std::vector<Part> inside;
    for (size_t g = range.begin(); g < range.end(); ++g) {
      const glm::ivec3 origin = (layout.crossed[static_cast<size_t>(members[first[g]].second)].origin >> shift) << shift;
      inside.clear();
      for (size_t k = first[g]; k < first[g + 1]; ++k) {
        const auto brick = static_cast<size_t>(members[k].second);
        const glm::ivec3 place = layout.crossed[brick].origin - origin, slot = place >> 3;
        inside.push_back({place, bricks.values.data() + brick * kBrickStride, {}});
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

void fill(const LevelSetData& data, const BrickLayout& layout, float steps_per_unit, RayBricks& bricks) {
  const size_t crossed = layout.crossed.size();
  tbb::parallel_for(tbb::blocked_range<size_t>(0, layout.size(), 64), [&](const tbb::blocked_range<size_t>& range) {
    const Accessor accessor = data.accessor();
    NodeValues nodes;
    for (size_t i = range.begin(); i < range.end(); ++i) {
      std::int16_t* const values = bricks.values.data() + i * kBrickStride;
      load_nodes(accessor, i < crossed ? layout.crossed[i].origin : layout.reached[i - crossed], nodes);
      quantise(nodes, steps_per_unit, values);
      std::fill(values + nodes.size(), values + kBrickStride, std::int16_t{0});
      if (i >= crossed) continue;
      const glm::ivec3& origin = layout.crossed[i].origin;
      Part whole{glm::ivec3(0), values, {}};
      bricks.groups[0].bounds[i] = bound_surface(origin, std::span(&whole, 1));
      for (int face = 0; face < 6; ++face) {
        bricks.neighbors[i].face[face] = layout.find(key_of(origin + kBrickCells * face_step(face)));
      }
    }
  });
}

}  // namespace

std::int64_t RayBricks::bytes() const {
  size_t sum = neighbors.size() * sizeof(BrickNeighbors) + values.size() * sizeof(std::int16_t);
  for (const BrickGroups& of : groups) sum += of.bounds.size() * sizeof(SurfaceBound) + of.bricks.size() * sizeof(std::int32_t);
  return static_cast<std::int64_t>(sum) + spline.bytes();
}

std::shared_ptr<const RayBricks> make_bricks(const LevelSet& level_set, bool with_spline) {
  const auto start = std::chrono::steady_clock::now();
  const LevelSetData& data = level_set.data();
  const BrickLayout layout = lay_out_bricks(data);
  if (layout.size() > kMostBricks || (with_spline && layout.crossed.size() > kMostSplineBricks)) return nullptr;
  auto bricks = std::make_shared<RayBricks>();
  if (!layout.crossed.empty()) {
    const float scale = scale_for(layout, std::abs(data.grid->tree().background()));
    if (scale == 0.0f) return nullptr;
    bricks->world_per_step = 1.0 / static_cast<double>(scale);
    bricks->groups.push_back({.shift = 3, .bounds = std::vector<SurfaceBound>(layout.crossed.size()), .bricks = {}});
    bricks->neighbors.resize(layout.crossed.size());
    bricks->values.resize(layout.size() * kBrickStride);
    fill(data, layout, scale, *bricks);
    if (with_spline) {
      std::vector<glm::ivec3> origins;
      for (const Candidate& candidate : layout.crossed) origins.push_back(candidate.origin);
      bricks->spline = make_spline_bricks(data, origins);
    }
    for (const int shift : {4, 5}) bricks->groups.push_back(group_bricks(layout, *bricks, shift));
    bricks->lower = glm::ivec3(std::numeric_limits<int>::max());
    bricks->upper = glm::ivec3(std::numeric_limits<int>::lowest());
    for (const SurfaceBound& header : bricks->groups[0].bounds) {
      for (int axis = 0; axis < 3; ++axis) {
        bricks->lower[axis] = std::min(bricks->lower[axis], header.origin[axis] + header.lower[axis]);
        bricks->upper[axis] = std::max(bricks->upper[axis], header.origin[axis] + header.upper[axis]);
      }
    }
  }
  bricks->prepare_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return bricks;
}

}  // namespace limn
