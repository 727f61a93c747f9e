#include "raymarch/analytic/tile.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "raymarch/analytic/tile_work.h"

namespace limn {
namespace {

constexpr int kLongestRun = 3;  // Slabs.
constexpr size_t kFewBalls = 3;

void trace_balls(const TileWork& work, const SlabRun& run, std::span<const std::uint32_t> balls, SampleWork& sample) {
  for (int block = 0; block < work.blocks; ++block) {
    unsigned& active = sample.active[static_cast<size_t>(block)];
    if (active == 0) continue;
    const RayBlock& rays = sample.block[static_cast<size_t>(block)];
    LaneArray a, b;
    unsigned late = 0, unsure = 0;
    const unsigned lanes = stretches_between(rays, run.z0, run.z1, run.sign_from, a, b, late) & active;
    if (lanes == 0) continue;
    BallHits found;
    const unsigned hit = ball_roots(*work.view.tape, balls, rays.rays, a, b, found, unsure) & lanes;
    // From within a ball the way out is that of all that it overlaps.
    enqueue(sample, block, lanes & unsure, a, b, ~0u, 0.0);
    active &= ~(lanes & unsure);
    const unsigned entered = hit & ~unsure;
    if (entered != 0) write_ball_hits(*sample.own.rays, block * kLanes, found, entered, *sample.own.hits);
    active &= ~entered;
  }
}

void trace_balls(TileWork& work, const SlabRun& run, std::span<const TapeStep> steps, std::span<const std::uint32_t> balls) {
  for (SampleWork& sample : work.samples) trace_balls(work, run, balls, sample);
  settle_queues(work, steps);
}

/// True where rays meet a few balls, without any bounds of f that samples could share.
bool is_few_balls(const TapeSegment& segment) { return !segment.balls.empty() && segment.balls.size() <= kFewBalls; }

void trace_segment(TileWork& work, const PixelTile& rectangle, const TapeSegment& segment) {
  if (is_few_balls(segment)) {
    return trace_balls(work, {segment.z0, segment.z1, segment.sign, segment.sign_from, 0}, segment.steps, segment.balls);
  }
  SlabRuns runs;
  find_runs(work.view, rectangle, segment, segment.steps, work.scratch, runs);
  // Tracing a run overwrites the choices.
  std::vector<TapeStep>& steps = work.scratch.run_steps;
  const std::vector<TapeChoice> choices = runs.count > 1 ? work.scratch.tape.choices : std::vector<TapeChoice>{};
  for (int k = 0; k < runs.count && !work.done(); ++k) {
    const SlabRun& run = runs.runs[static_cast<size_t>(k)];
    prune_tape(segment.steps, k > 0 ? choices : work.scratch.tape.choices, run.lanes, work.view.tape->registers, TapeUse::bounds, steps);
    find_balls(*work.view.tape, steps, work.scratch.balls);
    if (!work.scratch.balls.empty()) {
      trace_balls(work, run, steps, work.scratch.balls);
    } else {
      trace_run(work, run, steps);
    }
  }
}

/// The lanes of a block whose pixels lie in `cell`.
unsigned lanes_within(const PixelTile& tile, const PixelTile& cell, int block) {
  const int across = (tile.width + 3) >> 2, x = tile.x + block % across * 4, y = tile.y + block / across * 4;
  unsigned lanes = 0;
  for (int i = 0; i < kLanes; ++i) {
    const int px = x + (i & 3), py = y + (i >> 2);
    const bool within = px >= cell.x && px < cell.x + cell.width && py >= cell.y && py < cell.y + cell.height;
    lanes |= within ? 1u << i : 0u;
  }
  return lanes;
}

PixelTile overlap(const PixelTile& a, const PixelTile& b) {
  const int x = std::max(a.x, b.x), y = std::max(a.y, b.y);
  return {x, y, std::min(a.x + a.width, b.x + b.width) - x, std::min(a.y + a.height, b.y + b.height) - y};
}

/// True where float has moved no ray farther from its pixel's beam than the view allows for.
bool within_slack(const TileWork& work) {
  double largest = 0.0;
  for (const SampleWork& sample : work.samples)
    for (int block = 0; block < work.blocks; ++block) largest = std::max(largest, sample.block[static_cast<size_t>(block)].reach);
  return 1e-6 * (std::sqrt(3.0) * largest + work.view.reach) <= work.view.beams.slack;
}

/// Calls visit(segments, cell) for the cells of a view that hold anything and that the tile reaches into.
template <class Visit>
void visit_cells(const FieldView& view, const PixelTile& tile, const Visit& visit) {
  for (int row = tile.y / kCell_px; row <= (tile.y + tile.height - 1) / kCell_px; ++row) {
    for (int column = tile.x / kCell_px; column <= (tile.x + tile.width - 1) / kCell_px; ++column) {
      const std::vector<TapeSegment>& segments = view.cell(column, row);
      if (!segments.empty()) visit(segments, PixelTile{column * kCell_px, row * kCell_px, kCell_px, kCell_px});
    }
  }
}

void trace_together(const FieldView& view, const PixelTile& tile, ViewScratch& scratch, std::span<const SampleHits> samples) {
  if (scratch.samples.size() < samples.size()) scratch.samples.resize(samples.size());
  TileWork work(view, scratch, tile, std::span(scratch.samples).first(samples.size()));
  for (size_t k = 0; k < samples.size(); ++k) {
    SampleWork& sample = work.samples[k];
    sample.own = samples[k];
    for (int block = 0; block < work.blocks; ++block)
      load_block(*sample.own.rays, block * kLanes, view.beams.eye, view.beams.forward, sample.block[static_cast<size_t>(block)]);
  }
  if (!within_slack(work)) {
    for (const SampleHits& sample : samples) view.tracer.trace(view.tracer.state, *sample.rays, *sample.hits);
    return;
  }
  visit_cells(view, tile, [&](std::span<const TapeSegment> segments, const PixelTile& cell) {
    const PixelTile part = overlap(tile, cell);
    const bool whole = part.width == tile.width && part.height == tile.height;
    for (int block = 0; block < work.blocks; ++block) {
      const unsigned lanes = whole ? 0xffffu : lanes_within(tile, cell, block);
      for (SampleWork& sample : work.samples) sample.active[static_cast<size_t>(block)] = lanes;
    }
    for (size_t k = 0; k < segments.size() && !work.done(); ++k) trace_segment(work, part, segments[k]);
  });
}

}  // namespace

void find_runs(const FieldView& view, const PixelTile& rectangle, const TapeSegment& within, std::span<const TapeStep> steps,
               ViewScratch& scratch, SlabRuns& runs) {
  const double length = within.z1 - within.z0, width = width_at(view.beams, rectangle, within.z1);
  const int slabs = static_cast<int>(std::clamp(std::ceil(length / width), 1.0, static_cast<double>(kLanes)));
  LaneBeams beams;
  LaneBounds bounds;
  slabs_of(view.beams, rectangle, within.z0, within.z1, slabs, beams);
  tape_bounds(*view.tape, steps, beams, scratch.tape, bounds);
  double sign = within.sign, sign_from = within.sign_from;
  SlabRun run;
  const auto finish = [&] {
    if (run.lanes != 0) runs.runs[static_cast<size_t>(runs.count++)] = run;
    run.lanes = 0;
  };
  for (int i = 0; i < slabs && !runs.closed; ++i) {
    const double here = bounds.lower[i] > 0.0 ? 1.0 : bounds.upper[i] < 0.0 ? -1.0 : 0.0;
    const double z0 = beams.middle[i] - beams.half[i], z1 = beams.middle[i] + beams.half[i];
    if (here != 0.0) {
      finish();
      runs.closed = sign != 0.0 && here != sign;
      if (sign == 0.0) sign_from = z0;
      if (sign == 0.0) sign = here;
      continue;
    }
    if (run.lanes == 0) run = {z0, z1, sign, sign_from, 0};
    run.z1 = z1;
    run.lanes = static_cast<std::uint16_t>(run.lanes | 1u << i);
    if (std::popcount(run.lanes) >= kLongestRun) finish();
  }
  finish();
}

void trace_tile_samples(const void* opaque, const PixelTile& tile, std::span<const SampleHits> samples) {
  const FieldView& view = *static_cast<const FieldView*>(opaque);
  ViewScratch& scratch = view.scratch->views.local();
  bool shares = false;
  visit_cells(view, tile, [&](std::span<const TapeSegment> segments, const PixelTile&) {
    shares = shares || !std::all_of(segments.begin(), segments.end(), is_few_balls);
  });
  // Without anything to share the rays of one sample at a time stay in the cache.
  const size_t at_once = shares ? samples.size() : 1;
  for (size_t k = 0; k < samples.size(); k += at_once) trace_together(view, tile, scratch, samples.subspan(k, at_once));
}

void trace_tile(const void* view, const PixelTile& tile, const RayBatch& rays, HitBatch& hits) {
  const SampleHits one{&rays, &hits};
  trace_tile_samples(view, tile, std::span(&one, 1));
}

}  // namespace limn
