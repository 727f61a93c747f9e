#include "raymarch/local/local_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "raymarch/local/local_demand.h"
#include "sdf/error.h"
#include "sdf/memory_text.h"
#include "sdf/parallel.h"
#include "sdf/size_error.h"

namespace limn {
namespace {

/// No border asks for more halvings of an edge.
constexpr int kMostPasses = 32;
/// How often a facet that is folded across a crease is split in the hope that a middle comes to lie on it: each time what is wrong becomes
/// half as wide, and twice as many.
constexpr int kMostFoldedSplits = 4;

/// The same where edges follow all creases: splitting ends the fold, but where a surface has no tangent plane.
constexpr int kMostUnfolds = 12;

std::uint64_t key_of(std::uint32_t a, std::uint32_t b) { return (std::uint64_t{std::min(a, b)} << 32) | std::max(a, b); }

size_t next(size_t k) { return (k + 1) % 3; }

/// Whether an edge becomes two shorter ones, neither of which is much of the whole: where the surface turns back, as at the end of a thin
/// wall, the middle may come to lie on one of the ends, and splitting would go on for ever.
bool halves(const LocalTriangles& mesh, const LocalEdge& edge, const glm::dvec3& middle) {
  constexpr double kMost = 0.75;
  const EdgeSide& side = edge.sides[edge.sides[0].triangle ? 0 : 1];
  const auto k = static_cast<size_t>(side.corner);
  const glm::dvec3 a = mesh.positions[side.triangle->vertices[k]], b = mesh.positions[side.triangle->vertices[next(k)]];
  const double most = kMost * glm::distance(a, b);
  return glm::distance(a, middle) < most && glm::distance(b, middle) < most;
}

/// The middles of edges, made when an edge first appears and kept until it is split.
class Middles {
 public:
  /// Makes those that are missing among the triangles from `first` on. Edges of others are there already.
  void update(const LocalTriangles& mesh, const LocalSource& source, const std::vector<char>& is_new) {
    std::vector<LocalEdge> edges;
    std::unordered_map<std::uint64_t, std::uint32_t> missing;
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
      if (is_new[t]) ask(mesh.triangles[t], edges, missing);
    }
    // The other side of a new edge may be a triangle that stays: only where an edge was there before, and then its middle is known.
    std::vector<EdgeMiddle> made(edges.size());
    source.middles(mesh, edges, made);
    for (size_t i = 0; i < edges.size(); ++i)
      made[i].halves = made[i].crosses || source.has_parameters || halves(mesh, edges[i], made[i].position);
    for (const auto& [key, index] : missing) known_[key] = made[index];
  }
  const EdgeMiddle& at(std::uint32_t a, std::uint32_t b) const { return known_.at(key_of(a, b)); }
  /// The vertex that the middle of a split edge becomes.
  std::uint32_t vertex(std::uint32_t a, std::uint32_t b, LocalTriangles& mesh) {
    const auto [found, inserted] = vertices_.try_emplace(key_of(a, b), static_cast<std::uint32_t>(mesh.positions.size()));
    if (inserted) {
      mesh.positions.push_back(at(a, b).position);
      if (!mesh.colors.empty()) mesh.colors.push_back(0.5f * (mesh.colors[a] + mesh.colors[b]));
    }
    return found->second;
  }
  void forget_split() {
    for (const auto& [key, vertex] : vertices_) known_.erase(key);
    vertices_.clear();
  }

