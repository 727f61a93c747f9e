// Where connected parts of a mesh go through each other: edges of the one, faces of the other.

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>

#include "raymarch/lines/mesh_tree.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr double kInPlane = 1e-5;  // the sine of the angle between an edge and a plane
constexpr double kBeside = 1e-5;   // of the extent: hits in single precision lie that near to what they hit
constexpr size_t kPart = 4096;     // triangles

/// Space in even cells, each of which knows whether one part reaches into it, or several.
class PartCells {
 public:
  PartCells(const Box& box, size_t triangles) : lower_(box.lower) {
    constexpr double kMostCells = 160.0;  // along the longest side
    const double most = std::clamp(2.0 * std::cbrt(static_cast<double>(triangles)), 8.0, kMostCells);
    const glm::dvec3 size = box.size();
    per_unit_ = box.longest_side() > 0.0 ? most / box.longest_side() : 0.0;
    for (int k = 0; k < 3; ++k) counts_[k] = static_cast<int>(size[k] * per_unit_) + 1;
    parts_ = std::vector<std::atomic<std::uint32_t>>(static_cast<size_t>(counts_.x) * static_cast<size_t>(counts_.y) *
                                                     static_cast<size_t>(counts_.z));
  }

  void mark(const Box& box, std::uint32_t part) {
    any_cell(box, [&](std::atomic<std::uint32_t>& cell) {
      std::uint32_t none = kNone;
      if (!cell.compare_exchange_strong(none, part + kFirst, std::memory_order_relaxed) && none != part + kFirst)
        cell.store(kSeveral, std::memory_order_relaxed);
      return false;
    });
  }
  bool several(const Box& box) {
    return any_cell(box, [](const std::atomic<std::uint32_t>& cell) { return cell.load(std::memory_order_relaxed) == kSeveral; });
  }

 private:
  static constexpr std::uint32_t kNone = 0, kSeveral = 1, kFirst = 2;

  template <class Test>
  bool any_cell(const Box& box, const Test& test) {
    glm::ivec3 first, last;
    for (int k = 0; k < 3; ++k) {
      const auto at = [&](double v) { return static_cast<int>(std::clamp((v - lower_[k]) * per_unit_, 0.0, counts_[k] - 1.0)); };
      first[k] = at(box.lower[k]);
      last[k] = at(box.upper[k]);
    }
    for (int z = first.z; z <= last.z; ++z) {
      for (int y = first.y; y <= last.y; ++y) {
        for (int x = first.x; x <= last.x; ++x) {
          if (test(parts_[(static_cast<size_t>(z) * static_cast<size_t>(counts_.y) + static_cast<size_t>(y)) *
                              static_cast<size_t>(counts_.x) +
                          static_cast<size_t>(x)]))
            return true;
        }
      }
    }
    return false;
  }

  glm::dvec3 lower_{0.0};
  double per_unit_ = 0.0;
  glm::ivec3 counts_{1};
  std::vector<std::atomic<std::uint32_t>> parts_{};
};

}  // namespace

/// Those in cells that several parts reach into: no other triangle meets another part.
std::vector<char> MeshTree::near_other_parts() const {
  Box all;
  for (const glm::dvec3& p : positions_) all = include(all, p);
  std::vector<char> near(triangles_.size(), 0);
  if (all.empty()) return near;
  const glm::dvec3 beside(kBeside * extent_);
  const auto box_of = [&](const LayerTriangle& triangle) {
    Box box;
    for (const std::uint32_t corner : triangle.corners) box = include(box, positions_[corner]);
    return Box{box.lower - beside, box.upper + beside};
  };
  PartCells cells(all, triangles_.size());
  parallel_parts(triangles_.size(), kPart, [&](const IndexRange<size_t>& range) {
    for (size_t f = range.begin(); f < range.end(); ++f) cells.mark(box_of(triangles_[f]), triangles_[f].part);
  });
  parallel_parts(triangles_.size(), kPart, [&](const IndexRange<size_t>& range) {
    for (size_t f = range.begin(); f < range.end(); ++f) near[f] = cells.several(box_of(triangles_[f]));
  });
  return near;
}

