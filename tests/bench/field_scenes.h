#pragma once
// Analytic scenes that the bench draws, and the floor that they are measured against.

#include "raymarch/scene.h"
#include "sdf/camera.h"

namespace limn::bench {

Field sphere_field();
/// `count` balls with random centres in the cube [-1, 1]^3, their radii such that `count` discs of them have the same area for any count.
Field random_spheres(int count);
/// Twenty primitives: a machined block with bosses, blended ribs, holes, slots and a dome. Half of them are taken away from the rest.
Field csg_of_twenty();

/// The sphere of sphere_field by its quadratic equation, float SIMD, and nothing else: ray directions, discriminant, distance from the eye
/// (infinite where there is none), normal (three floats a pixel). Parallel over rows, in the surrounding arena.
void closed_form_sphere(const Camera& camera, float* distance, glm::vec3* normal);

}  // namespace limn::bench
