#pragma once
// Internal: what a prepared field and the tracing of its tiles share.

#include <tbb/enumerable_thread_specific.h>

#include "raymarch/analytic/analytic_view.h"
#include "raymarch/analytic/block.h"

namespace limn {

inline constexpr int kCell_px = 64;

/// One sample's rays of a tile on their way: which of them have yet to meet the surface.
struct SampleWork {
  SampleHits own{};
  std::array<RayBlock, kLanes> block;
  std::array<unsigned, kLanes> active{};  ///< Lanes of each block.
  StretchList queue{};                    ///< Empty between runs.
};

struct ViewScratch {
  TapeScratch tape{};
  std::vector<TapeStep> run_steps{}, block_steps{};
  std::vector<std::uint32_t> balls{};
  std::vector<TapeChoice> choices{};
  std::vector<SampleWork> samples{};  ///< Of a tile.
};

/// Memory for threads, one piece for each however many fields a model has: of thousands of small objects it would be most of what they
/// take.
struct FieldScratch {
  tbb::enumerable_thread_specific<ViewScratch> views{};
};

struct FieldView {
  std::shared_ptr<const void> keep{};
  const FieldTape* tape = nullptr;
  MarchLimits limits{};
  RayTracer tracer{};
  double reach = 0.0;  ///< Of the bounds from the render origin.
  ViewBeams beams{};
  int first_column = 0, first_row = 0, columns = 0, rows = 0;  ///< The cells that the bounds' image reaches into.
  std::vector<std::vector<TapeSegment>> cells{};
  std::vector<TapeSegment> nothing{};  ///< Of all other cells.
  std::shared_ptr<FieldScratch> scratch{};

  const std::vector<TapeSegment>& cell(int column, int row) const {
    const int x = column - first_column, y = row - first_row;
    if (x < 0 || y < 0 || x >= columns || y >= rows) return nothing;
    return cells[static_cast<size_t>(y) * static_cast<size_t>(columns) + static_cast<size_t>(x)];
  }
};

/// Neighbouring slabs of a beam that bounds do not clear: lanes of the last tape_bounds.
struct SlabRun {
  double z0 = 0.0, z1 = 0.0, sign = 0.0, sign_from = 0.0;
  std::uint16_t lanes = 0;
};
struct SlabRuns {
  std::array<SlabRun, kLanes> runs;
  int count = 0;
  bool closed = false;  ///< Behind the last one every ray has met the surface.
};

/// Bounds f over slabs of the beam of `rectangle` in `within`; leaves the choices of every slab in `scratch`.
void find_runs(const FieldView& view, const PixelTile& rectangle, const TapeSegment& within, std::span<const TapeStep> steps,
               ViewScratch& scratch, SlabRuns& runs);

/// SurfaceView::trace and SurfaceView::trace_samples of a FieldView.
void trace_tile(const void* view, const PixelTile& tile, const RayBatch& rays, HitBatch& hits);
void trace_tile_samples(const void* view, const PixelTile& tile, std::span<const SampleHits> samples);

}  // namespace limn
