#pragma once
// Analytic scenes that the bench draws.

#include "raymarch/scene.h"

namespace limn::bench {

Field sphere_field();
/// Three different radii, turned.
Field ellipsoid_field();
/// `count` balls with random centres in the cube [-1, 1]^3, their radii such that `count` discs of them have the same area for any count.
Field random_spheres(int count);
/// Twenty primitives: a machined block with bosses, blended ribs, holes, slots and a dome. Half of them are taken away from the rest.
Field csg_of_twenty();

}  // namespace limn::bench
