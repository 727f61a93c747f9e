#pragma once
// Internal: the signed distance of any field near its surface.

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "sdf/field.h"
#include "sdf/lane_points.h"
#include "sdf/tape_lanes.h"

namespace limn {

/// The distance that a jet alone tells, from value, gradient and second derivative along the gradient; `reasonable` is false where the
/// curvature is too strong for it to mean anything.
struct JetDistance {
  double distance = 0.0;
  bool reasonable = true;
};
JetDistance distance_from_jet(const FieldJet& jet);

/// Evaluates distances to one field; owns its scratch memory, so keep one for each thread.
struct DistanceEvaluator {
  /// `memory`: of an evaluator that is no longer needed.
  explicit DistanceEvaluator(const Field& field, TapeScratch memory = {})
      : evaluator(field), scratch(std::move(memory)), lipschitz(field.traits().lipschitz) {}
  FieldEvaluator evaluator;
  std::optional<FieldTape> tape{};  ///< Made where it is needed first.
  bool has_bits_of_field = false;   ///< Of the tape, where there is one.
  TapeScratch scratch{};
  double lipschitz;  ///< Of the field within the half width of the points that are asked for, no more than its traits'.
  /// Of a field that `evaluator`'s is a part of, for places outside that part; null: there are none.
  FieldEvaluator* projects = nullptr;
};

/// Makes it one of this field, if it is not: neighbouring blocks often share a field, and so what evaluates it. The memory that one field
/// was evaluated in, a quarter of a megabyte, serves the next.
void turn_to(const Field& field, std::optional<DistanceEvaluator>& distance);

/// f at each point, to the last bit as FieldEvaluator::values() has it; points are filled up.
void field_values(DistanceEvaluator& distance, const LanePoints& points, LaneNumbers& values);

/// Signed distances at `points`, right to third order where |distance| <= half_width (world); beyond it only |distance| > half_width
/// and the sign are. Exact fields are taken as they are. At most 512 points; sizes equal, and lanes filled up.
void signed_distances(DistanceEvaluator& distance, std::span<const glm::dvec3> points, double half_width, std::span<double> distances);
void signed_distances(DistanceEvaluator& distance, const LanePoints& points, double half_width, LaneNumbers& distances);

}  // namespace limn
