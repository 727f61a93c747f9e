#pragma once
// Internal: curves found on a body of one or several fields, or level sets, as curves of the view graph.

#include "raymarch/lines/surface_curves.h"
#include "raymarch/truth/field_bodies.h"
#include "raymarch/truth/field_curves.h"

namespace limn {

struct MaterialParts;  // raymarch/lines/material_curves.h

/// What one body's curves are made into lines by.
struct FieldTask {
  const LineTask& task;
  const FieldBodies& bodies;
  const std::vector<size_t>& body;
  Viewer viewer{};
  std::vector<FieldEvaluator>& evaluators;  ///< Of the fields of `bodies`.
  const MaterialParts* parts = nullptr;     ///< Of the body, where some have materials of their own.

  /// Which object a point lies on, from 1; where two meet, the one with that normal.
  int object_of(const glm::dvec3& p, const glm::dvec3& normal) const {
    return static_cast<int>(bodies.numbers[static_cast<size_t>(object_at(evaluators, body, p, normal, bodies.extent))] + 1);
  }
};

/// `found(i)` for i below `count`: contours and level curves of N.V, and whole seams.
std::vector<SurfaceCurve> surface_curves(const FieldTask& fields, size_t count, const std::function<const FieldCurve&(size_t)>& found);

}  // namespace limn
