#pragma once
// Internal to limn-read-svg: curves as polylines.

#include <array>
#include <glm/glm.hpp>
#include <vector>

namespace limn {

/// An arc of an ellipse as SVG's path data say it.
struct EllipticArc {
  glm::dvec2 from{0.0}, to{0.0}, radii{0.0};
  double rotation_deg = 0.0;
  bool large = false, sweep = false;
};

/// Moves curves by the transform and appends them to `points`, without their first point, to kSvgFlatness_px. Points that are not finite or
/// farther than a million px from the corner throw std::runtime_error, as do more points than limn-read-svg sends.
struct CurveFlattener {
  glm::dmat3 transform{1.0};
  void line(const glm::dvec2& to, std::vector<glm::dvec2>& points) const;
  void cubic(const std::array<glm::dvec2, 4>& control, std::vector<glm::dvec2>& points) const;
  void arc(const EllipticArc& one, std::vector<glm::dvec2>& points) const;
};

}  // namespace limn
