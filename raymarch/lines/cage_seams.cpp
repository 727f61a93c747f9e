#include "raymarch/lines/cage_seams.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "sdf/segment.h"

namespace limn {
namespace {

constexpr int kDeepest = 8;
constexpr double kSmooth = 0.99985;  // the cosine of one degree

/// A node pair of the lattice where sheets end.
struct SeamEdge {
  std::uint32_t a = 0, b = 0;
  std::span<const SeamUse> uses{};
  bool taken = false;
};

struct Tracer {
  const PlacedLimitSurface& placed;
  const LimitGrid& grid;
  const Camera& camera;
  double tolerance_px;
  int object;
};

/// Corners of a use at the nodes from and to.
struct UseCorners {
  LimitTriangle triangle{};
  int from = 0, to = 0;
};
UseCorners corners_of(const LimitGrid& grid, const SeamUse& use, std::uint32_t from) {
  UseCorners corners{triangle_of(grid, use.triangle), use.from, (use.from + 1) % 3};
  if (corners.triangle.corners[static_cast<size_t>(corners.from)].node != from) std::swap(corners.from, corners.to);
  return corners;
}

/// Neither an open edge nor a crease: both sides agree on the normals, and on which of them is the outside.
bool is_smooth(const LimitGrid& grid, std::span<const SeamUse> uses, std::uint32_t a) {
  if (uses.size() != 2) return false;
  const UseCorners one = corners_of(grid, uses[0], a), two = corners_of(grid, uses[1], a);
  const bool opposite = (one.from == uses[0].from) != (two.from == uses[1].from);
  return opposite && side_towards(one.triangle, one.from, one.to) == side_towards(two.triangle, two.from, two.to) &&
         side_towards(one.triangle, one.to, one.from) == side_towards(two.triangle, two.to, two.from);
}

/// At the share t of the way from node `from` to its other node.
SeamSample sample_seam(const Tracer& tracer, const SeamEdge& edge, std::uint32_t from, double t) {
  SeamSample result;
  result.object = tracer.object;
  for (const SeamUse& use : edge.uses) {
    const UseCorners at = corners_of(tracer.grid, use, from);
    const auto corner = [&](int i) -> const LimitCorner& { return at.triangle.corners[static_cast<size_t>(i)]; };
    const LimitSample s = sample(tracer.placed, at.triangle.patch, glm::mix(corner(at.from).uv(), corner(at.to).uv(), t));
    const glm::dvec3 &pa = tracer.grid.positions[corner(at.from).node], &pb = tracer.grid.positions[corner(at.to).node];
    const glm::dvec3& third = tracer.grid.positions[corner((use.from + 2) % 3).node];
    if (result.sides.empty()) result.p = s.valid ? s.position : glm::mix(pa, pb, t);
    SeamSide side;
    // At the ends the lattice knows of normals that a patch does not have there.
    const bool end = t == 0.0 || t == 1.0;
    side.normal = s.valid && !end ? s.normal
                  : t < 0.5       ? tracer.grid.normals[side_towards(at.triangle, at.from, at.to)]
                                  : tracer.grid.normals[side_towards(at.triangle, at.to, at.from)];
    const glm::dvec3 across = glm::cross(side.normal, pb - pa);
    side.into = glm::dot(across, third - pa) < 0.0 ? -across : across;
    side.facing = glm::dot(side.normal, view_vector(tracer.camera, result.p));
    result.sides.push_back(side);
  }
  return result;
}

/// Points between those at t0 and t1, until their chords keep to the tolerance.
void refine(const Tracer& tracer, const SeamEdge& edge, std::uint32_t from, double t0, const SeamSample& a, double t1, const SeamSample& b,
            int depth, std::vector<SeamSample>& out) {
  const double t = 0.5 * (t0 + t1);
  const SeamSample middle = sample_seam(tracer, edge, from, t);
  const glm::dvec2 pa(project(tracer.camera, a.p)), pb(project(tracer.camera, b.p)), pm(project(tracer.camera, middle.p));
  const bool again = depth > 0 && distance_to_segment(pm, pa, pb) > tracer.tolerance_px;
  if (again) refine(tracer, edge, from, t0, a, t, middle, depth - 1, out);
  out.push_back(middle);
  if (again) refine(tracer, edge, from, t, middle, t1, b, depth - 1, out);
}

/// Sides of the next sample in the order of those before it.
void align(const SeamSample& before, SeamSample& sample) {
  if (sample.sides.size() != 2) return;
  const auto& b = before.sides;
  auto& s = sample.sides;
  const double kept = glm::dot(b[0].into, s[0].into) / (glm::length(b[0].into) * glm::length(s[0].into)) +
                      glm::dot(b[1].into, s[1].into) / (glm::length(b[1].into) * glm::length(s[1].into));
  const double swapped = glm::dot(b[0].into, s[1].into) / (glm::length(b[0].into) * glm::length(s[1].into)) +
                         glm::dot(b[1].into, s[0].into) / (glm::length(b[1].into) * glm::length(s[0].into));
  if (swapped > kept) std::swap(s[0], s[1]);
}

class Chains {
 public:
  explicit Chains(const Tracer& tracer) : tracer_(tracer) {
    for (const LimitSeam& seam : tracer.grid.seams) {
      const auto [first, second] = seam.nodes;
      const std::span<const SeamUse> uses = uses_of(tracer.grid, seam);
      if (is_smooth(tracer.grid, uses, first)) continue;
      const SeamEdge edge{first, second, uses};
      if (plain(edge) && uses.size() == 2) {
        // Beside extraordinary vertices the normals of patches differ by their error.
        const SeamSample middle = sample_seam(tracer, edge, first, 0.5);
        if (glm::dot(middle.sides[0].normal, middle.sides[1].normal) > kSmooth) continue;
      }
      at_node_[first].push_back(edges_.size());
      at_node_[second].push_back(edges_.size());
      edges_.push_back(edge);
    }
  }

