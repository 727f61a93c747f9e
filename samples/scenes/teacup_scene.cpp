// A teacup with a handle on its saucer: two closed cages, one of genus 1. Where the handle leaves the wall, vertices have five edges.

#include <algorithm>
#include <array>
#include <numbers>

#include "samples/scenes/cage_builder.h"
#include "samples/scenes/cage_scene.h"
#include "samples/scenes/scenes.h"

namespace limn {
namespace {

constexpr int kSegments = 16;

// Corner order of a wall's quad whose outside looks along +x: below and near (+z), below and far, above and far, above and near.
std::vector<glm::dvec3> handle_section(const glm::dvec2& center, const glm::dvec2& along, double half_width, double half_thickness) {
  const glm::dvec2 tangent = glm::normalize(along);
  const glm::dvec3 outer = half_thickness * glm::dvec3(-tangent.y, tangent.x, 0.0);
  const glm::dvec3 side(0.0, 0.0, half_width);
  const glm::dvec3 middle(center, 0.0);
  return {middle - outer + side, middle - outer - side, middle + outer - side, middle + outer + side};
}

std::vector<std::vector<glm::dvec3>> handle_sections() {
  const std::array<glm::dvec2, 8> path = {
      {{1.14, 1.02}, {1.36, 1.10}, {1.58, 1.04}, {1.69, 0.84}, {1.64, 0.60}, {1.46, 0.42}, {1.22, 0.34}, {1.04, 0.35}}};
  const std::array<double, 8> half_width = {0.125, 0.10, 0.095, 0.09, 0.085, 0.085, 0.09, 0.11};
  const std::array<double, 8> half_thickness = {0.085, 0.065, 0.06, 0.06, 0.06, 0.06, 0.06, 0.075};
  std::vector<std::vector<glm::dvec3>> sections;
  for (size_t i = 0; i < path.size(); ++i) {
    const glm::dvec2 before = path[i == 0 ? 0 : i - 1], after = path[std::min(i + 1, path.size() - 1)];
    sections.push_back(handle_section(path[i], after - before, half_width[i], half_thickness[i]));
  }
  return sections;
}

Mesh cup() {
  const std::array<ProfilePoint, 15> profile = {{{0.34, 0.07, 0.0f},
                                                 {0.40, 0.00, 2.0f},
                                                 {0.49, 0.00, 2.0f},
                                                 {0.50, 0.10, 0.0f},
                                                 {0.74, 0.22, 0.0f},
                                                 {0.90, 0.48, 0.0f},
                                                 {0.97, 0.82, 0.0f},
                                                 {1.01, 1.12, 0.0f},
                                                 {1.10, 1.33, 1.5f},
                                                 {1.04, 1.34, 1.5f},
                                                 {0.94, 1.10, 0.0f},
                                                 {0.89, 0.80, 0.0f},
                                                 {0.81, 0.50, 0.0f},
                                                 {0.60, 0.27, 0.0f},
                                                 {0.30, 0.20, 0.0f}}};
  CageBuilder cage;
  // Half a segment of phase: quad 0 of every band faces +x, where the handle goes.
  const auto body = cage.revolve(profile, kSegments, -std::numbers::pi / kSegments);
  constexpr int kUpperBand = 6, kLowerBand = 4;
  cage.tube(body.bands[kUpperBand], handle_sections(), body.bands[kLowerBand]);
  return cage.mesh();
}

Mesh saucer() {
  const std::array<ProfilePoint, 10> profile = {{{0.50, 0.03, 0.0f},
                                                 {0.62, 0.00, 2.0f},
                                                 {0.72, 0.00, 2.0f},
                                                 {0.78, 0.06, 0.0f},
                                                 {1.35, 0.13, 0.0f},
                                                 {1.80, 0.25, 1.5f},
                                                 {1.78, 0.31, 1.5f},
                                                 {1.30, 0.20, 0.0f},
                                                 {0.72, 0.15, 1.0f},
                                                 {0.58, 0.11, 1.0f}}};
  CageBuilder cage;
  cage.revolve(profile, kSegments, -std::numbers::pi / kSegments);
  return cage.mesh();
}

Scene make() {
  Scene scene;
  SceneObject cup_object = cage_object("cup", cup(), {0.72f, 0.78f, 0.80f});
  cup_object.world_from_object.translation = {0.0, 0.13, 0.0};
  scene.objects.push_back(std::move(cup_object));
  scene.objects.push_back(cage_object("saucer", saucer(), {0.16f, 0.33f, 0.52f}));
  scene.camera = look_at({0.0, 0.47, 0.1}, {0.5, 0.80, 1.0}, 5.5);
  return scene;
}

}  // namespace

SceneDescriptor teacup_scene() {
  return {{"teacup", "a cup with its handle, on a saucer: subdivision cages with creased rims and five-edged vertices", "limn"}, make};
}

}  // namespace limn
