// The bricks of a local level set from its file.

#include "raymarch/surface/local_volume.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "raymarch/level_set/quantise.h"
#include "raymarch/level_set/sized_bricks.h"
#include "sdf/error.h"
#include "sdf/level_set_data.h"
#include "sdf/local_grid.h"

namespace limn {
namespace {

/// All grids of a local level set, and what the file says of each.
struct FileGrids {
  std::vector<LevelSet> grids;
  const std::vector<LocalGrid>& said;
};

[[noreturn]] void refuse(const LevelSet& grid, const std::string& file, const std::string& problem) {
  throw InputError({file, "grid", grid.info().name, problem, "a file as limn exported it"});
}

/// How often the smallest voxels are doubled in a grid, whose lattice must be theirs.
int doublings_of(const LevelSet& grid, const LevelSet& smallest, const std::string& file) {
  const Affine &map = grid.info().world_from_index, &finest = smallest.info().world_from_index;
  const double times = glm::length(map.linear[0]) / glm::length(finest.linear[0]);
  const auto doublings = static_cast<int>(std::lround(std::log2(std::clamp(times, 1.0, 1e9))));
  const double scale = std::exp2(doublings), tolerance = 1e-9 * scale * glm::length(finest.linear[0]);
  bool same = glm::distance(map.translation, finest.translation) <= 1e-3 * tolerance + 1e-9 * glm::length(finest.linear[0]);
  for (int axis = 0; axis < 3; ++axis) same = same && glm::distance(map.linear[axis], scale * finest.linear[axis]) <= tolerance;
  if (!same) refuse(grid, file, "its voxels do not lie on the lattice of '" + smallest.info().name + "', of the same local level set");
  return doublings;
}

/// What smaller bricks hold of each: they lie in bricks of the next size.
std::vector<std::vector<BrickPlace>> places_of(const FileGrids& volume, const std::vector<int>& doublings, const std::string& file) {
  std::vector<std::vector<BrickPlace>> places;
  for (size_t k = 0; k < volume.said.size(); ++k) {
    std::unordered_map<std::uint64_t, size_t> at;
    places.emplace_back();
    for (const glm::ivec3& place : volume.said[k].bricks)
      at.emplace(key_of(8 * place), at.size()), places.back().push_back({.origin = 8 * place});
    if (k == 0) continue;
    const int step = doublings[k] - doublings[k - 1];
    if (step != 1 && step != 2) refuse(volume.grids[k], file, "its voxels are not two or four times those of the size before");
    for (const glm::ivec3& smaller : volume.said[k - 1].bricks) {
      const auto found = at.find(key_of(8 * (smaller >> step)));
      if (found == at.end()) refuse(volume.grids[k], file, "no brick of it holds one of '" + volume.grids[k - 1].info().name + "'");
      places.back()[found->second].covered |= covered_by(smaller & ((1 << step) - 1), step);
    }
  }
  return places;
}

struct FileNodes {
  const LevelSetData& data;
  float steps_per_unit = 0.0f;
};

NodeReader reader_of(const FileNodes& nodes) {
  return {&nodes,
          [](const void* of, size_t, const glm::ivec3& origin, NodeSteps& steps) {
            const auto& [data, steps_per_unit] = *static_cast<const FileNodes*>(of);
            NodeValues values;
            load_nodes(data.accessor(), origin, values);
            quantise(values, steps_per_unit, steps.data());
          },
          [](const void* of, const glm::ivec3& node, const void*&) {
            const auto& [data, steps_per_unit] = *static_cast<const FileNodes*>(of);
            const auto accessor = data.accessor();
            const nanovdb::Coord at(node.x, node.y, node.z);
            return accessor.isActive(at) ? quantised(accessor.getValue(at), steps_per_unit) : std::numeric_limits<std::int16_t>::max();
          }};
}

/// All nodes of all bricks have values.
void check_nodes(const LevelSet& grid, std::span<const BrickPlace> places, const std::string& file) {
  const auto accessor = grid.data().accessor();
  for (const BrickPlace& place : places)
    for (int k = 0; k < 729; ++k)
      if (!accessor.isActive(nanovdb::Coord(place.origin.x + k / 81, place.origin.y + k / 9 % 9, place.origin.z + k % 9)))
        refuse(grid, file, "it lacks nodes of its bricks");
}

}  // namespace

Surface local_level_set_of_file(const LevelSet& local, const GradientDescriptor& gradient, const glm::dvec3& render_origin,
                                const std::string& file) {
  const auto started = std::chrono::steady_clock::now();
  const FileGrids volume{grids_of(local), local_volume(local)->said};
  auto state = std::make_shared<LocalBricks>();
  state->gradient = brick_gradient(gradient);
  const std::string& made_for = volume.said.front().gradient;
  if (find_gradient(made_for, file, "gradient").half_width_voxels < gradient.half_width_voxels)
    throw InputError({file, "gradient", gradient.about.name,
                      "its bricks hold no more nodes than the gradient '" + made_for + "' reads, for which they were made", made_for});
  std::vector<int> doublings;
  for (const LevelSet& grid : volume.grids) doublings.push_back(doublings_of(grid, volume.grids.front(), file));
  const std::vector<std::vector<BrickPlace>> places = places_of(volume, doublings, file);
  Surface surface;
  for (size_t k = 0; k < volume.grids.size(); ++k) {
    const LevelSet& grid = volume.grids[k];
    const LevelSetInfo& info = grid.info();
    check_nodes(grid, places[k], file);
    surface.info.voxels += info.active_voxels;
    const double half_width = volume.said[k].half_width;
    // As wide as a band can be asked for; the steps of 16 bits are counted by it.
    if (!(half_width > info.voxel_size && half_width < 1001.0 * info.voxel_size)) refuse(grid, file, "its band is not as wide as it says");
    Affine render_from_index = info.world_from_index;
    render_from_index.translation -= render_origin;
    // The last is the grid of the largest voxels, which holds the whole surface.
    state->sides = [grid, index_from_render = inverse(render_from_index)] {
      return [grid, index_from_render](const glm::dvec3& place) {
        const glm::ivec3 node(glm::round(index_from_render.point(place)));
        return grid.data().accessor().getValue(nanovdb::Coord(node.x, node.y, node.z)) < 0.0f;
      };
    };
    const BrickSize size{info.voxel_size, half_width / info.voxel_size, static_cast<float>(32767.0 / half_width), render_from_index};
    const FileNodes nodes{grid.data(), size.steps_per_unit};
    const auto bricks = bricks_of_size(reader_of(nodes), places[k], size, state->gradient, [&] { return grid; });
    if (!bricks) continue;
    if (surface.info.voxel_size == 0.0) surface.info.voxel_size = info.voxel_size;
    add_size(bricks, *state, surface.info);
  }
  if (state->sizes.empty() || state->sizes.size() > kMostBrickSizes) refuse(volume.grids.front(), file, "its bricks hold no surface");
  surface.curvature.from = "a file's local level set has no curvature of its own";
  set_traced(std::move(state), surface);
  surface.info.build_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - started).count();
  return surface;
}

}  // namespace limn
