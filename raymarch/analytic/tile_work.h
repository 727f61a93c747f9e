#pragma once
// Internal: a tile being traced.

#include "raymarch/analytic/tile.h"

namespace limn {

/// A tile on its way. What bounds of f over the beam of a block tell, they tell of all its samples.
struct TileWork {
  const FieldView& view;
  ViewScratch& scratch;
  PixelTile tile;
  std::span<SampleWork> samples;
  int blocks = 0;

  TileWork(const FieldView& v, ViewScratch& s, const PixelTile& t, std::span<SampleWork> of)
      : view(v), scratch(s), tile(t), samples(of), blocks(((t.width + 3) >> 2) * ((t.height + 3) >> 2)) {}
  bool is_active(int at) const {
    for (const SampleWork& sample : samples) {
      if (sample.active[static_cast<size_t>(at)] != 0) return true;
    }
    return false;
  }
  bool done() const {
    for (int block = 0; block < blocks; ++block) {
      if (is_active(block)) return false;
    }
    return true;
  }
};

/// Puts lanes of a block into the queue, with their stretches from a to b; `unsure`: those before which the sign of f is not known.
void enqueue(SampleWork& sample, int block, unsigned lanes, const LaneArray& a, const LaneArray& b, unsigned unsure, double sign);
/// Isolates the queued stretches ray by ray, sixteen at a time. Those that hold no root are active again.
void settle_queues(TileWork& work, std::span<const TapeStep> steps);
/// First hits in a run, whatever the field.
void trace_run(TileWork& work, const SlabRun& run, std::span<const TapeStep> steps);

}  // namespace limn
