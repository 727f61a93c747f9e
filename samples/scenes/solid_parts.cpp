#include "samples/scenes/solid_parts.h"

#include <cmath>
#include <numbers>

#include "samples/scenes/scenes.h"
#include "sdf/shape.h"

namespace limn {
namespace {

using Kind = PartSolid::Kind;

Field field_of(const PartSolid& solid) {
  switch (solid.kind) {
    case Kind::sphere:
      return make_shape("sphere", {{"radius", {solid.size.x}}});
    case Kind::cylinder:
      return make_shape("cylinder", {{"radius", {solid.size.x}}, {"half_height", {solid.size.y}}});
    case Kind::torus:
      return make_shape("torus", {{"major", {solid.size.x}}, {"minor", {solid.size.y}}});
    case Kind::box:
      return make_shape("box", {{"half", {solid.size.x, solid.size.y, solid.size.z}}});
    case Kind::hexagon:
      break;
  }
  std::vector<Field> sides;
  for (int i = 0; i < 6; ++i) {
    const double turn = i * std::numbers::pi / 3.0;
    sides.push_back(make_shape("plane", {{"normal", {std::cos(turn), 0.0, std::sin(turn)}}, {"offset", {solid.size.x}}}));
  }
  return combine(Csg::intersection, sides);
}

}  // namespace

SolidPart fused_spheres_part() {
  // One in the middle, the others along a spiral over it (Fibonacci lattice), their radii in turn.
  constexpr int kOuter = 35;
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  SolidPart part{"fused_spheres", {{Kind::sphere, {0.9, 0.0, 0.0}}}};
  for (int i = 0; i < kOuter; ++i) {
    const double y = 1.0 - 2.0 * (i + 0.5) / kOuter, r = std::sqrt(1.0 - y * y), turn = golden * i;
    part.solids.push_back(
        {Kind::sphere, {0.23 + 0.04 * (i % 3), 0.0, 0.0}, {0.92 * r * std::cos(turn), 0.92 * y, 0.92 * r * std::sin(turn)}});
  }
  return part;
}

SolidPart honeycomb_part(double half_height) {
  constexpr double kPitch = 0.098;   // between the middles of neighbouring cells
  constexpr double kAcross = 0.041;  // from a cell's middle to its sides
  SolidPart part{"honeycomb", {{Kind::box, {1.18, half_height, 0.36}}}};
  // Seven rows of 23 cells, every other one moved by half a pitch.
  const double step = kPitch * std::sqrt(3.0) / 2.0;
  for (int row = 0; row < 7; ++row) {
    for (int i = 0; i < 23; ++i) {
      const glm::dvec3 center((i - 11 + (row % 2 == 0 ? 0.25 : -0.25)) * kPitch, 0.0, (row - 3) * step);
      part.solids.push_back({Kind::hexagon, {kAcross, 2.0 * half_height, 0.0}, center, true});
    }
  }
  return part;
}

Field field_of(const SolidPart& part) {
  std::vector<Field> joined, cut;
  for (const PartSolid& solid : part.solids) (solid.cut ? cut : joined).push_back(translate(field_of(solid), solid.center));
  std::vector<Field> all = {combine(Csg::union_, joined)};
  all.insert(all.end(), cut.begin(), cut.end());
  return combine(Csg::difference, all);
}

Scene scene_of(const SolidPart& part) {
  Scene scene;
  scene.objects.push_back({.name = part.name, .source = field_of(part), .color = {0.62f, 0.64f, 0.66f}});
  scene.camera = look_at({0.0, 0.0, 0.0}, {-0.35, 1.0, 0.8}, 4.8);
  return scene;
}

}  // namespace limn
