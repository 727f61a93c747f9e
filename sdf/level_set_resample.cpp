#include "sdf/level_set_resample.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>
#include <mutex>

#include "sdf/error.h"
#include "sdf/level_set_data.h"
#include "sdf/level_set_patches.h"
#include "sdf/memory_text.h"
#include "sdf/parallel.h"
#include "sdf/size_error.h"

namespace limn {
namespace {

constexpr int kBlock = 8;
/// Of a block while it is built: ours, and NanoVDB's leaf.
constexpr double kBlockBytes = static_cast<double>(sizeof(LevelSetBlock)) + 2176.0;
/// Points of each surface that the gap is looked for at.
constexpr size_t kMostPoints = 150'000;
/// Beyond this the patch's own side is not asked for, in voxels of the source: its sign there is that of the nodes.
constexpr double kOwnSide = 0.3;
/// The farthest that a foot may lie from the reconstruction's surface, in voxels of the source; more is none of its doing.
constexpr double kFarthestCorrection = 0.25;

double since_ms(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// The surface that is asked for distances: its patches and the grid they come from.
struct Source {
  const LevelSet& level_set;
  const GradientDescriptor& gradient;
  SurfacePatches surface;
  PatchBins bins;
  Affine world_from_target;
  double voxel = 0.0;  ///< Target's space, the smallest side.

  Source(const LevelSet& from, const GradientDescriptor& how, const Affine& target_from_world, double bin_size)
      : level_set(from),
        gradient(how),
        surface(surface_patches(from, how, target_from_world)),
        bins(surface, std::max(bin_size, 3.0 * surface.reach)),
        world_from_target(inverse(target_from_world)) {
    const glm::dmat3 axes = target_from_world.linear * from.info().world_from_index.linear;
    voxel = std::min({glm::length(axes[0]), glm::length(axes[1]), glm::length(axes[2])});
  }
};

/// Signed distances from feet on patches: what the reconstruction says at the foot corrects the parabola.
void correct(const Source& source, std::span<const PatchFoot> feet, std::span<double> distances) {
  std::vector<glm::dvec3> places(feet.size());
  std::vector<double> values(feet.size());
  for (size_t i = 0; i < feet.size(); ++i) places[i] = source.world_from_target.point(feet[i].foot);
  if (source.gradient.values)
    source.gradient.values(source.level_set.data(), places, values);
  else
    level_set_values(source.level_set, places, values);
  const double most = kFarthestCorrection * source.voxel;
  for (size_t i = 0; i < feet.size(); ++i) {
    const double off = values[i] / static_cast<double>(source.surface.patches[feet[i].patch].slope);
    distances[i] = feet[i].distance + (std::abs(off) <= most ? off : 0.0);
  }
}

struct Lattice {
  glm::dvec3 origin;
  double h = 0.0;
  double half_width = 0.0;
  glm::dvec3 node(const glm::ivec3& index) const { return origin + h * glm::dvec3(index); }
};

/// The nodes of one block in reach of the surface, with their nearest patches: cubes are halved, and of the patches only those go on that
/// can be the nearest to some node of the cube.
class BlockSearch {
 public:
  BlockSearch(const Source& source, const Lattice& lattice) : source_(source), lattice_(lattice) {}

  bool near(const glm::ivec3& origin) {
    const Box nodes{lattice_.node(origin), lattice_.node(origin + (kBlock - 1))};
    source_.bins.gather(dilate(nodes, lattice_.half_width + source_.surface.reach), gathered_);
    if (gathered_.empty()) return false;
    load_patches(source_.surface, gathered_, nodes.center(), patches_[0]);
    return narrow(origin, kBlock, patches_[0], patches_[1]);
  }
  void search(const glm::ivec3& origin) {
    indices.clear();
    feet.clear();
    if (near(origin)) halve(origin, {0, 0, 0}, kBlock, 1);
  }

  std::vector<int> indices{};  ///< Nodes as LevelSetBlock numbers them.
  std::vector<PatchFoot> feet{};

 private:
  /// Keeps those that may be nearest; false where none is in reach of the cube.
  bool narrow(const glm::ivec3& origin, int size, const NearPatches& all, NearPatches& kept) {
    const double half = 0.5 * lattice_.h * (size - 1);
    const double radius = half * std::sqrt(3.0), slack = 0.5 * source_.surface.reach;
    disk_distances(all, source_.surface.reach, lattice_.node(origin) + glm::dvec3(half), 0.0f, bounds_);
    const double least = static_cast<double>(*std::min_element(bounds_.begin(), bounds_.end()));
    if (least > lattice_.half_width + radius + slack) return false;
    keep_within(all, bounds_, static_cast<float>(least + 2.0 * radius + slack), kept);
    return true;
  }

  void halve(const glm::ivec3& block, const glm::ivec3& local, int size, size_t depth) {
    const int half = size / 2;
    for (int octant = 0; octant < 8; ++octant) {
      const glm::ivec3 child = local + half * glm::ivec3(octant & 1, octant >> 1 & 1, octant >> 2);
      if (half == 1)
        take(block, child, patches_[depth]);
      else if (narrow(block + child, half, patches_[depth], patches_[depth + 1]))
        halve(block, child, half, depth + 1);
    }
  }

  void take(const glm::ivec3& block, const glm::ivec3& local, const NearPatches& near) {
    const PatchFoot foot = nearest_foot(source_.surface, near, lattice_.node(block + local), bounds_);
    if (std::abs(foot.distance) > lattice_.half_width + source_.surface.reach) return;
    indices.push_back(local.x << 6 | local.y << 3 | local.z);
    feet.push_back(foot);
  }

  const Source& source_;
  const Lattice& lattice_;
  std::vector<std::uint32_t> gathered_{};
  std::array<NearPatches, 4> patches_{};
  std::vector<float> bounds_{};
};

/// Near the surface the patch tells the side, beyond it the source's own nodes do: across an edge or a thin wall the nearest patch may be
/// of the other side.
void give_sides(const Source& source, const Lattice& lattice, const glm::ivec3& origin, const BlockSearch& found,
                std::span<double> distances) {
  std::vector<glm::dvec3> points;
  std::vector<size_t> asked;
  for (size_t i = 0; i < distances.size(); ++i) {
    if (found.feet[i].within && std::abs(distances[i]) < kOwnSide * source.voxel) continue;
    const int n = found.indices[i];
    points.push_back(source.world_from_target.point(lattice.node(origin + glm::ivec3(n >> 6, n >> 3 & 7, n & 7))));
    asked.push_back(i);
  }
  std::vector<double> values(points.size());
  level_set_values(source.level_set, points, values);
  for (size_t k = 0; k < asked.size(); ++k) distances[asked[k]] = std::copysign(distances[asked[k]], values[k]);
}

void fill(const Source& source, const Lattice& lattice, const glm::ivec3& origin, BlockSearch& search, LevelSetBlock& block) {
  block.origin = origin;
  std::memset(block.active, 0, sizeof block.active);
  std::fill(std::begin(block.values), std::end(block.values), static_cast<float>(lattice.half_width));
  search.search(origin);
  std::vector<double> distances(search.feet.size());
  correct(source, search.feet, distances);
  give_sides(source, lattice, origin, search, distances);
  for (size_t i = 0; i < distances.size(); ++i) {
    const int n = search.indices[i];
    const bool active = std::abs(distances[i]) <= lattice.half_width;
    if (active) block.active[n >> 6] |= std::uint64_t{1} << (n & 63);
    block.values[n] = static_cast<float>(active ? distances[i] : std::copysign(lattice.half_width, distances[i]));
  }
}

/// Blocks that the patches of some bin may reach, in rising order of x, y and z.
std::vector<glm::ivec3> candidates(const Source& source, const Lattice& lattice) {
  const double reach = lattice.half_width + source.surface.reach, side = kBlock * lattice.h;
  std::vector<std::array<int, 3>> blocks;
  for (size_t bin = 0; bin < source.bins.count(); ++bin) {
    const Box box = dilate(source.bins.box_of(bin), reach);
    const glm::ivec3 first(glm::floor((box.lower - lattice.origin) / side)), last(glm::floor((box.upper - lattice.origin) / side));
    for (int x = first.x; x <= last.x; ++x)
      for (int y = first.y; y <= last.y; ++y)
        for (int z = first.z; z <= last.z; ++z) blocks.push_back({x, y, z});
  }
  parallel_sort(blocks.begin(), blocks.end());
  blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  std::vector<glm::ivec3> origins;
  origins.reserve(blocks.size());
  for (const auto& block : blocks) origins.push_back(kBlock * glm::ivec3(block[0], block[1], block[2]));
  return origins;
}

[[noreturn]] void refuse(const std::string& value, const std::string& problem, const std::string& expected) {
  throw InputError({.file = {}, .field = "voxel size", .value = value, .problem = problem, .expected = expected});
}

/// Before anything is built: a crossed cell stands for about a voxel's face and a half of surface.
void check_size(const Source& source, const LevelSetSettings& settings, double longest_side) {
  const double h = settings.voxel_size;
  if (longest_side / h > double{1 << 27}) refuse(fmt::format("{:.4g}", h), "far too small for this volume", "larger voxels");
  const double area = static_cast<double>(source.surface.patches.size()) * source.voxel * source.voxel / 1.5;
  const double blocks = area / (64.0 * h * h) * (1.0 + 2.0 * settings.half_width_voxels / kBlock) * 1.5;
  const double bytes = blocks * kBlockBytes;
  if (bytes <= static_cast<double>(settings.max_bytes)) return;
  const double factor = std::sqrt(bytes / static_cast<double>(settings.max_bytes));
  throw SizeError({{},
                   "voxel size",
                   fmt::format("{:.4g}", h),
                   fmt::format("resampling would take about {} of memory, the limit is {}", memory_text(bytes),
                               memory_text(static_cast<double>(settings.max_bytes))),
                   fmt::format("a voxel size of about {:.2g} or more", 1.05 * factor * h)});
}

std::vector<LevelSetBlock> band(const Source& source, const Lattice& lattice, const LevelSetSettings& settings) {
  std::vector<glm::ivec3> origins = candidates(source, lattice);
  std::vector<char> near(origins.size());
  parallel_for(size_t{0}, origins.size(), [&](size_t i) { near[i] = BlockSearch(source, lattice).near(origins[i]); });
  size_t kept = 0;
  for (size_t i = 0; i < origins.size(); ++i)
    if (near[i]) origins[kept++] = origins[i];
  std::vector<LevelSetBlock> blocks(kept);
  std::mutex telling;
  size_t done = 0;
  parallel_for(size_t{0}, kept, [&](size_t i) {
    BlockSearch search(source, lattice);
    fill(source, lattice, origins[i], search, blocks[i]);
    if (!settings.progress) return;
    const std::lock_guard lock(telling);
    ++done;
    if (done * 100 / kept != (done - 1) * 100 / kept) settings.progress(static_cast<double>(done) / static_cast<double>(kept));
  });
  return blocks;
}

/// Distances of points of one bin to another surface: what is farther than it was looked for is looked for twice as far.
struct GapSums {
  double squares = 0.0, worst = 0.0;
  std::int64_t points = 0;
};

GapSums gap_of(const std::vector<glm::dvec3>& points, const Source& to, double first_reach) {
  GapSums sums;
  if (to.surface.patches.empty()) return sums;
  std::vector<glm::dvec3> left = points;
  std::vector<std::uint32_t> near;
  NearPatches patches;
  std::vector<float> scratch;
  for (double reach = first_reach; !left.empty(); reach *= 2.0) {
    Box box;
    for (const glm::dvec3& point : left) box = include(box, point);
    to.bins.gather(dilate(box, reach + to.surface.reach), near);
    load_patches(to.surface, near, box.center(), patches);
    const bool all = near.size() == to.surface.patches.size();
    std::vector<glm::dvec3> farther;
    std::vector<PatchFoot> feet;
    for (const glm::dvec3& point : left) {
      PatchFoot foot;
      foot.distance = std::numeric_limits<double>::infinity();
      if (!near.empty()) foot = nearest_foot(to.surface, patches, point, scratch);
      if (!all && std::abs(foot.distance) > reach)
        farther.push_back(point);
      else
        feet.push_back(foot);
    }
    std::vector<double> distances(feet.size());
    correct(to, feet, distances);
    for (const double distance : distances) {
      sums.squares += distance * distance;
      sums.worst = std::max(sums.worst, std::abs(distance));
      ++sums.points;
    }
    left = std::move(farther);
  }
  return sums;
}

GapSums one_way(const Source& from, const Source& to, double first_reach) {
  const size_t stride = std::max<size_t>(1, from.surface.patches.size() / kMostPoints);
  std::vector<GapSums> parts(from.bins.count());
  parallel_for(size_t{0}, parts.size(), [&](size_t bin) {
    std::vector<glm::dvec3> points;
    for (const std::uint32_t i : from.bins.of(bin))
      if (i % stride == 0) points.push_back(from.surface.patches[i].position);
    parts[bin] = gap_of(points, to, first_reach);
  });
  GapSums sums;
  for (const GapSums& part : parts) {
    sums.squares += part.squares;
    sums.worst = std::max(sums.worst, part.worst);
    sums.points += part.points;
  }
  return sums;
}

SurfaceGap gap_between(const Source& a, const Source& b) {
  const double reach = std::max(a.surface.reach, b.surface.reach);
  const GapSums there = one_way(a, b, reach), back = one_way(b, a, reach);
  SurfaceGap gap;
  gap.points = there.points + back.points;
  gap.worst = std::max(there.worst, back.worst);
  // Each way counts as much, however many points a surface has.
  const auto mean = [](const GapSums& sums) { return sums.points > 0 ? sums.squares / static_cast<double>(sums.points) : 0.0; };
  gap.rms = std::sqrt(0.5 * (mean(there) + mean(back)));
  return gap;
}

void check(const LevelSet& source, const LevelSetSettings& settings) {
  if (!std::isfinite(settings.voxel_size) || settings.voxel_size <= 0.0)
    refuse(fmt::format("{:.6g}", settings.voxel_size), "not a length", "above 0");
  LIMN_CHECK(settings.half_width_voxels >= 1.8);
  if (source.info().bounds.empty()) refuse("", "there is no surface to resample", "a level set with an inside");
}

}  // namespace

ResampledLevelSet resampled(const LevelSet& source, const LevelSetSettings& settings, const GradientDescriptor& gradient,
                            const Affine& target_from_world) {
  check(source, settings);
  const auto started = std::chrono::steady_clock::now();
  const double h = settings.voxel_size;
  const GradientDescriptor& best = best_gradient_of(source);
  const LevelSet whole = complete_band(source, best);
  const Source from(whole, best, target_from_world, kBlock * h);
  const Box bounds = transform(target_from_world, source.info().bounds);
  check_size(from, settings, bounds.longest_side());
  const glm::dvec3 origin = glm::round(bounds.center() / (kBlock * h)) * (kBlock * h);
  const Lattice lattice{origin, h, h * settings.half_width_voxels};
  const auto too_thin = [&] {
    refuse(fmt::format("{:.4g}", h), "no voxel lies inside the surface: it is thinner than a voxel", "smaller voxels");
  };
  const std::vector<LevelSetBlock> blocks = band(from, lattice, settings);
  const auto data = join_blocks(blocks, h, settings.half_width_voxels, source.info().name, lattice.origin);
  if (data->info.bounds.empty()) too_thin();
  data->file.value_type = source.data().file.value_type;
  data->file.metadata = source.data().file.metadata;
  data->file.of_file = source.data().file.of_file;
  // What is wrong with the file is wrong with what is made of it.
  data->info.warnings.insert(data->info.warnings.begin(), source.info().warnings.begin(), source.info().warnings.end());
  ResampledLevelSet made{LevelSet(data)};
  made.own_voxel = from.voxel;
  made.build_ms = since_ms(started);
  data->info.build_ms = made.build_ms;
  const auto built = std::chrono::steady_clock::now();
  made.gap = gap_between(from, Source(made.level_set, gradient, Affine{}, kBlock * h));
  made.compare_ms = since_ms(built);
  return made;
}

std::string resampling_words(const ResampledLevelSet& made) {
  const double h = made.level_set.info().voxel_size;
  std::string words = fmt::format(
      "resampled from voxels of {:.4g} to {:.4g}: {:.2g} from the file's surface (RMS), {:.2g} at worst ({:.2g} and {:.2g} of its voxels)",
      made.own_voxel, h, made.gap.rms, made.gap.worst, made.gap.rms / made.own_voxel, made.gap.worst / made.own_voxel);
  if (h < 0.99 * made.own_voxel) words += "; voxels smaller than the file's add no detail";
  return words;
}

}  // namespace limn
