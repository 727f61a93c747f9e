#pragma once
// Internal: sixteen consecutive rays of a batch, a block of 4 x 4 pixels, by SIMD.

#include "raymarch/analytic/march_field.h"

namespace limn {

/// The rays of a block, and where they cross planes across the view.
struct RayBlock {
  LaneRays rays;
  LaneArray t_min, t_max;
  LaneArray depth, depth_per_t;  ///< Of the point at t along the view axis: depth + t depth_per_t.
  double reach = 0.0;            ///< Of the origins: their largest coordinate.
};

/// `forward`: unit; depths are measured from `eye`.
void load_block(const RayBatch& rays, int first, const glm::dvec3& eye, const glm::dvec3& forward, RayBlock& block);

/// Where the rays run between the depths z0 and z1, within their own ends; returns the lanes where that is anything. `late`: the rays that
/// start behind the depth `from`.
unsigned stretches_between(const RayBlock& block, double z0, double z1, double from, LaneArray& a, LaneArray& b, unsigned& late);

/// Where another sample's ray through the same pixel has hit, as that block of its batch has it, the root in `t` becomes the place where
/// the plane that touches the surface there is met. Elsewhere it stays.
void guess_from_hits(const LaneRays& rays, const SampleHits& other, int first, LaneArray& t);

/// First roots of a function that, times `sign`, is positive at a and falls all the way to b: Newton's steps from `t`, kept within the
/// bracket. Returns the lanes that have one, with t near enough for write_roots; `undecided` are those that did not settle.
unsigned newton_roots(const MarchTape& march, const LaneRays& rays, const LaneArray& a, const LaneArray& b, double sign, double tolerance,
                      unsigned lanes, TapeScratch& scratch, LaneArray& t, unsigned& undecided);

/// Nearest hits of balls and ellipsoids, all of which are solid; nothing else is there.
struct BallHits {
  LaneArray t;          ///< Rounded to float.
  LaneArray normal[3];  ///< Unit.
};
/// Returns the lanes with a hit in [begin, end]; `unsure` those that are within one at `begin`, or whose hit is as near to one float as to
/// the next: these are for write_roots, where f decides.
unsigned ball_roots(const FieldTape& tape, std::span<const std::uint32_t> leaves, const LaneRays& rays, const LaneArray& begin,
                    const LaneArray& end, BallHits& hits, unsigned& unsure);

/// Writes what `lanes` of a block hit before their ends; returns which did.
unsigned write_ball_hits(const RayBatch& rays, int first, const BallHits& found, unsigned lanes, HitBatch& hits);

/// Of sixteen roots, known to a millionth of the extent or better, the ones in `lanes`: moved to the nearest float as f there tells it, so
/// that the result does not depend on how they were found, and the normal there. Returns those before their ends. The packet's lane i is
/// lane[i] of the batch; `lane` null: first + i.
unsigned write_roots(const MarchTape& march, const RayBatch& rays, const LaneRays& packet, const LaneArray& t, const LaneArray& sign,
                     const int* lane, int first, unsigned lanes, TapeScratch& scratch, HitBatch& hits);

}  // namespace limn
