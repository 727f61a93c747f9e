// The squared distance from a point to a triangle is h^2 + m^2: h its height over the plane, m its distance to the triangle within the
// plane, 0 inside, else that to the nearest edge, whose part across the edge is w and beyond the edge's ends u. h, w and the place s along
// each edge are linear in the point, so that a row of nodes costs a few additions each.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "subdiv/band_distance.cpp"
#include "sdf/simd.h"
// clang-format off
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

#include <cmath>
#include <limits>

#include "subdiv/band_distance.h"
#include "subdiv/mesh_distance.h"

#ifndef LIMN_BAND_DISTANCE_TYPES
#define LIMN_BAND_DISTANCE_TYPES
namespace limn {

/// f(p) = slope . p + constant; in voxels from the block's first node.
struct LinearForm {
  glm::dvec3 slope;
  double constant;
};

struct PreparedTriangle {
  LinearForm height;
  LinearForm across[3], along[3];  ///< Of each edge; `across` is positive outside.
  double length[3];
  glm::dvec3 center;  ///< Of a sphere that holds it.
  double radius;
};

/// What has been found so far, 64 rows of 8 nodes.
struct BlockDistances {
  alignas(64) double squared[512];
  double row_farthest[64];  ///< The largest distance (not squared) in each row.
  double reach;             ///< What they all began with.
};

}  // namespace limn
#endif

HWY_BEFORE_NAMESPACE();
namespace limn::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Lanes8 = hn::CappedTag<double, 8>;
using Vec = hn::Vec<Lanes8>;

/// Squared distances of one row to the triangle; true where any node's became less.
HWY_INLINE bool TakeRow(const PreparedTriangle& triangle, double x, double y, double* HWY_RESTRICT squared) {
  const Lanes8 d;
  const auto base = [x, y](const LinearForm& f) { return f.constant + f.slope.x * x + f.slope.y * y; };
  const double height = base(triangle.height);
  double across[3], along[3];
  for (int k = 0; k < 3; ++k) across[k] = base(triangle.across[k]), along[k] = base(triangle.along[k]);
  bool changed = false;
  for (size_t first = 0; first < 8; first += hn::Lanes(d)) {
    const Vec z = hn::Iota(d, static_cast<double>(first));
    const auto at = [&](const LinearForm& f, double start) { return hn::Add(hn::Set(d, start), hn::Mul(z, hn::Set(d, f.slope.z))); };
    Vec outside = hn::Set(d, -1.0), in_plane = hn::Set(d, std::numeric_limits<double>::infinity());
    for (int k = 0; k < 3; ++k) {
      const Vec w = at(triangle.across[k], across[k]), s = at(triangle.along[k], along[k]);
      const Vec u = hn::Max(hn::Max(hn::Neg(s), hn::Sub(s, hn::Set(d, triangle.length[k]))), hn::Zero(d));
      in_plane = hn::Min(in_plane, hn::Add(hn::Mul(w, w), hn::Mul(u, u)));
      outside = hn::Max(outside, w);
    }
    in_plane = hn::IfThenElseZero(hn::Gt(outside, hn::Zero(d)), in_plane);
    const Vec h = at(triangle.height, height);
    const Vec found = hn::Add(hn::Mul(h, h), in_plane), before = hn::Load(d, squared + first);
    changed |= !hn::AllFalse(d, hn::Lt(found, before));
    hn::Store(hn::Min(found, before), d, squared + first);
  }
  return changed;
}

HWY_INLINE double Farthest(const double* squared) {
  const Lanes8 d;
  Vec most = hn::Load(d, squared);
  for (size_t first = hn::Lanes(d); first < 8; first += hn::Lanes(d)) most = hn::Max(most, hn::Load(d, squared + first));
  return std::sqrt(hn::GetLane(hn::MaxOfLanes(d, most)));
}

