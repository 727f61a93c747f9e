#pragma once
// Internal: values and jets of a field, and the distances that jets tell, at many points with the widest SIMD of the machine. Every bit is
// that of FieldEvaluator::jets() and of distance_from_jet() (sdf/level_set_distance.h).

#include <cstdint>
#include <span>

#include "sdf/lane_points.h"
#include "sdf/tape_lanes.h"

namespace limn {

/// Value, gradient and Hessian (xx, xy, xz, yy, yz, zz) of sixteen points.
struct LaneJets {
  LaneArray value;
  LaneArray gradient[3];
  LaneArray hessian[6];
};

/// f, its gradient and its Hessian at points[0][i], points[1][i], points[2][i] (world).
void tape_jets(const FieldTape& tape, const LaneArray (&points)[3], TapeScratch& scratch, LaneJets& jets);

/// f at points that are filled up (world). Every bit is that of FieldEvaluator::values() where has_bits_of_field().
void tape_values_at(const FieldTape& tape, const LanePoints& points, TapeScratch& scratch, LaneNumbers& values);
/// The same at any number of points; sizes equal.
void tape_values_at(const FieldTape& tape, std::span<const glm::dvec3> points, TapeScratch& scratch, std::span<double> values);
/// f and its gradient at any number of points (world); sizes equal. Every bit is that of FieldEvaluator::gradients() of one point where
/// has_bits_of_field().
void tape_gradients_at(const FieldTape& tape, std::span<const glm::dvec3> points, TapeScratch& scratch, std::span<double> values,
                       std::span<glm::dvec3> gradients);
/// False for metaballs, which lanes add in another order.
bool has_bits_of_field(const FieldTape& tape);

/// The distances that the jets tell at points that are filled up, and where they mean anything (distance_from_jet).
void tape_distances(const FieldTape& tape, const LanePoints& points, TapeScratch& scratch, LaneNumbers& distances, LaneFlags& reasonable);

}  // namespace limn
