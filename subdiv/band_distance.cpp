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

#include <bit>
#include <cmath>
#include <limits>

#include "subdiv/band_distance.h"
#include "subdiv/mesh_distance.h"

#ifndef LIMN_BAND_DISTANCE_TYPES
#define LIMN_BAND_DISTANCE_TYPES
namespace limn {

/// f(p) = slope . p + constant; in voxels from the block's first node.
struct AffineForm {
  glm::dvec3 slope;
  double constant;
};

struct PreparedTriangle {
  AffineForm height;
  AffineForm across[3], along[3];  ///< Of each edge; `across` is positive outside.
  double length[3];
  std::uint64_t rows;  ///< Those of which some node may be nearer to it than to what is known.
};

/// A sphere that holds a triangle.
struct TriangleSphere {
  float x, y, z, radius;
};

/// Of 64 places, 8 by 8: k / 8 and k % 8.
struct PlacesOf64 {
  alignas(64) float first[64], second[64];
  constexpr PlacesOf64() : first(), second() {
    for (int k = 0; k < 64; ++k) first[k] = static_cast<float>(k / 8), second[k] = static_cast<float>(k % 8);
  }
};
inline constexpr PlacesOf64 kRowPlaces{};

/// What has been found so far, 64 rows of 8 nodes.
struct BlockDistances {
  alignas(64) double squared[512];
  alignas(64) float known[512];     ///< Distances, not squared, rounded up: what a triangle must come below.
  double row_farthest[64];          ///< The largest distance (not squared) in each row.
  alignas(64) float row_known[64];  ///< The largest of `known` in each row.
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
  const auto base = [x, y](const AffineForm& f) { return f.constant + f.slope.x * x + f.slope.y * y; };
  const double height = base(triangle.height);
  double across[3], along[3];
  for (int k = 0; k < 3; ++k) across[k] = base(triangle.across[k]), along[k] = base(triangle.along[k]);
  bool changed = false;
  for (size_t first = 0; first < 8; first += hn::Lanes(d)) {
    const Vec z = hn::Iota(d, static_cast<double>(first));
    const auto at = [&](const AffineForm& f, double start) { return hn::Add(hn::Set(d, start), hn::Mul(z, hn::Set(d, f.slope.z))); };
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

/// Takes note of a row whose squared distances have changed.
HWY_INLINE void UpdateRow(int row, BlockDistances& block) {
  const Lanes8 d;
  const hn::Rebind<float, Lanes8> f;
  Vec most = hn::Zero(d);
  auto most_known = hn::Zero(f);
  for (size_t first = 0; first < 8; first += hn::Lanes(d)) {
    const Vec distance = hn::Sqrt(hn::Load(d, block.squared + 8 * row + first));
    const auto known = hn::DemoteTo(f, hn::Mul(distance, hn::Set(d, 1.0 + 1e-6)));
    most = hn::Max(most, distance);
    most_known = hn::Max(most_known, known);
    hn::Store(known, f, block.known + 8 * row + first);
  }
  block.row_farthest[row] = hn::GetLane(hn::MaxOfLanes(d, most));
  block.row_known[row] = hn::GetLane(hn::MaxOfLanes(f, most_known));
}

/// Single precision has rounding.
inline constexpr float kRoom = 1e-4f;

/// Rows that may come as near to the sphere as the farthest that is known of them, as bits: all of those that RowsInReach() finds.
HWY_INLINE std::uint64_t RowsNear(const TriangleSphere& sphere, const BlockDistances& block) {
  const hn::CappedTag<float, 16> d;
  const float beyond_z = std::max(std::max(-sphere.z, sphere.z - 7.0f), 0.0f);
  const auto radius = hn::Set(d, sphere.radius * (1.0f + kRoom) + kRoom), squared_z = hn::Set(d, beyond_z * beyond_z);
  std::uint64_t rows = 0;
  for (size_t row = 0; row < 64; row += hn::Lanes(d)) {
    const auto dx = hn::Sub(hn::Load(d, kRowPlaces.first + row), hn::Set(d, sphere.x));
    const auto dy = hn::Sub(hn::Load(d, kRowPlaces.second + row), hn::Set(d, sphere.y));
    const auto squared = hn::Add(hn::Add(hn::Mul(dy, dy), squared_z), hn::Mul(dx, dx));
    const auto reach = hn::Add(hn::Load(d, block.row_known + row), radius);
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, hn::Le(squared, hn::Mul(hn::Mul(reach, reach), hn::Set(d, 1.0f + kRoom))), bits);
    rows |= ((bits[0] | std::uint64_t{bits[1]} << 8) & ((std::uint64_t{1} << hn::Lanes(d)) - 1)) << row;
  }
  return rows;
}

/// The rows of which some node may be nearer to a triangle in the sphere than to what is known, as bits: in single precision, with room for
/// its rounding.
HWY_INLINE std::uint64_t RowsInReach(const TriangleSphere& sphere, const BlockDistances& block) {
  const hn::CappedTag<float, 16> d;
  const std::uint64_t rows_near = RowsNear(sphere, block);
  if (rows_near == 0) return 0;
  alignas(64) float across[64];
  for (size_t k = 0; k < 64; k += hn::Lanes(d)) {
    // Lanes of one row, or of whole rows one after the other.
    const auto dy = hn::Sub(hn::Load(d, kRowPlaces.first + k), hn::Set(d, sphere.y)),
               dz = hn::Sub(hn::Load(d, kRowPlaces.second + k), hn::Set(d, sphere.z));
    hn::Store(hn::Add(hn::Mul(dy, dy), hn::Mul(dz, dz)), d, across + k);
  }
  const auto radius = hn::Set(d, sphere.radius * (1.0f + kRoom) + kRoom);
  std::uint64_t rows = 0;
  for (int x = 0; x < 8; ++x) {
    const float dx = static_cast<float>(x) - sphere.x;
    const auto squared_x = hn::Set(d, dx * dx);
    if ((rows_near >> (8 * x) & 0xffu) == 0) continue;
    for (size_t k = 0; k < 64; k += hn::Lanes(d)) {
      constexpr std::uint64_t kRows = hn::MaxLanes(d) > 8 ? 3 : 1;  // of a vector
      if ((rows_near >> (8 * static_cast<size_t>(x) + k / 8) & kRows) == 0) continue;
      const auto reach = hn::Add(hn::Load(d, block.known + 64 * x + k), radius);
      const auto near = hn::Le(hn::Add(hn::Load(d, across + k), squared_x), hn::Mul(hn::Mul(reach, reach), hn::Set(d, 1.0f + kRoom)));
      if (hn::AllFalse(d, near)) continue;
      std::uint8_t bits[8] = {};
      hn::StoreMaskBits(d, near, bits);
      for (size_t first = 0; first < hn::Lanes(d); first += 8)
        if (bits[first / 8] != 0) rows |= std::uint64_t{1} << (8 * static_cast<size_t>(x) + (k + first) / 8);
    }
  }
  return rows;
}

void FindRows(const TriangleSphere* spheres, size_t count, const BlockDistances& block, std::uint64_t* rows) {
  for (size_t i = 0; i < count; ++i) rows[i] = RowsInReach(spheres[i], block);
}

void TakeTriangles(const PreparedTriangle* triangles, size_t count, BlockDistances& block) {
  for (size_t i = 0; i < count; ++i) {
    const PreparedTriangle& triangle = triangles[i];
    for (std::uint64_t rows = triangle.rows; rows != 0; rows &= rows - 1) {
      const int row = std::countr_zero(rows), x = row >> 3, y = row & 7;
      // By the plane: it cannot come nearer than what is known.
      const double known = block.row_farthest[row];
      const AffineForm& h = triangle.height;
      const double low = h.constant + h.slope.x * x + h.slope.y * y, high = low + 7.0 * h.slope.z;
      if (std::min(low, high) >= known || std::max(low, high) <= -known) continue;
      if (TakeRow(triangle, x, y, block.squared + 8 * row)) UpdateRow(row, block);
    }
  }
}

}  // namespace limn::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace limn {
namespace {

HWY_EXPORT(FindRows);
HWY_EXPORT(TakeTriangles);

AffineForm form(const glm::dvec3& slope, const glm::dvec3& zero) { return {slope, -glm::dot(slope, zero)}; }

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

/// The triangles of a block, a batch at a time: first which rows each may concern, by little arithmetic, then those exactly that concern
/// any.
class BlockMeasure {
 public:
  BlockMeasure(const TriangleMesh& mesh, const glm::ivec3& origin, double voxel_size, BlockDistances& block)
      : mesh_(mesh), first_(voxel_size * glm::dvec3(origin)), voxel_size_(voxel_size), per_unit_(1.0 / voxel_size), block_(block) {}

