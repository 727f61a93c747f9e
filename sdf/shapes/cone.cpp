#include <cmath>
#include <numbers>

#include "sdf/shapes/entry.h"
#include "sdf/shapes/profile.h"

namespace limn {
namespace {

// A triangle turned about the axis: its distance is closed, outside as well as inside.
Field make(const Parameters& p) {
  const double height = p.number("height");
  const double radius = height * std::tan(p.number("angle_deg") * std::numbers::pi / 180.0);
  return field_from_shape(make_profile({{0.0, -0.5 * height}, {radius, -0.5 * height}, {0.0, 0.5 * height}}), 1.0, true);
}

}  // namespace

ShapeDescriptor describe_cone() {
  const Parameter angle = a_number("angle_deg", 25.0).in(0.1, 89.0).unit("deg").help("between the axis (y) and the side");
  return {{"cone", "a capped cone, apex up, half its height above the origin", "closed form"},
          {angle, length_parameter("height", 1.6, "from the base to the apex")},
          make};
}

}  // namespace limn
