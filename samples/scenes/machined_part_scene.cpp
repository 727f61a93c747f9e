// A flanged hub as a lathe and a mill would make it: a disc, a boss with a fillet to it, three ribs blended in, a bore with a keyway,
// and six counterbored bolt holes. Blends are smooth, cuts are sharp.

#include <cmath>
#include <numbers>
#include <vector>

#include "samples/scenes/scenes.h"

namespace limn {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kFlangeTop = 0.14;  ///< Height above the flange's middle.

Field cylinder(double radius, double half_height, const glm::dvec3& center) {
  return translate(make_shape("cylinder", {{"radius", {radius}}, {"half_height", {half_height}}}), center);
}

Field body() {
  // The offset of a smaller disc has a rounded edge: a broken edge all around the flange.
  Field part = offset(cylinder(1.16, kFlangeTop - 0.04, {0.0, 0.0, 0.0}), 0.04);
  const Field boss = offset(cylinder(0.44, 0.44, {0.0, 0.36, 0.0}), 0.03);
  std::vector<Field> ribs;
  for (int i = 0; i < 3; ++i) {
    // A bar laid aslant from the boss down to the flange; what would stick out below is inside the flange.
    Field rib = make_shape("rounded_box", {{"half", {0.34, 0.17, 0.055}}, {"rounding", {0.03}}});
    rib = translate(rotate(rib, {0.0, 0.0, 1.0}, -41.0 * kDegree), {0.588, 0.247, 0.0});
    ribs.push_back(rotate(rib, {0.0, 1.0, 0.0}, (120.0 * i + 60.0) * kDegree));
  }
  part = combine(Csg::union_, part, combine(Csg::union_, ribs), 0.06);
  return combine(Csg::union_, part, boss, 0.10);
}

std::vector<Field> cuts() {
  std::vector<Field> tools;
  tools.push_back(cylinder(0.26, 2.0, {0.0, 0.0, 0.0}));
  const Field key = make_shape("box", {{"half", {0.06, 2.0, 0.10}}});
  tools.push_back(translate(key, {0.0, 0.0, 0.26}));
  for (int i = 0; i < 6; ++i) {
    const double angle = (30.0 + 60.0 * i) * kDegree;
    // Ribs stand at 60, 180 and 300 degrees: no hole meets one.
    const glm::dvec3 at = 0.92 * glm::dvec3(std::cos(angle), 0.0, -std::sin(angle));
    tools.push_back(cylinder(0.085, 1.0, at));
    tools.push_back(cylinder(0.145, 0.10, at + glm::dvec3(0.0, kFlangeTop + 0.04, 0.0)));
  }
  return tools;
}

Scene make() {
  std::vector<Field> part = {body()};
  for (const Field& tool : cuts()) part.push_back(tool);
  Scene scene;
  scene.objects.push_back({.name = "flanged hub", .source = combine(Csg::difference, part), .color = {0.50f, 0.53f, 0.56f}});
  scene.camera = look_at({0.0, 0.13, 0.0}, {-0.36, 0.95, 1.0}, 4.1);
  return scene;
}

}  // namespace

SceneDescriptor machined_part_scene() {
  return {{"machined_part", "a flanged hub by CSG: blended fillets, sharp bores, a keyway and counterbored bolt holes", "limn"}, make};
}

}  // namespace limn