  void add(std::uint32_t index) {
    const glm::uvec3& t = mesh_.triangles[index];
    const glm::dvec3 a = (mesh_.positions[t.x] - first_) * per_unit_, b = (mesh_.positions[t.y] - first_) * per_unit_,
                     c = (mesh_.positions[t.z] - first_) * per_unit_;
    const glm::dvec3 center = 0.5 * (glm::min(glm::min(a, b), c) + glm::max(glm::max(a, b), c));
    const auto squared = [&center](const glm::dvec3& p) { return glm::dot(p - center, p - center); };
    const double radius = std::sqrt(std::max({squared(a), squared(b), squared(c)}));
    triangles_[count_] = index;
    spheres_[count_] = {static_cast<float>(center.x), static_cast<float>(center.y), static_cast<float>(center.z),
                        static_cast<float>(radius)};
    if (++count_ == kBatch) flush();
  }

  void flush() {
    std::uint64_t rows[kBatch];
    HWY_DYNAMIC_DISPATCH(FindRows)(spheres_, count_, block_, rows);
    size_t prepared = 0;
    for (size_t i = 0; i < count_; ++i) {
      if (rows[i] == 0) continue;
      const glm::uvec3& t = mesh_.triangles[triangles_[i]];
      const glm::dvec3 a = (mesh_.positions[t.x] - first_) / voxel_size_, b = (mesh_.positions[t.y] - first_) / voxel_size_,
                       c = (mesh_.positions[t.z] - first_) / voxel_size_;
      if (prepare(a, b, c, prepared_[prepared]))
        prepared_[prepared++].rows = rows[i];
      else
        take_sliver(a, b, c, block_);
    }
    HWY_DYNAMIC_DISPATCH(TakeTriangles)(prepared_, prepared, block_);
    count_ = 0;
  }

