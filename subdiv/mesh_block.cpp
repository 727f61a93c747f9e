// One block of a mesh's level set. The sign is the generalised winding number above one half, but it is asked for as seldom as possible:
// a straight step from p to q of length h cannot meet a triangle while d(p) + d(q) > h, so nodes joined by such steps lie on one side, and
// one of them answers for all; small groups close to the surface follow a slanting step, or a column of nodes through the triangles
// between, each of which changes the number by one. Near the holes of an open mesh the number changes smoothly through one half; there
// every node is asked, and the surface {w = 1/2}, which closes the hole, counts as surface with its distance to first order,
// |w - 1/2| / |grad w|.
#include "subdiv/mesh_block.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "subdiv/column_crossings.h"

namespace limn {
namespace {

constexpr int kNodes = 512;

int node_index(int x, int y, int z) { return x * 64 + y * 8 + z; }
glm::ivec3 node_at(int index) { return {index >> 6, (index >> 3) & 7, index & 7}; }
/// Where a node's neighbour stands in BlockFace.
size_t on_face(const glm::ivec3& at, size_t axis) {
  return static_cast<size_t>(axis == 0 ? 8 * at.y + at.z : axis == 1 ? 8 * at.x + at.z : 8 * at.x + at.y);
}

class BlockFiller {
 public:
  BlockFiller(const glm::ivec3& origin, const BlockDistanceArray& distances, const BlockMesh& mesh, const BlockSettings& settings)
      : origin_(origin), winding_(mesh.winding), settings_(settings), triangles_(mesh.triangles), distances_(distances) {
    if (mesh.filled == nullptr || !winding_.closed()) return;
    for (int axis = 0; axis < 3; ++axis) before_[static_cast<size_t>(axis)] = mesh.filled->before(origin, axis);
  }

  BlockResult run(LevelSetBlock& block) {
    if (settings_.shell > 0.0) {
      for (double& d : distances_) d -= settings_.shell;
      return write(block);
    }
    joined_ = components_of(distances_, settings_.voxel_size, !winding_.closed());
    for (Component& component : joined_.components) settle(component);
    settle_by_columns();
    for (const auto& [node, distance] : near_membrane_) distances_[static_cast<size_t>(node)] = distance;
    for (size_t node = 0; node < kNodes; ++node)
      if (inside_[node]) distances_[node] = -distances_[node];
    return write(block);
  }

  /// Of a closed mesh.
  int number_at(int node) const { return number_of(component_of(node)); }

 private:
  using Component = BlockComponent;
  static int number_of(const Component& component) { return static_cast<int>(std::lround(component.number)); }

  glm::dvec3 world(int node) const { return settings_.voxel_size * glm::dvec3(origin_ + node_at(node)); }
  double distance(int node) const { return distances_[static_cast<size_t>(node)]; }
  std::span<const int> members(const Component& component) const { return joined_.members_of(component); }
  const Component& component_of(int node) const { return joined_.components[static_cast<size_t>(joined_.of[static_cast<size_t>(node)])]; }
  /// Whether a straight step of `length` voxels between two nodes stays clear of all triangles.
  bool clear_step(int from, int to, double length) const {
    return distance(from) + distance(to) > kClearStep * length * settings_.voxel_size;
  }

  template <class Visit>
  static void for_each_neighbour(int node, const Visit& visit) {
    const glm::ivec3 at = node_at(node);
    constexpr int kStrides[3] = {64, 8, 1};
    for (int axis = 0; axis < 3; ++axis) {
      if (at[axis] > 0) visit(node - kStrides[axis]);
      if (at[axis] < 7) visit(node + kStrides[axis]);
    }
  }

  /// How far the number may differ between two nodes that only the potential of the border parts, and what the tree is off by.
  static constexpr double kFarLook = 2.5, kTreeError = 0.03;
  /// Where the number itself shapes the surface, in the smallest cubes, the tree is held to a hundredth.
  static constexpr double kCloseLook = 3.5, kCloseError = 0.01;
  static constexpr int kSmallestCube = 2;

