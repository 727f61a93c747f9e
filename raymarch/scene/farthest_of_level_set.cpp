#include <algorithm>
#include <limits>

#include "raymarch/scene/farthest_points.h"
#include "sdf/level_set_band.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

/// A leaf and a bound of how far its crossings reach.
struct Candidate {
  double along = 0.0;
  std::uint32_t leaf = 0;
};

struct Farthest {
  double along = -std::numeric_limits<double>::infinity();
  glm::dvec3 point{0.0};  ///< Index coordinates.
};

/// The crossings on the edges that begin at a leaf's nodes, by linear interpolation. `direction` is one of index coordinates.
void look_into(const NanoLeaf& leaf, const NanoAccessor& accessor, const glm::dvec3& direction, Farthest& best) {
  constexpr int kSteps[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const nanovdb::Coord origin = leaf.origin();
  NodeWindow nodes;
  load_nodes(LeafWindow(accessor, origin), nodes);
  const auto value = [&](int x, int y, int z) {
    return nodes[static_cast<size_t>(x) + 1][static_cast<size_t>(y) + 1][static_cast<size_t>(z) + 1];
  };
  for (int n = 0; n < 512; ++n) {
    const int x = n >> 6, y = n >> 3 & 7, z = n & 7;
    for (const auto& step : kSteps) {
      const float at_here = value(x, y, z), at_there = value(x + step[0], y + step[1], z + step[2]);
      if ((at_here < 0.0f) == (at_there < 0.0f)) continue;
      const double here = static_cast<double>(at_here), there = static_cast<double>(at_there);
      const glm::dvec3 point =
          glm::dvec3(origin[0] + x, origin[1] + y, origin[2] + z) + here / (here - there) * glm::dvec3(step[0], step[1], step[2]);
      const double along = glm::dot(point, direction);
      if (along > best.along) best = {along, point};
    }
  }
}

/// Leaves in the order of their bounds, until none that is left can reach farther.
Farthest farthest(const nanovdb::FloatGrid& grid, const glm::dvec3& direction) {
  const NanoLeaf* leaves = grid.tree().getFirstNode<0>();
  std::vector<Candidate> order(grid.tree().nodeCount(0));
  const double half = 4.0 * (std::abs(direction.x) + std::abs(direction.y) + std::abs(direction.z));
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    const nanovdb::Coord o = leaves[i].origin();
    order[i] = {glm::dot(glm::dvec3(o[0] + 4, o[1] + 4, o[2] + 4), direction) + half, i};
  }
  const auto behind = [](const Candidate& a, const Candidate& b) { return a.along != b.along ? a.along < b.along : a.leaf > b.leaf; };
  std::make_heap(order.begin(), order.end(), behind);
  const auto accessor = grid.getAccessor();
  Farthest best;
  while (!order.empty() && order.front().along > best.along) {
    look_into(leaves[order.front().leaf], accessor, direction, best);
    std::pop_heap(order.begin(), order.end(), behind);
    order.pop_back();
  }
  return best;
}

}  // namespace

FarthestPoints farthest_of_level_set(const LevelSet& level_set, const Affine& world_from_object) {
  return [level_set, world_from_object](std::span<const glm::dvec3> directions) {
    const Affine world_from_index = compose(world_from_object, level_set.info().world_from_index);
    std::vector<Farthest> best(directions.size());
    parallel_each(directions.size(),
                  [&](size_t i) { best[i] = farthest(*level_set.data().grid, glm::transpose(world_from_index.linear) * directions[i]); });
    std::vector<glm::dvec3> points;
    for (const Farthest& one : best) {
      if (one.along == -std::numeric_limits<double>::infinity()) return std::vector<glm::dvec3>{};
      points.push_back(world_from_index.point(one.point));
    }
    return points;
  };
}

}  // namespace limn
