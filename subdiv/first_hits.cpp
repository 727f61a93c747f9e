#include "subdiv/first_hits.h"

#include <algorithm>
#include <cmath>

#include "sdf/parallel.h"

namespace limn {
namespace {

/// A ray in the axes of the watertight test (Woop, Benthin, Wald 2013): z along the largest component of its direction, x and y sheared
/// onto it. A vertex comes out the same for every triangle that holds it.
struct ShearedSegment {
  glm::dvec3 origin{0.0};
  int x = 0, y = 1, z = 2;
  glm::dvec3 shear{0.0};
  double from = 0.0, to = 0.0;

  explicit ShearedSegment(const SegmentRay& ray) : origin(ray.origin), from(ray.from), to(ray.to) {
    const glm::dvec3 size = glm::abs(ray.direction);
    z = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    x = (z + 1) % 3;
    y = (x + 1) % 3;
    shear = glm::dvec3(ray.direction[x], ray.direction[y], 1.0) / ray.direction[z];
  }
  glm::dvec3 sheared(const glm::dvec3& point) const {
    const glm::dvec3 p = point - origin;
    return {p[x] - shear.x * p[z], p[y] - shear.y * p[z], shear.z * p[z]};
  }
  /// Infinite where the triangle is not met.
  double meet(const glm::dvec3& p, const glm::dvec3& q, const glm::dvec3& r) const {
    constexpr double kNever = std::numeric_limits<double>::infinity();
    const glm::dvec3 a = sheared(p), b = sheared(q), c = sheared(r);
    const double at_a = c.x * b.y - c.y * b.x, at_b = a.x * c.y - a.y * c.x, at_c = b.x * a.y - b.y * a.x;
    if ((at_a < 0.0 || at_b < 0.0 || at_c < 0.0) && (at_a > 0.0 || at_b > 0.0 || at_c > 0.0)) return kNever;
    const double sum = at_a + at_b + at_c;
    if (sum == 0.0) return kNever;  // seen edge on: its neighbours stop the ray
    const double t = (at_a * a.z + at_b * b.z + at_c * c.z) / sum;
    return t > from && t < to ? t : kNever;
  }
};

void take(double t, std::uint32_t triangle, SegmentHit& nearest) {
  if (t < nearest.t || (t == nearest.t && nearest.found() && triangle < nearest.triangle)) nearest = {t, triangle};
}

/// Cells, and the rays that run through each.
class RayLattice {
 public:
  /// `within`: where the triangles are.
  RayLattice(std::span<const SegmentRay> rays, const Box& within) : bounds_(within) {
    for (const SegmentRay& ray : rays) segments_.emplace_back(ray);
    cell_ = std::max(bounds_.longest_side() / kCells, std::numeric_limits<double>::min());
    margin_ = 1e-6 * cell_;
    bounds_ = dilate(bounds_, cell_);
    count_ = glm::ivec3(glm::ceil(bounds_.size() / cell_)) + 1;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (size_t i = 0; i < rays.size(); ++i) walk(rays[i], static_cast<std::uint32_t>(i), pairs);
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    first_.assign(cells() + 1, 0);
    for (const auto& [cell, ray] : pairs) ++first_[cell + 1], rays_.push_back(ray);
    for (size_t cell = 0; cell < cells(); ++cell) first_[cell + 1] += first_[cell];
  }

