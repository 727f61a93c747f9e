#pragma once
// Materials and colours of the parts of a field, whatever it was modelled as.

#include "raymarch/surface.h"
#include "sdf/field_tree.h"

namespace limn {

/// Where parts of the object, a field, have materials or colours of their own: the same surface, whose hits tell the material of the part
/// that owns the place, and parts_of(). Else the surface as it is.
Surface with_field_parts(const SceneObject& object, Surface surface, const glm::dvec3& render_origin);

/// In render space; null where with_field_parts() left the surface as it was. Valid as long as the surface is.
const FieldParts* parts_of(const Surface& surface);

}  // namespace limn
