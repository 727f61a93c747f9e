// What hides what in a local model's pictures: a mesh's facets, drawn, beside the same mesh traced ray by ray.

#include <gtest/gtest.h>

#include <cmath>

#include "raymarch/local/local_depth.h"
#include "raymarch/surface/object_mesh.h"
#include "samples/experiment/job.h"
#include "samples/scenes/scenes.h"
#include "tests/samples/scene_camera.h"

namespace limn {
namespace {

/// Pixels of two pictures of depths, and where they differ.
struct Difference {
  int seen = 0, depth = 0, coverage = 0;
};

Difference difference(const HiddenParts& a, const HiddenParts& b) {
  Difference found;
  EXPECT_EQ(a.depth.size(), b.depth.size());
  for (size_t i = 0; i < std::min(a.depth.size(), b.depth.size()); ++i) {
    const bool in_a = std::isfinite(a.depth[i]), in_b = std::isfinite(b.depth[i]);
    found.seen += in_a, found.coverage += in_a != in_b;
    if (in_a && in_b) found.depth += std::abs(a.depth[i] - b.depth[i]) > 1e-4f * b.depth[i];
  }
  return found;
}

TEST(LocalHidden, DrawnFacetsHideWhatTracedOnesDo) {
  for (const char* name : {"rook", "teacup", "pipe_junction"})
    for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
      Scene scene = find_scene(name)->make();
      scene.camera.projection = projection;
      const SurfaceSettings settings{.kind = "mesh", .level = 2};
      const Surface traced = find_surface("mesh").build(scene.objects.front(), settings, glm::dvec3(0.0));
      const ObjectMesh mesh = object_mesh(scene.objects.front(), settings, glm::dvec3(0.0));
      const Camera camera = camera_of(scene, 1, 4, {500, 400});
      const SmallPicture by_rays = small_picture(traced, camera), drawn = small_picture(*mesh.triangles, camera);
      EXPECT_LE(drawn.camera.width_px, 320) << name;
      const Difference found = difference(drawn.hidden, by_rays.hidden);
      EXPECT_GT(found.seen, 5000) << name;
      // Pixels whose middle lies on an edge, within rounding.
      EXPECT_LE(found.depth, 3) << name;
      EXPECT_LE(found.coverage, 3) << name;
    }
}

}  // namespace
}  // namespace limn
