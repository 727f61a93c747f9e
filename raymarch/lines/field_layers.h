#pragma once
// Internal: how many layers of surface a ray goes through, where everything is a field.

#include <tbb/enumerable_thread_specific.h>

#include <vector>

#include "raymarch/lines/surface_curves.h"
#include "sdf/field.h"

namespace limn {

/// From beside a sample to the eye (or the plane Z = 0).
struct LayerRay {
  glm::dvec3 origin{0.0}, direction{0.0};
  double end = 0.0;
};
/// The sample is lifted off its surface by an epsilon; a point on a chord, which lies beside its curve, by so much more.
LayerRay layer_ray(const Camera& camera, double extent, const CurveSample& sample);

/// Bodies in solver space that do not overlap. Safe from many threads.
class FieldLayers {
 public:
  FieldLayers(const std::vector<Field>& bodies, const Camera& camera, double extent);

  /// Sign changes between the sample, lifted off by an epsilon, and the eye (or the plane Z = 0). Bounds along the ray prove each stretch
  /// to hold none or one; stretches of less than 1e-10 of the extent hold one where their ends differ.
  int before(const CurveSample& sample) const;

 private:
  struct Body {
    Field field;
    Box clip{};
    double lipschitz = 1.0;
  };
  int sign_changes(FieldEvaluator& evaluator, const Body& body, const glm::dvec3& origin, const glm::dvec3& direction, double end) const;

  std::vector<Body> bodies_;
  Camera camera_;
  double extent_;
  mutable tbb::enumerable_thread_specific<std::vector<FieldEvaluator>> evaluators_;
};

}  // namespace limn