  std::vector<Seam> run() {
    std::vector<Seam> seams;
    for (const auto& [node, edges] : at_node_) {
      if (!ends_at(node)) continue;
      for (const size_t e : edges) {
        if (!edges_[e].taken) seams.push_back(walk(e, node));
      }
    }
    for (size_t e = 0; e < edges_.size(); ++e) {
      if (!edges_[e].taken) seams.push_back(walk(e, edges_[e].a));
    }
    return seams;
  }

 private:
  /// Three and more sheets at an edge, and sheets that disagree on the outside, are told apart edge by edge.
  bool plain(const SeamEdge& edge) const {
    if (edge.uses.size() == 1) return true;
    if (edge.uses.size() != 2) return false;
    const UseCorners one = corners_of(tracer_.grid, edge.uses[0], edge.a), two = corners_of(tracer_.grid, edge.uses[1], edge.a);
    return (one.from == edge.uses[0].from) != (two.from == edge.uses[1].from);
  }
  bool ends_at(std::uint32_t node) const {
    const auto& edges = at_node_.at(node);
    if (edges.size() != 2) return true;
    const SeamEdge &a = edges_[edges[0]], &b = edges_[edges[1]];
    return !plain(a) || !plain(b) || a.uses.size() != b.uses.size();
  }

  Seam walk(size_t first, std::uint32_t start) {
    Seam seam;
    seam.line_class = edges_[first].uses.size() == 1 ? LineClass::boundary : LineClass::crease;
    std::uint32_t node = start;
    for (size_t e = first;;) {
      SeamEdge& edge = edges_[e];
      edge.taken = true;
      append(edge, node, seam);
      node = edge.a == node ? edge.b : edge.a;
      if (node == start || ends_at(node)) break;
      const auto& here = at_node_.at(node);
      e = here[0] == e ? here[1] : here[0];
      if (edges_[e].taken) break;
    }
    seam.closed = node == start && !ends_at(node) && seam.samples.size() > 3;
    if (seam.closed) seam.samples.pop_back();
    return seam;
  }

  void append(const SeamEdge& edge, std::uint32_t from, Seam& seam) const {
    std::vector<SeamSample> points{sample_seam(tracer_, edge, from, 0.0)};
    const SeamSample last = sample_seam(tracer_, edge, from, 1.0);
    refine(tracer_, edge, from, 0.0, points.front(), 1.0, last, kDeepest, points);
    points.push_back(last);
    for (size_t i = 0; i < points.size(); ++i) {
      if (!seam.samples.empty()) {
        if (i == 0) continue;  // The node, which the edge before ended with.
        align(seam.samples.back(), points[i]);
      }
      seam.samples.push_back(points[i]);
    }
  }

  const Tracer& tracer_;
  std::vector<SeamEdge> edges_;
  std::map<std::uint32_t, std::vector<size_t>> at_node_;
};

}  // namespace

std::vector<Seam> limit_seams(const PlacedLimitSurface& placed, const LimitGrid& grid, const Camera& camera, double tolerance_px,
                              int object) {
  const Tracer tracer{placed, grid, camera, tolerance_px, object};
  return Chains(tracer).run();
}

}  // namespace limn
