#pragma once
// Internal: NanoVDB grids straight from blocks, without an OpenVDB tree between.

#include <algorithm>
#include <functional>
#include <optional>
#include <span>

#include "sdf/level_set_data.h"
#include "sdf/parallel.h"

namespace limn {

struct VdbTile;  // sdf/read_vdb.h

inline bool has_active_node(const LevelSetBlock& block) {
  return std::any_of(std::begin(block.active), std::end(block.active), [](std::uint64_t word) { return word != 0; });
}

/// What nanovdb::openToNanoVDB makes of an OpenVDB tree with these leaves, flood-filled (signedFloodFill): the same nodes in the same
/// order with the same values. Blocks without active nodes are left out; of several with one origin the last counts.
/// `inside`, where given, tells the sign of tiles instead, at a place in index coordinates, and nodes that are not active keep that of the
/// block's value: for bands that are patches.
nanovdb::GridHandle<nanovdb::HostBuffer> nano_grid(std::span<const LevelSetBlock> blocks, float background,
                                                   const std::function<bool(const glm::dvec3&)>& inside = {});

/// The grid of a file, by its leaves and its tiles inside (distinct, aligned, of levels 1 to 3): nano_grid of `blocks`, where a flood fill
/// gives the signs that are filed. Nothing where it does not, or where a block has no active node.
std::optional<nanovdb::GridHandle<nanovdb::HostBuffer>> nano_grid_as_filed(std::span<const LevelSetBlock> blocks,
                                                                           std::span<const VdbTile> tiles, float background);

using WriteLeaf = std::function<void(size_t, const LevelSetBlock&)>;
/// Calls `write(i, block)` for each leaf i of a part. From many threads at a time.
using FillLeaves = std::function<void(const IndexRange<size_t>& part, const WriteLeaf& write)>;

/// The same from blocks that are made when they are written, so that they are never all in memory. Each has an active node; `origins` are
/// theirs, each once. `inside` may be asked from many threads at a time.
nanovdb::GridHandle<nanovdb::HostBuffer> nano_grid(std::span<const glm::ivec3> origins, const FillLeaves& fill, float background,
                                                   const std::function<bool(const glm::dvec3&)>& inside = {});

/// level_set_from_blocks of such blocks, still open to additions.
std::shared_ptr<LevelSetData> join_leaves(std::span<const glm::ivec3> origins, const FillLeaves& fill, double voxel_size,
                                          double half_width_voxels, const std::string& name, const glm::dvec3& origin);

}  // namespace limn
