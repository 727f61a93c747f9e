#include <numbers>

#include "samples/scenes/scenes.h"

namespace limn {
namespace {

Field ring(double major, double minor) { return make_shape("torus", {{"major", {major}}, {"minor", {minor}}}); }

Scene make() {
  Scene scene;
  // Two objects whose tubes pass through each other twice: their intersection is a curve of degree eight.
  const double quarter = std::numbers::pi / 2.0;
  scene.objects.push_back({.name = "first ring", .source = translate(ring(0.8, 0.26), {-0.4, 0.0, 0.0}), .color = {0.72f, 0.36f, 0.26f}});
  scene.objects.push_back({.name = "second ring",
                           .source = translate(rotate(ring(0.8, 0.30), {1.0, 0.0, 0.0}, quarter), {0.4, 0.0, 0.06}),
                           .color = {0.30f, 0.44f, 0.62f}});
  scene.camera = look_at({0.0, 0.0, 0.0}, {0.5, 0.7, 1.0}, 4.0);
  return scene;
}

}  // namespace

SceneDescriptor passing_tori_scene() {
  return {{"passing_tori", "two rings that pass through each other, each hiding a part of the other", "limn"}, make};
}

}  // namespace limn