  void meet(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, std::uint32_t triangle, std::span<SegmentHit> nearest) const {
    const glm::dvec3 lower = (glm::min(glm::min(a, b), c) - margin_ - bounds_.lower) / cell_,
                     upper = (glm::max(glm::max(a, b), c) + margin_ - bounds_.lower) / cell_;
    const glm::dvec3 limit(count_ - 1);
    if (!(glm::all(glm::greaterThanEqual(upper, glm::dvec3(0.0))) && glm::all(glm::lessThanEqual(lower, limit + 1.0)))) return;
    const glm::ivec3 first(glm::clamp(glm::floor(lower), glm::dvec3(0.0), limit)),
        last(glm::clamp(glm::floor(upper), glm::dvec3(0.0), limit));
    const glm::dvec3 size = glm::dvec3(last - first) + 1.0;
    // A triangle costs as much as there are rays, at most, however large it is.
    if (size.x * size.y * size.z > static_cast<double>(segments_.size())) {
      for (size_t i = 0; i < segments_.size(); ++i) take(segments_[i].meet(a, b, c), triangle, nearest[i]);
      return;
    }
    for (int x = first.x; x <= last.x; ++x)
      for (int y = first.y; y <= last.y; ++y)
        for (int z = first.z; z <= last.z; ++z) {
          const size_t cell = index({x, y, z});
          for (std::uint32_t k = first_[cell]; k < first_[cell + 1]; ++k)
            take(segments_[rays_[k]].meet(a, b, c), triangle, nearest[rays_[k]]);
        }
  }

 private:
  static constexpr double kCells = 64.0;  // along the longest side

  size_t cells() const { return static_cast<size_t>(count_.x) * static_cast<size_t>(count_.y) * static_cast<size_t>(count_.z); }
  size_t index(const glm::ivec3& cell) const {
    return (static_cast<size_t>(cell.x) * static_cast<size_t>(count_.y) + static_cast<size_t>(cell.y)) * static_cast<size_t>(count_.z) +
           static_cast<size_t>(cell.z);
  }

  /// The cells that a ray runs through, from plane to plane of the lattice (Amanatides & Woo 1987): each piece between two planes lies in
  /// the cell of its middle. Triangles reach a little beyond their boxes, so that rounding at a plane loses nothing.
  void walk(const SegmentRay& ray, std::uint32_t number, std::vector<std::pair<std::uint32_t, std::uint32_t>>& pairs) const {
    double from = ray.from, to = ray.to;
    for (int axis = 0; axis < 3; ++axis) {
      const double slope = ray.direction[axis], below = bounds_.lower[axis] - ray.origin[axis],
                   above = bounds_.upper[axis] - ray.origin[axis];
      if (slope == 0.0 && (below > 0.0 || above < 0.0)) return;
      if (slope == 0.0) continue;
      from = std::max(from, std::min(below / slope, above / slope));
      to = std::min(to, std::max(below / slope, above / slope));
    }
    if (!(from < to)) return;
    std::vector<double> cuts{from, to};
    for (int axis = 0; axis < 3; ++axis) {
      const double slope = ray.direction[axis];
      if (slope == 0.0) continue;
      const double a = (ray.origin[axis] + from * slope - bounds_.lower[axis]) / cell_,
                   b = (ray.origin[axis] + to * slope - bounds_.lower[axis]) / cell_;
      for (double plane = std::ceil(std::min(a, b)); plane <= std::max(a, b); plane += 1.0)
        cuts.push_back((bounds_.lower[axis] + plane * cell_ - ray.origin[axis]) / slope);
    }
    std::sort(cuts.begin(), cuts.end());
    for (size_t i = 1; i < cuts.size(); ++i) {
      const glm::dvec3 middle = ray.origin + 0.5 * (cuts[i - 1] + cuts[i]) * ray.direction;
      const glm::dvec3 cell = glm::clamp(glm::floor((middle - bounds_.lower) / cell_), glm::dvec3(0.0), glm::dvec3(count_ - 1));
      pairs.emplace_back(static_cast<std::uint32_t>(index(glm::ivec3(cell))), number);
    }
  }

  std::vector<ShearedSegment> segments_;
  Box bounds_{};
  double cell_ = 1.0, margin_ = 0.0;
  glm::ivec3 count_{1};
  std::vector<std::uint32_t> first_, rays_;
};

glm::dvec3 area_normal(const TriangleMesh& mesh, size_t triangle) {
  const glm::uvec3 t = mesh.triangles[triangle];
  return 0.5 * glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]);
}

