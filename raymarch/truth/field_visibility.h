#pragma once
// Internal: whether something stands between a point and the eye, where everything is a field.

#include <tbb/enumerable_thread_specific.h>

#include <optional>
#include <vector>

#include "raymarch/truth/parts.h"
#include "sdf/field.h"

namespace limn {

/// Fields in solver space. Copies nothing while asked; safe from many threads.
class FieldOccluders {
 public:
  FieldOccluders(const std::vector<Field>& fields, const Camera& camera, double extent);

  /// The segment from the point, lifted off by an epsilon, to the eye (or to the plane Z = 0) is somewhere inside an object. Bounds along
  /// the segment prove that it is not; stretches of less than 1e-10 of the extent count as clear where both ends are. `own` is the place of
  /// the point's own field, which is asked first; none where it lies on something else.
  bool blocked(const TracedPoint& point, std::optional<size_t> own) const;
  /// The least value of the other fields.
  double others(const glm::dvec3& p, std::optional<size_t> own) const;

 private:
  struct Occluder {
    Field field;
    Box clip{};
    double lipschitz = 1.0;
  };
  bool blocks(FieldEvaluator& whole, const Occluder& occluder, const glm::dvec3& origin, const glm::dvec3& direction, double end) const;
  std::vector<FieldEvaluator>& evaluators() const;

  std::vector<Occluder> occluders_;
  Camera camera_;
  double extent_;
  mutable tbb::enumerable_thread_specific<std::vector<FieldEvaluator>> evaluators_;
};

}  // namespace limn
