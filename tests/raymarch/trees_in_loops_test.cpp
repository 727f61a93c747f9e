// Embree's trees that were made within a loop outlive it, and loops that end by exceptions afterwards end by these.

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <numbers>
#include <stdexcept>

#include "raymarch/gbuffer.h"
#include "raymarch/lines/mesh_tree.h"
#include "raymarch/mesh/polygons.h"
#include "sdf/parallel.h"
#include "subdiv/mesh_level_set.h"
#include "tests/raymarch/scenes.h"

namespace limn::test {
namespace {

/// Writes over what a loop left behind on the stack. What it holds is no address.
__attribute__((noinline)) int clobber_stack(int depth) {
  std::array<char, 4096> bytes;
  std::memset(bytes.data(), 0x41 + (depth & 7), bytes.size());
  asm volatile("" : : "r"(bytes.data()) : "memory");
  return depth == 0 ? bytes[7] : clobber_stack(depth - 1) + bytes[5];
}

/// Of a loop that has had loops within it TBB looks for all that might be another.
void expect_that_loops_end_by_their_exceptions() {
  EXPECT_NE(clobber_stack(40), 0);
  for (int round = 0; round < 20; ++round)
    EXPECT_THROW(parallel_each(8,
                               [](int outer) {
                                 parallel_for(0, 64, [](int) { clobber_stack(2); });
                                 if (outer == 3) throw std::runtime_error("no");
                               }),
                 std::runtime_error);
}

TEST(TreesInLoops, OutliveThem) {
  const Scene scene = scene_of({object_of(make_shape("sphere", {{"radius", {1.0}}}))});
  SurfaceSettings settings = surface_kind("mesh");
  settings.level = 1;
  constexpr size_t kCount = 8;
  std::vector<SceneModel> models(kCount);
  for (SceneModel& model : models) model = build_model(scene, settings);
  const Camera camera = framing(scene, view(20, 20));
  std::vector<std::unique_ptr<ClosestPointQuery>> closest(kCount);
  std::vector<std::unique_ptr<MeshTree>> trees(kCount);
  // Loops within loops: a tree is made in the part of a loop that ends before the tree does.
  parallel_each(kCount, [&](size_t k) {
    parallel_each(2, [&](int half) {
      if (half == 1) return;
      PointSample hit;
      const glm::dvec2 middle(10.0);
      sample_points(models[k], camera, {&middle, 1}, {&hit, 1});
      EXPECT_EQ(hit.status, HitStatus::hit);
      const std::shared_ptr<const Polygons> polygons = models[k].surfaces.front().polygons;
      closest[k] = std::make_unique<ClosestPointQuery>(triangulate(polygons->mesh(), NormalKind::flat));
      trees[k] = std::make_unique<MeshTree>(std::vector{polygons}, glm::dvec3(0.0), std::vector{1}, 1.0, false);
      EXPECT_EQ(trees[k]->hits_along({0.1, 0.2, -3.0}, {0.0, 0.0, 1.0}, 10.0).size(), 2u);
      EXPECT_EQ(trees[k]->exact_hits().through({{0.1, 0.2, -3.0}, {0.1, 0.2, 3.0}}).size(), 2u);
    });
  });
  expect_that_loops_end_by_their_exceptions();
  for (const auto& query : closest) EXPECT_NEAR(query->closest({3.0, 0.0, 0.0}).distance, 2.0, 0.05);
}

}  // namespace
}  // namespace limn::test
