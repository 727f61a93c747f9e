// Embree's trees that were made within a loop outlive it, and loops that end by exceptions afterwards end by these.

#include <gtest/gtest.h>
#include <pthread.h>

#include <chrono>
#include <functional>
#include <stdexcept>
#include <thread>

#include "raymarch/gbuffer.h"
#include "raymarch/lines/mesh_tree.h"
#include "raymarch/mesh/polygons.h"
#include "sdf/parallel.h"
#include "subdiv/mesh_level_set.h"
#include "tests/raymarch/scenes.h"

namespace limn::test {
namespace {

/// On a stack of its own, which is gone afterwards: it is larger than those that the C library keeps.
void run_on_a_stack_that_goes(std::function<void()> work) {
  pthread_attr_t attributes;
  ASSERT_EQ(pthread_attr_init(&attributes), 0);
  ASSERT_EQ(pthread_attr_setstacksize(&attributes, size_t{256} << 20), 0);
  pthread_t thread;
  const auto run = [](void* given) -> void* {
    (*static_cast<std::function<void()>*>(given))();
    return nullptr;
  };
  ASSERT_EQ(pthread_create(&thread, &attributes, run, &work), 0);
  ASSERT_EQ(pthread_join(thread, nullptr), 0);
  pthread_attr_destroy(&attributes);
}

/// Of a loop that has had loops within it TBB looks for all that might be another.
void expect_that_loops_end_by_their_exceptions() {
  for (int round = 0; round < 20; ++round)
    EXPECT_THROW(parallel_each(8,
                               [](int outer) {
                                 parallel_for(0, 64, [](int) {});
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
  run_on_a_stack_that_goes([&] {
    parallel_each(kCount, [&](size_t k) {
      PointSample hit;
      const glm::dvec2 middle(10.0);
      sample_points(models[k], camera, {&middle, 1}, {&hit, 1});
      EXPECT_EQ(hit.status, HitStatus::hit);
      const std::shared_ptr<const Polygons> polygons = models[k].surfaces.front().polygons;
      closest[k] = std::make_unique<ClosestPointQuery>(triangulate(polygons->mesh(), NormalKind::flat));
      trees[k] = std::make_unique<MeshTree>(std::vector{polygons}, glm::dvec3(0.0), std::vector{1}, 1.0, false);
      EXPECT_EQ(trees[k]->hits_along({0.1, 0.2, -3.0}, {0.0, 0.0, 1.0}, 10.0).size(), 2u);
      EXPECT_EQ(trees[k]->exact_hits().through({{0.1, 0.2, -3.0}, {0.1, 0.2, 3.0}}).size(), 2u);
      // Other threads are to make some, too.
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    });
  });
  expect_that_loops_end_by_their_exceptions();
  for (const auto& query : closest) EXPECT_NEAR(query->closest({3.0, 0.0, 0.0}).distance, 2.0, 0.05);
}

}  // namespace
}  // namespace limn::test
