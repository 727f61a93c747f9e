#include "tests/bench/line_scenes.h"

#include <cmath>
#include <numbers>

#include "samples/scenes/scenes.h"

namespace limn::bench {
namespace {

constexpr double kPitch = 0.098;      ///< Between the middles of neighbouring cells.
constexpr double kAcross = 0.041;     ///< From a cell's middle to its sides.
constexpr double kHalfHeight = 0.09;  ///< Of the plate.

/// A hexagonal hole without end, its sides along the plate's thickness.
Field cell(const glm::dvec3& center) {
  std::vector<Field> sides;
  for (int i = 0; i < 6; ++i) {
    const double turn = i * std::numbers::pi / 3.0;
    sides.push_back(make_shape("plane", {{"normal", {std::cos(turn), 0.0, std::sin(turn)}}, {"offset", {kAcross}}}));
  }
  return translate(combine(Csg::intersection, sides), center);
}

/// A plate with 161 hexagonal cells cut through it: straight edges by the thousand, most of them hidden.
Scene honeycomb() {
  // Seven rows of 23 cells, every other one moved by half a pitch.
  std::vector<Field> part = {make_shape("box", {{"half", {1.18, kHalfHeight, 0.36}}})};
  const double step = kPitch * std::sqrt(3.0) / 2.0;
  for (int row = 0; row < 7; ++row) {
    for (int i = 0; i < 23; ++i) part.push_back(cell({(i - 11 + (row % 2 == 0 ? 0.25 : -0.25)) * kPitch, 0.0, (row - 3) * step}));
  }
  Scene scene;
  scene.objects.push_back({.name = "plate", .source = combine(Csg::difference, part), .color = {0.78f, 0.62f, 0.30f}});
  scene.camera = look_at({0.0, 0.0, 0.0}, {-0.35, 1.0, 0.8}, 3.6);
  return scene;
}

/// 36 spheres fused into one body: every seam and every contour is a circle.
Scene fused_spheres() {
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

/// A tube seen straight down its axis: its walls are edge-on everywhere.
Scene cylinder_end() {
  Scene scene;
  const Field tube = combine(Csg::difference, make_shape("cylinder", {{"radius", {0.7}}, {"half_height", {1.0}}}),
                             make_shape("cylinder", {{"radius", {0.45}}, {"half_height", {1.5}}}));
  scene.objects.push_back({.name = "tube", .source = tube, .color = {0.62f, 0.64f, 0.66f}});
  // Down the axis: rays are parallel to the walls, whose N.V is 0 everywhere.
  scene.camera.target = glm::dvec3(0.0);
  scene.camera.eye = glm::dvec3(0.0, 4.0, 0.0);
  scene.camera.up = {0.0, 0.0, -1.0};
  scene.camera.projection = Projection::orthographic;
  scene.camera.ortho_height = 2.0;
  return scene;
}

}  // namespace

std::vector<NamedScene> line_scenes() {
  return {{"honeycomb", honeycomb()}, {"fused_spheres", fused_spheres()}, {"cylinder_end", cylinder_end()}};
}

}  // namespace limn::bench