void TakeTriangles(const PreparedTriangle* triangles, size_t count, BlockDistances& block) {
  for (size_t i = 0; i < count; ++i) {
    const PreparedTriangle& triangle = triangles[i];
    const double farthest = block.reach + triangle.radius;
    const auto first = [&](double center) { return static_cast<int>(std::ceil(std::max(0.0, center - farthest))); };
    const auto last = [&](double center) { return static_cast<int>(std::floor(std::min(7.0, center + farthest))); };
    const int last_x = last(triangle.center.x), first_y = first(triangle.center.y), last_y = last(triangle.center.y);
    const double z = std::min(std::max(triangle.center.z, 0.0), 7.0), dz = z - triangle.center.z;
    for (int x = first(triangle.center.x); x <= last_x; ++x) {
      const double dx = x - triangle.center.x, across_y = dx * dx + dz * dz;
      for (int y = first_y; y <= last_y; ++y) {
        // Out of the row's reach, by the sphere and by the plane: it cannot come nearer than what is known.
        const int row = 8 * x + y;
        const double known = block.row_farthest[row], dy = y - triangle.center.y;
        const double reach = known + triangle.radius;
        if (across_y + dy * dy >= reach * reach) continue;
        const LinearForm& h = triangle.height;
        const double low = h.constant + h.slope.x * x + h.slope.y * y, high = low + 7.0 * h.slope.z;
        if (std::min(low, high) >= known || std::max(low, high) <= -known) continue;
        if (TakeRow(triangle, x, y, block.squared + 8 * row)) block.row_farthest[row] = Farthest(block.squared + 8 * row);
      }
    }
  }
}

}  // namespace limn::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace limn {
namespace {

HWY_EXPORT(TakeTriangles);

LinearForm form(const glm::dvec3& slope, const glm::dvec3& zero) { return {slope, -glm::dot(slope, zero)}; }

/// False for slivers, whose plane is not known well enough.
bool prepare(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, PreparedTriangle& out) {
  const glm::dvec3 corners[3] = {a, b, c}, edges[3] = {b - a, c - b, a - c};
  const glm::dvec3 area = glm::cross(edges[0], -edges[2]);
  double longest_squared = 0.0;
  for (const glm::dvec3& edge : edges) longest_squared = std::max(longest_squared, glm::dot(edge, edge));
  const double doubled_area = glm::length(area);
  // Its normal is off by the cross product's rounding over this; 1e-10 of the band's width does not show.
  constexpr double kSliver = 1e-6;
  if (!(doubled_area > kSliver * longest_squared)) return false;
  const glm::dvec3 normal = area / doubled_area;
  out.height = form(normal, a);
  for (int k = 0; k < 3; ++k) {
    out.length[k] = glm::length(edges[k]);
    const glm::dvec3 direction = edges[k] / out.length[k];
    out.along[k] = form(direction, corners[k]);
    out.across[k] = form(glm::cross(direction, normal), corners[k]);
  }
  out.center = 0.5 * (glm::min(glm::min(a, b), c) + glm::max(glm::max(a, b), c));
  out.radius = std::max({glm::distance(out.center, a), glm::distance(out.center, b), glm::distance(out.center, c)}) * (1.0 + 1e-12);
  return true;
}

void take_sliver(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, BlockDistances& block) {
  const glm::dvec3 lower = glm::min(glm::min(a, b), c), upper = glm::max(glm::max(a, b), c);
  for (int row = 0; row < 64; ++row) {
    const double known = block.row_farthest[row];
    for (int k = 0; k < 8; ++k) {
      const glm::dvec3 p(row >> 3, row & 7, k), away = p - glm::clamp(p, lower, upper);
      if (glm::dot(away, away) > known * known) continue;
      const glm::dvec3 q = closest_on_triangle(p, a, b, c) - p;
      double& squared = block.squared[8 * row + k];
      squared = std::min(squared, glm::dot(q, q));
    }
  }
}

}  // namespace

void band_distances(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles, const glm::ivec3& origin, double voxel_size,
                    double reach, std::array<double, 512>& distances) {
  const auto take = HWY_DYNAMIC_DISPATCH(TakeTriangles);
  const double reach_voxels = reach / voxel_size;
  BlockDistances block;
  std::fill(std::begin(block.squared), std::end(block.squared), reach_voxels * reach_voxels * (1.0 + 1e-12));
  std::fill(std::begin(block.row_farthest), std::end(block.row_farthest), reach_voxels * (1.0 + 1e-12));
  block.reach = block.row_farthest[0];
  const double beyond = block.squared[0];
  const glm::dvec3 first = voxel_size * glm::dvec3(origin);
  constexpr size_t kBatch = 32;
  PreparedTriangle prepared[kBatch];
  size_t count = 0;
  for (const std::uint32_t index : triangles) {
    const glm::uvec3& t = mesh.triangles[index];
    const glm::dvec3 a = (mesh.positions[t.x] - first) / voxel_size, b = (mesh.positions[t.y] - first) / voxel_size,
                     c = (mesh.positions[t.z] - first) / voxel_size;
    if (prepare(a, b, c, prepared[count]))
      ++count;
    else
      take_sliver(a, b, c, block);
    if (count == kBatch) take(prepared, count, block), count = 0;
  }
  take(prepared, count, block);
  for (size_t node = 0; node < 512; ++node) {
    const double squared = block.squared[node];
    distances[node] = squared < beyond ? voxel_size * std::sqrt(squared) : std::numeric_limits<double>::infinity();
  }
}

}  // namespace limn
#endif
