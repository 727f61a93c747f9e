// The two peers that march grids: OpenVDB's own intersector, and NanoVDB's zero crossing with the hit refined and a gradient taken.

#include <nanovdb/NanoVDB.h>
#include <nanovdb/util/HDDA.h>
#include <nanovdb/util/OpenToNanoVDB.h>
#include <nanovdb/util/Ray.h>
#include <nanovdb/util/SampleFromVoxels.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/RayIntersector.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "tests/bench/contestant.h"

namespace limn::bench {
namespace {

openvdb::FloatGrid::Ptr grid_of(const LevelSet& level_set) {
  openvdb::initialize();
  const std::filesystem::path file = std::filesystem::temp_directory_path() / "limn-bench-grid.vdb";
  write_level_set(level_set, file);
  openvdb::io::File reader(file.string());
  reader.open(false);
  openvdb::GridBase::Ptr grid = reader.readGrid(reader.beginName().gridName());
  reader.close();
  std::filesystem::remove(file);
  return openvdb::gridPtrCast<openvdb::FloatGrid>(grid);
}

size_t pixel(const Camera& camera, int x, int y) {
  return static_cast<size_t>(y) * static_cast<size_t>(camera.width_px) + static_cast<size_t>(x);
}

}  // namespace

Contestant openvdb_level_set_ray_intersector(const BenchCase& bench_case) {
  using Intersector = openvdb::tools::LevelSetRayIntersector<openvdb::FloatGrid>;
  auto grid = grid_of(bench_case.level_set);
  auto prototype = std::make_shared<Intersector>(*grid);
  const Camera camera = bench_case.camera;
  return {.name = "OpenVDB LevelSetRayIntersector", .draw = [grid, prototype, camera](Frame& frame) {
            for_each_row(camera.height_px, [&](int y) {
              Intersector intersector(*prototype);
              for (int x = 0; x < camera.width_px; ++x) {
                const CameraRay ray = camera_ray(camera, x + 0.5, y + 0.5);
                openvdb::math::Ray<openvdb::Real> world(openvdb::Vec3d(ray.origin.x, ray.origin.y, ray.origin.z),
                                                        openvdb::Vec3d(ray.direction.x, ray.direction.y, ray.direction.z));
                openvdb::Vec3d hit, normal;
                openvdb::Real t = 0.0;
                const bool found = intersector.intersectsWS(world, hit, normal, t);
                const size_t i = pixel(camera, x, y);
                frame.distance[i] = found ? static_cast<float>(t) : std::numeric_limits<float>::infinity();
                frame.normal[i] = found ? glm::vec3(normal.x(), normal.y(), normal.z()) : glm::vec3(0.0f);
              }
            });
          }};
}

Contestant nanovdb_zero_crossing(const BenchCase& bench_case) {
  auto handle = std::make_shared<nanovdb::GridHandle<>>(nanovdb::openToNanoVDB(grid_of(bench_case.level_set)));
  const Camera camera = bench_case.camera;
  return {.name = "NanoVDB ZeroCrossing, refined, gradient", .draw = [handle, camera](Frame& frame) {
            using Vec3 = nanovdb::Vec3f;
            const auto* grid = handle->grid<float>();
            for_each_row(camera.height_px, [&](int y) {
              auto accessor = grid->getAccessor();
              auto sampler = nanovdb::createSampler<1>(accessor);
              for (int x = 0; x < camera.width_px; ++x) {
                const CameraRay ray = camera_ray(camera, x + 0.5, y + 0.5);
                const nanovdb::Ray<float> world(Vec3(float(ray.origin.x), float(ray.origin.y), float(ray.origin.z)),
                                                Vec3(float(ray.direction.x), float(ray.direction.y), float(ray.direction.z)));
                auto index = world.worldToIndexF(*grid);
                const float index_per_world = 1.0f / static_cast<float>(grid->voxelSize()[0]);
                nanovdb::Coord ijk;
                float value = 0.0f, t = 0.0f;
                const size_t i = pixel(camera, x, y);
                frame.distance[i] = std::numeric_limits<float>::infinity();
                frame.normal[i] = glm::vec3(0.0f);
                if (!nanovdb::ZeroCrossing(index, accessor, ijk, value, t)) continue;
                // The crossing is found to a voxel; a few steps of the trilinear value along the ray bring it onto the surface.
                for (int step = 0; step < 4; ++step) t += sampler(index(t)) * index_per_world;
                const auto gradient = sampler.gradient(index(t));
                frame.distance[i] = t / index_per_world;
                frame.normal[i] = glm::normalize(glm::vec3(gradient[0], gradient[1], gradient[2]));
              }
            });
          }};
}

}  // namespace limn::bench
