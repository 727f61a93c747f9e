#include "sdf/level_set_lower.h"

#include <algorithm>
#include <tuple>

#include "sdf/level_set_band.h"

namespace limn {
namespace {

bool before(const LoweredBlock& block, const glm::ivec3& origin) {
  return std::tuple(block.origin.x, block.origin.y, block.origin.z) < std::tuple(origin.x, origin.y, origin.z);
}

/// Indices of the gradients of lower order than `gradient`, the highest first.
std::vector<size_t> lower_gradients(const GradientDescriptor& gradient) {
  std::vector<size_t> lower;
  for (size_t k = 0; k < gradients().size(); ++k)
    if (gradients()[k].order < gradient.order) lower.push_back(k);
  std::sort(lower.begin(), lower.end(), [](size_t a, size_t b) { return gradients()[a].order > gradients()[b].order; });
  return lower;
}

/// Of a block's nodes, as OpenVDB numbers them.
size_t node_number(int x, int y, int z) { return static_cast<size_t>(x) * 64 + static_cast<size_t>(y) * 8 + static_cast<size_t>(z); }

void lower_block(const CrossedCells& lacking, const CrossedCells& crossed, const ActiveRows& rows, const std::vector<size_t>& lower,
                 LoweredBlock& block) {
  std::vector<CrossedCells> outside;
  outside.reserve(lower.size());
  for (const size_t k : lower) outside.push_back(cells_outside(crossed, rows, gradients()[k].stencil));
  for_each_cell(lacking, [&](int x, int y, int z) {
    std::uint8_t& taken = block.gradient[node_number(x, y, z)];
    for (size_t i = 0; i < lower.size() && taken == 0; ++i)
      if (i + 1 == lower.size() || (outside[i].cells[x][y] >> z & 1) == 0) taken = static_cast<std::uint8_t>(1 + lower[i]);
  });
}

}  // namespace

std::vector<LoweredBlock> lowered_cells(const LevelSet& level_set, const GradientDescriptor& gradient) {
  std::vector<LoweredBlock> lowered;
  const std::vector<size_t> lower = lower_gradients(gradient);
  if (!level_set.data().completed || cells_lacking(level_set, gradient) == 0 || lower.empty()) return lowered;
  const LevelSetData& data = level_set.data();
  const NanoAccessor accessor = data.accessor();
  NodeWindow nodes;
  for (const nanovdb::Coord& origin : blocks_with_cells(*data.grid)) {
    const LeafWindow window(accessor, origin);
    load_nodes(window, nodes);
    const CrossedCells crossed = cells_crossed(nodes);
    if (!crossed.any) continue;
    const ActiveRows rows = active_rows(window);
    const CrossedCells lacking = cells_outside(crossed, rows, gradient.stencil);
    if (!lacking.any) continue;
    LoweredBlock& block = lowered.emplace_back();
    block.origin = {origin[0], origin[1], origin[2]};
    lower_block(lacking, crossed, rows, lower, block);
  }
  std::sort(lowered.begin(), lowered.end(), [](const LoweredBlock& a, const LoweredBlock& b) { return before(a, b.origin); });
  return lowered;
}

const GradientDescriptor& gradient_in_cell(const std::vector<LoweredBlock>& lowered, const glm::ivec3& cell,
                                           const GradientDescriptor& asked) {
  const glm::ivec3 origin = (cell >> 3) << 3, place = cell - origin;
  const auto found = std::lower_bound(lowered.begin(), lowered.end(), origin, before);
  if (found == lowered.end() || found->origin != origin) return asked;
  const std::uint8_t taken = found->gradient[node_number(place.x, place.y, place.z)];
  return taken == 0 ? asked : gradients()[taken - size_t{1}];
}

}  // namespace limn