  /// Whether all nodes within `farthest` of one where the winding is `number` are on its side, and the membrane out of their band's reach.
  /// Within the block, which no border enters, the number is a smooth potential and whole numbers: along a component's ways only the
  /// potential changes, by no more than its slope times the straight distance.
  bool decides(double number, double farthest, double slope_bound, double error = kTreeError) const {
    if (winding_.closed()) return true;
    return std::abs(number - 0.5) > slope_bound * (farthest + settings_.half_width) + error;
  }

  /// Of a closed mesh, where a straight step leads to a node of a block before this one that lies well off the surface: there its side is
  /// certain.
  bool follow_before(Component& component) {
    for (size_t axis = 0; axis < 3; ++axis) {
      if (before_[axis] == nullptr) continue;
      for (const int node : members(component)) {
        const glm::ivec3 at = node_at(node);
        if (at[static_cast<int>(axis)] != 0) continue;
        const size_t beside = on_face(at, axis);
        const double off = before_[axis]->distances[beside];
        if (off < 0.5 * settings_.voxel_size || !(off + distance(node) > kClearStep * settings_.voxel_size)) continue;
        tell(component, node, before_[axis]->numbers[beside]);
        return true;
      }
    }
    return false;
  }

  /// `number` holds for all of it, as the node tells.
  void tell(Component& component, int node, double number) {
    component.speaker = node, component.number = number;
    mark(members(component), number > 0.5);
  }

  void settle(Component& component) {
    constexpr int kSmall = 8;
    if (follow_before(component)) return;
    if (component.size() <= kSmall && follow_neighbour(component)) return;
    if (component.size() <= kSmall && !triangles_.empty())
      waiting_.push_back(&component);
    else
      settle_whole(component);
  }

  void settle_whole(Component& component) { settle_part(members(component), glm::ivec3(0), 8, block_slope_bound(), &component); }

  /// Nodes that no clear step leads to lie very close to the surface, mostly one by one. From a node beside them in the same column, whose
  /// number is known, the triangles between lead to theirs.
  void settle_by_columns() {
    for (int axis = 2; axis >= 0 && !waiting_.empty(); --axis) {
      std::uint64_t wanted = 0;
      for (const Component* component : waiting_)
        wanted |= std::uint64_t{1} << on_face(node_at(component->first), static_cast<size_t>(axis));
      const ColumnCrossings crossings(winding_, triangles_, {origin_, settings_.voxel_size, axis}, wanted);
      std::erase_if(waiting_, [&](Component* component) { return follow_column(crossings, axis, *component); });
    }
    for (Component* component : waiting_) settle_whole(*component);
    waiting_.clear();
  }

  /// Of an open mesh the number changes smoothly, too. What the bounds then allow is decided as the node's own number would be.
  bool decides_along_column(double number, int speaker, const Component& component) {
    if (winding_.closed()) return true;
    return std::abs(number - 0.5) > block_slope_bound() * (farthest_from(speaker, component) + settings_.half_width) + 3.0 * kTreeError;
  }

  double farthest_from(int speaker, const Component& component) const {
    double farthest = 0.0;
    for (const int node : members(component)) farthest = std::max(farthest, glm::distance(world(speaker), world(node)));
    return farthest;
  }

  /// From the nearest nodes on either side, which have to agree.
  bool follow_column(const ColumnCrossings& crossings, int axis, Component& component) {
    const glm::ivec3 at = node_at(component.first);
    const auto column = static_cast<int>(on_face(at, static_cast<size_t>(axis)));
    std::optional<double> number;
    for (const int step : {-1, 1}) {
      for (glm::ivec3 next = at; next[axis] >= 0 && next[axis] <= 7; next[axis] += step) {
        const Component& other = component_of(node_index(next.x, next.y, next.z));
        if (other.speaker < 0) continue;
        const std::optional<int> change = crossings.change(column, next[axis], at[axis]);
        if (!change) return false;
        const double carried = (winding_.closed() ? number_of(other) : other.number) + *change;
        if (!decides_along_column(carried, other.speaker, component)) return false;
        if (number && (*number > 0.5) != (carried > 0.5)) return false;
        number = carried;
        break;
      }
    }
    if (number) tell(component, component.first, *number);
    return number.has_value();
  }

