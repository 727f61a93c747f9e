// 36 spheres fused into one body: every seam is a circle, every contour a circle, and nearly everything hides something.

#include <cmath>
#include <numbers>
#include <vector>

#include "samples/scenes/scenes.h"

namespace limn {
namespace {

Scene make() {
  // One in the middle, the others along a spiral over it (Fibonacci lattice), their radii in turn.
  constexpr int kOuter = 35;
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  std::vector<Field> spheres = {make_shape("sphere", {{"radius", {0.82}}})};
  for (int i = 0; i < kOuter; ++i) {
    const double y = 1.0 - 2.0 * (i + 0.5) / kOuter, r = std::sqrt(1.0 - y * y), turn = golden * i;
    const double radius = 0.19 + 0.04 * (i % 3);
    spheres.push_back(
        translate(make_shape("sphere", {{"radius", {radius}}}), {0.8 * r * std::cos(turn), 0.8 * y, 0.8 * r * std::sin(turn)}));
  }
  Scene scene;
  scene.objects.push_back({.name = "spheres", .source = combine(Csg::union_, spheres), .color = {0.45f, 0.55f, 0.72f}});
  scene.camera = look_at({0.0, 0.0, 0.0}, {0.35, 0.45, 1.0}, 4.2);
  return scene;
}

}  // namespace

SceneDescriptor fused_spheres_scene() {
  return {{"fused_spheres", "36 spheres fused into one body: seams and contours are circles", "limn"}, make};
}

}  // namespace limn
