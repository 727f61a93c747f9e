#include "subdiv/lattice_crossings.h"

#include <algorithm>
#include <optional>

#include "subdiv/thin_walls.h"

namespace limn {
namespace {

/// Of edges from a node inside to one outside, by bisection, since fields may jump in slope.
std::vector<SurfaceCrossing> crossings_on(LocalField& field, std::span<const LatticeEdge> edges) {
  std::vector<LatticeEdge> parts(edges.begin(), edges.end());
  std::vector<glm::dvec3> points(edges.size()), gradients(edges.size());
  std::vector<double> values(edges.size());
  const auto halve = [&] {
    for (size_t i = 0; i < parts.size(); ++i) points[i] = 0.5 * (parts[i].from + parts[i].to);
  };
  for (int halving = 0; halving < 24; ++halving) {
    halve();
    field.values(points, values);
    for (size_t i = 0; i < parts.size(); ++i) (values[i] < 0.0 ? parts[i].from : parts[i].to) = points[i];
  }
  halve();
  field.gradients(points, values, gradients);
  std::vector<SurfaceCrossing> crossings;
  for (size_t i = 0; i < points.size(); ++i) crossings.push_back({points[i], direction_of(gradients[i])});
  return crossings;
}

/// A face whose corners in a ring are inside and outside by turns.
struct TwiceCrossedFace {
  std::array<glm::ivec3, 4> nodes{};
  std::array<glm::dvec3, 4> corners{};
  size_t index = 0;  ///< As numbered by FieldLattice::edge_index.
};

/// What one block finds on the edges and faces that begin at its nodes.
struct BlockFinds {
  std::vector<size_t> edges{};  ///< As numbered by FieldLattice::edge_index.
  std::vector<SurfaceCrossing> crossings{};
  std::vector<size_t> faces{};  ///< Crossed twice; as numbered by FieldLattice::edge_index.
};

/// Where the field changes sign between two nodes.
void find_in_block(const FieldLattice& lattice, const Field& part, const glm::ivec3& first, const glm::ivec3& end, BlockFinds& finds) {
  std::vector<LatticeEdge> edges;
  FieldLattice::for_axes(first, end, [&](const glm::ivec3& a, int axis) {
    const glm::ivec3 b = FieldLattice::along(a, axis);
    if (!lattice.holds(b) || lattice.inside(a) == lattice.inside(b)) return;
    finds.edges.push_back(lattice.edge_index(a, axis));
    edges.push_back({lattice.world(lattice.inside(a) ? a : b), lattice.world(lattice.inside(a) ? b : a)});
  });
  finds.crossings = by_groups<SurfaceCrossing>(part, edges, crossings_on);
}

/// A wall thinner than a cell misses the middle. It joins the corners that lie in it, and surely two of them where it keeps the others
/// apart.
void ask_thin_walls(const FieldLattice& lattice, const Field& part, std::span<const TwiceCrossedFace> faces,
                    std::vector<char>& middle_inside) {
  std::vector<LatticeEdge> diagonals;
  for (const TwiceCrossedFace& face : faces)
    for (const size_t i : {size_t{0}, size_t{1}}) diagonals.push_back({face.corners[i], face.corners[i + 2]});
  const std::vector<std::optional<double>> passes = find_thin_walls(part, diagonals);
  const std::vector<char> apart = are_apart(part, diagonals);
  for (size_t i = 0; i < faces.size(); ++i) {
    const auto is_moved = [&](size_t k) { return lattice.is_moved(faces[i].nodes[k]); };
    const bool even = is_moved(0) || is_moved(2), odd = is_moved(1) || is_moved(3);
    const bool even_apart = passes[2 * i].has_value() || apart[2 * i] != 0,
               odd_apart = passes[2 * i + 1].has_value() || apart[2 * i + 1] != 0;
    const bool first_inside = lattice.inside(faces[i].nodes[0]);
    if (even_apart != odd_apart)
      middle_inside[faces[i].index] = even_apart ? !first_inside : first_inside;
    else if (even != odd)
      middle_inside[faces[i].index] = even ? first_inside : !first_inside;
  }
}

void ask_middles(const FieldLattice& lattice, const Field& part, const glm::ivec3& first, const glm::ivec3& end, BlockFinds& finds,
                 std::vector<char>& middle_inside) {
  std::vector<TwiceCrossedFace> faces;
  std::vector<glm::dvec3> middles;
  FieldLattice::for_axes(first, end, [&](const glm::ivec3& at, int axis) {
    TwiceCrossedFace face{.nodes = ring(at, axis), .index = lattice.edge_index(at, axis)};
    if (!lattice.holds(face.nodes[2])) return;
    const bool in = lattice.inside(face.nodes[0]);
    if (lattice.inside(face.nodes[1]) == in || lattice.inside(face.nodes[2]) != in || lattice.inside(face.nodes[3]) == in) return;
    for (size_t i = 0; i < 4; ++i) face.corners[i] = lattice.world(face.nodes[i]);
    middles.push_back(0.25 * (face.corners[0] + face.corners[1] + face.corners[2] + face.corners[3]));
    finds.faces.push_back(face.index);
    faces.push_back(face);
  });
  std::vector<double> values(middles.size());
  FieldEvaluator(part).values(middles, values);
  for (size_t i = 0; i < faces.size(); ++i) middle_inside[faces[i].index] = values[i] < 0.0;
  std::erase_if(faces, [&](const TwiceCrossedFace& face) {
    return std::none_of(face.nodes.begin(), face.nodes.end(), [&](const glm::ivec3& at) { return lattice.is_moved(at); });
  });
  ask_thin_walls(lattice, part, faces, middle_inside);
}

}  // namespace

LatticeCrossings find_crossings(const FieldLattice& lattice) {
  LatticeCrossings result;
  result.of_edge.assign(3 * lattice.values.size(), -1);
  result.middle_inside.assign(3 * lattice.values.size(), 0);
  std::vector<BlockFinds> finds(lattice.parts.size());
  lattice.for_blocks([&](size_t b, const glm::ivec3& first, const glm::ivec3& end) {
    // Where bounds leave no surface in a block, it has no edge that is crossed.
    if (!lattice.parts[b]) return;
    find_in_block(lattice, *lattice.parts[b], first, end, finds[b]);
    ask_middles(lattice, *lattice.parts[b], first, end, finds[b], result.middle_inside);
  });
  for (const BlockFinds& block : finds) {
    for (size_t i = 0; i < block.edges.size(); ++i) result.of_edge[block.edges[i]] = static_cast<std::int32_t>(result.crossings.size() + i);
    result.crossings.insert(result.crossings.end(), block.crossings.begin(), block.crossings.end());
    result.crossed_twice.insert(result.crossed_twice.end(), block.faces.begin(), block.faces.end());
  }
  return result;
}

}  // namespace limn
