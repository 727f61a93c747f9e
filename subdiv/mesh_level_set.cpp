#include "subdiv/mesh_level_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <mutex>
#include <tuple>

#include "sdf/parallel.h"
#include "sdf/size_error.h"
#include "subdiv/band_distance.h"
#include "subdiv/first_hits.h"
#include "subdiv/mesh_block.h"
#include "subdiv/mesh_distance.h"
#include "subdiv/weld.h"

namespace limn {
namespace {

constexpr std::int64_t kMaxIndex = std::int64_t{1} << 30;

/// What level sets are made from: triangles about the middle of their box (far from it double precision and 32-bit indices would run out),
/// those that lie on one place taken together.
struct LocalMesh {
  TriangleMesh mesh{};
  std::vector<std::int32_t> times{};  ///< As MergedTriangles.
  std::vector<std::uint32_t> first_at{};
};

LocalMesh local_mesh(const TriangleMesh& mesh, const glm::dvec3& origin) {
  LocalMesh local;
  local.mesh.positions.resize(mesh.positions.size());
  parallel_parts(mesh.positions.size(), size_t{4096}, [&](const IndexRange<size_t>& part) {
    for (size_t i = part.first; i < part.last; ++i) local.mesh.positions[i] = mesh.positions[i] - origin;
  });
  local.first_at = first_at_position(local.mesh.positions);
  MergedTriangles merged = merge_coincident(mesh, local.first_at);
  local.mesh.triangles = std::move(merged.triangles);
  local.times = std::move(merged.times);
  return local;
}

double signed_volume(const LocalMesh& local) {
  const TriangleMesh& mesh = local.mesh;
  double volume = 0.0;
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    const glm::uvec3& t = mesh.triangles[i];
    const double own = glm::dot(mesh.positions[t.x], glm::cross(mesh.positions[t.y], mesh.positions[t.z])) / 6.0;
    volume += local.times.empty() ? own : static_cast<double>(local.times[i]) * own;
  }
  return volume;
}

Box used_bounds(const TriangleMesh& mesh) {
  Box box;
  for (const glm::uvec3& t : mesh.triangles)
    for (int i = 0; i < 3; ++i) box = include(box, mesh.positions[t[i]]);
  return box;
}

std::int64_t max_blocks(const LevelSetSettings& settings) {
  return std::max<std::int64_t>(1, settings.max_bytes / static_cast<std::int64_t>(sizeof(LevelSetBlock)));
}

void check(const TriangleMesh& mesh, const LevelSetSettings& settings) {
  if (mesh.triangles.empty()) throw InputError({"", "", "", "the mesh has no triangle with an area", "at least one"});
  if (!(settings.voxel_size > 0.0) || !std::isfinite(settings.voxel_size))
    throw InputError(
        {"", "voxel_size", fmt::format("{}", settings.voxel_size), "the voxel size is out of range", "above 0, in world units"});
  if (!(settings.half_width_voxels >= 1.8) || settings.half_width_voxels > 1000.0)
    throw InputError(
        {"", "half_width", fmt::format("{}", settings.half_width_voxels), "the half-width is out of range", "1.8 to 1000 voxels"});
  const double side = used_bounds(mesh).longest_side() / settings.voxel_size;
  if (side > static_cast<double>(kMaxIndex))
    throw InputError(
        {"", "voxel_size", fmt::format("{}", settings.voxel_size), fmt::format("the mesh is {:.3g} voxels long", side), "larger voxels"});
}

/// Progress from many threads, handed on by one at a time.
class Progress {
 public:
  Progress(const std::function<void(double)>& report, size_t total) : report_(report), total_(total) {}
  void step() {
    const size_t done = ++done_;
    if (!report_ || done % 64 != 0) return;
    if (const std::unique_lock lock(mutex_, std::try_to_lock); lock.owns_lock())
      report_(std::min(1.0, static_cast<double>(done) / static_cast<double>(total_)));
  }

 private:
  const std::function<void(double)>& report_;
  size_t total_;
  std::atomic<size_t> done_{0};
  std::mutex mutex_;
};

/// Embree's tree over the triangles, made when it is first asked for.
class LazyTree {
 public:
  explicit LazyTree(const TriangleMesh& mesh) : mesh_(mesh) {}
  const ClosestPointData& get() const {
    std::call_once(made_, [this] { tree_ = std::make_unique<const ClosestPointData>(mesh_); });
    return *tree_;
  }

