#pragma once
// Internal: contours that lead to the tip of a cone.

#include "raymarch/lines/surface_curves.h"
#include "sdf/field.h"

namespace limn {

/// Of the shapes in a field, those that lie on its surface (ShapeFunctions::tip).
std::vector<glm::dvec3> tips_of(const Field& field, double extent);

/// Nothing can be traced at a tip itself, where a surface has no normal: contours that end or go past beside one are led to it.
void lead_to_tips(const std::vector<glm::dvec3>& tips, const Camera& camera, std::vector<SurfaceCurve>& curves);

}  // namespace limn
