#include "raymarch/local/local_nodes.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "raymarch/local/node_measure.h"
#include "sdf/level_set_nano.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

size_t block_at(LevelNodes& nodes, const glm::ivec3& origin, const SurfacePart& part) {
  const auto [number, is_new] = nodes.at.add(key_of(origin));
  if (is_new) nodes.blocks.add(origin, part);
  return number;
}

/// The 9^3 nodes of a brick: all of its own block, and the first layers of those behind.
void want_brick(const LocalBrick& brick, LevelNodes& nodes) {
  constexpr std::uint64_t kAll = ~std::uint64_t{0}, kFirstRow = 0xff, kFirstColumn = 0x0101010101010101;
  std::array<std::uint32_t, 8>& numbers = nodes.of_brick.emplace_back();
  for (size_t corner = 0; corner < 8; ++corner) {
    const glm::ivec3 step(corner & 1, corner >> 1 & 1, corner >> 2);
    const size_t number = block_at(nodes, 8 * (brick.place + step), brick.part);
    numbers[corner] = static_cast<std::uint32_t>(number);
    NodeBlock& block = nodes.blocks[number];
    const std::uint64_t bits = (step.y ? kFirstRow : kAll) & (step.z ? kFirstColumn : kAll);
    for (size_t x = 0; x < (step.x ? 1 : 8); ++x) block.wanted[x] |= bits;
  }
}

/// Nodes -2..10 about a brick that the stencils of its crossed cells read: bit z + 2 of [x + 2][y + 2].
using ReadNodes = std::array<std::array<std::uint32_t, 13>, 13>;
ReadNodes nodes_read(const CrossedCells& crossed, const Stencil& stencil) {
  ReadNodes read{};
  for (size_t x = 0; x < 8; ++x)
    for (size_t y = 0; y < 8; ++y) {
      const std::uint32_t cells = crossed.cells[x][y];
      if (cells == 0) continue;
      for (size_t dx = 0; dx < 6; ++dx)
        for (size_t dy = 0; dy < 6; ++dy)
          for (std::uint32_t bits = stencil[dx][dy]; bits != 0; bits &= bits - 1) read[x + dx][y + dy] |= cells << std::countr_zero(bits);
    }
  return read;
}

/// Of the nodes about a brick those that are not its own, which are known.
void want_read(const LocalBrick& brick, const ReadNodes& read, LevelNodes& nodes) {
  std::array<NodeBlock*, 27> blocks{};
  for (int x = -2; x <= 10; ++x)
    for (int y = -2; y <= 10; ++y) {
      std::uint32_t bits = read[static_cast<size_t>(x) + 2][static_cast<size_t>(y) + 2];
      if (x >= 0 && x <= 8 && y >= 0 && y <= 8) bits &= ~(0x1ffu << 2);
      // Of a row, nodes -2 and -1, 0 to 7, 8 to 10 lie in a block each, from these nodes of it on.
      const std::array<std::uint64_t, 3> rows{std::uint64_t{bits & 3} << 6, bits >> 2 & 0xff, bits >> 10};
      for (int z = 0; z < 3; ++z) {
        const std::uint64_t row = rows[static_cast<size_t>(z)];
        if (row == 0) continue;
        const glm::ivec3 step(x >> 3, y >> 3, z - 1);
        const int at = 9 * (step.x + 1) + 3 * (step.y + 1) + z;
        NodeBlock*& block = blocks[static_cast<size_t>(at)];
        if (!block) block = &nodes.blocks[block_at(nodes, 8 * (brick.place + step), brick.part)];
        block->wanted[static_cast<size_t>(x & 7)] |= row << 8 * (y & 7);
      }
    }
}

