#pragma once
// Internal: a scene's model, object by object.

#include "raymarch/surface.h"

namespace limn {

/// Appends an object's surface with its colour and material. The model's bounds grow by what reaches beyond the object: a dual-contoured
/// mesh, a grid's cells.
void append_surface(const SceneObject& object, Surface surface, SceneModel& model);

/// Where the models of a scene have their origin, world.
glm::dvec3 render_origin_of(const Scene& scene);

}  // namespace limn
