#include "subdiv/mesh_level_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <tuple>

#include "sdf/large_pages.h"
#include "sdf/level_set_nano.h"
#include "sdf/parallel.h"
#include "sdf/size_error.h"
#include "subdiv/mesh_body.h"

namespace limn {
namespace {

constexpr std::int64_t kMaxIndex = std::int64_t{1} << 30;

std::int64_t max_blocks(const LevelSetSettings& settings) {
  return std::max<std::int64_t>(1, settings.max_bytes / static_cast<std::int64_t>(sizeof(LevelSetBlock)));
}

void check(const Box& bounds, const LevelSetSettings& settings) {
  if (!(settings.voxel_size > 0.0) || !std::isfinite(settings.voxel_size))
    throw InputError(
        {"", "voxel_size", fmt::format("{}", settings.voxel_size), "the voxel size is out of range", "above 0, in world units"});
  if (!(settings.half_width_voxels >= 1.8) || settings.half_width_voxels > 1000.0)
    throw InputError(
        {"", "half_width", fmt::format("{}", settings.half_width_voxels), "the half-width is out of range", "1.8 to 1000 voxels"});
  const double side = bounds.longest_side() / settings.voxel_size;
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

/// Blocks in pieces of memory that are given back as soon as none of their blocks is needed any more.
class PassingBlocks {
 public:
  explicit PassingBlocks(size_t count) : pieces_((count + kPiece - 1) / kPiece), left_(pieces_.size()) {
    for (size_t k = 0; k < pieces_.size(); ++k) {
      const size_t size = std::min(kPiece, count - k * kPiece);
      pieces_[k].resize(size);
      left_[k] = size;
    }
  }
  /// Unset at first.
  LevelSetBlock& operator[](size_t i) { return pieces_[i / kPiece][i % kPiece]; }
  /// Once for each block, from any thread.
  void let_go(size_t i) {
    if (--left_[i / kPiece] == 0) PassingVector<LevelSetBlock>().swap(pieces_[i / kPiece]);
  }

 private:
  static constexpr size_t kPiece = (size_t{4} << 20) / sizeof(LevelSetBlock);
  std::vector<PassingVector<LevelSetBlock>> pieces_;
  std::vector<std::atomic<size_t>> left_;
};

struct Band {
  /// One that has an active node.
  struct Block {
    PassingBlocks* of = nullptr;
    size_t number = 0;
  };
  std::vector<std::unique_ptr<PassingBlocks>> waves;
  std::vector<Block> blocks;
  std::vector<glm::ivec3> origins;  ///< Of `blocks`.
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

/// Where a block's distances come from: the triangles listed for it, or the tree.
class Distances {
 public:
  Distances(const MeshBody& body, double voxel_size, double reach, std::int64_t max_blocks)
      : body_(body), voxel_size_(voxel_size), reach_(reach), by_tree_(reach > kScatterReach_voxels * voxel_size) {
    // Made here, not by the first of many threads: a thread that waits for it takes up other work, which would wait for it too.
    if (by_tree_) body.tree();
    if (by_tree_)
      lists_.origins = blocks_near_triangles(body.mesh(), voxel_size, reach, max_blocks);
    else
      lists_ = triangles_near_blocks(body.mesh(), voxel_size, reach, max_blocks);
  }
  const std::vector<glm::ivec3>& near() const { return lists_.origins; }

  /// That come near the block; none where nobody knows.
  std::span<const std::uint32_t> triangles(const glm::ivec3& origin) const {
    if (by_tree_) return {};
    const auto found = std::lower_bound(lists_.origins.begin(), lists_.origins.end(), origin, before);
    // Blocks that are looked at for the sake of a hole may have no triangle near them.
    const bool listed = found != lists_.origins.end() && *found == origin;
    return listed ? lists_.of(static_cast<size_t>(found - lists_.origins.begin())) : std::span<const std::uint32_t>{};
  }

  /// `triangles`: as triangles() has them.
  void measure(const glm::ivec3& origin, std::span<const std::uint32_t> triangles, BlockDistanceArray& distances) const {
    if (by_tree_) return measure_block(origin, body_.tree(), voxel_size_, reach_, distances);
    band_distances(body_.mesh(), triangles, origin, voxel_size_, reach_, distances);
  }

 private:
  const MeshBody& body_;
  double voxel_size_, reach_;
  bool by_tree_;
  BlockTriangles lists_;
};

Band make_band(const MeshBody& body, const LevelSetSettings& settings, double shell) {
  const BlockSettings block_settings{settings.voxel_size, settings.voxel_size * settings.half_width_voxels, shell};
  Band band;
  const Distances distances(body, settings.voxel_size, block_settings.half_width + shell, max_blocks(settings));
  std::vector<glm::ivec3> wave = distances.near();
  std::vector<glm::ivec3> known = wave;
  Progress progress(settings.progress, wave.size());
  while (!wave.empty()) {
    if (static_cast<std::int64_t>(known.size()) > max_blocks(settings))
      throw SizeError({"", "voxel_size", fmt::format("{}", settings.voxel_size), "closing the mesh's holes takes more memory than allowed",
                       "larger voxels, or a closed mesh"});
    PassingBlocks& blocks = *band.waves.emplace_back(std::make_unique<PassingBlocks>(wave.size()));
    std::vector<char> membrane(wave.size(), 0), active(wave.size(), 0), inside(wave.size(), 0);
    parallel_parts(wave.size(), size_t{1}, [&](const IndexRange<size_t>& part) {
      FilledBlocks filled;
      for (size_t i = part.first; i < part.last; ++i) {
        BlockDistanceArray unsigned_distances;
        const BlockMesh mesh{body.winding(), distances.triangles(wave[i]), &filled};
        distances.measure(wave[i], mesh.triangles, unsigned_distances);
        const BlockResult result = fill_block(wave[i], unsigned_distances, mesh, block_settings, blocks[i]);
        membrane[i] = result.membrane, active[i] = result.any_active, inside[i] = result.any_inside;
        progress.step();
      }
    });
    for (size_t i = 0; i < wave.size(); ++i) {
      if (!active[i]) {
        blocks.let_go(i);
        continue;
      }
      band.blocks.push_back({&blocks, i});
      band.origins.push_back(wave[i]);
      band.any_inside |= inside[i] != 0;
    }
    wave = next_wave(wave, membrane, known);
  }
  return band;
}

/// What is written into the grid is let go.
std::shared_ptr<LevelSetData> join_band(const Band& band, const LevelSetSettings& settings, const glm::dvec3& origin) {
  const FillLeaves fill = [&band](const IndexRange<size_t>& part, const WriteLeaf& write) {
    for (size_t i = part.first; i < part.last; ++i) {
      const auto& [of, number] = band.blocks[i];
      write(i, (*of)[number]);
      of->let_go(number);
    }
  };
  return join_leaves(band.origins, fill, settings.voxel_size, settings.half_width_voxels, "mesh", origin);
}

}  // namespace

MeshLevelSet level_set_from_mesh(const TriangleMesh& mesh, const LevelSetSettings& settings) {
  return level_set_from_mesh(MeshBody(mesh), settings);
}

MeshLevelSet level_set_from_mesh(const MeshBody& body, const LevelSetSettings& settings) {
  const auto started = std::chrono::steady_clock::now();
  check(body.bounds(), settings);
  std::vector<std::string> warnings = body.warnings();
  const double inside = share_with_inside(body, 0.5 * settings.voxel_size);
  Band band;
  if (inside >= 0.5) band = make_band(body, settings, 0.0);
  if (!band.any_inside) {
    warnings.push_back(
        fmt::format("the mesh has no inside behind {:.0f} % of its surface (a sheet, or thinner than a voxel): drawn as a shell, "
                    "one voxel to each side",
                    band.blocks.empty() ? 100.0 * (1.0 - inside) : 100.0));
    band = make_band(body, settings, settings.voxel_size);
  }
  warn_of_thin_sheets(body, settings.voxel_size, warnings);
  const std::shared_ptr<LevelSetData> data = join_band(band, settings, body.origin());
  data->info.build_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - started).count();
  return {LevelSet(data), std::move(warnings)};
}

}  // namespace limn