/// Which cells of each brick the surface crosses.
void find_crossed(const std::vector<LocalBrick>& bricks, LevelNodes& nodes) {
  nodes.crossed.resize(bricks.size());
  parallel_parts(bricks.size(), size_t{64}, [&](const IndexRange<size_t>& range) {
    NodeSteps steps;
    for (size_t i = range.begin(); i < range.end(); ++i) {
      load_brick(nodes, i, steps);
      nodes.crossed[i] = without_covered(crossed_cells_of(steps), bricks[i].covered);
    }
  });
}

/// What the stencils of crossed cells read beyond their brick.
void want_stencils(const std::vector<LocalBrick>& bricks, const Stencil& stencil, LevelNodes& nodes) {
  // So many at once stay in the cache.
  constexpr size_t kAtOnce = 1024;
  std::vector<ReadNodes> read(std::min(bricks.size(), kAtOnce));
  for (size_t first = 0; first < bricks.size(); first += kAtOnce) {
    const size_t count = std::min(bricks.size() - first, kAtOnce);
    parallel_parts(count, size_t{64}, [&](const IndexRange<size_t>& range) {
      for (size_t i = range.begin(); i < range.end(); ++i)
        if (const CrossedCells& crossed = nodes.crossed[first + i]; crossed.any) read[i] = nodes_read(crossed, stencil);
    });
    for (size_t i = 0; i < count; ++i)
      if (nodes.crossed[first + i].any) want_read(bricks[first + i], read[i], nodes);
  }
}

}  // namespace

void load_brick(const LevelNodes& nodes, size_t brick, NodeSteps& steps) {
  for (size_t corner = 0; corner < 8; ++corner) {
    const glm::ivec3 step(corner & 1, corner >> 1 & 1, corner >> 2);
    const NodeBlock& block = nodes.blocks[nodes.of_brick[brick][corner]];
    for (int x = 0; x < (step.x ? 1 : 8); ++x)
      for (int y = 0; y < (step.y ? 1 : 8); ++y) {
        std::int16_t* const to = &steps[static_cast<size_t>(brick_element(8 * step.x + x, 8 * step.y + y, 8 * step.z))];
        const std::int16_t* const row = block.steps + block.slot(static_cast<size_t>(x << 6 | y << 3));
        // Lengths that the compiler knows.
        if (step.z)
          *to = *row;
        else
          std::copy_n(row, 8, to);
      }
  }
}

const NodeBlock* LevelNodes::find(const glm::ivec3& origin, const NodeBlock*& last) const {
  if (last && last->origin == origin) return last;
  const size_t number = at.find(key_of(origin));
  return last = number == KeyNumbers::kNone ? nullptr : &blocks[number];
}

float LevelNodes::value(const glm::ivec3& node) const {
  return value_of(blocks[at.find(key_of(block_of(node)))].step(place_in_block(node)));
}

std::int64_t LevelNodes::known() const {
  std::int64_t sum = 0;
  for (size_t i = 0; i < blocks.size(); ++i)
    for (const std::uint64_t word : blocks[i].known) sum += std::popcount(word);
  return sum;
}

NodeReader LevelNodes::reader() const {
  return {this,
          [](const void* of, size_t brick, const glm::ivec3&, NodeSteps& steps) {
            load_brick(*static_cast<const LevelNodes*>(of), brick, steps);
          },
          [](const void* of, const glm::ivec3& node, const void*& last) {
            const auto* block = static_cast<const NodeBlock*>(last);
            static_cast<const LevelNodes*>(of)->find(block_of(node), block);
            last = block;
            const size_t n = place_in_block(node);
            return block && block->is_known(n) ? block->step(n) : std::numeric_limits<std::int16_t>::max();
          }};
}