  /// A few nodes close to the surface, which slanting steps may join to a component that has its answer.
  bool follow_neighbour(Component& component) {
    for (const int from : members(component)) {
      const glm::ivec3 at = node_at(from);
      for (int step = 0; step < 27; ++step) {
        const glm::ivec3 offset(step / 9 - 1, step / 3 % 3 - 1, step % 3 - 1), next = at + offset;
        const int squared = offset.x * offset.x + offset.y * offset.y + offset.z * offset.z;
        if (squared < 2 || glm::any(glm::lessThan(next, glm::ivec3(0))) || glm::any(glm::greaterThan(next, glm::ivec3(7)))) continue;
        const int to = node_index(next.x, next.y, next.z);
        const Component& other = component_of(to);
        if (other.speaker < 0 || !clear_step(from, to, std::sqrt(static_cast<double>(squared)))) continue;
        if (!winding_.closed() && !decides(other.number, farthest_from(other.speaker, component), block_slope_bound())) continue;
        tell(component, other.speaker, other.number);
        return true;
      }
    }
    return false;
  }

  double block_slope_bound() {
    if (winding_.closed()) return 0.0;
    if (block_slope_bound_ < 0.0) block_slope_bound_ = winding_.gradient_bound(center_of(glm::ivec3(0), 8), bound_radius(8));
    return block_slope_bound_;
  }
  /// Of the cube of `size` nodes at `corner`.
  glm::dvec3 center_of(const glm::ivec3& corner, int size) const {
    return world(0) + settings_.voxel_size * (glm::dvec3(corner) + 0.5 * (size - 1));
  }
  double bound_radius(int size) const { return 0.5 * (size - 1) * std::sqrt(3.0) * settings_.voxel_size + settings_.half_width; }

  /// Nodes of one component in the cube of `size` nodes at `corner`, where no slope is larger than `bound`. Near a hole one answer does for
  /// small cubes only.
  void settle_part(std::span<const int> nodes, const glm::ivec3& corner, int size, double bound, Component* whole) {
    // The farthest from the surface answers: there the number is nearest to a whole one.
    int speaker = nodes.front();
    for (const int node : nodes)
      if (distance(node) > distance(speaker)) speaker = node;
    const bool is_last = size <= kSmallestCube;
    if (!std::isfinite(bound)) return is_last ? near_hole(nodes, {}) : settle_parts(nodes, corner, size / 2);
    const double number = winding_.number(world(speaker), is_last ? kCloseLook : kFarLook);
    double farthest = 0.0;
    if (!winding_.closed())
      for (const int node : nodes) farthest = std::max(farthest, glm::distance(world(speaker), world(node)));
    if (decides(number, farthest, bound, is_last ? kCloseError : kTreeError)) {
      if (whole)
        tell(*whole, speaker, number);
      else
        mark(nodes, number > 0.5);
      return;
    }
    if (is_last)
      near_hole(nodes, Spoken{speaker, number});
    else
      settle_parts(nodes, corner, size / 2);
  }

