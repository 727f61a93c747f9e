#include "raymarch/local/node_measure.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <optional>

#include "raymarch/level_set/quantise.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

glm::ivec3 node_of(const NodeBlock& block, int n) { return block.origin + glm::ivec3(n >> 6, n >> 3 & 7, n & 7); }

/// Calls `visit(n)` for each node of a word of bits, `word` of eight.
template <class Visit>
void for_each_bit(std::uint64_t bits, size_t word, const Visit& visit) {
  for (; bits != 0; bits &= bits - 1) visit(static_cast<int>(word) << 6 | std::countr_zero(bits));
}

std::optional<LargerBeside> larger_beside(const NodeMeasure& measure, const NodeBlock& block) {
  std::optional<LargerBeside> beside;
  if (measure.larger) beside.emplace(*measure.larger, block.origin);
  if (beside && !beside->any()) beside.reset();
  return beside;
}

/// The surface's own value, or the larger bricks': cells far from their surface must not meet it on their faces, where it would end.
/// Creases that larger voxels round off reach so far.
double on_its_side(double value, const glm::ivec3& node, LargerBeside& beside) {
  return beside.on_other_side(node, value < 0.0) ? beside.interpolated(node) : value;
}

/// Where the nodes of a block stand along each axis.
struct NodePlaces {
  double at[3][8];

  NodePlaces(const glm::dvec3& origin, double h, const glm::ivec3& first) {
    for (int axis = 0; axis < 3; ++axis)
      for (int k = 0; k < 8; ++k) at[axis][k] = origin[axis] + h * static_cast<double>(first[axis] + k);
  }
};

/// Nodes of a block that the surface is asked for.
struct AskedNodes {
  LanePoints points;
  std::array<std::uint16_t, kMostLanePoints> numbers;  ///< Of the nodes in their block.

  /// The nodes of a word, row by row along z.
  void add(std::uint64_t bits, size_t word, const NodePlaces& places) {
    for (size_t y = 0; y < 8; ++y, bits >>= 8) {
      const auto first = static_cast<std::uint16_t>(word << 6 | y << 3);
      std::uint32_t row = bits & 0xff;
      if (row == 0xff) {
        add_row(first, {places.at[0][word], places.at[1][y]}, places.at[2]);
        continue;
      }
      for (; row != 0; row &= row - 1) {
        const auto z = static_cast<size_t>(std::countr_zero(row));
        numbers[points.count] = static_cast<std::uint16_t>(first + z);
        points.add({places.at[0][word], places.at[1][y], places.at[2][z]});
      }
    }
  }

 private:
  /// All eight.
  void add_row(std::uint16_t first, const glm::dvec2& at, const double (&along_z)[8]) {
    const size_t from = points.count;
    for (size_t z = 0; z < 8; ++z) {
      points.at[0][from + z] = at.x;
      points.at[1][from + z] = at.y;
      points.at[2][from + z] = along_z[z];
      numbers[from + z] = static_cast<std::uint16_t>(first + z);
    }
    points.count += 8;
  }
};

/// What a larger brick tells is not asked of the field.
void ask_field(const NodeBlock& block, const NodeMeasure& measure, const LargerBeside* beside, AskedNodes& asked) {
  const NodePlaces places(measure.choice.origin, measure.lattice.h, block.origin);
  for (size_t word = 0; word < 8; ++word) {
    const std::uint64_t pending = block.wanted[word] & ~block.known[word];
    asked.add(beside ? pending & ~beside->near_nodes(word) : pending, word, places);
  }
  asked.points.fill_up();
}

void take_from_larger(NodeBlock& block, const NodeMeasure& measure, LargerBeside& beside) {
  for (size_t word = 0; word < 8; ++word)
    for_each_bit(block.wanted[word] & ~block.known[word] & beside.near_nodes(word), word,
                 [&](int n) { block.set(static_cast<size_t>(n), measure.steps(beside.interpolated(node_of(block, n)))); });
}

void evaluate_field(DistanceEvaluator& distance, NodeBlock& block, const NodeMeasure& measure) {
  std::optional<LargerBeside> beside = larger_beside(measure, block);
  if (beside) take_from_larger(block, measure, *beside);
  AskedNodes asked;
  ask_field(block, measure, beside ? &*beside : nullptr, asked);
  if (asked.points.count == 0) return;
  LaneNumbers distances;
  const double half_width = measure.lattice.half_width;
  signed_distances(distance, asked.points, half_width, distances);
  std::array<float, kMostLanePoints> values;
  for (size_t k = 0; k < asked.points.count; ++k) values[k] = static_cast<float>(std::clamp(distances[k], -half_width, half_width));
  if (beside && beside->may_be_on_other_side())
    for (size_t k = 0; k < asked.points.count; ++k)
      values[k] = static_cast<float>(on_its_side(static_cast<double>(values[k]), node_of(block, asked.numbers[k]), *beside));
  std::array<std::int16_t, kMostLanePoints> steps;
  quantise(std::span(values).first(asked.points.count), measure.steps_per_unit, steps.data());
  for (size_t k = 0; k < asked.points.count; ++k) block.set(asked.numbers[k], steps[k]);
}

