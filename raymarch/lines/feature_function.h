#pragma once
// Internal: the functions whose zeros are suggestive contours, ridges and valleys, and what of these zeros is drawn.

#include "raymarch/lines/feature_surface.h"

namespace limn {

/// A function's value, whose sign belongs to a direction where that has two: turned round, the value changes sign.
struct FeatureValue {
  double value = 0.0;
  glm::dvec3 along{0.0};  ///< Unit; 0: the sign is the value's own.
};

/// Of one class on one surface; both must outlive it. Safe from many threads.
class FeatureFunction {
 public:
  FeatureFunction(const FeatureSurface& surface, const LineTask& task, LineClass line_class)
      : surface_(surface), camera_(task.camera), settings_(task.settings), line_class_(line_class) {}

  LineClass line_class() const { return line_class_; }
  /// Suggestive contours: the radial curvature times the view's tangential part squared (DeCarlo, Finkelstein, Rusinkiewicz and
  /// Santella 2003). Ridges and valleys: the derivative of the larger or smaller principal curvature along its direction (Ohtake et al.
  /// 2004).
  FeatureValue value(const FeaturePoint& point) const;
  /// Cheap: false where no line is kept nearby.
  bool worth_a_look(const FeaturePoint& point) const;
  /// A value that small, beside the curvature, is rounding.
  bool is_rounding(const FeaturePoint& point, const FeatureValue& value) const;
  /// At least 0 where a zero belongs to a line, if that is strong somewhere.
  double kept(const FeaturePoint& point) const;
  bool strong(const FeaturePoint& point) const;
  /// The curvature across a ridge or valley, whose integral along the line has no unit; nothing of suggestive contours.
  std::optional<double> curvature_across(const FeaturePoint& point) const;

 private:
  double suggestion(const FeaturePoint& point) const;
  double strength(const FeaturePoint& point) const;
  double sharpness(const FeaturePoint& point) const;

  const FeatureSurface& surface_;
  const Camera& camera_;
  const LineSettings& settings_;
  LineClass line_class_;
};

/// Radial curvature: the normal curvature along the tangential part of the view; NaN where the surface faces the eye.
double radial_curvature_of(const FeaturePoint& point, const glm::dvec3& view);

}  // namespace limn
