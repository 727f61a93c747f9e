// A chess rook: a turned body, and battlements raised from every other quad of its top, with semi-sharp edges.

#include <array>
#include <numbers>

#include "samples/scenes/cage_builder.h"
#include "samples/scenes/cage_scene.h"
#include "samples/scenes/scenes.h"

namespace limn {
namespace {

constexpr int kSegments = 12;
constexpr float kEdge = 2.5f;

void raise_battlements(CageBuilder& cage, int top_band) {
  for (int i = 0; i < kSegments; i += 2) {
    const CageBuilder::Loop base = cage.corners(top_band + i);
    const CageBuilder::Loop top = cage.corners(cage.extrude(top_band + i, {0.0, 0.24, 0.0}));
    cage.crease_loop(top, kEdge);
    for (size_t k = 0; k < base.size(); ++k) cage.crease(base[k], top[k], kEdge);
    // The short edges of the base, across the wall; those along it are creased with their rings.
    cage.crease(base[1], base[2], kEdge);
    cage.crease(base[3], base[0], kEdge);
  }
}

Mesh rook() {
  const std::array<ProfilePoint, 21> profile = {
      {{0.50, 0.04, 0.0f}, {0.66, 0.00, 2.0f}, {0.74, 0.00, 2.5f}, {0.76, 0.14, 2.0f}, {0.66, 0.20, 2.0f},  {0.68, 0.30, 1.0f},
       {0.62, 0.40, 2.0f}, {0.50, 0.44, 1.0f}, {0.42, 0.62, 0.0f}, {0.36, 0.95, 0.0f}, {0.37, 1.22, 1.0f},  {0.46, 1.30, 2.0f},
       {0.46, 1.37, 2.0f}, {0.40, 1.41, 1.0f}, {0.43, 1.50, 0.0f}, {0.58, 1.58, 2.5f}, {0.58, 1.82, kEdge}, {0.40, 1.82, kEdge},
       {0.38, 1.70, 0.0f}, {0.36, 1.66, 2.0f}, {0.18, 1.65, 0.0f}}};
  constexpr int kTopBand = 16;  // from the outer to the inner rim
  CageBuilder cage;
  const auto body = cage.revolve(profile, kSegments, 0.0);
  raise_battlements(cage, body.bands[kTopBand]);
  return cage.mesh();
}

Scene make() {
  Scene scene;
  scene.objects.push_back(cage_object("rook", rook(), {0.55f, 0.36f, 0.20f}));
  scene.camera = look_at({0.0, 0.98, 0.0}, {0.35, 0.52, 1.0}, 4.4);
  return scene;
}

}  // namespace

SceneDescriptor rook_scene() {
  return {{"rook", "a chess rook: a turned body with battlements, a subdivision cage with semi-sharp edges", "limn"}, make};
}

}  // namespace limn