/// All nodes of the block at once, as a uniform level set has them: the signs of some follow from others.
void evaluate_mesh(const MeshPart& part, NodeBlock& block, const NodeMeasure& measure, FilledBlocks& filled) {
  if (!block.measured) {
    std::array<float, 512> own;
    block_distances(part, block.origin, measure.lattice, filled, own);
    for (size_t n = 0; n < 512; ++n)
      if (!block.is_known(n)) block.steps[n] = quantised(own[n], measure.steps_per_unit);
    block.measured = true;
  }
  std::optional<LargerBeside> beside = larger_beside(measure, block);
  if (!beside) return;
  take_from_larger(block, measure, *beside);
  for (size_t word = 0; word < 8; ++word)
    for_each_bit(block.wanted[word] & ~block.known[word] & ~beside->near_nodes(word), word, [&](int n) {
      std::int16_t& steps = block.steps[static_cast<size_t>(n)];
      if (const glm::ivec3 node = node_of(block, n); beside->on_other_side(node, steps < 0))
        steps = measure.steps(beside->interpolated(node));
    });
}

/// Evaluates blocks one after the other, for one thread.
class BlockEvaluator {
 public:
  explicit BlockEvaluator(const NodeMeasure& measure) : measure_(measure) {}

  void evaluate(NodeBlock& block) {
    if (const Field* const field = std::get_if<Field>(block.part)) {
      turn_to(*field, distance_);
      evaluate_field(*distance_, block, measure_);
    } else {
      evaluate_mesh(std::get<MeshPart>(*block.part), block, measure_, filled_);
    }
    for (size_t word = 0; word < 8; ++word) block.known[word] |= block.wanted[word];
  }

 private:
  const NodeMeasure& measure_;
  std::optional<DistanceEvaluator> distance_{};
  FilledBlocks filled_{};  ///< Of a mesh.
};

/// Of a mesh one block tells the next on which side of it nodes lie: by x, y and z. Those of a field stay beside the bricks that they came
/// with, whose part of the field they ask.
std::vector<size_t> order_of(const NodeBlocks& blocks) {
  std::vector<size_t> order(blocks.size());
  std::iota(order.begin(), order.end(), size_t{0});
  if (blocks.empty() || std::holds_alternative<Field>(*blocks[0].part)) return order;
  std::vector<std::uint64_t> keys(blocks.size());
  for (size_t i = 0; i < blocks.size(); ++i) keys[i] = key_of(blocks[i].origin);
  parallel_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return keys[a] < keys[b]; });
  return order;
}

}  // namespace

void measure_wanted(NodeBlocks& blocks, const NodeMeasure& measure) {
  if (blocks.empty()) return;
  // Of a mesh all nodes of a block are measured together.
  blocks.make_room(std::holds_alternative<MeshPart>(*blocks[0].part));
  const std::vector<size_t> order = order_of(blocks);
  const size_t at_once = std::clamp(order.size() / 64, size_t{16}, size_t{512});
  parallel_parts(order.size(), at_once, [&](const IndexRange<size_t>& range) {
    BlockEvaluator evaluator(measure);
    for (size_t i = range.begin(); i < range.end(); ++i) evaluator.evaluate(blocks[order[i]]);
  });
}

std::array<std::uint64_t, 8> NodeSides::inside(const NodeBlock& block) {
  std::array<std::uint64_t, 8> bits{};
  if (block.measured) {
    for (size_t n = 0; n < 512; ++n) bits[n >> 6] |= std::uint64_t{block.step(n) < 0} << (n & 63);
    return bits;
  }
  const Field& field = std::get<Field>(*block.part);
  turn_to(field, distance_);
  AskedNodes asked;
  const NodePlaces places(origin_, h_, block.origin);
  for (size_t word = 0; word < 8; ++word) asked.add(~block.known[word], word, places);
  if (asked.points.count == 0) return bits;
  asked.points.fill_up();
  LaneNumbers values;
  field_values(*distance_, asked.points, values);
  for (size_t k = 0; k < asked.points.count; ++k) bits[asked.numbers[k] >> 6] |= std::uint64_t{values[k] < 0.0} << (asked.numbers[k] & 63);
  return bits;
}

}  // namespace limn
