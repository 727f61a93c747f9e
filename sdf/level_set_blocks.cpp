#include <chrono>
#include <string>

#include "sdf/error.h"
#include "sdf/level_set_nano.h"

namespace limn {

namespace {

std::shared_ptr<LevelSetData> finished(nanovdb::GridHandle<nanovdb::HostBuffer> grid, double voxel_size, double half_width_voxels,
                                       const std::string& name, const glm::dvec3& origin) {
  auto data = make_level_set(std::move(grid), {glm::dmat3(voxel_size), origin}, name, half_width_voxels);
  if (const std::int64_t torn = cells_lacking(LevelSet(data), find_gradient("cell")); torn > 0)
    data->info.warnings.push_back(std::to_string(torn) + " cells on the surface reach beyond the band; the surface may have gaps there");
  return data;
}

[[noreturn]] void refuse_without_surface(const std::string& name) {
  throw InputError({.file = {}, .field = name, .value = {}, .problem = "holds no surface", .expected = "a band with active voxels"});
}

}  // namespace

std::shared_ptr<LevelSetData> join_blocks(std::span<const LevelSetBlock> blocks, double voxel_size, double half_width_voxels,
                                          const std::string& name, const glm::dvec3& origin) {
  LIMN_CHECK(voxel_size > 0.0 && half_width_voxels > 0.0);
  const auto started = std::chrono::steady_clock::now();
  if (std::none_of(blocks.begin(), blocks.end(), has_active_node)) refuse_without_surface(name);
  auto data = finished(nano_grid(blocks, static_cast<float>(voxel_size * half_width_voxels)), voxel_size, half_width_voxels, name, origin);
  data->info.build_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - started).count();
  return data;
}

std::shared_ptr<LevelSetData> join_leaves(std::span<const glm::ivec3> origins, const FillLeaves& fill, double voxel_size,
                                          double half_width_voxels, const std::string& name, const glm::dvec3& origin) {
  LIMN_CHECK(voxel_size > 0.0 && half_width_voxels > 0.0);
  if (origins.empty()) refuse_without_surface(name);
  auto grid = nano_grid(origins, fill, static_cast<float>(voxel_size * half_width_voxels));
  return finished(std::move(grid), voxel_size, half_width_voxels, name, origin);
}

LevelSet level_set_from_blocks(std::span<const LevelSetBlock> blocks, double voxel_size, double half_width_voxels, const std::string& name,
                               const glm::dvec3& origin) {
  return LevelSet(join_blocks(blocks, voxel_size, half_width_voxels, name, origin));
}

}  // namespace limn
