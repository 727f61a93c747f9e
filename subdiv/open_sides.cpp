#include "subdiv/open_sides.h"

#include <cmath>
#include <limits>
#include <optional>

namespace limn {
namespace {

template <class Visit>
void for_each_neighbour(int node, const Visit& visit) {
  const glm::ivec3 at = node_at(node);
  constexpr int kStrides[3] = {64, 8, 1};
  for (int axis = 0; axis < 3; ++axis) {
    if (at[axis] > 0) visit(node - kStrides[axis]);
    if (at[axis] < 7) visit(node + kStrides[axis]);
  }
}

/// A whole number is certain where what tells it is nearer than that.
constexpr double kCertain = 0.25;

/// The number of that potential next to one that is about right.
std::optional<double> next_to(double number, const Winding::Potential& potential) {
  const double exact = potential.part + std::round(number - potential.part);
  return std::abs(exact - number) < kCertain ? std::optional(exact) : std::nullopt;
}

}  // namespace

double OpenSides::slope_bound() {
  const double half_side = 3.5 * nodes_.voxel_size;
  if (slope_bound_ < 0.0) slope_bound_ = winding_.gradient_bound(nodes_.world(0) + half_side, std::sqrt(3.0) * half_side + half_width_);
  return slope_bound_;
}

bool OpenSides::decides(double number, double reach, double slope, double error) const {
  return std::abs(number - 0.5) > slope * (reach + half_width_) + error;
}

/// The tree tells the whole number, unless something is wrong with the mesh.
double OpenSides::number_at(int node) const {
  const double number = winding_.number(nodes_.world(node));
  return next_to(number, potential_->at(node)).value_or(number);
}

/// By the trapezium rule along a step that no triangle crosses; nothing where the gradient changes too much for that.
std::optional<double> OpenSides::number_from(int node, double number, int next) const {
  const Winding::Potential &from = potential_->at(node), &to = potential_->at(next);
  const glm::dvec3 step = nodes_.world(next) - nodes_.world(node);
  if (!(glm::length(to.gradient - from.gradient) * glm::length(step) < kCertain)) return std::nullopt;
  return next_to(number + 0.5 * glm::dot(from.gradient + to.gradient, step), to);
}

/// From the node that is farthest off, where the number is most certain, along clear steps.
void OpenSides::settle(std::span<const int> nodes) {
  if (!potential_) potential_.emplace(nodes_, winding_);
  std::array<bool, kBlockNodes> waiting{};
  for (const int node : nodes) waiting[static_cast<size_t>(node)] = true;
  std::array<double, kBlockNodes> numbers;
  std::vector<int> reached{nodes_.farthest_off(nodes)};
  waiting[static_cast<size_t>(reached.front())] = false;
  numbers[static_cast<size_t>(reached.front())] = number_at(reached.front());
  for (size_t i = 0; i < reached.size(); ++i) {
    const int node = reached[i];
    const double number = numbers[static_cast<size_t>(node)];
    near_hole(node, number);
    for_each_neighbour(node, [&](int next) {
      if (!waiting[static_cast<size_t>(next)] || !nodes_.clear_step(node, next, 1.0)) return;
      waiting[static_cast<size_t>(next)] = false;
      const std::optional<double> carried = number_from(node, number, next);
      numbers[static_cast<size_t>(next)] = carried ? *carried : number_at(next);
      reached.push_back(next);
    });
  }
}

void OpenSides::near_hole(int node, double number) {
  const double slope = glm::length(potential_->at(node).gradient), to_triangles = nodes_.distance(node);
  const double to_membrane = slope > 0.0 ? std::abs(number - 0.5) / slope : std::numeric_limits<double>::infinity();
  if (to_membrane < half_width_ && to_membrane < to_triangles) has_membrane_ = true;
  // Other components still ask for the distance to the triangles: these wait until all are settled.
  near_membrane_.push_back({node, std::min(to_triangles, to_membrane)});
  inside_[static_cast<size_t>(node)] = number > 0.5;
}

}  // namespace limn