 private:
  void ask(const LocalTriangle& triangle, std::vector<LocalEdge>& edges, std::unordered_map<std::uint64_t, std::uint32_t>& missing) {
    for (size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangle.vertices[k], b = triangle.vertices[next(k)];
      if (known_.count(key_of(a, b)) > 0) continue;
      const auto [found, inserted] = missing.try_emplace(key_of(a, b), static_cast<std::uint32_t>(edges.size()));
      if (inserted) edges.push_back({});
      edges[found->second].sides[a < b ? 0 : 1] = {&triangle, static_cast<int>(k)};
    }
  }
  std::unordered_map<std::uint64_t, EdgeMiddle> known_{};
  std::unordered_map<std::uint64_t, std::uint32_t> vertices_{};
};

TriangleSample sample_of(const LocalTriangles& mesh, const Middles& middles, const LocalTriangle& triangle) {
  TriangleSample sample;
  sample.vertices = triangle.vertices;
  sample.corner_normals = triangle.normals;
  for (size_t k = 0; k < 3; ++k) {
    const std::uint32_t a = triangle.vertices[k], b = triangle.vertices[next(k)];
    const EdgeMiddle& middle = middles.at(a, b);
    const size_t side = a < b ? 0 : 1;
    sample.corners[k] = mesh.positions[a];
    sample.middles[k] = middle.position;
    sample.middle_normals[k] = middle.normals[side];
    sample.beyond[k] = middle.normals[1 - side];
    sample.crease[k] = middle.crease;
    sample.crosses[k] = middle.crosses;
    sample.halves[k] = middle.halves;
  }
  return sample;
}

/// A corner of the triangles that a split one becomes: a corner of its own, or the middle of the edge from that corner.
struct Piece {
  std::array<int, 3> corners{};  ///< 0..2: corners, 3..5: middles.
};

/// Of the quadrangle that is left when edges `first` and the next are split: whether its diagonal runs from the corner, not from the
/// middle. Where one of the two crosses a crease that ends at the opposite corner, along the crease; else the shorter one.
bool diagonal_from_corner(const TriangleSample& sample, size_t first) {
  const size_t second = next(first), third = next(second);
  if (sample.crosses[first] != sample.crosses[second]) return sample.crosses[second];
  return glm::distance(sample.corners[first], sample.middles[second]) < glm::distance(sample.middles[first], sample.corners[third]);
}

/// By which edges are split.
std::vector<Piece> pieces_of(unsigned split, const TriangleSample& sample) {
  const int count = ((split & 1u) ? 1 : 0) + ((split & 2u) ? 1 : 0) + ((split & 4u) ? 1 : 0);
  if (count == 3) return {{{0, 3, 5}}, {{3, 1, 4}}, {{5, 4, 2}}, {{3, 4, 5}}};
  // Turned so that the split edge is edge 0, or the split edges are 0 and 1.
  int turn = 0;
  const auto has = [&](int k) { return (split & (1u << ((k + turn) % 3))) != 0; };
  while (!(count == 1 ? has(0) : has(0) && has(1))) ++turn;
  const auto corner = [&](int k) { return (k + turn) % 3; };
  const auto middle = [&](int k) { return 3 + (k + turn) % 3; };
  if (count == 1) return {{{corner(0), middle(0), corner(2)}}, {{middle(0), corner(1), corner(2)}}};
  const Piece tip{{middle(0), corner(1), middle(1)}};
  if (diagonal_from_corner(sample, static_cast<size_t>(turn)))
    return {tip, {{corner(0), middle(0), middle(1)}}, {{corner(0), middle(1), corner(2)}}};
  return {tip, {{corner(0), middle(0), corner(2)}}, {{middle(0), middle(1), corner(2)}}};
}

/// A corner whose normal only its triangle's side knows.
struct OpenNormal {
  size_t triangle = 0;
  size_t corner = 0;
};

class Splitter {
 public:
  Splitter(LocalTriangles& mesh, Middles& middles) : mesh_(mesh), middles_(middles) {}

  void keep(const LocalTriangle& triangle) { out_.push_back(triangle), is_new_.push_back(0); }
  void split(const LocalTriangle& triangle, unsigned edges) {
    const TriangleSample sample = sample_of(mesh_, middles_, triangle);
    const int folded = triangle.folded + (is_folded(sample.corners, sample.corner_normals) ? 1 : 0);
    const bool crossed = sample.crosses[0] || sample.crosses[1] || sample.crosses[2];
    for (const Piece& piece : pieces_of(edges, sample)) {
      LocalTriangle child{{}, {}, {}, triangle.patch, triangle.face, folded};
      for (size_t k = 0; k < 3; ++k) set_corner(triangle, sample, piece.corners[k], k, crossed, child);
      out_.push_back(child), is_new_.push_back(1);
    }
  }
  /// The corners at creases, then the triangles become the mesh's.
  std::vector<char> finish(const LocalSource& source) {
    if (source.crease_normals && !open_.empty()) {
      std::vector<CreaseCorner> corners;
      std::vector<glm::dvec3> normals;
      for (const OpenNormal& open : open_) {
        const LocalTriangle& triangle = out_[open.triangle];
        const auto position = [&](size_t k) { return mesh_.positions[triangle.vertices[k]]; };
        corners.push_back({position(open.corner), (position(0) + position(1) + position(2)) / 3.0});
        normals.push_back(triangle.normals[open.corner]);
      }
      source.crease_normals(corners, normals);
      for (size_t i = 0; i < open_.size(); ++i) out_[open_[i].triangle].normals[open_[i].corner] = normals[i];
    }
    mesh_.triangles = std::move(out_);
    return std::move(is_new_);
  }

