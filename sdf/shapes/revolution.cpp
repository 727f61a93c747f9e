#include "sdf/shapes/entry.h"
#include "sdf/shapes/profile.h"

namespace limn {
namespace {

Field make(const Parameters& p) {
  const auto numbers = p.list("profile");
  std::vector<glm::dvec2> points;
  for (size_t i = 0; i + 1 < numbers.size(); i += 2) points.emplace_back(numbers[i], numbers[i + 1]);
  return field_from_shape(make_profile(std::move(points)), 1.0, true);
}

}  // namespace

ShapeDescriptor describe_revolution() {
  // A goblet: foot, stem, cup, and back down inside.
  const std::vector<double> goblet = {0.00,  -0.90, 0.45,  -0.90, 0.45, -0.84, 0.16, -0.72, 0.09, -0.55, 0.09,
                                      -0.20, 0.18,  -0.08, 0.38,  0.08, 0.50,  0.32, 0.52,  0.60, 0.46,  0.90,
                                      0.41,  0.90,  0.46,  0.60,  0.44, 0.34,  0.33, 0.13,  0.00, 0.00};
  Parameter profile = list_parameter("profile", goblet, -greatest_length, 2, "closed polygon of [r, y] points, r >= 0, sides not crossing");
  return {{"revolution", "a polygon turned about the y axis", "distance to a polygon; limn"}, {profile}, make};
}

}  // namespace limn
