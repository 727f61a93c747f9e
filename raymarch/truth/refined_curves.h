#pragma once
// Internal: points between those that were found of a curve in cells, and what tells that a curve so made leads from one arm to another.

#include <cstdint>

#include "raymarch/truth/field_curves.h"

namespace limn {

struct Refiner {
  const Field& field;
  const Camera& camera;
  const Viewer& viewer;
  double tolerance_px;
  double extent;
  bool far_aside = true;  ///< Points between are looked for farther aside than a step is long, too.
};

/// Adds points until each step's error is well below the tolerance; steps that cannot be halved are counted in `stats`.
void refine(const Refiner& refiner, FieldCurve& curve, FieldCurves& stats);
/// Steps of a refined curve that lead from one arm of it to another, and turns that it cannot have.
std::int64_t count_broken(const Refiner& refiner, const FieldCurve& curve);

}  // namespace limn
