#include <algorithm>
#include <bit>
#include <cmath>

#include "raymarch/analytic/tile_work.h"

namespace limn {
namespace {

// Newton's steps end here, as a share of the extent: the next would be the square of it.
constexpr double kNewtonTolerance = 1e-6;
// What is left of a stretch that bounds say too little about.
constexpr double kCut = 0.25;
constexpr double kShortest = 1.0 / 256.0;  // Of a run: so few steps are the most that a block can take.

/// Depth at which the block's middle ray would meet a plane of the block's middle value and slope; in t of each ray.
void guess_roots(const RayBlock& block, const LaneBeams& beams, const LaneBounds& bounds, int lane, LaneArray& t) {
  const double slope = 0.5 * (bounds.slope_lower[lane] + bounds.slope_upper[lane]);
  const double z = beams.middle[lane] - bounds.middle[lane] / slope;
  for (int i = 0; i < kLanes; ++i) t[i] = (z - block.depth[i]) / block.depth_per_t[i];
}

/// Takes a block's rays from the loop to be isolated one by one in what is left of the run.
void leave_to_isolation(SampleWork& sample, const SlabRun& run, double z, int block) {
  unsigned& active = sample.active[static_cast<size_t>(block)];
  LaneArray a, b;
  unsigned late = 0;
  const unsigned lanes = stretches_between(sample.block[static_cast<size_t>(block)], z, run.z1, run.sign_from, a, b, late) & active;
  enqueue(sample, block, lanes, a, b, run.sign == 0.0 ? lanes : late, run.sign);
  active &= ~lanes;
}

/// The roots of a block's rays between two depths where f falls, or does not for those that start within the field.
void trace_monotone(TileWork& work, const SlabRun& run, const MarchTape& march, const LaneBeams& beams, const LaneBounds& bounds,
                    bool falls, int lane, int block, SampleWork& sample) {
  unsigned& active = sample.active[static_cast<size_t>(block)];
  if (active == 0) return;
  const RayBlock& rays = sample.block[static_cast<size_t>(block)];
  const double z0 = beams.middle[lane] - beams.half[lane], z1 = beams.middle[lane] + beams.half[lane];
  LaneArray a, b, t, sign;
  unsigned late = 0, undecided = 0;
  const unsigned lanes = stretches_between(rays, z0, z1, run.sign_from, a, b, late) & active;
  if ((lanes & late) != 0) return leave_to_isolation(sample, run, z0, block);
  if (lanes == 0 || !falls) return;
  guess_roots(rays, beams, bounds, lane, t);
  const SampleWork& first = work.samples.front();
  if (&sample != &first) guess_from_hits(rays.rays, first.own, block * kLanes, t);
  const unsigned found =
      newton_roots(march, rays.rays, a, b, run.sign, kNewtonTolerance * work.view.limits.extent, lanes, work.scratch.tape, t, undecided);
  if (undecided != 0) return leave_to_isolation(sample, run, z0, block);
  if (found == 0) return;
  std::fill_n(sign.lane, kLanes, run.sign);
  write_roots(march, *sample.own.rays, rays.rays, t, sign, nullptr, block * kLanes, found, work.scratch.tape, *sample.own.hits);
  active &= ~found;
}

/// True where two lanes leave the same steps out.
bool decide_alike(std::span<const TapeChoice> choices, int a, int b) {
  unsigned different = 0;
  for (const TapeChoice& choice : choices) {
    for (const unsigned idle : choice.idle) different |= (idle >> a ^ idle >> b) & 1u;
  }
  return different == 0;
}

/// A stretch of a block, given bounds over it in `lane`. Returns false where it must be cut. `pruned`: the lane that the block's steps were
/// last pruned for; -1: none.
bool trace_stretch(TileWork& work, const SlabRun& run, std::span<const TapeStep> steps, std::span<const TapeChoice> choices,
                   const LaneBeams& beams, const LaneBounds& bounds, int lane, int block, int& pruned) {
  if (bounds.lower[lane] > 0.0 || bounds.upper[lane] < 0.0) return true;
  const double steepest = 1e-9 * work.view.limits.lipschitz;
  const bool down = bounds.slope_upper[lane]<-steepest, up = bounds.slope_lower[lane]> steepest;
  if (run.sign == 0.0 || (!down && !up)) return false;
  if (pruned < 0 || !decide_alike(choices, lane, pruned)) {
    prune_tape(steps, choices, static_cast<std::uint16_t>(1u << lane), work.view.tape->registers, TapeUse::points,
               work.scratch.block_steps);
    pruned = lane;
  }
  const MarchTape march{work.view.tape, work.scratch.block_steps};
  for (SampleWork& sample : work.samples) trace_monotone(work, run, march, beams, bounds, run.sign > 0.0 ? down : up, lane, block, sample);
  return true;
}

/// Where each block of a tile stands in a run: rays of block i that are still active have no root in front of z[i]; length[i] is what to
/// try next.
struct BlockFronts {
  std::array<double, kLanes> z{}, length{};
  double shortest = 0.0;
};

/// The next stretch of each block that has anything left, and where lanes remain also shorter ones, in case it must be cut.
int next_stretches(const TileWork& work, const SlabRun& run, const BlockFronts& fronts, std::array<BlockStretch, kLanes>& next) {
  int going = 0, count = 0;
  std::array<int, kLanes> blocks{};
  for (int block = 0; block < work.blocks; ++block) {
    const auto k = static_cast<size_t>(block);
    if (fronts.z[k] < run.z1 && work.is_active(block)) blocks[static_cast<size_t>(going++)] = block;
  }
  for (int i = 0; i < going; ++i) {
    const int block = blocks[static_cast<size_t>(i)], tries = kLanes / going;
    double length = fronts.length[static_cast<size_t>(block)];
    for (int k = 0; k < tries && (k == 0 || length > kCut * fronts.shortest); ++k) {
      next[static_cast<size_t>(count++)] = {block, fronts.z[static_cast<size_t>(block)], length};
      length *= kCut;
    }
  }
  return count;
}

void settle_queue(TileWork& work, const MarchTape& march, SampleWork& sample) {
  StretchList& queue = sample.queue;
  std::array<unsigned, kLanes> waiting{};
  for (int k = 0; k < queue.count; ++k) waiting[static_cast<size_t>(queue[k].lane / kLanes)] |= 1u << queue[k].lane % kLanes;
  isolate(march, work.view.limits, *sample.own.rays, work.scratch.tape, queue, *sample.own.hits);
  for (int k = 0; k < queue.count; ++k) waiting[static_cast<size_t>(queue[k].lane / kLanes)] &= ~(1u << queue[k].lane % kLanes);
  for (size_t block = 0; block < waiting.size(); ++block) sample.active[block] |= waiting[block];
  polish(march, work.view.limits, *sample.own.rays, work.scratch.tape, queue, *sample.own.hits);
  queue.count = 0;
}

}  // namespace

void enqueue(SampleWork& sample, int block, unsigned lanes, const LaneArray& a, const LaneArray& b, unsigned unsure, double sign) {
  for (unsigned left = lanes; left != 0; left &= left - 1) {
    const int i = std::countr_zero(left);
    sample.queue.add({block * kLanes + i, 0, a[i], b[i], unsure >> i & 1u ? 0.0 : sign});
  }
}

void settle_queues(TileWork& work, std::span<const TapeStep> steps) {
  const MarchTape march{work.view.tape, steps};
  for (SampleWork& sample : work.samples)
    if (sample.queue.count != 0) settle_queue(work, march, sample);
}

/// Cuts the run, block by block and front to back, into stretches where bounds of f and its slope tell that there is nothing, or that f
/// falls all the way and Newton's iteration may be trusted. Where a stretch no deeper than a block is wide tells neither, there is a
/// silhouette in it, and rays are isolated one by one. Every round moves a block's front by kCut of `shortest` or more, cuts its stretch
/// to kCut, or takes the block from the loop.
void trace_run(TileWork& work, const SlabRun& run, std::span<const TapeStep> steps) {
  BlockFronts fronts;
  fronts.z.fill(run.z0);
  fronts.length.fill(run.z1 - run.z0);
  // At the eye beams have no width.
  fronts.shortest = std::max(width_at(work.view.beams, {0, 0, 4, 4}, run.z0), kShortest * (run.z1 - run.z0));
  LaneBeams beams;
  LaneBounds bounds;
  std::array<BlockStretch, kLanes> next;
  std::vector<TapeChoice>& choices = work.scratch.choices;
  while (const int count = next_stretches(work, run, fronts, next)) {
    stretches_of(work.view.beams, work.tile, std::span(next).first(static_cast<size_t>(count)), run.z1, beams);
    tape_slope_bounds(*work.view.tape, steps, beams, work.scratch.tape, bounds);
    choices.swap(work.scratch.tape.choices);
    int pruned = -1;
    for (int lane = 0; lane < count;) {
      const int block = next[static_cast<size_t>(lane)].block;
      double &z = fronts.z[static_cast<size_t>(block)], &length = fronts.length[static_cast<size_t>(block)];
      bool done = false;
      for (; lane < count && next[static_cast<size_t>(lane)].block == block; ++lane) {
        if (done) continue;
        length = next[static_cast<size_t>(lane)].length;
        done = trace_stretch(work, run, steps, choices, beams, bounds, lane, block, pruned);
      }
      if (done) {
        z = std::min(z + length, run.z1);
        length *= 2.0;
      } else if (length > fronts.shortest && run.sign != 0.0) {
        length *= kCut;
      } else {
        for (SampleWork& sample : work.samples) leave_to_isolation(sample, run, z, block);
        z = run.z1;
      }
    }
  }
  settle_queues(work, steps);
}

}  // namespace limn