/// In the order of the edges; faces in theirs.
std::vector<MeshTree::EdgeFaces> MeshTree::faces_of_edges(const std::vector<char>& asked) const {
  struct Use {
    std::uint32_t a, b, face;
    bool operator<(const Use& other) const { return std::tie(a, b, face) < std::tie(other.a, other.b, other.face); }
  };
  std::vector<Use> uses;
  for (std::uint32_t f = 0; f < triangles_.size(); ++f) {
    if (asked[f] == 0) continue;
    for (size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles_[f].corners[k], b = triangles_[f].corners[(k + 1) % 3];
      uses.push_back({std::min(a, b), std::max(a, b), f});
    }
  }
  parallel_sort(uses.begin(), uses.end());
  std::vector<EdgeFaces> edges;
  for (const Use& use : uses) {
    if (edges.empty() || edges.back().a != use.a || edges.back().b != use.b) edges.push_back({use.a, use.b, {}});
    edges.back().faces.push_back(use.face);
  }
  return edges;
}

/// By lengths along it.
std::vector<LayerHit> MeshTree::hits_of_edge(std::uint32_t a, std::uint32_t b) const {
  const glm::dvec3 &from = positions_[a], &to = positions_[b];
  const double length = glm::distance(from, to);
  if (!(length > 0.0)) return {};
  if (!exact_) return hits_along(from, (to - from) / length, length);
  std::vector<LayerHit> hits;
  for (const ExactHit& hit : exact_hits().through({.from = from, .to = to, .vertices = {a, b}}))
    hits.push_back({hit.share * length, hit.triangle});
  return hits;
}

PartMeetings MeshTree::find_meetings() const {
  PartMeetings result;
  const std::vector<EdgeFaces> faces_of = faces_of_edges(near_other_parts());
  std::vector<std::vector<LayerHit>> hits_of(faces_of.size());
  parallel_parts(faces_of.size(), size_t{256}, [&](const IndexRange<size_t>& range) {
    for (size_t e = range.begin(); e < range.end(); ++e) {
      hits_of[e] = hits_of_edge(faces_of[e].a, faces_of[e].b);
    }
  });
  // Each pair of faces that go through each other is left where an edge of the one meets the other.
  std::vector<PartMeeting>& hits = result.places;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<size_t>> of_pair;
  for (size_t e = 0; e < faces_of.size(); ++e) {
    const std::vector<std::uint32_t>& faces = faces_of[e].faces;
    const glm::dvec3 &a = positions_[faces_of[e].a], &b = positions_[faces_of[e].b];
    const double length = glm::distance(a, b);
    for (const LayerHit& hit : hits_of[e]) {
      const LayerTriangle& other = triangles_[hit.triangle];
      if (other.part == triangles_[faces[0]].part) continue;
      const LayerTriangle& own = triangles_[faces[0]];
      const glm::dvec3 own_normal = glm::normalize(normal_of(own)), other_normal = glm::normalize(normal_of(other));
      // An edge in a face's plane goes through it nowhere, whatever rounding says.
      if (std::fabs(glm::dot(b - a, other_normal)) < kInPlane * length) continue;
      const bool lower = own.part < other.part;
      hits.push_back({glm::mix(a, b, hit.t / length), lower ? own_normal : other_normal, lower ? other_normal : own_normal, other.object,
                      own.object, other.material, own.material});
      for (const std::uint32_t face : faces)
        of_pair[{std::min(face, hit.triangle), std::max(face, hit.triangle)}].push_back(hits.size() - 1);
    }
  }
  std::vector<std::vector<NextMeeting>>& next = result.next;
  next.resize(hits.size());
  for (const auto& [pair, ends] : of_pair) {
    if (ends.size() != 2) continue;
    next[ends[0]].push_back({ends[1], {pair.first, pair.second}});
    next[ends[1]].push_back({ends[0], {pair.first, pair.second}});
  }
  return result;
}

}  // namespace limn
