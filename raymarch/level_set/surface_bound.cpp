#include "raymarch/level_set/surface_bound.h"

#include <algorithm>
#include <cmath>

#include "sdf/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raymarch/level_set/surface_bound.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace limn {
namespace HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

// Rows of nodes along z: eight as vectors, the ninth, which the next row's first follows, on its own.
constexpr int kRow = 8;

template <class Tag>
HWY_INLINE hn::Mask<Tag> mask_of(Tag tag, std::uint32_t bits) {
  std::uint8_t bytes[8] = {static_cast<std::uint8_t>(bits)};
  return hn::LoadMaskBits(tag, bytes);
}

void measure_edges(const std::int16_t* values, int axis, BrickShape& shape) {
  using Whole = hn::CappedTag<std::int32_t, kRow>;
  using Steps = hn::Rebind<std::int16_t, Whole>;
  const Whole whole;
  constexpr int kLanes = static_cast<int>(hn::MaxLanes(Whole()));
  const int step = axis == 0 ? kBrickNodes * kBrickNodes : axis == 1 ? kBrickNodes : 1;
  auto least = hn::Set(whole, shape.least[axis]), greatest = hn::Set(whole, shape.greatest[axis]);
  auto sum = hn::Zero(whole), edges = hn::Zero(whole);
  int last_least = shape.least[axis], last_greatest = shape.greatest[axis], last_sum = 0, last_edges = 0;
  const auto one = hn::Set(whole, 1);
  for (int x = 0; x < (axis == 0 ? 8 : 9); ++x) {
    const CellPlane plane = cells_about(shape.crossed, x, axis != 0, axis != 1);
    for (int y = 0; y < (axis == 1 ? 8 : 9); ++y) {
      // Bit z: whether (x, y, z) is the first node of an edge along `axis` of a crossed cell.
      const std::uint32_t cells = plane.at(y), bits = axis == 2 ? cells : cells | cells << 1;
      if (bits == 0) continue;
      const std::int16_t* const row = values + brick_element(x, y, 0);
      for (int z = 0; z < kRow; z += kLanes) {
        const auto mask = mask_of(whole, bits >> z & ((1u << kLanes) - 1u));
        const auto difference =
            hn::Sub(hn::PromoteTo(whole, hn::LoadU(Steps(), row + z + step)), hn::PromoteTo(whole, hn::LoadU(Steps(), row + z)));
        least = hn::IfThenElse(mask, hn::Min(least, difference), least);
        greatest = hn::IfThenElse(mask, hn::Max(greatest, difference), greatest);
        sum = hn::Add(sum, hn::IfThenElseZero(mask, difference));
        edges = hn::Add(edges, hn::IfThenElseZero(mask, one));
      }
      if ((bits >> kRow & 1u) == 0) continue;
      const int difference = row[kRow + step] - row[kRow];
      last_least = std::min(last_least, difference);
      last_greatest = std::max(last_greatest, difference);
      last_sum += difference;
      ++last_edges;
    }
  }
  HWY_ALIGN std::int32_t lanes[4][kLanes] = {};
  hn::Store(least, whole, lanes[0]);
  hn::Store(greatest, whole, lanes[1]);
  hn::Store(sum, whole, lanes[2]);
  hn::Store(edges, whole, lanes[3]);
  for (int i = 0; i < kLanes; ++i) {
    last_least = std::min(last_least, lanes[0][i]);
    last_greatest = std::max(last_greatest, lanes[1][i]);
    last_sum += lanes[2][i];
    last_edges += lanes[3][i];
  }
  shape.least[axis] = last_least;
  shape.greatest[axis] = last_greatest;
  shape.sum[axis] = last_sum;
  shape.edges[axis] = last_edges;
}

void measure_all_edges(const std::int16_t* values, BrickShape& shape) {
  for (int axis = 0; axis < 3; ++axis) measure_edges(values, axis, shape);
}

/// The range of value - normal . node over the nodes of crossed cells, `least` and `greatest` among it.
void bound_rests(const BrickInCube& part, const double* normal, double& least, double& greatest) {
  using Real = hn::CappedTag<double, kRow>;
  using Whole = hn::Rebind<std::int32_t, Real>;
  using Steps = hn::Rebind<std::int16_t, Real>;
  const Real real;
  constexpr int kLanes = static_cast<int>(hn::MaxLanes(Real()));
  auto lower = hn::Set(real, least), upper = hn::Set(real, greatest);
  const auto along_z = hn::Set(real, normal[2]), first = hn::Iota(real, static_cast<double>(part.place.z));
  const CrossedCells& crossed = part.shape->crossed;
  for (int x = 0; x < kBrickNodes; ++x) {
    const CellPlane plane = cells_about(crossed, x);
    for (int y = 0; y < kBrickNodes; ++y) {
      const std::uint32_t cells = plane.at(y), bits = cells | cells << 1;
      if (bits == 0) continue;
      const std::int16_t* const row = part.values + brick_element(x, y, 0);
      // In the order in which glm::dot() adds.
      const double of_row = normal[0] * (part.place.x + x) + normal[1] * (part.place.y + y);
      for (int z = 0; z < kRow; z += kLanes) {
        const auto mask = mask_of(real, bits >> z & ((1u << kLanes) - 1u));
        const auto value = hn::PromoteTo(real, hn::PromoteTo(Whole(), hn::LoadU(Steps(), row + z)));
        const auto place = hn::Add(first, hn::Set(real, static_cast<double>(z)));
        const auto rest = hn::Sub(value, hn::Add(hn::Set(real, of_row), hn::Mul(along_z, place)));
        lower = hn::IfThenElse(mask, hn::Min(lower, rest), lower);
        upper = hn::IfThenElse(mask, hn::Max(upper, rest), upper);
      }
      if ((bits >> kRow & 1u) == 0) continue;
      const double rest = row[kRow] - (of_row + normal[2] * (part.place.z + kRow));
      least = std::min(least, rest);
      greatest = std::max(greatest, rest);
    }
  }
  HWY_ALIGN double lanes[2][kLanes] = {};
  hn::Store(lower, real, lanes[0]);
  hn::Store(upper, real, lanes[1]);
  for (int i = 0; i < kLanes; ++i) {
    least = std::min(least, lanes[0][i]);
    greatest = std::max(greatest, lanes[1][i]);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace limn
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace limn {
namespace {

HWY_EXPORT(measure_all_edges);
HWY_EXPORT(bound_rests);

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
  const double normal[3] = {static_cast<double>(bound.normal[0]), static_cast<double>(bound.normal[1]),
                            static_cast<double>(bound.normal[2])};
  double least = 1e30, greatest = -1e30;
  for (const BrickInCube& part : parts) HWY_DYNAMIC_DISPATCH(bound_rests)(part, normal, least, greatest);
  bound.offset = static_cast<float>(-0.5 * (least + greatest));
  // Rounded outwards: both numbers are stored as float.
  bound.slab = static_cast<float>(0.5 * (greatest - least) * (1.0 + 1e-5) + 1e-5 * std::abs(static_cast<double>(bound.offset)) + 1e-3);
}

}  // namespace

BrickShape shape_of(const std::int16_t* values, const CrossedCells& crossed) {
  BrickShape shape;
  shape.crossed = crossed;
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
  HWY_DYNAMIC_DISPATCH(measure_all_edges)(values, shape);
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
#endif
