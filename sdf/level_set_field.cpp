#include <fmt/format.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstring>
#include <mutex>
#include <optional>

#include "sdf/field_leaf_bounds.h"
#include "sdf/field_program.h"
#include "sdf/level_set_cubes.h"
#include "sdf/level_set_data.h"
#include "sdf/level_set_distance.h"
#include "sdf/level_set_lanes.h"
#include "sdf/level_set_nano.h"
#include "sdf/level_set_thin.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

[[noreturn]] void refuse(const std::string& field, const std::string& value, const std::string& problem, const std::string& expected) {
  throw InputError({.file = {}, .field = field, .value = value, .problem = problem, .expected = expected});
}

/// Progress of parallel work, told by one thread at a time and never backwards.
class Progress {
 public:
  Progress(const std::function<void(double)>& tell, size_t total) : tell_(tell), total_(total) {}
  void step() {
    if (!tell_) return;
    const std::lock_guard lock(mutex_);
    ++done_;
    if (done_ * 100 / total_ != (done_ - 1) * 100 / total_) tell_(static_cast<double>(done_) / static_cast<double>(total_));
  }

 private:
  const std::function<void(double)>& tell_;
  size_t total_, done_ = 0;
  std::mutex mutex_;
};

/// Multiples of 8h near the centre: index numbers stay small far from the world's origin, and the nodes do not depend on the bounds.
BandLattice lattice_for(const Box& bounds, const LevelSetSettings& settings) {
  const double step = kLevelSetBlock * settings.voxel_size;
  return {glm::round(bounds.center() / step) * step, settings.voxel_size, settings.voxel_size * settings.half_width_voxels};
}

/// Nodes of a block that may lie in the band, by sixteen: four along y by four along z.
struct BandNodes {
  LanePoints points;
  LaneNumbers distances;
  std::array<std::uint16_t, kMostLanePoints / 16> first;  ///< Of each sixteen, numbered as in LevelSetBlock.

  size_t count() const { return points.count; }
  std::span<const std::uint16_t> firsts() const { return std::span(first).first(points.count / 16); }
};

/// Coordinates of a block's nodes.
struct NodePlaces {
  NodePlaces(const BandCube& cube, const BandLattice& lattice) {
    for (int k = 0; k < kLevelSetBlock; ++k) along[static_cast<size_t>(k)] = lattice.node(cube.origin + k);
    for (size_t half = 0; half < 2; ++half)
      for (size_t i = 0; i < 16; ++i) {
        y[half][i] = along[4 * half + i / 4].y;
        z[half][i] = along[4 * half + i % 4].z;
      }
  }
  std::array<glm::dvec3, kLevelSetBlock> along;
  double y[2][16], z[2][16];  ///< Of sixteen nodes in either half.
};

/// Sixteen nodes at once, in the halves of y and z.
void add_sixteen(const NodePlaces& places, size_t x, size_t half_y, size_t half_z, BandNodes& found) {
  const size_t at = found.points.count;
  std::fill_n(found.points.at[0] + at, 16, places.along[x].x);
  std::copy_n(places.y[half_y], 16, found.points.at[1] + at);
  std::copy_n(places.z[half_z], 16, found.points.at[2] + at);
  found.first[at / 16] = static_cast<std::uint16_t>(x * 64 + half_y * 32 + half_z * 4);
  found.points.count += 16;
}

/// As large as the terms are that the field is summed up from, for its rounding.
double extent_at(const Field& field, const glm::dvec3& point) {
  double extent = field.traits().lipschitz * largest(point);
  for (const FieldLeaf& leaf : field.program().leaves) extent = std::max(extent, leaf_extent(leaf, point));
  return extent;
}

