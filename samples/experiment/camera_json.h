#pragma once
// A camera for people and programs that want to change it and give it back.

#include "samples/output/output.h"
#include "sdf/framed_surface.h"

namespace limn {

/// The keys of a scene file's [camera], which are options too: eye, target, up, fov or ortho, size; and the angles
/// against `up`, which is the call's.
Json camera_json(const Camera& camera, const glm::dvec3& up, const Box& bounds);

}  // namespace limn
