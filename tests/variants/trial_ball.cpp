// A shape, for the test of this folder: the sphere under another name.

#include "sdf/shapes/entry.h"

namespace limn {

ShapeDescriptor describe_trial_ball() {
  return {
      {"trial_ball", "a ball, on trial", "limn"}, {length_parameter("radius", 1.0, "distance from the origin")}, [](const Parameters& p) {
        return make_shape("sphere", {{"radius", {p.number("radius")}}});
      }};
}

}  // namespace limn