void sample_bricks(const LocalChoice& choice, const GradientDescriptor& gradient, double half_width_voxels,
                   const std::function<void(size_t level, LevelNodes nodes)>& take) {
  LevelNodes before;  // of the next larger level
  for (size_t level = choice.levels.size(); level-- > 0;) {
    const std::vector<LocalBrick>& bricks = choice.levels[level];
    const bool has_larger = level + 1 < choice.levels.size();
    LevelNodes nodes;
    const double h = choice.voxel_of(level), half_width = half_width_voxels * h;
    nodes.steps_per_unit = static_cast<float>(32767.0 / half_width);
    Larger larger;
    if (has_larger) larger = larger_of(before, choice.step(level), choice.levels[level + 1], h);
    NodeMeasure measure{.choice = choice, .lattice = {h, half_width, choice.doublings[level] == 0}, .steps_per_unit = nodes.steps_per_unit};
    if (has_larger && !choice.levels[level + 1].empty()) measure.larger = &larger;
    nodes.of_brick.reserve(bricks.size());
    for (const LocalBrick& brick : bricks) want_brick(brick, nodes);
    measure_wanted(nodes.blocks, measure);
    find_crossed(bricks, nodes);
    // Stencils read the surface's own values beyond the brick: they are nearer to the surface's normals than a larger brick's interpolant.
    want_stencils(bricks, gradient.stencil, nodes);
    measure.larger = nullptr;
    measure_wanted(nodes.blocks, measure);
    if (has_larger) take(level + 1, std::move(before));
    before = std::move(nodes);
  }
  take(0, std::move(before));
}

std::vector<LevelNodes> sample_bricks(const LocalChoice& choice, const GradientDescriptor& gradient, double half_width_voxels) {
  std::vector<LevelNodes> levels(choice.levels.size());
  sample_bricks(choice, gradient, half_width_voxels, [&](size_t level, LevelNodes nodes) { levels[level] = std::move(nodes); });
  return levels;
}

namespace {

/// What is not known has a value of `sides`' sign; without these its neighbours will tell it.
LevelSetBlock filed_block(const LevelNodes& nodes, const NodeBlock& block, NodeSides* sides) {
  LevelSetBlock filed;
  filed.origin = block.origin;
  std::copy_n(block.known.begin(), 8, filed.active);
  std::array<std::uint64_t, 8> inside{};
  if (sides) inside = sides->inside(block);
  for (size_t n = 0; n < 512; ++n) {
    filed.values[n] = block.is_known(n) ? nodes.value_of(block.step(n)) : (inside[n >> 6] >> (n & 63) & 1) != 0 ? -1.0f : 0.0f;
  }
  return filed;
}

}  // namespace

LevelSet level_set_of(const LevelNodes& nodes, const LocalChoice& choice, size_t level, double half_width_voxels, const std::string& name,
                      const FiledLevel* filed) {
  const double h = choice.voxel_of(level);
  std::vector<LevelSetBlock> blocks(nodes.blocks.size());
  parallel_parts(blocks.size(), size_t{16}, [&](const IndexRange<size_t>& range) {
    NodeSides sides(choice.origin, h);
    for (size_t i = range.begin(); i < range.end(); ++i) blocks[i] = filed_block(nodes, nodes.blocks[i], filed ? &sides : nullptr);
  });
  auto data = std::make_shared<LevelSetData>();
  std::function<bool(const glm::dvec3&)> inside;
  if (filed) inside = [&](const glm::dvec3& place) { return filed->inside(choice.origin + h * place); };
  data->handle = nano_grid(blocks, static_cast<float>(half_width_voxels * h), inside);
  data->grid = data->handle.grid<float>();
  data->info.name = name;
  data->info.world_from_index = {glm::dmat3(h), choice.origin + (filed ? filed->part_origin : glm::dvec3(0.0))};
  data->info.voxel_size = h;
  data->info.half_width_voxels = half_width_voxels;
  data->info.active_voxels = nodes.known();
  data->info.bytes = static_cast<std::int64_t>(data->handle.size());
  data->index_from_world = inverse(data->info.world_from_index);
  data->per_voxel = h;
  if (filed) data->file.metadata.push_back(filed->said);
  return LevelSet(data);
}

}  // namespace limn
