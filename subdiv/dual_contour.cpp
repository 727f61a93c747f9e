#include "subdiv/dual_contour.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include "subdiv/field_lattice.h"
#include "subdiv/local_field.h"
#include "subdiv/mesh_audit.h"
#include "subdiv/surface_snap.h"
#include "subdiv/thin_walls.h"

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

/// Rows of cells whose vertices and quads one thread makes, so that they have the same numbers on any number of threads.
constexpr size_t kRows = 64;

/// Where the surface crosses an edge of the lattice.
struct Crossing {
  glm::dvec3 point{0.0}, normal{0.0};
};

/// What one block finds on the edges and faces that begin at its nodes.
struct BlockFinds {
  std::vector<size_t> edges{};  ///< As numbered by FieldLattice::edge_index.
  std::vector<Crossing> crossings{};
  std::vector<size_t> faces{};  ///< Crossed twice; as numbered by FieldLattice::edge_index.
};

/// Nodes are put back at most so often.
constexpr int kMostRounds = 8;

/// Vertices and quads of some rows of cells.
struct RowFinds {
  std::vector<glm::dvec3> positions{};
  std::vector<std::int32_t> corners{};
};

class DualContour {
 public:
  DualContour(const Field& field, int cells, ThinWalls thin_walls) : lattice_(sample_lattice(field, cells)) {
    if (thin_walls == ThinWalls::kept) move_nodes_into_walls(field, lattice_);
  }

  Mesh run() {
    Mesh mesh;
    for (int round = 0;; ++round) {
      find_crossings();
      make_vertices(mesh);
      std::vector<size_t> nodes = moved_nodes_at_pinches();
      if (nodes.empty() || round == kMostRounds) break;
      put_back(lattice_, std::move(nodes));
    }
    make_quads(mesh);
    return mesh;
  }

 private:
  static glm::ivec3 corner(const glm::ivec3& cell, int i) { return cell + glm::ivec3(i & 1, (i >> 1) & 1, (i >> 2) & 1); }
  static glm::ivec3 along(const glm::ivec3& at, int axis) { return FieldLattice::along(at, axis); }
  bool inside(const glm::ivec3& at) const { return lattice_.inside(at); }

  /// Where the surface crosses the lattice's edges, each asked once for the four cells at it; and the signs in the middles of faces that it
  /// crosses twice.
  void find_crossings() {
    crossings_.clear(), crossed_twice_.clear();
    crossing_of_.assign(3 * lattice_.values.size(), -1);
    middle_inside_.assign(3 * lattice_.values.size(), 0);
    std::vector<BlockFinds> finds(lattice_.parts.size());
    lattice_.for_blocks([&](size_t b, const glm::ivec3& first, const glm::ivec3& end) {
      // Where bounds leave no surface in a block, it has no edge that is crossed.
      if (!lattice_.parts[b]) return;
      FieldEvaluator part(*lattice_.parts[b]);
      find_crossings(part, first, end, finds[b]);
      ask_middles(part, first, end, finds[b].faces);
    });
    for (const BlockFinds& block : finds) {
      for (size_t i = 0; i < block.edges.size(); ++i) crossing_of_[block.edges[i]] = static_cast<std::int32_t>(crossings_.size() + i);
      crossings_.insert(crossings_.end(), block.crossings.begin(), block.crossings.end());
      crossed_twice_.insert(crossed_twice_.end(), block.faces.begin(), block.faces.end());
    }
  }

  /// Where the field changes sign between two nodes (bisection: fields may jump in slope).
  void find_crossings(FieldEvaluator& evaluator, const glm::ivec3& first, const glm::ivec3& end, BlockFinds& finds) const {
    std::vector<glm::dvec3> in, out;
    FieldLattice::for_axes(first, end, [&](const glm::ivec3& a, int axis) {
      const glm::ivec3 b = along(a, axis);
      if (!lattice_.holds(b) || inside(a) == inside(b)) return;
      finds.edges.push_back(lattice_.edge_index(a, axis));
      in.push_back(lattice_.world(inside(a) ? a : b)), out.push_back(lattice_.world(inside(a) ? b : a));
    });
    const size_t count = in.size();
    std::vector<glm::dvec3> points(count), gradients(count);
    std::vector<double> values(count);
    for (int halving = 0; halving < 24; ++halving) {
      for (size_t i = 0; i < count; ++i) points[i] = 0.5 * (in[i] + out[i]);
      evaluator.values(points, values);
      for (size_t i = 0; i < count; ++i) (values[i] < 0.0 ? in[i] : out[i]) = points[i];
    }
    for (size_t i = 0; i < count; ++i) points[i] = 0.5 * (in[i] + out[i]);
    evaluator.gradients(points, values, gradients);
    finds.crossings.resize(count);
    for (size_t i = 0; i < count; ++i) finds.crossings[i] = {points[i], direction_of(gradients[i])};
  }

