#include "subdiv/dual_contour.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include "subdiv/field_lattice.h"
#include "subdiv/lattice_crossings.h"
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

/// Rows of cells whose vertices and quads one thread makes, so that they have the same numbers on any number of threads.
constexpr size_t kRows = 64;

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
      found_ = find_crossings(lattice_);
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
      const bool middle_inside = found_.middle_inside[lattice_.edge_index(corner(cell, face[0]), static_cast<int>(f) / 2)] != 0;
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
        const std::int32_t crossing = found_.of_edge[lattice_.edge_index(corner(at, edge.from), edge.axis)];
        if (root[static_cast<size_t>(e)] != sheet || crossing < 0) continue;
        sheet_[12 * lattice_.node_index(at) + static_cast<size_t>(e)] = static_cast<std::int32_t>(positions.size());
        points.push_back(found_.crossings[static_cast<size_t>(crossing)].point);
        normals.push_back(found_.crossings[static_cast<size_t>(crossing)].normal);
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
    for (const size_t face : found_.crossed_twice) {
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
  LatticeCrossings found_{};
  std::vector<std::int32_t> sheet_{};  ///< Vertex of each edge of each cell, 12 a node, counted within its rows.
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
