#pragma once
// Shapes with sharp edges as minima and maxima of smooth faces, so that each edge is where two of them meet (ShapeFunctions::faces). The
// sign is the shape's; outside, the values are not.

#include "sdf/field.h"
#include "sdf/shapes/profile.h"

namespace limn {

/// Behind the plane dot(normal, p) = offset; `normal` unit.
Field half_space(const glm::dvec3& normal, double offset);
/// Behind a line of the half-plane (r, y), turned about the y axis: a cone's side, a cylinder or a plane. `normal` unit.
Field turned_line(const glm::dvec2& normal, double offset);
/// The solid inside a polygon turned about the y axis, each of its sides once (Dobkin, Guibas, Hershberger & Snoeyink 1988).
Field profile_faces(const Profile& profile);

}  // namespace limn