  /// The corners of the face across an axis that begins at a node, in a ring.
  static std::array<glm::ivec3, 4> ring(const glm::ivec3& at, int axis) {
    const int u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
    return {at, along(at, u), along(along(at, u), v), along(at, v)};
  }

  void ask_middles(FieldEvaluator& evaluator, const glm::ivec3& first, const glm::ivec3& end, std::vector<size_t>& faces) {
    std::vector<size_t> thin;
    std::vector<LatticeEdge> diagonals;
    FieldLattice::for_axes(first, end, [&](const glm::ivec3& at, int axis) {
      const std::array<glm::ivec3, 4> face = ring(at, axis);
      if (!lattice_.holds(face[2])) return;
      const bool in = inside(face[0]);
      if (inside(face[1]) == in || inside(face[2]) != in || inside(face[3]) == in) return;
      faces.push_back(lattice_.edge_index(at, axis));
      const std::array<glm::dvec3, 4> points = {lattice_.world(face[0]), lattice_.world(face[1]), lattice_.world(face[2]),
                                                lattice_.world(face[3])};
      const size_t index = faces.back();
      middle_inside_[index] = evaluator.value(0.25 * (points[0] + points[1] + points[2] + points[3])) < 0.0;
      const bool even = lattice_.is_moved(face[0]) || lattice_.is_moved(face[2]);
      const bool odd = lattice_.is_moved(face[1]) || lattice_.is_moved(face[3]);
      if (!even && !odd) return;
      if (even != odd) middle_inside_[index] = even ? in : !in;
      thin.push_back(index);
      for (const size_t i : {size_t{0}, size_t{1}}) diagonals.push_back({points[i], points[i + 2]});
    });
    if (thin.empty()) return;
    // A wall thinner than a cell misses the middle. It joins the corners that lie in it, and surely two of them where it keeps the others
    // apart.
    const std::vector<std::optional<double>> passes = find_thin_walls(evaluator, diagonals);
    const std::vector<char> apart = are_apart(evaluator, diagonals);
    for (size_t i = 0; i < thin.size(); ++i) {
      const bool even_apart = passes[2 * i].has_value() || apart[2 * i] != 0,
                 odd_apart = passes[2 * i + 1].has_value() || apart[2 * i + 1] != 0;
      if (even_apart == odd_apart) continue;
      const bool first_inside = lattice_.values[thin[i] / 3] < 0.0;
      middle_inside_[thin[i]] = even_apart ? !first_inside : first_inside;
    }
  }

  /// Joins the crossed edges of the cell that belong to one sheet: across each face the surface runs from edge to edge; where it crosses
  /// a face twice, the middle of the face tells which corners hang together, and both cells at the face find the same.
  void join_sheets(const glm::ivec3& cell, std::array<int, 12>& root) const {
    std::iota(root.begin(), root.end(), 0);
    const auto find = [&root](int e) {
      while (root[static_cast<size_t>(e)] != e) e = root[static_cast<size_t>(e)];
      return e;
    };
    for (size_t f = 0; f < kFaces.size(); ++f) {
      const std::array<int, 4>& face = kFaces[f];
      std::array<int, 4> crossed{};
      int count = 0;
      for (size_t i = 0; i < 4; ++i)
        if (inside(corner(cell, face[i])) != inside(corner(cell, face[(i + 1) % 4])))
          crossed[static_cast<size_t>(count++)] = edge_between(face[i], face[(i + 1) % 4]);
      if (count == 2) root[static_cast<size_t>(find(crossed[0]))] = find(crossed[1]);
      if (count != 4) continue;
      // Edge i joins ring corners i and i + 1. The corner that stands alone has the sign that the middle has not.
      const bool middle_inside = middle_inside_[lattice_.edge_index(corner(cell, face[0]), static_cast<int>(f) / 2)] != 0;
      const size_t alone = inside(corner(cell, face[0])) != middle_inside ? 0 : 1;
      for (const size_t i : {alone, alone + 2}) root[static_cast<size_t>(find(crossed[i % 4]))] = find(crossed[(i + 3) % 4]);
    }
    for (int e = 0; e < 12; ++e) root[static_cast<size_t>(e)] = find(e);
  }