/// The nodes of those sixteenths of the block (two along x by four by four) whose middle is no farther from the surface than the band
/// reaches. The others are given the background, with the sign that the field has in the middle: it changes nowhere in them.
void find_band_nodes(const BandCube& cube, const BandLattice& lattice, DistanceEvaluator& distance, LevelSetBlock& block,
                     BandNodes& found) {
  const NodePlaces places(cube, lattice);
  LanePoints middles;
  LaneNumbers values;
  const auto middle = [&](size_t k) { return 0.5 * (places.along[k] + places.along[k + 1]); };
  for (size_t part = 0; part < 16; ++part)
    middles.add({middle(2 * (part >> 2)).x, middle(1 + 4 * (part >> 1 & 1)).y, middle(1 + 4 * (part & 1)).z});
  field_values(distance, middles, values);

  const Field& field = distance.evaluator.field();
  const double lipschitz = cube.lipschitz;
  const double to_corner = 0.5 * std::sqrt(1.0 + 9.0 + 9.0) * lattice.h;
  const double limit = std::max(lipschitz, 1.0) * lattice.half_width + lipschitz * to_corner;
  const double slack = 1e-6 * limit + 1e-13 * extent_at(field, middles.point(0));
  found.points.count = 0;
  for (size_t part = 0; part < 16; ++part) {
    const size_t half_y = part >> 1 & 1, half_z = part & 1;
    const bool far = std::abs(values[part]) > limit + slack;
    const auto beyond = static_cast<float>(std::copysign(lattice.half_width, values[part]));
    for (size_t x = 2 * (part >> 2); x < 2 * (part >> 2) + 2; ++x) {
      if (!far) {
        add_sixteen(places, x, half_y, half_z, found);
        continue;
      }
      for (size_t y = 4 * half_y; y < 4 * half_y + 4; ++y) std::fill_n(block.values + x * 64 + y * 8 + 4 * half_z, 4, beyond);
    }
  }
}

ThinPlaces fill(LevelSetBlock& block, const BandCube& cube, const BandLattice& lattice, DistanceEvaluator& distance) {
  BandNodes nodes;
  find_band_nodes(cube, lattice, distance, block, nodes);
  distance.lipschitz = cube.lipschitz;
  signed_distances(distance, nodes.points, lattice.half_width, nodes.distances);
  block.origin = cube.origin;
  std::memset(block.active, 0, sizeof block.active);
  put_distances(nodes.distances, nodes.firsts(), lattice.half_width, block);
  return find_thin_places(distance, nodes.firsts(), nodes.points, nodes.distances, lattice.h);
}

/// Calls `visit(i, evaluator)` for a part of the cubes.
template <class Visit>
void for_each_cube(std::span<const BandCube> cubes, const IndexRange<size_t>& part, const Visit& visit) {
  std::optional<DistanceEvaluator> distance;
  for (size_t i = part.first; i < part.last; ++i) {
    turn_to(cubes[i].field, distance);
    visit(i, *distance);
  }
}

/// Two nodes of each eighth of a block: in most blocks that hold a part of the band one of them is in it.
constexpr size_t kFirstAsked = 16, kAskedTogether = 8;

/// What waits to be asked together, of one field.
struct Asked {
  std::array<size_t, kAskedTogether> cubes;
  size_t count = 0;
  BandNodes nodes;
};

/// Of the cubes asked so far, whether fill() will find an active node.
void tell_band(std::span<const BandCube> cubes, const BandLattice& lattice, DistanceEvaluator& distance, Asked& asked,
               std::vector<std::uint8_t>& holds) {
  BandNodes& nodes = asked.nodes;
  const auto any_in_band = [&](size_t first, size_t count) {
    const double* const from = nodes.distances.at + first;
    return std::any_of(from, from + count, [&](double d) { return std::abs(d) <= lattice.half_width; });
  };
  distance.lipschitz = 0.0;
  for (size_t k = 0; k < asked.count; ++k) distance.lipschitz = std::max(distance.lipschitz, cubes[asked.cubes[k]].lipschitz);
  signed_distances(distance, nodes.points, lattice.half_width, nodes.distances);
  for (size_t k = 0; k < asked.count; ++k) holds[asked.cubes[k]] = any_in_band(kFirstAsked * k, kFirstAsked) ? 1 : 0;
  for (size_t k = 0; k < asked.count; ++k) {
    const size_t i = asked.cubes[k];
    if (holds[i] != 0) continue;
    LevelSetBlock block;
    find_band_nodes(cubes[i], lattice, distance, block, nodes);
    distance.lipschitz = cubes[i].lipschitz;
    signed_distances(distance, nodes.points, lattice.half_width, nodes.distances);
    holds[i] = any_in_band(0, nodes.count()) ? 1 : 0;
  }
  asked.count = nodes.points.count = 0;
}