 private:
  /// `crossed`: by a crease, so that the parts of the triangle lie on its two sides and share none of its corners' normals.
  void set_corner(const LocalTriangle& triangle, const TriangleSample& sample, int from, size_t k, bool crossed, LocalTriangle& child) {
    const auto i = static_cast<size_t>(from % 3);
    if (crossed || (from >= 3 && sample.crease[i])) open_.push_back({out_.size(), k});
    if (from < 3) {
      child.vertices[k] = triangle.vertices[i], child.normals[k] = triangle.normals[i], child.uv[k] = triangle.uv[i];
      return;
    }
    child.vertices[k] = middles_.vertex(triangle.vertices[i], triangle.vertices[next(i)], mesh_);
    child.normals[k] = sample.middle_normals[i];
    child.uv[k] = 0.5 * (triangle.uv[i] + triangle.uv[next(i)]);
  }
  LocalTriangles& mesh_;
  Middles& middles_;
  std::vector<LocalTriangle> out_{};
  std::vector<char> is_new_{};
  std::vector<OpenNormal> open_{};
};

void check_size(const LocalTriangles& mesh, const LocalSettings& settings, std::int64_t max_bytes) {
  // Of a triangle while it is refined, with its edges' middles.
  constexpr double kBytes = 700.0;
  const double bytes = kBytes * static_cast<double>(mesh.triangles.size());
  if (bytes <= static_cast<double>(max_bytes)) return;
  throw SizeError({"", "local", fmt::format("{}", settings.tolerance_px),
                   fmt::format("the mesh has more than {} triangles and needs more than {}", mesh.triangles.size(), memory_text(bytes)),
                   fmt::format("a larger tolerance (at most {})", memory_text(static_cast<double>(max_bytes)))});
}

/// Where a surface folds over itself no splitting makes facets lie along it, and each that is split leaves two that ask for more.
void check_that_it_settles(const LocalTriangles& mesh, size_t base_triangles, const LocalSettings& settings) {
  // Borders of the built-in scenes at 0.1 px take less than one triangle a pixel.
  constexpr double kMostPerPixel = 8.0, kMostPerBase = 8.0, kNeverTooMany = 1e6;
  double pixels = 0.0;
  for (const Camera& camera : settings.cameras) pixels += static_cast<double>(camera.width_px) * camera.height_px;
  const auto triangles = static_cast<double>(mesh.triangles.size());
  if (triangles <= std::max(kNeverTooMany, kMostPerPixel * pixels) + kMostPerBase * static_cast<double>(base_triangles)) return;
  throw InputError(
      {"", "local", fmt::format("{}", settings.tolerance_px),
       fmt::format("the mesh has {} triangles and still asks for more: its surface folds over itself, as where a face of a cage "
                   "is twisted",
                   mesh.triangles.size()),
       "a mesh that is as fine everywhere (level)"});
}

/// For LocalView::turns; within one side of a crease.
std::vector<double> turns_of(const LocalTriangles& mesh, const Camera& camera) {
  std::vector<double> turns(mesh.positions.size(), 0.0);
  for (const LocalTriangle& triangle : mesh.triangles) {
    std::array<double, 3> facing{};
    for (size_t k = 0; k < 3; ++k) facing[k] = glm::dot(triangle.normals[k], view_vector(camera, mesh.positions[triangle.vertices[k]]));
    for (size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangle.vertices[k], b = triangle.vertices[next(k)];
      const double length = glm::distance(mesh.positions[a], mesh.positions[b]);
      if (!(length > 0.0)) continue;
      const double turn = std::abs(facing[k] - facing[next(k)]) / length;
      turns[a] = std::max(turns[a], turn), turns[b] = std::max(turns[b], turn);
    }
  }
  return turns;
}

/// Where a surface turns within itself, an edge may keep to it while the ones that pass beside it are asked to be split, each time to a
/// narrower needle in the surface's parameters. Needles are split across, too.
void split_needles(const LocalTriangles& mesh, std::unordered_map<std::uint64_t, char>& split) {
  constexpr double kLeastHeight = 0.05;  // over the longest side
  for (bool any = true; any;) {
    any = false;
    for (const LocalTriangle& triangle : mesh.triangles) {
      const auto key = [&](size_t k) { return key_of(triangle.vertices[k], triangle.vertices[next(k)]); };
      const std::array<glm::dvec2, 3> sides{triangle.uv[1] - triangle.uv[0], triangle.uv[2] - triangle.uv[1],
                                            triangle.uv[0] - triangle.uv[2]};
      size_t longest = 0;
      for (size_t k = 1; k < 3; ++k)
        if (glm::dot(sides[k], sides[k]) > glm::dot(sides[longest], sides[longest])) longest = k;
      const double twice_area = std::abs(sides[0].x * sides[1].y - sides[0].y * sides[1].x);
      if (twice_area >= kLeastHeight * glm::dot(sides[longest], sides[longest]) || split.count(key(longest)) > 0) continue;
      if (split.count(key(0)) + split.count(key(1)) + split.count(key(2)) == 0) continue;
      any = split.try_emplace(key(longest), 1).second;
    }
  }
}

/// One pass over the triangles that are new: false where none of them asks for anything.
bool refine_once(LocalTriangles& mesh, Middles& middles, std::vector<char>& is_new, const LocalSource& source, std::span<LocalView> views,
                 const LocalSettings& settings, bool only_coarse) {
  middles.update(mesh, source, is_new);
  std::vector<unsigned> asked(mesh.triangles.size(), 0);
  for (LocalView& view : views) view.turns = turns_of(mesh, view.camera);
  parallel_for(size_t{0}, mesh.triangles.size(), [&](size_t t) {
    if (!is_new[t]) return;
    TriangleSample sample = sample_of(mesh, middles, mesh.triangles[t]);
    sample.coarse_px = source.coarse_px;
    sample.stays = source.has_folds && mesh.triangles[t].folded >= kMostFoldedSplits && is_folded(sample.corners, sample.corner_normals);
    sample.unfolds = !source.has_folds && mesh.triangles[t].folded < kMostUnfolds;
    asked[t] = edges_to_split(sample, views, settings, only_coarse);
  });
  std::unordered_map<std::uint64_t, char> split;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& v = mesh.triangles[t].vertices;
    for (size_t k = 0; k < 3; ++k)
      if (asked[t] & (1u << k)) split[key_of(v[k], v[next(k)])] = 1;
  }
  if (split.empty()) return false;
  if (source.has_parameters) split_needles(mesh, split);
  Splitter splitter(mesh, middles);
  for (const LocalTriangle& triangle : mesh.triangles) {
    unsigned edges = 0;
    for (size_t k = 0; k < 3; ++k)
      if (split.count(key_of(triangle.vertices[k], triangle.vertices[next(k)])) > 0) edges |= 1u << k;
    if (edges == 0)
      splitter.keep(triangle);
    else
      splitter.split(triangle, edges);
  }
  is_new = splitter.finish(source);
  middles.forget_split();
  return true;
}

}  // namespace