 private:
  static constexpr size_t kBatch = 32;
  const TriangleMesh& mesh_;
  glm::dvec3 first_;
  double voxel_size_, per_unit_;
  BlockDistances& block_;
  std::uint32_t triangles_[kBatch];
  TriangleSphere spheres_[kBatch];
  PreparedTriangle prepared_[kBatch];
  size_t count_ = 0;
};

/// Where fine triangles crowd most are far from being any node's nearest: a few of them, spread over the list, come first and tell how near
/// the surface is. The least of all distances is the same in any order.
template <class Visit>
void visit_spread(std::span<const std::uint32_t> triangles, const Visit& visit) {
  constexpr size_t kStride = 16;
  for (size_t i = 0; i < triangles.size(); i += kStride) visit(triangles[i]);
  for (size_t i = 0; i < triangles.size(); ++i)
    if (i % kStride != 0) visit(triangles[i]);
}

}  // namespace

void band_distances(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles, const glm::ivec3& origin, double voxel_size,
                    double reach, std::array<double, 512>& distances) {
  const double reach_voxels = reach / voxel_size;
  BlockDistances block;
  std::fill(std::begin(block.squared), std::end(block.squared), reach_voxels * reach_voxels * (1.0 + 1e-12));
  std::fill(std::begin(block.known), std::end(block.known), static_cast<float>(reach_voxels * (1.0 + 1e-6)));
  std::fill(std::begin(block.row_farthest), std::end(block.row_farthest), reach_voxels * (1.0 + 1e-12));
  std::fill(std::begin(block.row_known), std::end(block.row_known), block.known[0]);
  const double beyond = block.squared[0];
  BlockMeasure measure(mesh, origin, voxel_size, block);
  visit_spread(triangles, [&measure](std::uint32_t index) { measure.add(index); });
  measure.flush();
  for (size_t node = 0; node < 512; ++node) {
    const double squared = block.squared[node];
    distances[node] = squared < beyond ? voxel_size * std::sqrt(squared) : std::numeric_limits<double>::infinity();
  }
}

}  // namespace limn
#endif