  /// The eight cubes of half the size by themselves.
  void settle_parts(std::span<const int> nodes, const glm::ivec3& corner, int half) {
    std::array<glm::ivec3, 8> corners;
    std::array<glm::dvec3, 8> centers;
    std::array<double, 8> bounds{};
    for (int part = 0; part < 8; ++part) {
      const auto k = static_cast<size_t>(part);
      corners[k] = corner + half * glm::ivec3(part >> 2, (part >> 1) & 1, part & 1);
      centers[k] = center_of(corners[k], half);
    }
    if (!winding_.closed()) winding_.gradient_bounds(centers, bound_radius(half), bounds);
    for (size_t k = 0; k < 8; ++k) {
      const glm::ivec3& lower = corners[k];
      std::vector<int> inside;
      for (const int node : nodes) {
        const glm::ivec3 at = node_at(node) - lower;
        if (glm::all(glm::greaterThanEqual(at, glm::ivec3(0))) && glm::all(glm::lessThan(at, glm::ivec3(half)))) inside.push_back(node);
      }
      settle_joined(inside, lower, half, bounds[k]);
    }
  }

  /// What hangs together in the whole block may do so around a border; in a part of it the sides can be apart.
  void settle_joined(const std::vector<int>& nodes, const glm::ivec3& corner, int size, double bound) {
    std::array<bool, kNodes> waiting{};
    for (const int node : nodes) waiting[static_cast<size_t>(node)] = true;
    for (const int first : nodes) {
      if (!waiting[static_cast<size_t>(first)]) continue;
      std::vector<int> joined{first};
      waiting[static_cast<size_t>(first)] = false;
      for (size_t i = 0; i < joined.size(); ++i) {
        for_each_neighbour(joined[i], [&](int node) {
          if (!waiting[static_cast<size_t>(node)] || !clear_step(joined[i], node, 1.0)) return;
          waiting[static_cast<size_t>(node)] = false;
          joined.push_back(node);
        });
      }
      settle_part(joined, corner, size, bound, nullptr);
    }
  }

  void mark(std::span<const int> nodes, bool inside) {
    for (const int node : nodes) inside_[static_cast<size_t>(node)] = inside;
  }

  /// The winding number and its gradient at a node.
  struct Potential {
    glm::dvec3 at{0.0};
    double number = 0.0;
    glm::dvec3 gradient{0.0};
  };

  /// The trapezium rule along the step, where the gradient changes so little that it is as good as the tree.
  double number_near(const Potential& known, const glm::dvec3& p, const glm::dvec3& gradient) const {
    constexpr double kStraight = 0.01;
    const glm::dvec3 step = p - known.at;
    const bool straight = glm::length(gradient - known.gradient) * glm::length(step) < kStraight;
    return straight ? known.number + 0.5 * glm::dot(gradient + known.gradient, step) : winding_.number(p);
  }

  /// A node's number.
  struct Spoken {
    int node = -1;
    double number = 0.0;
  };

  /// At most eight nodes of one component close to each other. The number at one of them tells those of the others; nothing does so close
  /// to the border that the gradient turns too quickly.
  void near_hole(std::span<const int> nodes, const std::optional<Spoken>& spoken) {
    std::array<glm::dvec3, 8> places, gradients;
    for (size_t k = 0; k < nodes.size(); ++k) places[k] = world(nodes[k]);
    winding_.gradients(std::span(places).first(nodes.size()), std::span(gradients).first(nodes.size()));
    std::optional<Potential> known;
    if (spoken) {
      const auto k = static_cast<size_t>(std::find(nodes.begin(), nodes.end(), spoken->node) - nodes.begin());
      known = {places[k], spoken->number, gradients[k]};
    }
    for (size_t k = 0; k < nodes.size(); ++k)
      near_hole(nodes[k], known ? number_near(*known, places[k], gradients[k]) : winding_.number(places[k]), gradients[k]);
  }

  void near_hole(int node, double number, const glm::dvec3& gradient) {
    const double slope = glm::length(gradient);
    const double to_triangles = distance(node);
    const double to_membrane = slope > 0.0 ? std::abs(number - 0.5) / slope : std::numeric_limits<double>::infinity();
    if (to_membrane < settings_.half_width && to_membrane < to_triangles) result_.membrane = true;
    // Other components still ask for the distance to the triangles; `near_membrane_` waits until all are settled.
    near_membrane_.push_back({node, std::min(to_triangles, to_membrane)});
    inside_[static_cast<size_t>(node)] = number > 0.5;
  }