  void cell(const glm::ivec3& at, std::vector<glm::dvec3>& positions) {
    int inside_count = 0;
    for (int i = 0; i < 8; ++i) inside_count += inside(corner(at, i));
    if (inside_count == 0 || inside_count == 8) return;
    std::array<int, 12> root{};
    join_sheets(at, root);
    for (int sheet = 0; sheet < 12; ++sheet) {
      std::vector<glm::dvec3> points, normals;
      for (int e = 0; e < 12; ++e) {
        const CellEdge& edge = kEdges[static_cast<size_t>(e)];
        const std::int32_t crossing = crossing_of_[lattice_.edge_index(corner(at, edge.from), edge.axis)];
        if (root[static_cast<size_t>(e)] != sheet || crossing < 0) continue;
        sheet_[12 * lattice_.node_index(at) + static_cast<size_t>(e)] = static_cast<std::int32_t>(positions.size());
        points.push_back(crossings_[static_cast<size_t>(crossing)].point);
        normals.push_back(crossings_[static_cast<size_t>(crossing)].normal);
      }
      if (points.empty()) continue;
      glm::dvec3 mean(0.0);
      for (const glm::dvec3& p : points) mean += p;
      mean /= static_cast<double>(points.size());
      Box box;
      for (int i = 0; i < 8; ++i) box = include(box, lattice_.world(corner(at, i)));
      positions.push_back(glm::clamp(meet_planes(points, normals, mean), box.lower, box.upper));
    }
  }

  std::int32_t vertex_of(const glm::ivec3& cell, int edge) const {
    return sheet_[12 * lattice_.node_index(cell) + static_cast<size_t>(edge)] + first_vertex_[row_of(cell) / kRows];
  }

  /// Of faces crossed twice, where both cells have one vertex for all four edges: four quads would meet in the edge between these two.
  /// What is not moved there stays.
  std::vector<size_t> moved_nodes_at_pinches() const {
    std::vector<size_t> nodes;
    for (const size_t face : crossed_twice_) {
      const size_t node = face / 3;
      const int axis = static_cast<int>(face % 3);
      const auto row = static_cast<size_t>(lattice_.count.x), layer = row * static_cast<size_t>(lattice_.count.y);
      const glm::ivec3 at(static_cast<int>(node % row), static_cast<int>(node % layer / row), static_cast<int>(node / layer));
      if (at[axis] == 0 || !is_pinched(at, axis)) continue;
      for (const glm::ivec3& corner : ring(at, axis))
        if (lattice_.is_moved(corner)) nodes.push_back(lattice_.node_index(corner));
    }
    return nodes;
  }

  bool is_pinched(const glm::ivec3& at, int axis) const {
    for (const int side : {0, 1}) {
      glm::ivec3 cell = at;
      cell[axis] -= 1 - side;
      const std::array<int, 4>& face = kFaces[static_cast<size_t>(2 * axis + 1 - side)];
      const std::int32_t vertex = vertex_of(cell, edge_between(face[0], face[1]));
      for (size_t i = 1; i < 4; ++i)
        if (vertex_of(cell, edge_between(face[i], face[(i + 1) % 4])) != vertex) return false;
    }
    return true;
  }

