// Every outline method on every built-in scene and on real models: finite ink in [0, 1], the same bytes for one thread and for several.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "raymarch/picture.h"
#include "samples/scenes/scenes.h"
#include "subdiv/import.h"

namespace limn {
namespace {

struct Drawn {
  Scene scene;
  SceneModel model;
  Camera camera;
};

Drawn model_in(Scene scene, const std::string& kind, int level) {
  scene.camera.width_px = 80;
  scene.camera.height_px = 60;
  SurfaceSettings settings;
  settings.kind = kind;
  settings.voxels = 48;
  settings.level = level;
  SceneModel model = build_model(scene, settings);
  const Camera camera = resolve_camera(scene.camera, model.bounds);
  return {std::move(scene), std::move(model), camera};
}

/// The first pixel that differs, or -1.
template <typename T>
std::ptrdiff_t first_difference(const Image<T>& a, const Image<T>& b) {
  if (a.pixels == b.pixels) return -1;
  return std::mismatch(a.pixels.begin(), a.pixels.end(), b.pixels.begin(), b.pixels.end()).first - a.pixels.begin();
}

/// Whether every method that can draw it draws ink in [0, 1] and some, and the same for one thread and for several.
testing::AssertionResult draws_soundly(const Drawn& drawn, const std::string& what) {
  int drawn_methods = 0;
  for (const BorderMethod& method : border_methods()) {
    if (!method.unsupported(drawn.model, drawn.scene).empty()) continue;
    ++drawn_methods;
    const PictureSettings settings{.methods = {{&method, resolve(method.parameters, {})}}};
    const Picture one = draw_picture(drawn.scene, drawn.model, drawn.camera, settings, {.threads = 1, .tile_px = 16});
    // A method reads no layer that it does not name.
    PictureSettings sparing = settings;
    sparing.layers = layers_read(settings.methods);
    const Picture several = draw_picture(drawn.scene, drawn.model, drawn.camera, sparing, {.threads = 3, .tile_px = 7});
    const auto failure = [&] { return testing::AssertionFailure() << method.about.name << " on " << what << ": "; };
    double ink = 0.0;
    for (const float coverage : one.border.pixels) {
      if (!(coverage >= 0.0f && coverage <= 1.0f)) return failure() << "ink of " << coverage;
      ink += coverage;
    }
    if (!(ink > 0.0)) return failure() << "draws nothing";
    const auto border = first_difference(one.border, several.border), composite = first_difference(one.composite, several.composite);
    if (border >= 0) return failure() << "with three threads another border, first at pixel " << border;
    if (composite >= 0) return failure() << "with three threads another composite, first at pixel " << composite;
  }
  if (drawn_methods < 10) return testing::AssertionFailure() << "only " << drawn_methods << " methods draw " << what;
  return testing::AssertionSuccess();
}

class MethodsOnScenes : public testing::TestWithParam<std::string> {};

TEST_P(MethodsOnScenes, InkIsSoundAndTheSameForAnyThreads) {
  const SceneDescriptor* scene = find_scene(GetParam());
  ASSERT_NE(scene, nullptr);
  EXPECT_TRUE(draws_soundly(model_in(scene->make(), "", 2), GetParam() + ", natural"));
}

INSTANTIATE_TEST_SUITE_P(All, MethodsOnScenes, testing::ValuesIn(scenes().names()), [](const auto& test) { return test.param; });

class MethodsOnModels : public testing::TestWithParam<std::string> {};

TEST_P(MethodsOnModels, InkIsSoundAndTheSameForAnyThreads) {
  const std::filesystem::path file = std::filesystem::path(LIMN_TEST_DATA) / (GetParam() + ".obj");
  const MeshSource source{load_mesh(file), std::nullopt, file.string()};
  for (const std::string kind : {"mesh", "mesh_level_set"}) {
    Scene scene;
    scene.objects.push_back({.name = GetParam(), .source = source});
    EXPECT_TRUE(draws_soundly(model_in(std::move(scene), kind, 0), GetParam() + ", " + kind));
  }
}

INSTANTIATE_TEST_SUITE_P(All, MethodsOnModels,
                         testing::Values("ogre_controlmesh", "pig_quad_controlmesh", "spot_control_mesh", "spot_damaged"),
                         [](const auto& test) {
                           std::string name = test.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace limn
