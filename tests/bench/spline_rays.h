#pragma once
// Rays against the cubic splines of level sets, sample by sample. The marcher of pictures looks for the trilinear interpolant's roots, and
// moves them to the spline's: what passes the one and meets the other it does not see.

#include <optional>
#include <vector>

#include "raymarch/scene.h"
#include "sdf/camera.h"
#include "sdf/field.h"

namespace limn::bench {

/// World units.
struct SplineBody {
  Field field;
  Box box{};
  double voxel = 0.0;
};
/// The level sets of a scene, one for each object; nothing where an object is something else.
std::vector<std::optional<SplineBody>> spline_bodies(const Scene& scene);

/// The first hit along a ray within [0, end]; 0 where it starts inside.
std::optional<double> first_hit(const SplineBody& body, FieldEvaluator& evaluator, const CameraRay& ray, double end);

/// The point of the body's contour nearest to a drawn one: where the surface is met and the ray touches it. Nothing where there is none
/// within `most` of it.
std::optional<glm::dvec3> on_contour(FieldEvaluator& evaluator, const Camera& camera, const glm::dvec3& drawn, double most);

}  // namespace limn::bench
