// One block of a mesh's level set. The sign is the generalised winding number above one half, but it is asked for as seldom as possible:
// a straight step from p to q of length h cannot meet a triangle while d(p) + d(q) > h, so nodes joined by such steps lie on one side, and
// one of them answers for all; small groups close to the surface follow a slanting step, or a column of nodes through the triangles
// between, each of which changes the number by one. Near the holes of an open mesh there is more to it (OpenSides).
#include "subdiv/mesh_block.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "subdiv/column_crossings.h"
#include "subdiv/open_sides.h"

namespace limn {
namespace {

/// Where a node's neighbour stands in BlockFace.
size_t on_face(const glm::ivec3& at, size_t axis) {
  return static_cast<size_t>(axis == 0 ? 8 * at.y + at.z : axis == 1 ? 8 * at.x + at.z : 8 * at.x + at.y);
}

class BlockFiller {
 public:
  BlockFiller(const glm::ivec3& origin, const BlockDistanceArray& distances, const BlockMesh& mesh, const BlockSettings& settings)
      : winding_(mesh.winding),
        settings_(settings),
        triangles_(mesh.triangles),
        distances_(distances),
        nodes_{origin, settings.voxel_size, distances_},
        open_(nodes_, winding_, settings.half_width, inside_) {
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
    for (const auto& [node, distance] : open_.near_membrane()) distances_[static_cast<size_t>(node)] = distance;
    result_.membrane = open_.has_membrane();
    for (size_t node = 0; node < kBlockNodes; ++node)
      if (inside_[node]) distances_[node] = -distances_[node];
    return write(block);
  }

  /// Of a closed mesh.
  int number_at(int node) const { return number_of(component_of(node)); }

 private:
  using Component = BlockComponent;
  static int number_of(const Component& component) { return static_cast<int>(std::lround(component.number)); }

  std::span<const int> members(const Component& component) const { return joined_.members_of(component); }
  const Component& component_of(int node) const { return joined_.components[static_cast<size_t>(joined_.of[static_cast<size_t>(node)])]; }

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
        if (off < 0.5 * settings_.voxel_size || !(off + nodes_.distance(node) > kClearStep * settings_.voxel_size)) continue;
        tell(component, node, before_[axis]->numbers[beside]);
        return true;
      }
    }
    return false;
  }

  /// `number` holds for all of it, as the node tells.
  void tell(Component& component, int node, double number) {
    component.speaker = node, component.number = number;
    for (const int each : members(component)) inside_[static_cast<size_t>(each)] = number > 0.5;
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

  void settle_whole(Component& component) {
    const std::span<const int> nodes = members(component);
    const int speaker = nodes_.farthest_off(nodes);
    if (winding_.closed()) return tell(component, speaker, winding_.number(nodes_.world(speaker)));
    const double slope = open_.slope_bound();
    if (!std::isfinite(slope)) return open_.settle(nodes);
    const double number = winding_.number(nodes_.world(speaker));
    if (open_.decides(number, nodes_.reach(speaker, nodes), slope))
      tell(component, speaker, number);
    else
      open_.settle(nodes);
  }

  /// Nodes that no clear step leads to lie very close to the surface, mostly one by one. From a node beside them in the same column, whose
  /// number is known, the triangles between lead to theirs.
  void settle_by_columns() {
    for (int axis = 2; axis >= 0 && !waiting_.empty(); --axis) {
      std::uint64_t wanted = 0;
      for (const Component* component : waiting_)
        wanted |= std::uint64_t{1} << on_face(node_at(component->first), static_cast<size_t>(axis));
      const ColumnCrossings crossings(winding_, triangles_, {nodes_.origin, settings_.voxel_size, axis}, wanted);
      std::erase_if(waiting_, [&](Component* component) { return follow_column(crossings, axis, *component); });
    }
    for (Component* component : waiting_) settle_whole(*component);
    waiting_.clear();
  }

  /// Of an open mesh the number changes smoothly, too. What the bounds then allow is decided as the node's own number would be.
  bool decides_along_column(double number, int speaker, const Component& component) {
    return winding_.closed() ||
           open_.decides(number, nodes_.reach(speaker, members(component)), open_.slope_bound(), 3.0 * Winding::kFarError);
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
        if (other.speaker < 0 || !nodes_.clear_step(from, to, std::sqrt(static_cast<double>(squared)))) continue;
        if (!winding_.closed() && !open_.decides(other.number, nodes_.reach(other.speaker, members(component)), open_.slope_bound()))
          continue;
        tell(component, other.speaker, other.number);
        return true;
      }
    }
    return false;
  }

  BlockResult write(LevelSetBlock& block) {
    block.origin = nodes_.origin;
    std::fill(std::begin(block.active), std::end(block.active), std::uint64_t{0});
    const double limit = settings_.half_width;
    for (int node = 0; node < kBlockNodes; ++node) {
      const double value = distances_[static_cast<size_t>(node)];
      block.values[node] = static_cast<float>(std::clamp(value, -limit, limit));
      result_.any_inside |= value < 0.0;
      if (!(std::abs(value) <= limit)) continue;
      block.active[node >> 6] |= std::uint64_t{1} << (node & 63);
      result_.any_active = true;
    }
    return result_;
  }

  const Winding& winding_;
  const BlockSettings& settings_;
  std::span<const std::uint32_t> triangles_;
  std::array<const BlockFace*, 3> before_{};  ///< Null where the block there is not known.
  BlockDistanceArray distances_;
  BlockNodes nodes_;
  std::array<bool, kBlockNodes> inside_{};
  OpenSides open_;  ///< Of an open mesh.
  BlockComponents joined_;
  std::vector<Component*> waiting_;  ///< Small ones that have no answer yet.
  BlockResult result_;
};

}  // namespace

/// Neighbouring nodes bound each other's search; nodes out of reach hold infinity.
void measure_block(const glm::ivec3& origin, const ClosestPointData& distance, double voxel_size, double reach,
                   BlockDistanceArray& distances) {
  std::array<std::uint32_t, kBlockNodes> closest_triangles{};  // where the distance is finite
  for (int node = 0; node < kBlockNodes; ++node) {
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
