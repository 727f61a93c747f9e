// The mesh that warnings and the choice of a method look at is the one that is drawn, and it is made once.

#include <gtest/gtest.h>

#include "raymarch/surface/object_mesh.h"
#include "samples/experiment/flat_input.h"
#include "samples/experiment/warnings.h"
#include "tests/raymarch/awkward_cages.h"

namespace limn {
namespace {

Scene scene_of(std::optional<Scheme> scheme, int objects) {
  Scene scene;
  for (int i = 0; i < objects; ++i) scene.objects.push_back({.name = "cage", .source = MeshSource{test::cube_cage(7), scheme}});
  return scene;
}

TEST(KeptMesh, WhatTheAuditLooksAtIsTheModels) {
  for (const auto scheme : {std::optional<Scheme>{}, std::optional(Scheme::catmark)}) {
    const Scene scene = scene_of(scheme, 1);
    const SurfaceSettings settings{.kind = "mesh", .level = 2};
    ObjectMeshCache cache;
    const double share = flat_share(scene, settings, &cache);
    EXPECT_EQ(share, flat_share(scene, settings));
    ASSERT_EQ(cache.kept.size(), 1u);
    const std::shared_ptr<const KeptMesh> kept = cache.kept.front();
    ASSERT_NE(kept, nullptr);
    EXPECT_EQ(warnings_of(scene, settings, {.meshes = &cache}), warnings_of(scene, settings, {}));
    const SceneModel model = build_model(scene, settings, &cache), alone = build_model(scene, settings);
    EXPECT_EQ(cache.kept.front(), kept) << "made twice";
    EXPECT_EQ(model.surfaces.front().polygons->mesh().positions, alone.surfaces.front().polygons->mesh().positions);
    // At another level it is not what the model needs.
    const SceneModel finer = build_model(scene, {.kind = "mesh", .level = 3}, &cache);
    EXPECT_EQ(total(finer).triangles, total(build_model(scene, {.kind = "mesh", .level = 3})).triangles);
    EXPECT_NE(cache.kept.front(), kept);
  }
}

TEST(KeptMesh, OfSeveralObjectsNoneIsKeptForTheWholeScene) {
  ObjectMeshCache cache;
  flat_share(scene_of(Scheme::catmark, 2), {.kind = "mesh"}, &cache);
  EXPECT_TRUE(cache.kept.empty());
}

}  // namespace
}  // namespace limn
