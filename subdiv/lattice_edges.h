#pragma once
// Internal: edges between the nodes of a lattice, and what a field says along them.

#include <numeric>
#include <span>
#include <vector>

#include "subdiv/local_field.h"

namespace limn {

/// Between two nodes.
struct LatticeEdge {
  glm::dvec3 from{0.0}, to{0.0};
};

/// What `find(field, edges of a group)` says of each; edges lie together in groups, and only what matters there of the field is evaluated.
template <class Answer, class Find>
std::vector<Answer> by_groups(const Field& field, std::span<const LatticeEdge> edges, const Find& find) {
  std::vector<glm::dvec3> middles;
  std::vector<double> reach;
  for (const LatticeEdge& edge : edges) {
    middles.push_back(0.5 * (edge.from + edge.to));
    reach.push_back((0.5 + 1e-9) * glm::distance(edge.from, edge.to));
  }
  std::vector<std::uint32_t> all(edges.size());
  std::iota(all.begin(), all.end(), 0u);
  std::vector<Answer> answers(edges.size());
  visit_groups(field, middles, reach, std::move(all), [&](LocalField& local, std::span<const std::uint32_t> members) {
    const std::vector<Answer> found = find(local, members_of(edges, members));
    for (size_t k = 0; k < members.size(); ++k) answers[members[k]] = found[k];
  });
  return answers;
}

}  // namespace limn
