#pragma once
// Internal: places on a curve, and image lengths along it.

#include "raymarch/lines/surface_curves.h"

namespace limn {

/// Steps between neighbouring samples.
size_t steps_of(const SurfaceCurve& curve);
/// Within the picture, and before the eye.
bool in_frame(const Camera& camera, const CurveSample& sample);
/// Between samples i and i + 1 (of a closed curve the first again) the curve's own point where it is known; else one of a smooth curve
/// through them and their neighbours.
glm::dvec3 point_at(const SurfaceCurve& curve, size_t i, double share);
/// Samples of a curve without all that is known of them.
struct CurvePath {
  struct Sample {
    glm::dvec3 p{0.0};
    double radial_curvature = 0.0;
  };
  bool closed = false, smooth = false, straight = false;
  std::vector<Sample> samples{};
};
CurvePath path_of(const SurfaceCurve& curve);
/// As point_at(), where nothing but the samples is known of the curve.
glm::dvec3 point_between(const CurvePath& path, size_t i, double share);
/// How far the curve leaves a step in the image; 0 where nothing but the step is known of it, and where it turns back at a cusp.
double sag_px(const SurfaceCurve& curve, size_t step, const Camera& camera);
/// The point at a place on a curve: the index of a step plus the share of it.
CurveSample sample_at(const SurfaceCurve& curve, double place, const Camera& camera);
/// Image points between two places, theirs included; `to` may lie beyond the last sample of a closed curve.
std::vector<glm::dvec2> px_between(const SurfaceCurve& curve, double from, double to, const Camera& camera);
/// The same where the image points of both places are known.
std::vector<glm::dvec2> px_between(const SurfaceCurve& curve, const glm::dvec2& from_px, double from, double to, const glm::dvec2& to_px);
/// The image of a place on a step's chord, where crossings are found.
glm::dvec2 chord_px(const SurfaceCurve& curve, double place, const Camera& camera);
/// The point, or every point, is within `apart_px` of a polyline.
bool lies_along(const glm::dvec2& px, const std::vector<glm::dvec2>& line, double apart_px);
bool lies_along(const std::vector<glm::dvec2>& px, const std::vector<glm::dvec2>& line, double apart_px);

/// Lengths along one curve. Keeps a reference to it.
class CurveWalk {
 public:
  CurveWalk(const SurfaceCurve& curve, const Camera& camera);

  size_t size() const { return curve_.samples.size(); }
  const CurveSample& at(size_t i) const { return curve_.samples[i < size() ? i : i % size()]; }
  double length_px() const { return lengths_.back(); }
  /// Image length from the curve's first point to a place, which may lie beyond the last.
  double length_to(double place) const;
  /// Image length between two places, the shorter way round.
  double apart_px(double one, double other) const { return apart_of_lengths(length_to(one), length_to(other)); }
  double apart_of_lengths(double one_px, double other_px) const;
  /// Image points from a place on, one way or the other, over some length and half a pixel.
  std::vector<glm::dvec2> px_from(double place, double length_px, int way) const;

 private:
  const SurfaceCurve& curve_;
  const Camera& camera_;
  std::vector<double> lengths_;  ///< To each sample, and to the first again of a closed one.
};

}  // namespace limn
