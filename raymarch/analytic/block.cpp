#include "raymarch/analytic/block.h"

#include <algorithm>
#include <limits>

#include "sdf/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raymarch/analytic/block.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "raymarch/analytic/newton-inl.h"

HWY_BEFORE_NAMESPACE();
namespace limn {
namespace HWY_NAMESPACE {
namespace {

void load_rays(const RayBatch& rays, int first, const glm::dvec3& eye, const glm::dvec3& forward, RayBlock& block) {
  const float* const origin[3] = {rays.origin_x, rays.origin_y, rays.origin_z};
  const float* const direction[3] = {rays.direction_x, rays.direction_y, rays.direction_z};
  const double eye_depth = glm::dot(eye, forward);
  Reals reach = reals(0.0);
  for (int at = 0; at < kLanes; at += kWidth) {
    for (int axis = 0; axis < 3; ++axis) {
      const Reals o = load_floats(origin[axis] + first + at);
      reach = maximum(reach, abs(o));
      store(o, block.rays.origin[axis], at);
      store(load_floats(direction[axis] + first + at), block.rays.direction[axis], at);
    }
    store(load_floats(rays.t_min + first + at), block.t_min, at);
    store(load_floats(rays.t_max + first + at), block.t_max, at);
    store(dot(block.rays.origin, forward, at) - eye_depth, block.depth, at);
    store(dot(block.rays.direction, forward, at), block.depth_per_t, at);
  }
  block.reach = hn::GetLane(hn::MaxOfLanes(RealTag(), reach.v));
}

unsigned between(const RayBlock& block, double z0, double z1, double from, LaneArray& a, LaneArray& b, unsigned& late) {
  unsigned some = 0;
  late = 0;
  for (int at = 0; at < kLanes; at += kWidth) {
    const Reals per_depth = reals(1.0) / load(block.depth_per_t, at), depth = load(block.depth, at), begin = load(block.t_min, at);
    const Reals first = maximum((reals(z0) - depth) * per_depth, begin),
                last = minimum((reals(z1) - depth) * per_depth, load(block.t_max, at));
    store(first, a, at);
    store(last, b, at);
    some |= bits_of(first < last) << at;
    late |= bits_of(depth + begin * load(block.depth_per_t, at) > reals(from)) << at;
  }
  return some;
}

void guess(const LaneRays& rays, const SampleHits& other, int first, LaneArray& t) {
  const RayBatch& before = *other.rays;
  const HitBatch& hits = *other.hits;
  LaneArray is_hit;
  for (int i = 0; i < kLanes; ++i) is_hit[i] = hits.status[first + i] == HitStatus::hit ? 1.0 : 0.0;
  const float* const origin[3] = {before.origin_x, before.origin_y, before.origin_z};
  const float* const direction[3] = {before.direction_x, before.direction_y, before.direction_z};
  const float* const normals[3] = {hits.normal_x, hits.normal_y, hits.normal_z};
  for (int at = 0; at < kLanes; at += kWidth) {
    const LaneMask known = load(is_hit, at) > reals(0.5);
    const Reals place = load_floats(hits.t + first + at);
    Reals height = reals(0.0), slope = reals(0.0);
    for (int axis = 0; axis < 3; ++axis) {
      const Reals normal = load_floats(normals[axis] + first + at);
      const Reals touched = load_floats(origin[axis] + first + at) + place * load_floats(direction[axis] + first + at);
      height = height + normal * (touched - load(rays.origin[axis], at));
      slope = slope + normal * load(rays.direction[axis], at);
    }
    // Edge-on the plane says little.
    const LaneMask taken = both(known, abs(slope) > reals(1e-3));
    store(select(taken, height / slope, load(t, at)), t, at);
  }
}

unsigned newton(const MarchTape& march, const LaneRays& rays, const LaneArray& a, const LaneArray& b, double sign, double tolerance,
                unsigned lanes, TapeScratch& scratch, LaneArray& t, unsigned& undecided) {
  constexpr int kMaxRounds = 40;
  NewtonState state{a, b, {}, {}, {}};
  LaneArray values, slopes;
  for (int at = 0; at < kLanes; at += kWidth) {
    store(maximum(load(a, at), minimum(load(t, at), load(b, at))), state.t, at);
    store(reals(1.0), state.going, at);
  }
  unsigned going = lanes, found = 0;
  for (int round = 0; going != 0 && round < kMaxRounds; ++round) {
    tape_slopes(*march.tape, march.steps, rays, state.t, scratch, values, slopes);
    unsigned settled = 0, over = 0;
    for (int at = 0; at < kLanes; at += kWidth) {
      newton_step(load(values, at) * sign, load(slopes, at) * sign, tolerance, at, state, settled, over);
    }
    found |= settled & lanes;
    going &= ~over;
  }
  t = state.t;
  undecided = going;
  return found;
}

HWY_INLINE Reals mapped(const TapeLeaf& leaf, int row, const LaneArray* p, int at) {
  const double* const m = leaf.row[row];
  if (leaf.translated_only) return load(p[row], at);
  return load(p[0], at) * m[0] + load(p[1], at) * m[1] + load(p[2], at) * m[2];
}

unsigned balls(const FieldTape& tape, std::span<const std::uint32_t> leaves, const LaneRays& rays, const LaneArray& from,
               const LaneArray& end, BallHits& hits, unsigned& unsure) {
  unsigned found = 0;
  unsure = 0;
  for (int at = 0; at < kLanes; at += kWidth) {
    const Reals begin = load(from, at), zero = reals(0.0);
    Reals nearest = load(end, at), normal[3] = {zero, zero, zero};
    unsigned hit = 0, within = 0;
    for (const std::uint32_t index : leaves) {
      const TapeLeaf& leaf = tape.leaves[index];
      Reals o[3], d[3], dd = zero, od = zero;
      for (int axis = 0; axis < 3; ++axis) {
        const double k = leaf.ball_from_object[axis];
        o[axis] = (mapped(leaf, axis, rays.origin, at) + leaf.row[axis][3]) * k;
        d[axis] = mapped(leaf, axis, rays.direction, at) * k;
        dd = dd + d[axis] * d[axis];
        od = od + o[axis] * d[axis];
      }
      // From the place nearest to the centre: the discriminant there has no terms that cancel.
      const Reals per = reals(1.0) / dd, closest = -(od * per);
      Reals squared = zero;
      for (int axis = 0; axis < 3; ++axis) squared = squared + square(o[axis] + closest * d[axis]);
      const LaneMask meets = squared < reals(1.0);
      if (hn::AllFalse(RealTag(), meets)) continue;
      const Reals half = square_root(maximum(reals(1.0) - squared, zero) * per);
      const Reals enter = closest - half, leave = closest + half;
      within |= bits_of(both(meets, both(enter < begin, leave >= begin)));
      const LaneMask nearer = both(both(meets, enter >= begin), enter <= nearest);
      const unsigned bits = bits_of(nearer);
      if (bits == 0) continue;
      hit |= bits;
      nearest = select(nearer, enter, nearest);
      const Reals place = as_float(enter);
      Reals n[3];
      for (int axis = 0; axis < 3; ++axis) n[axis] = (o[axis] + place * d[axis]) * leaf.ball_from_object[axis];
      for (int axis = 0; axis < 3; ++axis) {
        const Reals world = leaf.translated_only ? n[axis] : n[0] * leaf.row[0][axis] + n[1] * leaf.row[1][axis] + n[2] * leaf.row[2][axis];
        normal[axis] = select(nearer, world, normal[axis]);
      }
    }
    const Reals per_length = reals(1.0) / norm(normal[0], normal[1], normal[2]);
    for (int axis = 0; axis < 3; ++axis) store(normal[axis] * per_length, hits.normal[axis], at);
    const Reals place = as_float(nearest);
    store(place, hits.t, at);
    unsigned tied = 0;
    if (hit != 0) {
      const Reals next = nearly_as_near(place, nearest);
      tied = hit & bits_of(either(place<next, place> next));
    }
    found |= hit << at;
    unsure |= (within | tied) << at;
  }
  return found;
}

/// Floats of the lanes in `bits`, to lane[i] or to consecutive places from `first`.
HWY_INLINE void store_some(Reals a, unsigned bits, const int* lane, int first, float* to) {
  if (lane == nullptr && bits == (1u << kWidth) - 1u) return store_floats(a, to + first);
  HWY_ALIGN float values[kWidth];
  store_floats(a, values);
  for (int i = 0; i < kWidth; ++i) {
    if (bits >> i & 1u) to[lane ? lane[i] : first + i] = values[i];
  }
}

/// Writes a vector of lanes, from `at` of their packet; `lane` null: the packet is a block that starts at `first`.
HWY_INLINE void write_vector(Reals t, const Reals* normal, unsigned bits, const int* lane, int first, int at, HitBatch& hits) {
  if (lane) lane += at;
  first += at;
  store_some(t, bits, lane, first, hits.t);
  // What is pruned from a tape may change the sign of a zero: all are 0 here, none -0.
  const Reals zero = reals(0.0);
  store_some(normal[0] + zero, bits, lane, first, hits.normal_x);
  store_some(normal[1] + zero, bits, lane, first, hits.normal_y);
  store_some(normal[2] + zero, bits, lane, first, hits.normal_z);
  for (int i = 0; i < kWidth; ++i) {
    if (!(bits >> i & 1u)) continue;
    const int k = lane ? lane[i] : first + i;
    hits.face[k] = -1;
    hits.material[k] = 0;
    hits.status[k] = HitStatus::hit;
  }
}

HWY_INLINE unsigned before_ends(Reals t, const RayBatch& rays, const int* lane, int first, int at) {
  if (lane == nullptr) return bits_of(t < load_floats(rays.t_max + first + at));
  HWY_ALIGN float ends[kWidth];
  for (int i = 0; i < kWidth; ++i) ends[i] = rays.t_max[lane[at + i]];
  return bits_of(t < load_floats(ends));
}

unsigned write_balls(const RayBatch& rays, int first, const BallHits& found, unsigned lanes, HitBatch& hits) {
  unsigned written = 0;
  for (int at = 0; at < kLanes; at += kWidth) {
    const Reals t = load(found.t, at);
    const Reals normal[3] = {load(found.normal[0], at), load(found.normal[1], at), load(found.normal[2], at)};
    const unsigned bits = lanes >> at & before_ends(t, rays, nullptr, first, at);
    if (bits != 0) write_vector(t, normal, bits, nullptr, first, at, hits);
    written |= bits << at;
  }
  return written;
}

/// Newton's step from `place`, where f and its gradient were taken.
HWY_INLINE Reals newton_from(const LaneRays& packet, Reals place, Reals value, const std::array<LaneArray, 3>& gradients, int at) {
  Reals slope = reals(0.0);
  for (size_t axis = 0; axis < 3; ++axis) slope = slope + load(gradients[axis], at) * load(packet.direction[axis], at);
  return place - value / slope;
}

/// A step to `to`, rounded to float. Where rays graze, a step from so near may still lead away.
HWY_INLINE Reals stepped(Reals place, Reals to) {
  const Reals rounded = as_float(to);
  const LaneMask near = abs(rounded - place) <= abs(place) * (2.0 * std::numeric_limits<float>::epsilon());
  return select(near, rounded, place);
}

/// Between two floats that are equally near but for rounding, each may hold itself for the nearest: there the sign of f halfway decides.
/// `root`: as seen from `place`. True where a lane has moved.
bool settle_ties(const MarchTape& march, const LaneRays& packet, const LaneArray& sign, unsigned lanes, const LaneArray& root,
                 TapeScratch& scratch, LaneArray& place) {
  LaneArray other;
  unsigned ties = 0;
  for (int at = 0; at < kLanes; at += kWidth) {
    const Reals here = load(place, at), next = stepped(here, nearly_as_near(here, load(root, at)));
    ties |= bits_of(either(here<next, here> next)) << at;
    store(next, other, at);
  }
  ties &= lanes;
  if (ties == 0) return false;
  LaneArray halfway, between;
  for (int i = 0; i < kLanes; ++i) halfway[i] = 0.5 * (place[i] + other[i]);
  tape_values(*march.tape, march.steps, packet, halfway, scratch, between);
  bool moved = false;
  for (int i = 0; i < kLanes; ++i) {
    if (!(ties >> i & 1u)) continue;
    const bool beyond = sign[i] * between[i] > 0.0;
    const double nearest = beyond ? std::max(place[i], other[i]) : std::min(place[i], other[i]);
    moved = moved || nearest != place[i];
    place[i] = nearest;
  }
  return moved;
}

/// Moves roots to the floats that are nearest, as f sees it from there, so that how they were found makes no difference; takes gradients.
void settle_places(const MarchTape& march, const LaneRays& packet, const LaneArray& sign, unsigned lanes, TapeScratch& scratch,
                   LaneArray& place, std::array<LaneArray, 3>& gradients) {
  constexpr int kMaxMoves = 2;
  LaneArray values, root;
  for (int move = 0;; ++move) {
    tape_gradients(*march.tape, march.steps, packet, place, scratch, values, gradients);
    unsigned moved = 0;
    for (int at = 0; at < kLanes; at += kWidth) {
      const Reals here = load(place, at), newton = newton_from(packet, here, load(values, at), gradients, at);
      store(newton, root, at);
      if (move == kMaxMoves) continue;
      const Reals there = stepped(here, newton);
      moved |= bits_of(either(here<there, here> there)) << at;
      store(there, place, at);
    }
    if ((moved & lanes) == 0) break;
  }
  if (settle_ties(march, packet, sign, lanes, root, scratch, place)) {
    tape_gradients(*march.tape, march.steps, packet, place, scratch, values, gradients);
  }
}

unsigned write(const MarchTape& march, const RayBatch& rays, const LaneRays& packet, const LaneArray& t, const LaneArray& sign,
               const int* lane, int first, unsigned lanes, TapeScratch& scratch, HitBatch& hits) {
  LaneArray place;
  for (int at = 0; at < kLanes; at += kWidth) store(as_float(load(t, at)), place, at);
  std::array<LaneArray, 3> gradients;
  settle_places(march, packet, sign, lanes, scratch, place, gradients);
  unsigned written = 0;
  for (int at = 0; at < kLanes; at += kWidth) {
    const Reals hit = load(place, at);
    const unsigned bits = lanes >> at & before_ends(hit, rays, lane, first, at);
    Reals normal[3];
    for (size_t axis = 0; axis < 3; ++axis) normal[axis] = load(gradients[axis], at);
    const Reals length = norm(normal[0], normal[1], normal[2]);
    // Where the gradient vanishes (an apex, a double root) any side is as good; the ray's own shows the surface face on.
    const LaneMask defined = both(length > reals(0.0), length < reals(std::numeric_limits<double>::infinity()));
    for (int axis = 0; axis < 3; ++axis) {
      normal[axis] = select(defined, normal[axis] / length, -(load(sign, at) * load(packet.direction[axis], at)));
    }
    if (bits != 0) write_vector(hit, normal, bits, lane, first, at, hits);
    written |= bits << at;
  }
  return written;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace limn
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace limn {
namespace {
HWY_EXPORT(load_rays);
HWY_EXPORT(between);
HWY_EXPORT(guess);
HWY_EXPORT(newton);
HWY_EXPORT(balls);
HWY_EXPORT(write_balls);
HWY_EXPORT(write);
}  // namespace

void load_block(const RayBatch& rays, int first, const glm::dvec3& eye, const glm::dvec3& forward, RayBlock& block) {
  HWY_DYNAMIC_DISPATCH(load_rays)(rays, first, eye, forward, block);
}
unsigned stretches_between(const RayBlock& block, double z0, double z1, double from, LaneArray& a, LaneArray& b, unsigned& late) {
  return HWY_DYNAMIC_DISPATCH(between)(block, z0, z1, from, a, b, late);
}
void guess_from_hits(const LaneRays& rays, const SampleHits& other, int first, LaneArray& t) {
  HWY_DYNAMIC_DISPATCH(guess)(rays, other, first, t);
}
unsigned newton_roots(const MarchTape& march, const LaneRays& rays, const LaneArray& a, const LaneArray& b, double sign, double tolerance,
                      unsigned lanes, TapeScratch& scratch, LaneArray& t, unsigned& undecided) {
  return HWY_DYNAMIC_DISPATCH(newton)(march, rays, a, b, sign, tolerance, lanes, scratch, t, undecided);
}
unsigned ball_roots(const FieldTape& tape, std::span<const std::uint32_t> leaves, const LaneRays& rays, const LaneArray& begin,
                    const LaneArray& end, BallHits& hits, unsigned& unsure) {
  return HWY_DYNAMIC_DISPATCH(balls)(tape, leaves, rays, begin, end, hits, unsure);
}
unsigned write_ball_hits(const RayBatch& rays, int first, const BallHits& found, unsigned lanes, HitBatch& hits) {
  return HWY_DYNAMIC_DISPATCH(write_balls)(rays, first, found, lanes, hits);
}
unsigned write_roots(const MarchTape& march, const RayBatch& rays, const LaneRays& packet, const LaneArray& t, const LaneArray& sign,
                     const int* lane, int first, unsigned lanes, TapeScratch& scratch, HitBatch& hits) {
  return HWY_DYNAMIC_DISPATCH(write)(march, rays, packet, t, sign, lane, first, lanes, scratch, hits);
}

}  // namespace limn
#endif
