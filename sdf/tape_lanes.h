#pragma once
// Runs a tape for sixteen rays at once, with the widest SIMD of the machine: values, slopes along the rays, gradients, and bounds over
// stretches of rays or of beams. Double precision; only Mul and Add, square root and division, so that every target gives the same bits.

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "sdf/tape.h"

namespace limn {

inline constexpr int kLanes = 16;

struct alignas(64) LaneArray {
  double lane[kLanes];
  double& operator[](int i) { return lane[i]; }
  const double& operator[](int i) const { return lane[i]; }
};

/// Points origin + s * direction; world space, directions of any length.
struct LaneRays {
  LaneArray origin[3], direction[3];
};

/// Stretches of beams, one a lane: points o + s * d, s in middle +- half, o and d near those of `rays`:
///   o in rays.origin + [-1, 1] origin_spread[0] + ... + [-1, 1] origin_spread[2] + a ball of radius origin_slack, d likewise.
struct LaneBeams {
  LaneRays rays;
  LaneArray middle, half;
  LaneArray radius;    ///< Of a ball about the middle point that holds the stretch.
  int lanes = kLanes;  ///< Whatever comes after the first so many is not asked for.
  glm::dvec3 origin_spread[3]{}, direction_spread[3]{};
  double origin_slack = 0.0, direction_slack = 0.0;
};

/// Of f and of its derivative by s.
struct LaneBounds {
  LaneArray middle;  ///< f at the middle point.
  LaneArray lower, upper;
  LaneArray slope_lower, slope_upper;
};

/// Memory for one thread.
struct TapeScratch {
  std::vector<TapeChoice> choices{};  ///< What the last tape_bounds, tape_slope_bounds or tape_distances found, one a step.
  std::vector<TapeStep> pruned{};     ///< The steps of which tape_distances took jets last.

  /// So many, at a multiple of 64 bytes, as they were left: every step writes a register before another reads it.
  double* registers(size_t doubles) {
    constexpr size_t kAligned = 64 / sizeof(double);
    if (size_ < doubles) {
      size_ = doubles;
      memory_ = std::make_unique_for_overwrite<double[]>(doubles + kAligned);
    }
    void* start = memory_.get();
    size_t space = (size_ + kAligned) * sizeof(double);
    return static_cast<double*>(std::align(64, doubles * sizeof(double), start, space));
  }

 private:
  std::unique_ptr<double[]> memory_{};
  size_t size_ = 0;
};

/// f at s[i] of each ray.
void tape_values(const FieldTape& tape, std::span<const TapeStep> steps, const LaneRays& rays, const LaneArray& s, TapeScratch& scratch,
                 LaneArray& values);
/// ... and its derivative by s: at a crease that of one side.
void tape_slopes(const FieldTape& tape, std::span<const TapeStep> steps, const LaneRays& rays, const LaneArray& s, TapeScratch& scratch,
                 LaneArray& values, LaneArray& slopes);
/// ... and its gradient.
void tape_gradients(const FieldTape& tape, std::span<const TapeStep> steps, const LaneRays& rays, const LaneArray& s, TapeScratch& scratch,
                    LaneArray& values, std::array<LaneArray, 3>& gradients);
/// Bounds of f, and the choices that they decide. Fills `middle`, `lower` and `upper`.
void tape_bounds(const FieldTape& tape, std::span<const TapeStep> steps, const LaneBeams& beams, TapeScratch& scratch, LaneBounds& bounds);
/// Bounds of f and of every one-sided derivative by s (Clarke), and the choices that they decide.
void tape_slope_bounds(const FieldTape& tape, std::span<const TapeStep> steps, const LaneBeams& beams, TapeScratch& scratch,
                       LaneBounds& bounds);

}  // namespace limn
