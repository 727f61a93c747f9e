#include "raymarch/level_set/surface_bound.h"

#include <algorithm>
#include <cmath>

#include "raymarch/level_set/brick_layout.h"

namespace limn {
namespace {

/// Bits of the cells at (x, y), none outside of the brick.
std::uint32_t cells_at(const CrossedCells& crossed, int x, int y) {
  return std::min(x, y) >= 0 && std::max(x, y) < kBrickCells ? crossed.cells[x][y] : 0u;
}

/// Calls `visit(x, y, z)` for the first node of each edge along `axis` of a crossed cell, once.
template <class Visit>
void for_each_edge(const CrossedCells& crossed, int axis, const Visit& visit) {
  for (int x = 0; x < (axis == 0 ? 8 : 9); ++x) {
    for (int y = 0; y < (axis == 1 ? 8 : 9); ++y) {
      std::uint32_t bits = cells_at(crossed, x, y);
      if (axis != 0) bits |= cells_at(crossed, x - 1, y);
      if (axis != 1) bits |= cells_at(crossed, x, y - 1);
      if (axis == 2) bits |= cells_at(crossed, x - 1, y - 1);
      if (axis != 2) bits |= bits << 1;
      for (; bits != 0; bits &= bits - 1) visit(x, y, std::countr_zero(bits));
    }
  }
}

void bound_gradient(std::span<const BrickInCube> parts, SurfaceBound& bound) {
  double slope[3] = {}, least[3] = {}, greatest[3] = {};
  for (int axis = 0; axis < 3; ++axis) {
    int lower = 32, upper = 0, smallest = 1 << 20, largest = -(1 << 20);
    std::int64_t sum = 0, edges = 0;
    for (const BrickInCube& part : parts) {
      lower = std::min(lower, part.place[axis] + part.shape->lower[axis]);
      upper = std::max(upper, part.place[axis] + part.shape->upper[axis]);
      smallest = std::min(smallest, part.shape->least[axis]);
      largest = std::max(largest, part.shape->greatest[axis]);
      sum += part.shape->sum[axis];
      edges += part.shape->edges[axis];
    }
    bound.lower[axis] = static_cast<std::uint8_t>(lower);
    bound.upper[axis] = static_cast<std::uint8_t>(upper);
    slope[axis] = static_cast<double>(sum) / static_cast<double>(edges);
    least[axis] = smallest;
    greatest[axis] = largest;
  }
  // Sides that cancel out leave no plane: then the slab is the whole cube.
  const bool cancels = slope[0] == 0.0 && slope[1] == 0.0 && slope[2] == 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    bound.normal[axis] = cancels ? 1.0f : static_cast<float>(slope[axis]);
    bound.spread[axis] =
        std::max(static_cast<float>(greatest[axis]) - bound.normal[axis], bound.normal[axis] - static_cast<float>(least[axis]));
  }
}

void bound_values(std::span<const BrickInCube> parts, SurfaceBound& bound) {
  const glm::dvec3 normal(bound.normal[0], bound.normal[1], bound.normal[2]);
  double least = 1e30, greatest = -1e30;
  for (const BrickInCube& part : parts) {
    for_each_node(part.shape->crossed, [&](int x, int y, int z) {
      const double rest = part.values[brick_element(x, y, z)] - glm::dot(normal, glm::dvec3(part.place + glm::ivec3(x, y, z)));
      least = std::min(least, rest);
      greatest = std::max(greatest, rest);
    });
  }
  bound.offset = static_cast<float>(-0.5 * (least + greatest));
  // Rounded outwards: both numbers are stored as float.
  bound.slab = static_cast<float>(0.5 * (greatest - least) * (1.0 + 1e-5) + 1e-5 * std::abs(static_cast<double>(bound.offset)) + 1e-3);
}

}  // namespace

BrickShape shape_of(const std::int16_t* values, std::uint64_t covered) {
  BrickShape shape;
  shape.crossed = without_covered(crossed_cells_of(values), covered);
  std::uint32_t of_x = 0, of_y = 0, of_z = 0;  // bits: places that have a crossed cell
  for (int x = 0; x < kBrickCells; ++x) {
    for (int y = 0; y < kBrickCells; ++y) {
      const std::uint32_t cells = shape.crossed.cells[x][y], any = cells != 0 ? 1u : 0u;
      of_x |= any << x;
      of_y |= any << y;
      of_z |= cells;
    }
  }
  if (shape.crossed.any) {
    const std::uint32_t places[3] = {of_x, of_y, of_z};
    for (int axis = 0; axis < 3; ++axis) {
      shape.lower[axis] = std::countr_zero(places[axis]);
      shape.upper[axis] = static_cast<int>(std::bit_width(places[axis]));
    }
  }
  constexpr int kStep[3] = {kBrickNodes * kBrickNodes, kBrickNodes, 1};
  for (int axis = 0; axis < 3; ++axis) {
    int least = shape.least[axis], greatest = shape.greatest[axis], sum = 0, edges = 0;
    for_each_edge(shape.crossed, axis, [&](int x, int y, int z) {
      const std::int16_t* const node = values + brick_element(x, y, z);
      const int difference = node[kStep[axis]] - node[0];
      least = std::min(least, difference);
      greatest = std::max(greatest, difference);
      sum += difference;
      ++edges;
    });
    shape.least[axis] = least;
    shape.greatest[axis] = greatest;
    shape.sum[axis] = sum;
    shape.edges[axis] = edges;
  }
  return shape;
}

SurfaceBound bound_surface(const glm::ivec3& origin, std::span<const BrickInCube> parts) {
  SurfaceBound bound;
  for (int axis = 0; axis < 3; ++axis) bound.origin[axis] = origin[axis];
  bound_gradient(parts, bound);
  bound_values(parts, bound);
  return bound;
}

}  // namespace limn
