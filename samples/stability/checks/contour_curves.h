#pragma once
// Whole contour generators of fields, hidden parts included, for checks that count along them.

#include <glm/glm.hpp>
#include <vector>

#include "samples/stability/case_context.h"

namespace limn {

struct WholeContour {
  bool closed = false;
  struct Point {
    glm::dvec2 px{0.0};
    double radial_curvature = 0.0;  ///< 1 / world; NaN at creases.
  };
  std::vector<Point> points{};
};

/// Of all fields of the scene taken together. Throws InputError where an object is none.
std::vector<WholeContour> whole_contours(const Scene& scene, const Camera& camera, const ExecutionSettings& how);

}  // namespace limn
