// A plate with 161 hexagonal cells cut through it: straight edges by the thousand, most of them hidden.

#include <cmath>
#include <numbers>
#include <vector>

#include "samples/scenes/scenes.h"

namespace limn {
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

Scene make() {
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

}  // namespace

SceneDescriptor honeycomb_scene() {
  return {{"honeycomb", "a plate with 161 hexagonal cells: sharp edges by the thousand, most of them hidden", "limn"}, make};
}

}  // namespace limn
