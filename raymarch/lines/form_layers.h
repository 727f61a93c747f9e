#pragma once
// Internal: how many layers of a body in closed form a ray goes through.

#include "raymarch/lines/form_body.h"
#include "raymarch/lines/surface_curves.h"

namespace limn {

/// Exact roots along rays exist for everything but tori.
bool has_ray_roots(const FormBody& body);

/// Sign changes between the sample, lifted off by an epsilon, and the eye (or the plane Z = 0). A sample on a sharp edge stays where it is:
/// its own surfaces are left by the way that the ray takes.
int layers_before(const FormBody& body, const Camera& camera, double extent, const CurveSample& sample);

}  // namespace limn