/// Triangles at even steps of the area, so that each stands for as much of it.
std::vector<size_t> by_area(const TriangleMesh& mesh) {
  std::vector<double> until(mesh.triangles.size());
  parallel_parts(until.size(), size_t{4096}, [&](const IndexRange<size_t>& part) {
    for (size_t i = part.first; i < part.last; ++i) until[i] = glm::length(area_normal(mesh, i));
  });
  double area = 0.0;
  for (double& sum : until) sum = area += sum;
  std::vector<size_t> chosen;
  for (size_t k = 0; k < kThinSamples; ++k) {
    const double at = (static_cast<double>(k) + 0.5) / static_cast<double>(kThinSamples) * area;
    const auto found = std::upper_bound(until.begin(), until.end(), at);
    if (found != until.end()) chosen.push_back(static_cast<size_t>(found - until.begin()));
  }
  return chosen;
}

}  // namespace

std::vector<SegmentHit> first_hits(const TriangleMesh& mesh, std::span<const SegmentRay> rays) {
  std::vector<SegmentHit> nearest(rays.size());
  if (rays.empty()) return nearest;
  const Box within = parallel_reduce(
      mesh.triangles.size(), size_t{4096}, Box{},
      [&](const IndexRange<size_t>& part, Box box) {
        for (size_t i = part.first; i < part.last; ++i)
          for (int k = 0; k < 3; ++k) box = include(box, mesh.positions[mesh.triangles[i][k]]);
        return box;
      },
      [](const Box& a, const Box& b) { return merge(a, b); });
  if (within.empty()) return nearest;
  const RayLattice lattice(rays, within);
  constexpr size_t kPiece = 65'536;
  const size_t pieces = (mesh.triangles.size() + kPiece - 1) / kPiece;
  std::vector<std::vector<SegmentHit>> found(pieces);
  parallel_for(size_t{0}, pieces, [&](size_t piece) {
    found[piece].resize(rays.size());
    const size_t last = std::min((piece + 1) * kPiece, mesh.triangles.size());
    for (size_t i = piece * kPiece; i < last; ++i) {
      const glm::uvec3& t = mesh.triangles[i];
      lattice.meet(mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z], static_cast<std::uint32_t>(i), found[piece]);
    }
  });
  // In the order of the triangles: an earlier one stays where both are as near.
  for (const std::vector<SegmentHit>& part : found) {
    for (size_t i = 0; i < nearest.size(); ++i)
      if (part[i].t < nearest[i].t) nearest[i] = part[i];
  }
  return nearest;
}

ThinSamples thin_samples(const TriangleMesh& mesh, double longest_side, double farthest) {
  ThinSamples samples;
  samples.triangles = by_area(mesh);
  std::vector<SegmentRay> rays;
  const double start = 1e-6 * longest_side;
  for (const size_t i : samples.triangles) {
    const glm::uvec3 t = mesh.triangles[i];
    const glm::dvec3 normal = glm::normalize(area_normal(mesh, i));
    const glm::dvec3 middle = (mesh.positions[t.x] + mesh.positions[t.y] + mesh.positions[t.z]) / 3.0;
    for (const double side : {-1.0, 1.0}) rays.push_back({middle, side * normal, start, std::max(farthest, start)});
  }
  const std::vector<SegmentHit> hits = first_hits(mesh, rays);
  for (size_t k = 0; k < rays.size(); ++k) {
    const glm::dvec3 normal = (k % 2 == 0 ? -1.0 : 1.0) * rays[k].direction;
    const bool opposite = hits[k].found() && glm::dot(area_normal(mesh, hits[k].triangle), normal) < 0.0;
    (k % 2 == 0 ? samples.walls : samples.gaps).push_back(opposite ? hits[k].t : std::numeric_limits<double>::infinity());
  }
  return samples;
}

}  // namespace limn
