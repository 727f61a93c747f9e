#pragma once
// Internal: zeros of a function on a feature surface, joined to chains.

#include "raymarch/lines/feature_function.h"

namespace limn {

/// A zero of the function.
struct FeatureStation {
  FeaturePoint point{};
  FeaturePlace place{};   ///< Where evaluating the surface gives the point.
  glm::dvec3 along{0.0};  ///< Of its FeatureValue.
};

/// Both in one triangle.
struct FeatureStep {
  FeatureStation from{}, to{};
};

struct FeatureChain {
  bool closed = false;
  std::vector<FeatureStep> steps{};  ///< One for each triangle; each begins where the one before ends.
};

/// In an order that does not depend on threads.
std::vector<FeatureChain> march_features(const FeatureSurface& surface, const FeatureFunction& function,
                                         const ExecutionSettings& execution);

/// A zero beside the middle of a step; nothing where the function does not change sign across it there.
std::optional<FeatureStation> middle_of(const FeatureSurface& surface, const FeatureFunction& function, const FeatureStep& step);

}  // namespace limn
