#pragma once
// Internal: how many layers of level sets lie in front of a point.

#include <tbb/enumerable_thread_specific.h>

#include "raymarch/lines/placed_level_set.h"

namespace limn {

class LevelSetLayers {
 public:
  /// `bodies`: those that overlap, of which the outside of all counts.
  LevelSetLayers(std::vector<SharedLevelSet> level_sets, std::vector<std::vector<size_t>> bodies, const Camera& camera)
      : level_sets_(std::move(level_sets)), bodies_(std::move(bodies)), camera_(camera) {}

  /// Between the sample, lifted off, and the eye (or the plane Z = 0): sign changes along the ray, a quarter of a voxel at a time in cells
  /// that the surface may go through.
  LayersSeen before(const CurveSample& sample) const;
  /// Points on contours that its ray goes close by: beside each two sign changes of it that lie closer together than half a voxel.
  std::vector<glm::dvec3> contours_before(const CurveSample& sample) const;

 private:
  std::vector<SharedLevelSet> level_sets_;
  std::vector<std::vector<size_t>> bodies_;
  Camera camera_;
  std::vector<FieldEvaluator>& evaluators() const;  ///< The calling thread's, of each level set.
  mutable tbb::enumerable_thread_specific<std::vector<FieldEvaluator>> evaluators_;
};

}  // namespace limn
