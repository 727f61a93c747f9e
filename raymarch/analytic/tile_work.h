#pragma once
// Internal: a tile being traced.

#include "raymarch/analytic/block.h"
#include "raymarch/analytic/tile.h"

namespace limn {

/// A tile on its way: which of its rays have yet to meet the surface.
struct TileWork {
  const FieldView& view;
  const RayBatch& rays;
  HitBatch& hits;
  ViewScratch& scratch;
  PixelTile tile;
  StretchList& queue;
  int blocks = 0;
  std::array<RayBlock, kLanes> block;
  std::array<unsigned, kLanes> active{};

  TileWork(const FieldView& v, const RayBatch& r, HitBatch& h, ViewScratch& s, const PixelTile& t)
      : view(v), rays(r), hits(h), scratch(s), tile(t), queue(s.queue), blocks(((t.width + 3) >> 2) * ((t.height + 3) >> 2)) {}
  bool done() const {
    for (size_t i = 0; i < static_cast<size_t>(blocks); ++i) {
      if (active[i] != 0) return false;
    }
    return true;
  }
};

/// Puts lanes of a block into the queue, with their stretches from a to b; `unsure`: those before which the sign of f is not known.
void enqueue(TileWork& work, int block, unsigned lanes, const LaneArray& a, const LaneArray& b, unsigned unsure, double sign);
/// Isolates the queued stretches ray by ray, sixteen at a time. Those that hold no root are active again.
void settle_queue(TileWork& work, std::span<const TapeStep> steps);
/// First hits in a run, whatever the field.
void trace_run(TileWork& work, const SlabRun& run, std::span<const TapeStep> steps);

}  // namespace limn
