#include "subdiv/dual_contour.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "sdf/parallel.h"
#include "subdiv/mesh_audit.h"
#include "subdiv/surface_snap.h"

namespace limn {
namespace {

/// Corners of a cell: bit 0 is x, bit 1 y, bit 2 z. Its 12 edges: 4 along each axis.
struct CellEdge {
  int from, to, axis;
};
constexpr std::array<CellEdge, 12> kEdges = {
    {{0, 1, 0}, {2, 3, 0}, {4, 5, 0}, {6, 7, 0}, {0, 2, 1}, {1, 3, 1}, {4, 6, 1}, {5, 7, 1}, {0, 4, 2}, {1, 5, 2}, {2, 6, 2}, {3, 7, 2}}};
/// The faces by their corners in a ring.
constexpr std::array<std::array<int, 4>, 6> kFaces = {{{0, 2, 6, 4}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 5, 7, 6}}};

int edge_between(int a, int b) {
  for (int e = 0; e < 12; ++e)
    if ((kEdges[static_cast<size_t>(e)].from == a && kEdges[static_cast<size_t>(e)].to == b) ||
        (kEdges[static_cast<size_t>(e)].from == b && kEdges[static_cast<size_t>(e)].to == a))
      return e;
  return -1;
}

/// Cells to a side of the blocks that share a shortened field.
constexpr int kBlock = 8;

glm::dvec3 unit_gradient(FieldEvaluator& evaluator, const glm::dvec3& p) {
  glm::dvec3 gradient;
  double value = 0.0;
  evaluator.gradients(std::span(&p, 1), std::span(&value, 1), std::span(&gradient, 1));
  const double length = glm::length(gradient);
  return length > 0.0 ? gradient / length : glm::dvec3(0.0);
}

class DualContour {
 public:
  DualContour(const Field& field, int cells) : field_(field) {
    const Box box = field.traits().bounds;
    step_ = box.longest_side() / cells;
    // Nodes half a cell off the middle of the box, so that faces of symmetric shapes do not lie on them.
    for (int axis = 0; axis < 3; ++axis) {
      const int half = static_cast<int>(std::ceil(0.5 * box.size()[axis] / step_ - 1e-9)) + 2;
      count_[axis] = 2 * half;
      lower_[axis] = box.center()[axis] - (half - 0.5) * step_;
    }
  }

  Mesh run() {
    sample();
    for (int z = 0; z + 1 < count_.z; ++z)
      for (int y = 0; y + 1 < count_.y; ++y)
        for (int x = 0; x + 1 < count_.x; ++x) cell({x, y, z});
    for (int z = 1; z + 1 < count_.z; ++z)
      for (int y = 1; y + 1 < count_.y; ++y)
        for (int x = 1; x + 1 < count_.x; ++x)
          for (int axis = 0; axis < 3; ++axis) quad({x, y, z}, axis);
    return std::move(mesh_);
  }

 private:
  size_t node_index(const glm::ivec3& at) const {
    return (static_cast<size_t>(at.z) * static_cast<size_t>(count_.y) + static_cast<size_t>(at.y)) * static_cast<size_t>(count_.x) +
           static_cast<size_t>(at.x);
  }
  glm::dvec3 world(const glm::ivec3& at) const { return lower_ + step_ * glm::dvec3(at); }
  static glm::ivec3 corner(const glm::ivec3& cell, int i) { return cell + glm::ivec3(i & 1, (i >> 1) & 1, (i >> 2) & 1); }
  double value(const glm::ivec3& at) const { return values_[node_index(at)]; }
  bool inside(const glm::ivec3& at) const { return value(at) < 0.0; }

  glm::ivec3 block_count() const { return (count_ + (kBlock - 1)) / kBlock; }
  FieldEvaluator& evaluator(const glm::ivec3& cell) {
    const glm::ivec3 at = cell / kBlock, blocks = block_count();
    return evaluators_[static_cast<size_t>((at.z * blocks.y + at.y) * blocks.x + at.x)];
  }

