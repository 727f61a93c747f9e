// limn's own rows: what a user gets who asks for depth and normals.

#include <tbb/task_arena.h>

#include "raymarch/gbuffer.h"
#include "tests/bench/contestant.h"
#include "tests/bench/vdb_grid.h"

namespace limn::bench {

Contestant limn_surface(const std::string& key, const std::string& name, const Scene& scene, const SurfaceSettings& settings,
                        const Camera& camera, Drawn drawn) {
  auto model = std::make_shared<SceneModel>(build_model(scene, settings));
  auto gbuffer = std::make_shared<GBuffer>();
  return {.key = key,
          .name = name,
          .role = Role::ours,
          .drawn = drawn,
          .draw =
              [model, gbuffer, camera] {
                constexpr GBufferLayers kAsked{
                    .position = false, .n_dot_v = false, .id = false, .material = false, .face = false, .status = false};
                render_gbuffer(*model, camera, {.threads = tbb::this_task_arena::max_concurrency()}, {0.5, 0.5}, kAsked, *gbuffer);
              },
          .take =
              [gbuffer, camera](Frame& out) {
                const RayForms<double> forms = ray_forms(camera);
                const glm::dvec3 forward = -camera.world_from_camera[2];
                for (size_t i = 0; i < out.pixels(); ++i) {
                  const float depth = gbuffer->depth.pixels[i];
                  const glm::dvec3 d = forms.direction(static_cast<int>(i) % out.width, static_cast<int>(i) / out.width);
                  if (std::isfinite(depth))
                    out.hit(i, static_cast<float>(static_cast<double>(depth) / glm::dot(d, forward)), gbuffer->normal.pixels[i]);
                  else
                    out.miss(i);
                }
              }};
}

namespace {

Scene scene_of(std::variant<Field, MeshSource, LevelSetSource> source) {
  Scene scene;
  scene.objects.push_back({.name = "object", .source = std::move(source)});
  return scene;
}

MeshSource mesh_source(const TriangleMesh& triangles) {
  Mesh mesh;
  mesh.positions = triangles.positions;
  mesh.face_sizes.assign(triangles.triangles.size(), 3);
  for (const glm::uvec3& t : triangles.triangles)
    for (int k = 0; k < 3; ++k) mesh.corner_vertices.push_back(static_cast<std::int32_t>(t[k]));
  return {.mesh = std::move(mesh)};
}

}  // namespace

std::vector<Contestant> limn_contestants(const BenchCase& bench_case) {
  const Camera& camera = bench_case.camera;
  const Scene grid = scene_of(LevelSetSource{bench_case.level_set, {}});
  std::vector<Contestant> result;
  result.push_back(limn_surface("limn.central", "limn level_set, central normals", grid, {.kind = "level_set", .gradient = "central"},
                                camera, Drawn::grid));
  result.push_back(limn_surface("limn.cubic", "limn level_set, cubic normals", scene_of(LevelSetSource{bench_case.wide_level_set, {}}),
                                {.kind = "level_set", .gradient = "cubic"}, camera, Drawn::grid));
  if (std::holds_alternative<Field>(bench_case.scene.objects[0].source))
    result.push_back(limn_surface("limn.analytic", "limn analytic", bench_case.scene, {.kind = "analytic"}, camera, Drawn::grid));
  result.push_back(limn_surface("limn.mesh", "limn mesh, the original", scene_of(mesh_source(bench_case.original)), {.kind = "mesh"},
                                camera, Drawn::original));
  return result;
}

void add_our_cost(const BenchCase& bench_case, GridCost& cost) {
  const Scene grid = scene_of(LevelSetSource{bench_case.level_set, {}});
  tbb::task_arena arena(2);
  cost.ours_ms = std::numeric_limits<double>::infinity();
  for (int run = 0; run < 5; ++run) {
    arena.execute([&] {
      const SurfaceInfo info = build_model(grid, {.kind = "level_set", .gradient = "central"}).surfaces[0].info;
      cost.ours_ms = std::min(cost.ours_ms, info.prepare_ms);
      cost.ours_bytes = static_cast<double>(info.ray_bytes);
    });
  }
}

}  // namespace limn::bench
