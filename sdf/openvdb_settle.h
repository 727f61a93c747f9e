#pragma once
// Internal: bands as other tools leave them, made into what the rest reads: leaves with distances, signs everywhere else.

#include <openvdb/openvdb.h>

#include <span>

#include "sdf/read_vdb.h"

namespace limn {

/// Active tiles: far from the surface they become inactive, in the band they become leaves. Values outside the band that are distances all
/// the same (a tool switched their nodes off and left them as they were) join the band.
void settle_band(openvdb::FloatGrid& grid);

/// Where tiles inside touch what is outside without a leaf between them, as where a band was cut, leaves are put in: cells that change sign
/// are looked for in leaves. `inside`: the tiles of negative value.
void seal_tiles(openvdb::FloatGrid& grid, std::span<const VdbTile> inside);

/// The signs outside the band carried on from the band's own edges: for grids that were never flood-filled.
openvdb::FloatGrid::Ptr flood_filled(const openvdb::FloatGrid& grid);

}  // namespace limn