  /// The signs at the nodes: those of a block that the surface does not reach are known from bounds, elsewhere a block asks only the parts
  /// of the field that matter in it.
  void sample() {
    values_.resize(static_cast<size_t>(count_.x) * static_cast<size_t>(count_.y) * static_cast<size_t>(count_.z));
    sheet_.assign(values_.size() * 12, -1);
    const glm::ivec3 blocks = block_count();
    const int total = blocks.x * blocks.y * blocks.z;
    evaluators_.clear();
    for (int b = 0; b < total; ++b) evaluators_.emplace_back(field_);
    parallel_for(0, total, [&](int b) {
      const glm::ivec3 first = kBlock * glm::ivec3(b % blocks.x, b / blocks.x % blocks.y, b / (blocks.x * blocks.y));
      const glm::ivec3 end = glm::min(first + kBlock, count_);
      // A cell has nodes on the far side of its block, too.
      const Box box = dilate({world(first), world(end)}, 1e-6 * step_);
      FieldEvaluator whole(field_);
      const Interval bounds = whole.bounds(box);
      if (!bounds.contains(0.0)) return fill(first, end, bounds.lower);
      FieldEvaluator& own = evaluators_[static_cast<size_t>(b)];
      own = FieldEvaluator(whole.restricted(box));
      sample(own, first, end);
    });
  }

  void fill(const glm::ivec3& first, const glm::ivec3& end, double value) {
    for (int z = first.z; z < end.z; ++z)
      for (int y = first.y; y < end.y; ++y)
        std::fill_n(values_.begin() + static_cast<std::ptrdiff_t>(node_index({first.x, y, z})), end.x - first.x, value);
  }

  void sample(FieldEvaluator& evaluator, const glm::ivec3& first, const glm::ivec3& end) {
    std::vector<glm::dvec3> row(static_cast<size_t>(end.x - first.x));
    for (int z = first.z; z < end.z; ++z)
      for (int y = first.y; y < end.y; ++y) {
        for (int x = first.x; x < end.x; ++x) row[static_cast<size_t>(x - first.x)] = world({x, y, z});
        evaluator.values(row, std::span(values_).subspan(node_index({first.x, y, z}), row.size()));
      }
  }

  /// Where the field changes sign between two nodes (bisection: fields may jump in slope).
  glm::dvec3 crossing(FieldEvaluator& evaluator, const glm::ivec3& a, const glm::ivec3& b) {
    glm::dvec3 in = world(a), out = world(b);
    if (!inside(a)) std::swap(in, out);
    for (int i = 0; i < 24; ++i) {
      const glm::dvec3 middle = 0.5 * (in + out);
      (evaluator.value(middle) < 0.0 ? in : out) = middle;
    }
    return 0.5 * (in + out);
  }

  /// Joins the crossed edges of the cell that belong to one sheet: across each face the surface runs from edge to edge; where it crosses
  /// a face twice, the middle of the face tells which corners hang together, and both cells at the face find the same.
  void join_sheets(const glm::ivec3& cell, std::array<int, 12>& root) {
    std::iota(root.begin(), root.end(), 0);
    const auto find = [&root](int e) {
      while (root[static_cast<size_t>(e)] != e) e = root[static_cast<size_t>(e)];
      return e;
    };
    for (const std::array<int, 4>& face : kFaces) {
      std::array<int, 4> crossed{};
      int count = 0;
      for (size_t i = 0; i < 4; ++i)
        if (inside(corner(cell, face[i])) != inside(corner(cell, face[(i + 1) % 4])))
          crossed[static_cast<size_t>(count++)] = edge_between(face[i], face[(i + 1) % 4]);
      if (count == 2) root[static_cast<size_t>(find(crossed[0]))] = find(crossed[1]);
      if (count != 4) continue;
      // Edge i joins ring corners i and i + 1. The corner that stands alone has the sign that the middle has not.
      const glm::dvec3 middle = 0.25 * (world(corner(cell, face[0])) + world(corner(cell, face[1])) + world(corner(cell, face[2])) +
                                        world(corner(cell, face[3])));
      const bool middle_inside = evaluator(cell).value(middle) < 0.0;
      const size_t alone = inside(corner(cell, face[0])) != middle_inside ? 0 : 1;
      for (const size_t i : {alone, alone + 2}) root[static_cast<size_t>(find(crossed[i % 4]))] = find(crossed[(i + 3) % 4]);
    }
    for (int e = 0; e < 12; ++e) root[static_cast<size_t>(e)] = find(e);
  }

