#pragma once
// Internal: one pass over a level set's leaves that tells where the surface is, how wide the band is and what it lacks.

#include "sdf/band_slopes.h"
#include "sdf/leaf_window.h"

namespace limn {

struct BandSurvey {
  std::int64_t active = 0;
  Box crossings{};  ///< Index coordinates.
  double half_width_voxels = 0.0;
  double per_voxel = 0.0;  ///< By how much the values change over a voxel, straight across the surface.
  BandFacts facts{};
  std::vector<CrossedBlock> crossed{};  ///< As crossed_blocks().
};

/// `voxel_size`: by how much a distance's values change over a voxel. `of_others`: of grids that limn did not make, how wide the band is
/// and which surface has no inside is measured; of limn's own it is known, and `half_width_voxels`, `near_nodes` and `unsigned_nodes` stay
/// 0.
BandSurvey survey_band(const nanovdb::FloatGrid& grid, const glm::dmat3& world_from_index, double voxel_size, bool of_others);

/// Where cells that the surface crosses may start: the leaves, and the blocks of tiles before them whose last cells have nodes in a leaf of
/// another sign. In the order of the leaves, each once.
std::vector<nanovdb::Coord> blocks_with_cells(const nanovdb::FloatGrid& grid);

/// Those of blocks_with_cells that have crossed cells, in their order.
std::vector<CrossedBlock> crossed_blocks(const nanovdb::FloatGrid& grid);

ActiveRows active_rows(const LeafWindow& window);

void load_nodes(const LeafWindow& window, NodeWindow& nodes);

CrossedCells cells_crossed(const NodeWindow& nodes);
CrossedCells cells_crossed(const NodeBits& inside);
/// Those of the crossed cells whose stencil reads a node outside the band.
CrossedCells cells_outside(const CrossedCells& crossed, const ActiveRows& rows, const Stencil& stencil);

}  // namespace limn