 private:
  const TriangleMesh& mesh_;
  mutable std::once_flag made_;
  mutable std::unique_ptr<const ClosestPointData> tree_;
};

struct Band {
  std::vector<LevelSetBlock> blocks;
  bool any_inside = false;
};

bool before(const glm::ivec3& a, const glm::ivec3& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); }

/// Neighbours of the blocks that the surface's continuation over its holes runs through, as far as they are new.
std::vector<glm::ivec3> next_wave(const std::vector<glm::ivec3>& wave, const std::vector<char>& has_membrane,
                                  std::vector<glm::ivec3>& known) {
  std::vector<glm::ivec3> next;
  for (size_t i = 0; i < wave.size(); ++i) {
    if (!has_membrane[i]) continue;
    for (int x = -8; x <= 8; x += 8)
      for (int y = -8; y <= 8; y += 8)
        for (int z = -8; z <= 8; z += 8) next.push_back(wave[i] + glm::ivec3(x, y, z));
  }
  std::sort(next.begin(), next.end(), before);
  next.erase(std::unique(next.begin(), next.end()), next.end());
  std::erase_if(next, [&known](const glm::ivec3& o) { return std::binary_search(known.begin(), known.end(), o, before); });
  const size_t middle = known.size();
  known.insert(known.end(), next.begin(), next.end());
  std::inplace_merge(known.begin(), known.begin() + static_cast<std::ptrdiff_t>(middle), known.end(), before);
  return next;
}

/// Beyond this a block is in reach of so many triangles that the tree is quicker.
constexpr double kScatterReach_voxels = 6.0;

/// Where a block's distances come from: the triangles listed for it, or the tree.
class Distances {
 public:
  Distances(const TriangleMesh& mesh, const LazyTree& tree, double voxel_size, double reach, std::int64_t max_blocks)
      : mesh_(mesh), tree_(tree), voxel_size_(voxel_size), reach_(reach), by_tree_(reach > kScatterReach_voxels * voxel_size) {
    // Made here, not by the first of many threads: a thread that waits for it takes up other work, which would wait for it too.
    if (by_tree_) tree_.get();
    if (by_tree_)
      lists_.origins = blocks_near_triangles(mesh, voxel_size, reach, max_blocks);
    else
      lists_ = triangles_near_blocks(mesh, voxel_size, reach, max_blocks);
  }
  const std::vector<glm::ivec3>& near() const { return lists_.origins; }

  void measure(const glm::ivec3& origin, BlockDistanceArray& distances) const {
    if (by_tree_) return measure_block(origin, tree_.get(), voxel_size_, reach_, distances);
    const auto found = std::lower_bound(lists_.origins.begin(), lists_.origins.end(), origin, before);
    // Blocks that are looked at for the sake of a hole may have no triangle near them.
    const bool listed = found != lists_.origins.end() && *found == origin;
    const auto triangles = listed ? lists_.of(static_cast<size_t>(found - lists_.origins.begin())) : std::span<const std::uint32_t>{};
    band_distances(mesh_, triangles, origin, voxel_size_, reach_, distances);
  }

 private:
  const TriangleMesh& mesh_;
  const LazyTree& tree_;
  double voxel_size_, reach_;
  bool by_tree_;
  BlockTriangles lists_;
};

Band make_band(const TriangleMesh& mesh, const LazyTree& tree, const Winding& winding, const LevelSetSettings& settings, double shell) {
  const BlockSettings block_settings{settings.voxel_size, settings.voxel_size * settings.half_width_voxels, shell};
  Band band;
  const Distances distances(mesh, tree, settings.voxel_size, block_settings.half_width + shell, max_blocks(settings));
  std::vector<glm::ivec3> wave = distances.near();
  std::vector<glm::ivec3> known = wave;
  Progress progress(settings.progress, wave.size());
  while (!wave.empty()) {
    if (static_cast<std::int64_t>(known.size()) > max_blocks(settings))
      throw SizeError({"", "voxel_size", fmt::format("{}", settings.voxel_size), "closing the mesh's holes takes more memory than allowed",
                       "larger voxels, or a closed mesh"});
    std::vector<LevelSetBlock> blocks(wave.size());
    std::vector<char> membrane(wave.size(), 0), active(wave.size(), 0), inside(wave.size(), 0);
    parallel_parts(wave.size(), size_t{1}, [&](const IndexRange<size_t>& part) {
      std::optional<BlockLayer> layer;
      for (size_t i = part.first; i < part.last; ++i) {
        BlockDistanceArray unsigned_distances;
        distances.measure(wave[i], unsigned_distances);
        const BlockResult result = fill_block(wave[i], unsigned_distances, winding, block_settings, layer, blocks[i]);
        membrane[i] = result.membrane, active[i] = result.any_active, inside[i] = result.any_inside;
        progress.step();
      }
    });
    for (size_t i = 0; i < wave.size(); ++i) {
      if (!active[i]) continue;
      band.blocks.push_back(blocks[i]);
      band.any_inside |= inside[i] != 0;
    }
    wave = next_wave(wave, membrane, known);
  }
  return band;
}