  void cell(const glm::ivec3& at) {
    int inside_count = 0;
    for (int i = 0; i < 8; ++i) inside_count += inside(corner(at, i));
    if (inside_count == 0 || inside_count == 8) return;
    std::array<int, 12> root{};
    join_sheets(at, root);
    for (int sheet = 0; sheet < 12; ++sheet) {
      std::vector<glm::dvec3> points, normals;
      const auto vertex = static_cast<std::int32_t>(mesh_.vertex_count());
      for (int e = 0; e < 12; ++e) {
        const CellEdge& edge = kEdges[static_cast<size_t>(e)];
        const glm::ivec3 a = corner(at, edge.from), b = corner(at, edge.to);
        if (root[static_cast<size_t>(e)] != sheet || inside(a) == inside(b)) continue;
        sheet_[12 * node_index(at) + static_cast<size_t>(e)] = vertex;
        points.push_back(crossing(evaluator(at), a, b));
        normals.push_back(unit_gradient(evaluator(at), points.back()));
      }
      if (points.empty()) continue;
      glm::dvec3 mean(0.0);
      for (const glm::dvec3& p : points) mean += p;
      mean /= static_cast<double>(points.size());
      const glm::dvec3 first = world(at), last = world(at + 1);
      mesh_.positions.push_back(glm::clamp(meet_planes(points, normals, mean), first, last));
    }
  }

  /// The four cells around a lattice edge, each with the vertex of the sheet that crosses it.
  void quad(const glm::ivec3& at, int axis) {
    glm::ivec3 end = at;
    ++end[axis];
    const bool from_inside = inside(at);
    if (from_inside == inside(end)) return;
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    std::array<std::int32_t, 4> corners{};
    constexpr int kU[] = {-1, 0, 0, -1}, kV[] = {-1, -1, 0, 0};
    for (size_t i = 0; i < 4; ++i) {
      glm::ivec3 cell = at;
      cell[u] += kU[i], cell[v] += kV[i];
      const glm::ivec3 from = at - cell;
      const int bits = from.x + 2 * from.y + 4 * from.z;
      corners[i] = sheet_[12 * node_index(cell) + static_cast<size_t>(edge_between(bits, bits | (1 << axis)))];
    }
    if (!from_inside) std::reverse(corners.begin(), corners.end());
    mesh_.face_sizes.push_back(4);
    mesh_.corner_vertices.insert(mesh_.corner_vertices.end(), corners.begin(), corners.end());
  }

  Field field_;
  std::vector<FieldEvaluator> evaluators_;  ///< Of the blocks; where the surface is, of what matters there.
  double step_ = 0.0;
  glm::dvec3 lower_{0.0};
  glm::ivec3 count_{0};
  std::vector<double> values_;
  std::vector<std::int32_t> sheet_;  ///< Vertex of each edge of each cell, 12 a node.
  Mesh mesh_;
};

}  // namespace

Mesh dual_contour(const Field& field, int cells) { return DualContour(field, cells).run(); }

std::optional<Topology> topology_of(const Mesh& mesh) {
  if (mesh.face_sizes.empty()) return std::nullopt;
  const std::vector<Edge> edges = build_edges(mesh);
  for (const Edge& edge : edges)
    if (edge.face_count != 2 || !edge.consistent) return std::nullopt;
  std::vector<std::int32_t> part;
  const std::int32_t parts = part_of_faces(mesh, part);
  const auto count = [](size_t n) { return static_cast<std::int64_t>(n); };
  return Topology{parts, count(mesh.vertex_count()) - count(edges.size()) + count(mesh.face_count())};
}

}  // namespace limn