/// The cubes that hold a node of the band, in their order.
std::vector<BandCube> with_band(std::vector<BandCube> cubes, const BandLattice& lattice) {
  std::vector<std::uint8_t> holds(cubes.size());
  parallel_parts(cubes.size(), size_t{1}, [&](const IndexRange<size_t>& part) {
    Asked asked;
    for_each_cube(cubes, part, [&](size_t i, DistanceEvaluator& distance) {
      for (size_t k = 0; k < kFirstAsked; ++k)
        asked.nodes.points.add(
            lattice.node(cubes[i].origin + 4 * glm::ivec3(k >> 2 & 1, k >> 1 & 1, k & 1) + 1 + static_cast<int>(k >> 3)));
      asked.cubes[asked.count++] = i;
      const bool is_last = i + 1 == part.last || &cubes[i + 1].field.program() != &cubes[i].field.program();
      if (asked.count == kAskedTogether || is_last) tell_band(cubes, lattice, distance, asked, holds);
    });
  });
  size_t kept = 0;
  for (size_t i = 0; i < cubes.size(); ++i)
    if (holds[i] != 0 && kept++ != i) cubes[kept - 1] = std::move(cubes[i]);
  cubes.erase(cubes.begin() + static_cast<std::ptrdiff_t>(kept), cubes.end());
  return cubes;
}

void check(const Field& field, const LevelSetSettings& settings) {
  const auto number = [](double x) { return fmt::format("{:.6g}", x); };
  if (!std::isfinite(settings.voxel_size) || settings.voxel_size <= 0.0)
    refuse("voxel size", number(settings.voxel_size), "not a length", "above 0");
  if (!(settings.half_width_voxels >= 1.8) || settings.half_width_voxels > 1000.0)
    refuse("half width", number(settings.half_width_voxels), "out of range", "between 1.8 and 1000 voxels");
  const Box& bounds = field.traits().bounds;
  if (bounds.empty()) refuse("field", "", "has no surface", "a shape that is not empty");
  if (!bounds.finite()) refuse("field", "", "has no bounds, so that no grid can hold it", "its intersection with a box or a sphere");
}

/// The sign at a node is the surface's only witness.
[[noreturn]] void refuse_thin(double voxel_size, const Box& bounds) {
  const glm::dvec3 size = bounds.size();
  refuse("voxel size", fmt::format("{:.4g}", voxel_size), "no voxel lies inside the surface: it is thinner than a voxel, or empty",
         fmt::format("well below the smallest side of the bounds ({:.4g})", std::min({size.x, size.y, size.z})));
}

void warn_of_thin_places(const ThinPlaces& found, double voxel_size, std::vector<std::string>& warnings) {
  const auto share = [&](std::int64_t count) {
    return fmt::format("{:.2g} % of the surface", 100.0 * static_cast<double>(count) / static_cast<double>(found.looked_at));
  };
  const double most = kThinPlacesShare * static_cast<double>(found.looked_at);
  if (static_cast<double>(found.walls) > most)
    warnings.push_back(fmt::format("{} lies on walls thinner than two voxels ({:.3g}), which may break up: use smaller voxels",
                                   share(found.walls), 2.0 * voxel_size));
  if (static_cast<double>(found.gaps) > most)
    warnings.push_back(fmt::format("{} lies at gaps narrower than one voxel ({:.3g}), which may close: use smaller voxels",
                                   share(found.gaps), voxel_size));
}

}  // namespace

LevelSet level_set_from_field(const Field& field, const LevelSetSettings& settings) {
  check(field, settings);
  const auto started = std::chrono::steady_clock::now();
  const Box& bounds = field.traits().bounds;
  const BandLattice lattice = lattice_for(bounds, settings);
  const std::vector<BandCube> cubes = with_band(band_blocks(field, lattice, settings), lattice);
  if (cubes.empty()) refuse_thin(settings.voxel_size, bounds);
  std::vector<glm::ivec3> origins;
  origins.reserve(cubes.size());
  for (const BandCube& cube : cubes) origins.push_back(cube.origin);
  Progress progress(settings.progress, cubes.size());
  std::atomic<std::int64_t> looked_at{0}, walls{0}, gaps{0};
  const FillLeaves fill_leaves = [&](const IndexRange<size_t>& part, const WriteLeaf& write) {
    for_each_cube(cubes, part, [&](size_t i, DistanceEvaluator& distance) {
      LevelSetBlock block;
      const ThinPlaces found = fill(block, cubes[i], lattice, distance);
      looked_at += found.looked_at;
      walls += found.walls;
      gaps += found.gaps;
      write(i, block);
      progress.step();
    });
  };
  const auto data = join_leaves(origins, fill_leaves, settings.voxel_size, settings.half_width_voxels, "surface", lattice.origin);
  if (data->info.bounds.empty()) refuse_thin(settings.voxel_size, bounds);
  warn_of_thin_places({looked_at, walls, gaps}, settings.voxel_size, data->info.warnings);
  data->info.build_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - started).count();
  return LevelSet(data);
}

}  // namespace limn