  BlockResult write(LevelSetBlock& block) {
    block.origin = origin_;
    std::fill(std::begin(block.active), std::end(block.active), std::uint64_t{0});
    const double limit = settings_.half_width;
    for (int node = 0; node < kNodes; ++node) {
      const double value = distances_[static_cast<size_t>(node)];
      block.values[node] = static_cast<float>(std::clamp(value, -limit, limit));
      result_.any_inside |= value < 0.0;
      if (!(std::abs(value) <= limit)) continue;
      block.active[node >> 6] |= std::uint64_t{1} << (node & 63);
      result_.any_active = true;
    }
    return result_;
  }

  glm::ivec3 origin_;
  const Winding& winding_;
  const BlockSettings& settings_;
  std::span<const std::uint32_t> triangles_;
  std::array<const BlockFace*, 3> before_{};  ///< Null where the block there is not known.
  double block_slope_bound_ = -1.0;           ///< Below 0: not asked for yet.
  BlockDistanceArray distances_;
  std::array<bool, kNodes> inside_{};
  BlockComponents joined_;
  std::vector<Component*> waiting_;                    ///< Small ones that have no answer yet.
  std::vector<std::pair<int, double>> near_membrane_;  ///< Nodes, and their distances once the continuation over holes counts.
  BlockResult result_;
};

}  // namespace

/// Neighbouring nodes bound each other's search; nodes out of reach hold infinity.
void measure_block(const glm::ivec3& origin, const ClosestPointData& distance, double voxel_size, double reach,
                   BlockDistanceArray& distances) {
  std::array<std::uint32_t, kNodes> closest_triangles{};  // where the distance is finite
  for (int node = 0; node < kNodes; ++node) {
    double radius = reach;
    // What is closest to a neighbour is nearly closest here.
    std::array<std::uint32_t, 3> likely{};
    size_t likely_count = 0;
    const glm::ivec3 at = node_at(node);
    for (int axis = 0; axis < 3; ++axis) {
      if (at[axis] == 0) continue;
      const int previous = node - (axis == 0 ? 64 : axis == 1 ? 8 : 1);
      const auto neighbour = static_cast<size_t>(previous);
      radius = std::min(radius, distances[neighbour] + 1.0001 * voxel_size);
      if (std::isfinite(distances[neighbour])) likely[likely_count++] = closest_triangles[neighbour];
    }
    const auto closest = distance.within(voxel_size * glm::dvec3(origin + at), radius, {likely.data(), likely_count});
    closest_triangles[static_cast<size_t>(node)] = closest ? closest->triangle : 0;
    distances[static_cast<size_t>(node)] = closest ? closest->distance : std::numeric_limits<double>::infinity();
  }
}

BlockResult fill_block(const glm::ivec3& origin, const BlockDistanceArray& distances, const BlockMesh& mesh, const BlockSettings& settings,
                       LevelSetBlock& block) {
  BlockFiller filler(origin, distances, mesh, settings);
  const BlockResult result = filler.run(block);
  if (mesh.filled == nullptr || !mesh.winding.closed() || settings.shell > 0.0) return result;
  BlockFaces faces;
  for (int a = 0; a < 8; ++a)
    for (int b = 0; b < 8; ++b)
      for (size_t axis = 0; axis < 3; ++axis) {
        const glm::ivec3 at = axis == 0 ? glm::ivec3(7, a, b) : axis == 1 ? glm::ivec3(a, 7, b) : glm::ivec3(a, b, 7);
        const int node = node_index(at.x, at.y, at.z);
        const size_t to = on_face(at, axis);
        faces[axis].distances[to] = distances[static_cast<size_t>(node)];
        faces[axis].numbers[to] = filler.number_at(node);
      }
  mesh.filled->add(origin, faces);
  return result;
}

}  // namespace limn
