#pragma once
// Internal: shorter fields for boxes, exact near the surface alone.

#include "sdf/field.h"

namespace limn {

/// A field that equals `field` in `box`, to the last bit, wherever its value is at most `beyond` in size, and elsewhere is larger than
/// that, with the same sign. Shorter than FieldEvaluator::restricted(): of unions, intersections and complements only the sign counts far
/// from the surface, so that a part farther off than `beyond` leaves them. Its traits are those of the whole field.
Field restricted_near_surface(const Field& field, const Box& box, double beyond);

}  // namespace limn
