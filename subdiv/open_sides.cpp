#include "subdiv/open_sides.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace limn {
namespace {

constexpr int kSmallestCube = 2;

template <class Visit>
void for_each_neighbour(int node, const Visit& visit) {
  const glm::ivec3 at = node_at(node);
  constexpr int kStrides[3] = {64, 8, 1};
  for (int axis = 0; axis < 3; ++axis) {
    if (at[axis] > 0) visit(node - kStrides[axis]);
    if (at[axis] < 7) visit(node + kStrides[axis]);
  }
}

}  // namespace

double OpenSides::slope_bound() {
  if (slope_bound_ < 0.0) slope_bound_ = winding_.gradient_bound(center_of(glm::ivec3(0), 8), bound_radius(8));
  return slope_bound_;
}

bool OpenSides::decides(double number, double reach, double slope, double error) const {
  return std::abs(number - 0.5) > slope * (reach + half_width_) + error;
}

/// Of the cube of `size` nodes at `corner`.
glm::dvec3 OpenSides::center_of(const glm::ivec3& corner, int size) const {
  return nodes_.world(0) + nodes_.voxel_size * (glm::dvec3(corner) + 0.5 * (size - 1));
}
double OpenSides::bound_radius(int size) const { return 0.5 * (size - 1) * std::sqrt(3.0) * nodes_.voxel_size + half_width_; }

/// The eight cubes of half the size by themselves.
void OpenSides::settle_parts(std::span<const int> nodes, const glm::ivec3& corner, int half) {
  std::array<glm::ivec3, 8> corners;
  std::array<glm::dvec3, 8> centers;
  for (int part = 0; part < 8; ++part) {
    const auto k = static_cast<size_t>(part);
    corners[k] = corner + half * glm::ivec3(part >> 2, (part >> 1) & 1, part & 1);
    centers[k] = center_of(corners[k], half);
  }
  std::array<double, 8> slopes;
  winding_.gradient_bounds(centers, bound_radius(half), slopes);
  std::array<std::vector<int>, 8> parts;
  for (const int node : nodes) {
    const glm::ivec3 at = (node_at(node) - corner) / half;
    parts[static_cast<size_t>(at.x << 2 | at.y << 1 | at.z)].push_back(node);
  }
  for (size_t k = 0; k < 8; ++k)
    if (!parts[k].empty()) settle_joined(parts[k], corners[k], half, slopes[k]);
}

/// What hangs together in the whole block may do so around a border; in a part of it the sides can be apart.
void OpenSides::settle_joined(const std::vector<int>& nodes, const glm::ivec3& corner, int size, double slope) {
  std::array<bool, kBlockNodes> waiting{};
  for (const int node : nodes) waiting[static_cast<size_t>(node)] = true;
  std::vector<int> joined;
  for (const int first : nodes) {
    if (!waiting[static_cast<size_t>(first)]) continue;
    joined.assign(1, first);
    waiting[static_cast<size_t>(first)] = false;
    for (size_t i = 0; i < joined.size(); ++i) {
      for_each_neighbour(joined[i], [&](int node) {
        if (!waiting[static_cast<size_t>(node)] || !nodes_.clear_step(joined[i], node, 1.0)) return;
        waiting[static_cast<size_t>(node)] = false;
        joined.push_back(node);
      });
    }
    settle_part(joined, corner, size, slope);
  }
}

/// Nodes of one component in the cube of `size` nodes at `corner`.
void OpenSides::settle_part(std::span<const int> nodes, const glm::ivec3& corner, int size, double slope) {
  const bool is_last = size <= kSmallestCube;
  // So close to the border no node tells of another.
  if (!std::isfinite(slope)) return is_last ? near_hole(nodes, nullptr) : settle_parts(nodes, corner, size / 2);
  const int speaker = nodes_.farthest_off(nodes);
  const double number = winding_.number(nodes_.world(speaker), is_last ? Winding::kCloseLook : Winding::kFarLook);
  if (decides(number, nodes_.reach(speaker, nodes), slope, is_last ? Winding::kCloseError : Winding::kFarError)) {
    for (const int node : nodes) inside_[static_cast<size_t>(node)] = number > 0.5;
    return;
  }
  if (!is_last) return settle_parts(nodes, corner, size / 2);
  const Potential known{speaker, number};
  near_hole(nodes, &known);
}

/// The trapezium rule along the step, where the gradient changes so little that it is as good as the tree.
double OpenSides::number_near(const Potential& known, int node, const glm::dvec3& gradient) const {
  constexpr double kStraight = 0.01;
  const glm::dvec3 p = nodes_.world(node), step = p - nodes_.world(known.node);
  const bool straight = glm::length(gradient - known.gradient) * glm::length(step) < kStraight;
  return straight ? known.number + 0.5 * glm::dot(gradient + known.gradient, step) : winding_.number(p);
}

/// At most eight nodes of one component close to each other. The number at one of them, without its gradient, tells those of the others;
/// null: each is asked for its own.
void OpenSides::near_hole(std::span<const int> nodes, const Potential* known) {
  std::array<glm::dvec3, 8> places, gradients;
  for (size_t k = 0; k < nodes.size(); ++k) places[k] = nodes_.world(nodes[k]);
  winding_.gradients(std::span(places).first(nodes.size()), std::span(gradients).first(nodes.size()));
  Potential speaks;
  if (known) {
    speaks = *known;
    speaks.gradient = gradients[static_cast<size_t>(std::find(nodes.begin(), nodes.end(), known->node) - nodes.begin())];
  }
  for (size_t k = 0; k < nodes.size(); ++k)
    near_hole(nodes[k], known ? number_near(speaks, nodes[k], gradients[k]) : winding_.number(places[k]), gradients[k]);
}

void OpenSides::near_hole(int node, double number, const glm::dvec3& gradient) {
  const double slope = glm::length(gradient), to_triangles = nodes_.distance(node);
  const double to_membrane = slope > 0.0 ? std::abs(number - 0.5) / slope : std::numeric_limits<double>::infinity();
  if (to_membrane < half_width_ && to_membrane < to_triangles) has_membrane_ = true;
  // Other components still ask for the distance to the triangles: these wait until all are settled.
  near_membrane_.push_back({node, std::min(to_triangles, to_membrane)});
  inside_[static_cast<size_t>(node)] = number > 0.5;
}

}  // namespace limn
