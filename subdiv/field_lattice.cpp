#include "subdiv/field_lattice.h"

#include <cmath>

#include "subdiv/thin_walls.h"

namespace limn {
namespace {

/// How far a node is moved at most, in steps of the lattice.
constexpr double kFarthestMove = 0.6;

void fill(FieldLattice& lattice, const glm::ivec3& first, const glm::ivec3& end, double value) {
  for (int z = first.z; z < end.z; ++z)
    for (int y = first.y; y < end.y; ++y)
      std::fill_n(lattice.values.begin() + static_cast<std::ptrdiff_t>(lattice.node_index({first.x, y, z})), end.x - first.x, value);
}

void sample(FieldEvaluator& evaluator, FieldLattice& lattice, const glm::ivec3& first, const glm::ivec3& end) {
  std::vector<glm::dvec3> row(static_cast<size_t>(end.x - first.x));
  for (int z = first.z; z < end.z; ++z)
    for (int y = first.y; y < end.y; ++y) {
      for (int x = first.x; x < end.x; ++x) row[static_cast<size_t>(x - first.x)] = lattice.on_lattice({x, y, z});
      evaluator.values(row, std::span(lattice.values).subspan(lattice.node_index({first.x, y, z}), row.size()));
    }
}

/// A node that a wall or gap beside it asks for.
struct Move {
  size_t node = 0;
  glm::dvec3 to{0.0};
  double distance = 0.0;
};

/// Edges between nodes of one sign.
struct EqualEnds {
  std::vector<LatticeEdge> edges{};
  std::vector<std::array<glm::ivec3, 2>> nodes{};
};

/// Those where the field is near enough to zero to fall and rise again.
EqualEnds equal_ends(const FieldLattice& lattice, const glm::ivec3& first, const glm::ivec3& end, double lipschitz) {
  EqualEnds found;
  const double reach = lipschitz * lattice.step;
  FieldLattice::for_axes(first, end, [&](const glm::ivec3& a, int axis) {
    const glm::ivec3 b = FieldLattice::along(a, axis);
    if (!lattice.holds(b) || lattice.inside(a) != lattice.inside(b)) return;
    if (std::abs(lattice.value(a)) + std::abs(lattice.value(b)) >= reach) return;
    found.edges.push_back({lattice.on_lattice(a), lattice.on_lattice(b)});
    found.nodes.push_back({a, b});
  });
  return found;
}

/// A move that is possible as far as its own edge tells, and the edges from there to neighbours of another sign.
struct PossibleMove {
  Move move{};
  size_t edge = 0;
  size_t first = 0, end = 0;  ///< Among all such edges.
};

/// Nothing at the border of the lattice.
bool edges_after_move(const FieldLattice& lattice, const glm::ivec3& at, const glm::dvec3& to, std::vector<LatticeEdge>& edges) {
  for (int axis = 0; axis < 3; ++axis)
    for (const int by : {-1, 1}) {
      glm::ivec3 other = at;
      other[axis] += by;
      if (other[axis] < 0 || !lattice.holds(other)) return false;
      if (lattice.inside(other) != lattice.inside(at)) edges.push_back({to, lattice.on_lattice(other)});
    }
  return true;
}

/// For each wall the nearer of its edge's nodes first.
std::vector<PossibleMove> possible_moves(const FieldLattice& lattice, const EqualEnds& ends,
                                         const std::vector<std::optional<double>>& middles, std::vector<LatticeEdge>& edges) {
  std::vector<PossibleMove> moves;
  for (size_t i = 0; i < middles.size(); ++i) {
    if (!middles[i]) continue;
    const double share = *middles[i];
    const glm::dvec3 to = glm::mix(ends.edges[i].from, ends.edges[i].to, share);
    const std::array<double, 2> shares = {share, 1.0 - share};
    const size_t nearer = share < 0.5 ? 0 : 1;
    for (const size_t k : {nearer, 1 - nearer}) {
      const size_t first = edges.size();
      if (shares[k] > kFarthestMove) continue;
      if (edges_after_move(lattice, ends.nodes[i][k], to, edges))
        moves.push_back({{lattice.node_index(ends.nodes[i][k]), to, shares[k] * lattice.step}, i, first, edges.size()});
      else
        edges.resize(first);
    }
  }
  return moves;
}

std::vector<Move> find_moves(const Field& field, const Field& part, const FieldLattice& lattice, const glm::ivec3& first,
                             const glm::ivec3& end) {
  const EqualEnds ends = equal_ends(lattice, first, end, field.traits().lipschitz);
  std::vector<LatticeEdge> edges;
  const std::vector<PossibleMove> possible = possible_moves(lattice, ends, find_thin_walls(part, ends.edges), edges);
  std::vector<Move> moves;
  if (possible.empty()) return moves;
  // A node must not leave its neighbours of the same sign for a wall where it alone keeps that wall and others apart. Neighbours may lie
  // beyond the block.
  const Box around = dilate({lattice.on_lattice(first - 1), lattice.on_lattice(end + 1)}, 1e-6 * lattice.step);
  const std::vector<char> apart = are_apart(FieldEvaluator(field).restricted(around), edges);
  std::optional<size_t> moved;
  for (const PossibleMove& one : possible) {
    const auto from = apart.begin() + static_cast<std::ptrdiff_t>(one.first), to = apart.begin() + static_cast<std::ptrdiff_t>(one.end);
    if (one.edge == moved || std::find(from, to, 1) != to) continue;
    moves.push_back(one.move);
    moved = one.edge;
  }
  return moves;
}

}  // namespace

FieldLattice sample_lattice(const Field& field, int cells) {
  FieldLattice lattice;
  const Box bounds = field.traits().bounds;
  lattice.step = bounds.longest_side() / cells;
  // Nodes half a cell off the middle of the box, so that faces of symmetric shapes do not lie on them.
  for (int axis = 0; axis < 3; ++axis) {
    const int half = static_cast<int>(std::ceil(0.5 * bounds.size()[axis] / lattice.step - 1e-9)) + 2;
    lattice.count[axis] = 2 * half;
    lattice.lower[axis] = bounds.center()[axis] - (half - 0.5) * lattice.step;
  }
  const glm::ivec3 blocks = (lattice.count + (FieldLattice::kBlock - 1)) / FieldLattice::kBlock;
  lattice.values.resize(lattice.node_index({0, 0, lattice.count.z}));
  lattice.parts.resize(static_cast<size_t>(blocks.x) * static_cast<size_t>(blocks.y) * static_cast<size_t>(blocks.z));
  lattice.for_blocks([&](size_t b, const glm::ivec3& first, const glm::ivec3& end) {
    // A cell has nodes on the far side of its block, too; and nodes may be moved.
    const Box box = dilate({lattice.on_lattice(first), lattice.on_lattice(end)}, (kFarthestMove + 1e-6) * lattice.step);
    FieldEvaluator whole(field);
    const Interval value = whole.bounds(box);
    if (!value.contains(0.0)) return fill(lattice, first, end, value.lower);
    lattice.parts[b] = whole.restricted(box);
    FieldEvaluator part(*lattice.parts[b]);
    sample(part, lattice, first, end);
  });
  return lattice;
}

void move_nodes_into_walls(const Field& field, FieldLattice& lattice) {
  std::vector<std::vector<Move>> asked(lattice.parts.size());
  lattice.for_blocks([&](size_t b, const glm::ivec3& first, const glm::ivec3& end) {
    if (!lattice.parts[b]) return;
    asked[b] = find_moves(field, *lattice.parts[b], lattice, first, end);
  });
  std::unordered_map<size_t, Move> nearest;
  for (const std::vector<Move>& block : asked)
    for (const Move& move : block) {
      const auto [at, is_new] = nearest.try_emplace(move.node, move);
      if (!is_new && move.distance < at->second.distance) at->second = move;
    }
  for (const auto& [node, move] : nearest) {
    lattice.moved[node] = move.to;
    lattice.values[node] = lattice.values[node] < 0.0 ? 1.0 : -1.0;
  }
}

void put_back(FieldLattice& lattice, std::vector<size_t> nodes) {
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  for (const size_t node : nodes)
    if (lattice.moved.erase(node) > 0) lattice.values[node] = lattice.values[node] < 0.0 ? 1.0 : -1.0;
}

}  // namespace limn
