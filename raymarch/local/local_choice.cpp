#include "raymarch/local/local_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "raymarch/level_set/brick_layout.h"
#include "raymarch/local/brick_demand.h"
#include "sdf/number.h"
#include "sdf/parallel.h"
#include "sdf/size_error.h"

namespace limn {
namespace {

/// What a brick costs while it is built and after: nodes, a leaf, 16-bit values and layers.
constexpr std::int64_t kBrickBytes = 10'000;

struct Node {
  LocalBrick brick;
  bool split = false;
};

/// False only where the surface does not pass the box: by bounds of the value, then by those of its slope about the middle.
bool may_hold_surface(FieldEvaluator& evaluator, const Box& box) {
  if (!evaluator.bounds(box).contains(0.0)) return false;
  const GradientBounds bounds = evaluator.gradient_bounds(box);
  const glm::dvec3 half = 0.5 * box.size();
  double reach = 0.0;
  for (int axis = 0; axis < 3; ++axis) reach += half[axis] * magnitude(bounds.gradient[static_cast<size_t>(axis)]);
  // Corners are nowhere nearer to the middle than rounding makes them.
  return std::abs(evaluator.value(box.center())) <= reach * (1.0 + 1e-9) + 1e-12 * glm::length(half);
}

/// The parts of a brick that may hold the surface, each with what is left of the field there.
std::vector<LocalBrick> parts_of(FieldEvaluator& evaluator, const LocalBrick& brick, const LocalChoice& lattice, size_t level) {
  std::vector<LocalBrick> parts;
  const double h = lattice.voxel_of(level - 1);
  for (int octant = 0; octant < 8; ++octant) {
    const glm::ivec3 place = 2 * brick.place + glm::ivec3(octant & 1, octant >> 1 & 1, octant >> 2);
    const Box box = lattice.box_of(level - 1, place);
    if (!may_hold_surface(evaluator, box)) continue;
    // Its nodes are at most eight voxels away from a node that asks for the field, which asks as far as the band reaches.
    parts.push_back({place, evaluator.restricted(dilate(box, 16.0 * h))});
  }
  return parts;
}

/// Bricks of all sizes, those that were split among them.
class BrickTree {
 public:
  BrickTree(const LocalChoice& lattice, size_t levels, std::int64_t max_bytes)
      : lattice_(lattice), nodes_(levels), at_(levels), max_bytes_(max_bytes) {}

  void add(size_t level, LocalBrick brick) {
    at_[level].emplace(key_of(8 * brick.place), nodes_[level].size());
    nodes_[level].push_back({std::move(brick)});
    if (++count_ * kBrickBytes > max_bytes_) refuse();
  }

  std::vector<Node>& nodes(size_t level) { return nodes_[level]; }

  /// Neighbours that are larger are split first, so that no two bricks that touch differ by more than one size.
  void split(size_t level, size_t index, const std::vector<LocalBrick>* parts) {
    if (nodes_[level][index].split) return;
    nodes_[level][index].split = true;
    const LocalBrick brick = nodes_[level][index].brick;
    if (parts) {
      for (const LocalBrick& part : *parts) add(level - 1, part);
    } else {
      FieldEvaluator evaluator(brick.field);
      for (LocalBrick& part : parts_of(evaluator, brick, lattice_, level)) add(level - 1, std::move(part));
    }
    for (int k = 0; k < 27; ++k) require(level, brick.place + glm::ivec3(k / 9 - 1, k / 3 % 3 - 1, k % 3 - 1));
  }

 private:
  /// Splits what is larger at that place, if the surface passes there.
  void require(size_t level, const glm::ivec3& place) {
    if (level + 1 >= nodes_.size() || at_[level].contains(key_of(8 * place))) return;
    const glm::ivec3 parent(place.x >> 1, place.y >> 1, place.z >> 1);
    require(level + 1, parent);
    const auto found = at_[level + 1].find(key_of(8 * parent));
    if (found != at_[level + 1].end()) split(level + 1, found->second, nullptr);
  }

  [[noreturn]] void refuse() const {
    throw SizeError(
        {{},
         "voxel size",
         fmt::format("{:.4g}", lattice_.voxel_size),
         fmt::format("building the local level set needs more than the limit of {:.2f} GB", static_cast<double>(max_bytes_) / 1e9),
         "larger voxels or a larger tolerance"});
  }

  const LocalChoice& lattice_;
  std::vector<std::vector<Node>> nodes_;
  std::vector<std::unordered_map<std::uint64_t, size_t>> at_;
  std::int64_t max_bytes_, count_ = 0;
};

/// The bricks of one size that pictures ask to be split, all at once, then one after the other.
void refine(size_t level, const LocalChoice& lattice, const LocalBrickSettings& settings, BrickTree& tree) {
  const std::vector<Node>& nodes = tree.nodes(level);
  const size_t count = nodes.size();
  std::vector<std::uint8_t> needed(count, 0);
  std::vector<std::vector<LocalBrick>> parts(count);
  parallel_for(size_t{0}, count, [&](size_t i) {
    if (nodes[i].split) return;
    FieldEvaluator evaluator(nodes[i].brick.field);
    if (!needs_smaller_voxels(evaluator, lattice.box_of(level, nodes[i].brick.place), lattice.voxel_of(level), settings)) return;
    needed[i] = 1;
    parts[i] = parts_of(evaluator, nodes[i].brick, lattice, level);
  });
  for (size_t i = 0; i < count; ++i)
    if (needed[i]) tree.split(level, i, &parts[i]);
}

}  // namespace

LocalChoice choose_bricks(const Field& field, const LocalBrickSettings& settings) {
  const Box& bounds = field.traits().bounds;
  LocalChoice choice;
  choice.voxel_size = settings.voxel_size;
  // The largest bricks are half as large as the surface.
  size_t top = 0;
  while (top < 20 && 16.0 * choice.voxel_of(top) < bounds.longest_side()) ++top;
  const double step = 8.0 * choice.voxel_of(top);
  choice.origin = glm::round(bounds.center() / step) * step;
  const glm::ivec3 lower(glm::floor((bounds.lower - choice.origin) / step)), upper(glm::ceil((bounds.upper - choice.origin) / step));
  BrickTree tree(choice, top + 1, settings.max_bytes);
  FieldEvaluator evaluator(field);
  // Faces of the bounds may lie on faces of bricks: one more to each side.
  for (int x = lower.x - 1; x <= upper.x; ++x)
    for (int y = lower.y - 1; y <= upper.y; ++y)
      for (int z = lower.z - 1; z <= upper.z; ++z)
        if (evaluator.bounds(choice.box_of(top, {x, y, z})).contains(0.0)) tree.add(top, {{x, y, z}, field});
  // Splitting one may split larger ones beside it. Their parts are not looked at: what asks for smaller voxels in a part asks for them in
  // the whole.
  for (size_t level = top; level > 0; --level) refine(level, choice, settings, tree);
  choice.levels.resize(top + 1);
  for (size_t level = 0; level <= top; ++level) {
    for (Node& node : tree.nodes(level))
      if (!node.split) choice.levels[level].push_back(std::move(node.brick));
    std::sort(choice.levels[level].begin(), choice.levels[level].end(),
              [](const LocalBrick& a, const LocalBrick& b) { return key_of(8 * a.place) < key_of(8 * b.place); });
  }
  return choice;
}

}  // namespace limn