  /// The four cells around a lattice edge, each with the vertex of the sheet that crosses it.
  void quad(const glm::ivec3& at, int axis, std::vector<std::int32_t>& faces) const {
    const bool from_inside = inside(at);
    if (from_inside == inside(along(at, axis))) return;
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    std::array<std::int32_t, 4> corners{};
    constexpr int kU[] = {-1, 0, 0, -1}, kV[] = {-1, -1, 0, 0};
    for (size_t i = 0; i < 4; ++i) {
      glm::ivec3 cell = at;
      cell[u] += kU[i], cell[v] += kV[i];
      const glm::ivec3 from = at - cell;
      const int bits = from.x + 2 * from.y + 4 * from.z;
      corners[i] = vertex_of(cell, edge_between(bits, bits | (1 << axis)));
    }
    if (!from_inside) std::reverse(corners.begin(), corners.end());
    faces.insert(faces.end(), corners.begin(), corners.end());
  }

  size_t row_of(const glm::ivec3& at) const {
    return static_cast<size_t>(at.z) * static_cast<size_t>(lattice_.count.y) + static_cast<size_t>(at.y);
  }
  /// Calls `visit(cell, finds of its rows)` for all nodes that begin a cell, rows of different parts at the same time.
  template <class Visit>
  std::vector<RowFinds> by_rows(const Visit& visit) const {
    const size_t rows = row_of({0, 0, lattice_.count.z});
    std::vector<RowFinds> parts((rows + kRows - 1) / kRows);
    parallel_for(size_t{0}, parts.size(), [&](size_t part) {
      for (size_t row = part * kRows; row < std::min(rows, (part + 1) * kRows); ++row) {
        const int y = static_cast<int>(row) % lattice_.count.y, z = static_cast<int>(row) / lattice_.count.y;
        if (y + 1 == lattice_.count.y || z + 1 == lattice_.count.z) continue;
        for (int x = 0; x + 1 < lattice_.count.x; ++x) visit(glm::ivec3(x, y, z), parts[part]);
      }
    });
    return parts;
  }

  void make_vertices(Mesh& mesh) {
    mesh.positions.clear(), first_vertex_.clear();
    sheet_.assign(lattice_.values.size() * 12, -1);
    const std::vector<RowFinds> parts = by_rows([&](const glm::ivec3& at, RowFinds& finds) { cell(at, finds.positions); });
    for (const RowFinds& part : parts) {
      first_vertex_.push_back(static_cast<std::int32_t>(mesh.positions.size()));
      mesh.positions.insert(mesh.positions.end(), part.positions.begin(), part.positions.end());
    }
  }

  void make_quads(Mesh& mesh) const {
    const std::vector<RowFinds> parts = by_rows([&](const glm::ivec3& at, RowFinds& finds) {
      if (at.x == 0 || at.y == 0 || at.z == 0) return;
      for (int axis = 0; axis < 3; ++axis) quad(at, axis, finds.corners);
    });
    for (const RowFinds& part : parts) mesh.corner_vertices.insert(mesh.corner_vertices.end(), part.corners.begin(), part.corners.end());
    mesh.face_sizes.assign(mesh.corner_vertices.size() / 4, 4);
  }

  FieldLattice lattice_;
  std::vector<Crossing> crossings_{};
  std::vector<std::int32_t> crossing_of_{};  ///< Of each edge, -1 where it has none.
  std::vector<size_t> crossed_twice_{};      ///< Faces.
  std::vector<char> middle_inside_{};        ///< Of each of them; by FieldLattice::edge_index.
  std::vector<std::int32_t> sheet_{};        ///< Vertex of each edge of each cell, 12 a node, counted within its rows.
  std::vector<std::int32_t> first_vertex_{};
};

}  // namespace

Mesh dual_contour(const Field& field, int cells, ThinWalls thin_walls) { return DualContour(field, cells, thin_walls).run(); }

std::optional<Topology> topology_of(const Mesh& mesh) {
  if (mesh.face_sizes.empty()) return std::nullopt;
  const Edges edges = build_edges(mesh);
  for (const Edge& edge : edges)
    if (edge.face_count != 2 || !edge.consistent) return std::nullopt;
  std::vector<std::int32_t> part;
  const std::int32_t parts = part_of_faces(mesh, part);
  const auto count = [](size_t n) { return static_cast<std::int64_t>(n); };
  return Topology{parts, count(mesh.vertex_count()) - count(edges.size()) + count(mesh.face_count())};
}

}  // namespace limn