/// Share of an open mesh's area (of some thousand triangles of it) that has inside behind it at this depth. A sheet that is bent a little
/// has inside in its fold alone, and the surface that bounds that is not the sheet.
double share_with_inside(const TriangleMesh& mesh, const Winding& winding, double depth) {
  constexpr size_t kTriangles = 4096;
  const size_t stride = std::max<size_t>(1, mesh.triangles.size() / kTriangles);
  double area = 0.0, with_inside = 0.0;
  for (size_t i = 0; i < mesh.triangles.size(); i += stride) {
    const glm::uvec3 t = mesh.triangles[i];
    const glm::dvec3 a = mesh.positions[t.x], b = mesh.positions[t.y], c = mesh.positions[t.z], normal = glm::cross(b - a, c - a);
    const double own = glm::length(normal);
    if (!(own > 0.0)) continue;
    area += own;
    if (winding.number((a + b + c) / 3.0 - depth / own * normal) > 0.5) with_inside += own;
  }
  return area > 0.0 ? with_inside / area : 0.0;
}

/// Walls thinner than two voxels and gaps thinner than one: shares of the surface, as the audit measures them.
void warn_of_thin_sheets(const TriangleMesh& mesh, double voxel_size, std::vector<std::string>& warnings) {
  const ThinSamples samples = thin_samples(mesh, used_bounds(mesh).longest_side(), 2.0 * voxel_size);
  const auto share_below = [](const std::vector<double>& widths, double limit) {
    const auto below = std::count_if(widths.begin(), widths.end(), [limit](double width) { return width < limit; });
    return widths.empty() ? 0.0 : static_cast<double>(below) / static_cast<double>(widths.size());
  };
  const double thin = share_below(samples.walls, 2.0 * voxel_size), narrow = share_below(samples.gaps, voxel_size);
  if (thin > kThinShare)
    warnings.push_back(
        fmt::format("{:.2g} % of the surface lies on walls thinner than two voxels ({:.3g}), which may break up: use smaller voxels",
                    100.0 * thin, 2.0 * voxel_size));
  if (narrow > kThinShare)
    warnings.push_back(
        fmt::format("{:.2g} % of the surface lies at gaps narrower than one voxel ({:.3g}), which may close: use smaller voxels",
                    100.0 * narrow, voxel_size));
}

}  // namespace

MeshLevelSet level_set_from_mesh(const TriangleMesh& mesh, const LevelSetSettings& settings) {
  check(mesh, settings);
  const glm::dvec3 origin = used_bounds(mesh).center();
  LocalMesh made = local_mesh(mesh, origin);
  TriangleMesh& local = made.mesh;
  std::vector<std::string> warnings;
  if (const double volume = signed_volume(made); volume < 0.0) {
    for (glm::uvec3& t : local.triangles) std::swap(t.y, t.z);
    warnings.push_back(fmt::format("the mesh is turned inside out (its volume is {:.4g}): its faces were turned round", volume));
  }
  const LazyTree tree(local);
  const Winding winding(local, made.first_at, std::move(made.times));
  if (!winding.closed())
    warnings.push_back(
        fmt::format("{} open edges: inside is where the winding number is above 1/2, which closes the holes", winding.border().size()));
  const double inside = winding.closed() ? 1.0 : share_with_inside(local, winding, 0.5 * settings.voxel_size);
  Band band;
  if (inside >= 0.5) band = make_band(local, tree, winding, settings, 0.0);
  if (!band.any_inside) {
    warnings.push_back(
        fmt::format("the mesh has no inside behind {:.0f} % of its surface (a sheet, or thinner than a voxel): drawn as a shell, "
                    "one voxel to each side",
                    band.blocks.empty() ? 100.0 * (1.0 - inside) : 100.0));
    band = make_band(local, tree, winding, settings, settings.voxel_size);
  }
  warn_of_thin_sheets(local, settings.voxel_size, warnings);
  return {level_set_from_blocks(band.blocks, settings.voxel_size, settings.half_width_voxels, "mesh", origin), std::move(warnings)};
}

}  // namespace limn
