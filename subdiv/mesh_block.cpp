// One block of a mesh's level set. The sign is the generalised winding number above one half, but it is asked for as seldom as possible:
// a straight step from p to q of length h cannot meet a triangle while d(p) + d(q) > h, so nodes joined by such steps lie on one side, and
// one of them answers for all. Near the holes of an open mesh the number changes smoothly through one half; there every node is asked, and
// the surface {w = 1/2}, which closes the hole, counts as surface with its distance to first order, |w - 1/2| / |grad w|.
#include "subdiv/mesh_block.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace limn {
namespace {

constexpr int kNodes = 512;

int node_index(int x, int y, int z) { return x * 64 + y * 8 + z; }
glm::ivec3 node_at(int index) { return {index >> 6, (index >> 3) & 7, index & 7}; }

class BlockFiller {
 public:
  BlockFiller(const glm::ivec3& origin, const ClosestPointData& distance, const Winding& winding, const BlockSettings& settings)
      : origin_(origin), distance_(distance), winding_(winding), settings_(settings) {}

  BlockResult run(LevelSetBlock& block) {
    measure();
    if (settings_.shell > 0.0) {
      for (double& d : distances_) d -= settings_.shell;
      return write(block);
    }
    bound_gradient();
    component_.fill(-1);
    for (int node = 0; node < kNodes; ++node)
      if (component_[static_cast<size_t>(node)] < 0) settle_component(node);
    return write(block);
  }

 private:
  glm::dvec3 world(int node) const { return settings_.voxel_size * glm::dvec3(origin_ + node_at(node)); }

  /// Neighbouring nodes bound each other's search; nodes out of reach hold infinity.
  void measure() {
    const double reach = settings_.half_width + settings_.shell;
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
        radius = std::min(radius, distances_[neighbour] + 1.0001 * settings_.voxel_size);
        if (std::isfinite(distances_[neighbour])) likely[likely_count++] = closest_[neighbour];
      }
      const auto closest = distance_.within(world(node), radius, {likely.data(), likely_count});
      closest_[static_cast<size_t>(node)] = closest ? closest->triangle : 0;
      distances_[static_cast<size_t>(node)] = closest ? closest->distance : std::numeric_limits<double>::infinity();
    }
  }

  void bound_gradient() {
    if (winding_.closed()) return;
    const glm::dvec3 center = settings_.voxel_size * (glm::dvec3(origin_) + 3.5);
    gradient_bound_ = winding_.gradient_bound(center, 3.5 * std::sqrt(3.0) * settings_.voxel_size + settings_.half_width);
  }

  /// The nodes that can be reached from `first` without a chance to cross a triangle.
  void gather(int first) {
    members_.assign(1, first);
    component_[static_cast<size_t>(first)] = first;
    for (size_t i = 0; i < members_.size(); ++i) {
      const glm::ivec3 at = node_at(members_[i]);
      for (int axis = 0; axis < 3; ++axis)
        for (const int direction : {-1, 1}) {
          glm::ivec3 next = at;
          next[axis] += direction;
          if (next[axis] < 0 || next[axis] > 7) continue;
          const int node = node_index(next.x, next.y, next.z);
          if (component_[static_cast<size_t>(node)] >= 0) continue;
          const double room = distances_[static_cast<size_t>(members_[i])] + distances_[static_cast<size_t>(node)];
          if (!(room > 1.000001 * settings_.voxel_size)) continue;
          component_[static_cast<size_t>(node)] = first;
          members_.push_back(node);
        }
    }
  }

  void settle_component(int first) {
    gather(first);
    // The farthest from the surface answers: there the number is nearest to a whole one.
    int speaker = first;
    for (const int node : members_)
      if (distances_[static_cast<size_t>(node)] > distances_[static_cast<size_t>(speaker)]) speaker = node;
    const double number = winding_.number(world(speaker));
    if (winding_.closed()) {
      for (const int node : members_) apply_sign(node, number > 0.5);
      return;
    }
    // Within the block, which no border enters, the number is a smooth potential and whole numbers: along the component's ways only the
    // potential changes, by no more than its slope times the straight distance. The membrane must be out of the band's reach as well.
    double farthest = 0.0;
    for (const int node : members_) farthest = std::max(farthest, glm::distance(world(speaker), world(node)));
    const double change = gradient_bound_ * (farthest + settings_.half_width);
    constexpr double kTreeError = 0.03;
    if (std::abs(number - 0.5) > change + kTreeError) {
      for (const int node : members_) apply_sign(node, number > 0.5);
      return;
    }
    for (const int node : members_) near_hole(node);
  }

  void apply_sign(int node, bool inside) {
    if (inside) distances_[static_cast<size_t>(node)] = -distances_[static_cast<size_t>(node)];
  }

  void near_hole(int node) {
    const glm::dvec3 p = world(node);
    const double number = winding_.number(p), slope = glm::length(winding_.gradient(p));
    double& distance = distances_[static_cast<size_t>(node)];
    const double to_membrane = slope > 0.0 ? std::abs(number - 0.5) / slope : std::numeric_limits<double>::infinity();
    if (to_membrane < settings_.half_width && to_membrane < distance) result_.membrane = true;
    distance = std::min(distance, to_membrane);
    apply_sign(node, number > 0.5);
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
  const ClosestPointData& distance_;
  const Winding& winding_;
  const BlockSettings& settings_;
  double gradient_bound_ = 0.0;
  std::array<double, kNodes> distances_{};
  std::array<std::uint32_t, kNodes> closest_{};  ///< Triangles, where the distance is finite.
  std::array<int, kNodes> component_{};
  std::vector<int> members_;
  BlockResult result_;
};

}  // namespace

BlockResult fill_block(const glm::ivec3& origin, const ClosestPointData& distance, const Winding& winding, const BlockSettings& settings,
                       LevelSetBlock& block) {
  return BlockFiller(origin, distance, winding, settings).run(block);
}

}  // namespace limn
