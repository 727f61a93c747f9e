// Every outline method on every built-in scene and on real models: finite ink in [0, 1], the same bytes for one thread and for several.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
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

// A level set's band is rebuilt wider by `extrude`, which is tested on its own and slow on rich shapes.
void expect_sound_methods(const Drawn& drawn, const std::string& what) {
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
    double ink = 0.0;
    for (const float coverage : one.border.pixels) {
      ASSERT_TRUE(std::isfinite(coverage) && coverage >= 0.0f && coverage <= 1.0f) << method.about.name << " on " << what;
      ink += coverage;
    }
    EXPECT_GT(ink, 0.0) << method.about.name << " draws nothing on " << what;
    EXPECT_EQ(one.border.pixels, several.border.pixels) << method.about.name << " on " << what;
    EXPECT_EQ(one.composite.pixels, several.composite.pixels) << method.about.name << " on " << what;
  }
  EXPECT_GE(drawn_methods, 10) << what;
}

class MethodsOnScenes : public testing::TestWithParam<std::string> {};

TEST_P(MethodsOnScenes, InkIsSoundAndTheSameForAnyThreads) {
  const SceneDescriptor* scene = find_scene(GetParam());
  ASSERT_NE(scene, nullptr);
  expect_sound_methods(model_in(scene->make(), "", 2), GetParam() + ", natural");
}

INSTANTIATE_TEST_SUITE_P(All, MethodsOnScenes, testing::ValuesIn(scene_names()), [](const auto& test) { return test.param; });

class MethodsOnModels : public testing::TestWithParam<std::string> {};

TEST_P(MethodsOnModels, InkIsSoundAndTheSameForAnyThreads) {
  const std::filesystem::path file = std::filesystem::path(LIMN_MODELS) / (GetParam() + ".obj");
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file;
  const MeshSource source{load_mesh(file), std::nullopt, file.string()};
  for (const std::string kind : {"mesh", "mesh_level_set"}) {
    Scene scene;
    scene.objects.push_back({.name = GetParam(), .source = source});
    expect_sound_methods(model_in(std::move(scene), kind, 0), GetParam() + ", " + kind);
  }
}

INSTANTIATE_TEST_SUITE_P(All, MethodsOnModels,
                         testing::Values("beetle", "cow", "fandisk", "spot_control_mesh", "stanford-bunny", "suzanne", "teapot"),
                         [](const auto& test) {
                           std::string name = test.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace limn