LocalTriangles refine_locally(LocalTriangles base, const LocalSource& source, const LocalSettings& settings, std::int64_t max_bytes) {
  std::vector<LocalView> views;
  views.reserve(settings.cameras.size());
  for (const Camera& camera : settings.cameras) views.push_back({camera, {}, {}});
  LocalTriangles mesh = std::move(base);
  const size_t base_triangles = mesh.triangles.size();
  Middles middles;
  // The coarse surface first: it says what is hidden.
  for (const bool only_coarse : {true, false}) {
    std::vector<char> is_new(mesh.triangles.size(), 1);
    if (!only_coarse)
      for (LocalView& view : views) view.hidden = hidden_parts(mesh, view.camera);
    for (int pass = 0; pass < kMostPasses; ++pass) {
      if (!refine_once(mesh, middles, is_new, source, views, settings, only_coarse)) break;
      check_size(mesh, settings, max_bytes);
      check_that_it_settles(mesh, base_triangles, settings);
    }
  }
  return mesh;
}

Mesh as_mesh(const LocalTriangles& local, const Mesh& base_mesh) {
  Mesh mesh;
  mesh.positions = local.positions;
  mesh.vertex_colors = local.colors;
  copy_names(base_mesh, mesh);
  mesh.face_sizes.assign(local.triangles.size(), 3);
  for (const LocalTriangle& triangle : local.triangles) {
    for (size_t k = 0; k < 3; ++k) {
      mesh.corner_vertices.push_back(static_cast<std::int32_t>(triangle.vertices[k]));
      mesh.corner_normals.push_back(glm::vec3(triangle.normals[k]));
    }
    const auto face = static_cast<size_t>(triangle.face);
    if (!base_mesh.face_materials.empty()) mesh.face_materials.push_back(base_mesh.face_materials[face]);
    if (!base_mesh.face_groups.empty()) mesh.face_groups.push_back(base_mesh.face_groups[face]);
  }
  return mesh;
}

}  // namespace limn
