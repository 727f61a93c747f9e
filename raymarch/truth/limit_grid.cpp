#include "raymarch/truth/limit_grid.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "raymarch/truth/limit_cone_tips.h"
#include "raymarch/truth/seam_nodes.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

// Two evaluations of one place differ by rounding, and around extraordinary vertices by what patches approximate.
constexpr double kSamePlace = 1e-6;  // of the extent
constexpr double kRounding = 1e-12;  // of the largest coordinate: no two evaluations agree better
constexpr int kFinestSteps = 256;    // along a patch's side
constexpr double kTip_px = 0.005;    // the patches' side is so far from its ends after one step, where it shrinks as the step's square

/// Steps along a patch's side: even, so that an n-gon's shares, which have half as many, meet the lattices of its neighbours.
int steps_of(const LimitPatch& patch, int steps) { return patch.share ? steps / 2 : steps; }

std::int64_t triangles_of(const PlacedLimitSurface& placed, int steps) {
  std::int64_t count = 0;
  for (const LimitPatch& patch : placed.patches) {
    const std::int64_t n = steps_of(patch, steps);
    count += patch.triangle ? n * n : 2 * n * n;
  }
  return count;
}

double longest_side_px(const std::vector<PatchSide>& sides, const Camera& camera) {
  double longest = 0.0;
  for (const PatchSide& side : sides)
    longest = std::max(longest, side.length * pixels_per_unit_at(camera, std::max(project(camera, side.middle).z, 1e-9)));
  return longest;
}

constexpr std::array<std::array<int, 2>, 4> kCornerPlaces{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};

bool is_tip(const PlacedLimitSurface& placed, const LimitPatch& patch, size_t corner) {
  return !patch.triangle && placed.surface.is_tip(patch.face, patch.sub_face, static_cast<int>(corner));
}

/// Finer where a face has an interior vertex of valence 2.
int steps_for(const PlacedLimitSurface& placed, double longest_px, double cell_px) {
  const int steps = std::clamp(2 * static_cast<int>(std::ceil(0.5 * longest_px / cell_px)), 4, kFinestSteps);
  const bool any = std::any_of(placed.patches.begin(), placed.patches.end(), [&](const LimitPatch& patch) {
    return is_tip(placed, patch, 0) || is_tip(placed, patch, 1) || is_tip(placed, patch, 2) || is_tip(placed, patch, 3);
  });
  if (!any) return steps;
  return std::clamp(2 * static_cast<int>(std::ceil(0.5 * std::sqrt(longest_px / kTip_px))), steps, kFinestSteps);
}

/// The samples on a patch's sides, which other patches have too: all nodes are numbered by them.
struct PatchRim {
  int steps = 1;
  std::vector<LimitSample> samples{};  ///< By rim_index().
  bool valid = true;
  // Of a valid one:
  Box extent{};
  std::vector<glm::dvec2> tips{};  ///< cone_tips()
  double tip_px = 0.0;             ///< LimitGrid::tip_px
};

LimitSample sample_at(const PlacedLimitSurface& placed, size_t k, int steps, int column, int row) {
  return sample(placed, k, glm::dvec2(column, row) / double(steps));
}

/// From the tips of a patch to the samples around them.
double tip_px(const PlacedLimitSurface& placed, size_t k, int steps, const Camera& camera) {
  const LimitPatch& patch = placed.patches[k];
  double widest = 0.0;
  for (size_t corner = 0; corner < 4; ++corner) {
    if (!is_tip(placed, patch, corner)) continue;
    const auto px = [&](int i, int j) {
      const std::array<int, 2> at = kCornerPlaces[corner];
      const int u = at[0] ? steps - i : i, v = at[1] ? steps - j : j;
      return glm::dvec2(project(camera, sample_at(placed, k, steps, u, v).position));
    };
    widest = std::max({widest, glm::distance(px(0, 0), px(1, 0)), glm::distance(px(0, 0), px(0, 1)), glm::distance(px(0, 0), px(1, 1))});
  }
  return widest;
}

PatchRim sample_rim(const PlacedLimitSurface& placed, size_t k, int steps, const Camera& camera) {
  const LimitPatch& patch = placed.patches[k];
  PatchRim rim;
  rim.steps = steps;
  rim.samples.reserve(rim_size(patch, steps));
  for (int row = 0; row <= steps; ++row) {
    const int last = patch.triangle ? steps - row : steps, step = row == 0 || row == steps ? 1 : std::max(last, 1);
    for (int column = 0; column <= last; column += step) rim.samples.push_back(sample_at(placed, k, steps, column, row));
  }
  rim.valid = std::all_of(rim.samples.begin(), rim.samples.end(), [](const LimitSample& s) { return s.valid; });
  if (!rim.valid) return rim;
  for (const LimitSample& s : rim.samples) rim.extent = include(rim.extent, s.position);
  rim.tips = cone_tips(placed, k, steps);
  rim.tip_px = tip_px(placed, k, steps, camera);
  return rim;
}

/// Samples nearer to each other than this are one node. Never so little beside the coordinates that cells of that size cannot be counted.
double same_place(const std::vector<PatchRim>& rims) {
  Box extent;
  for (const PatchRim& rim : rims) {
    if (rim.valid) extent = merge(extent, rim.extent);
  }
  if (extent.empty()) return 1.0;
  const glm::dvec3 farthest = glm::max(glm::abs(extent.lower), glm::abs(extent.upper));
  const double largest = std::max({farthest.x, farthest.y, farthest.z});
  return std::max({kSamePlace * extent.radius(), kRounding * largest, 1e-300});
}

struct GridCounts {
  std::uint32_t nodes = 0, sides = 0, triangles = 0;
};

/// Nodes are counted row by row: those of the rim that no patch before has, and those inside.
LimitLattice number_lattice(const PlacedLimitSurface& placed, std::uint32_t k, const PatchRim& rim, SeamNodes& seams, GridCounts& counts) {
  LimitLattice lattice{k, placed.patches[k], rim.steps, counts.triangles};
  const int n = rim.steps;
  lattice.rim.reserve(rim.samples.size());
  lattice.inside.resize(static_cast<size_t>(n));
  std::vector<std::uint32_t> seam_of;
  const auto count_rim = [&] {
    const LimitSample& s = rim.samples[lattice.rim.size()];
    const std::uint32_t seam = seams.node_at(s.position, counts.nodes);
    lattice.rim.push_back({seams.nodes()[seam].number, seams.side_of(seam, s.normal, counts.sides)});
    seam_of.push_back(seam);
  };
  for (int row = 0; row <= n; ++row) {
    const int last = lattice.shape.triangle ? n - row : n, inside = last - 1;
    count_rim();
    if (row == 0 || row == n) {
      for (int column = 1; column <= last; ++column) count_rim();
      continue;
    }
    lattice.inside[static_cast<size_t>(row)] = {counts.nodes, counts.sides};
    counts.nodes += static_cast<std::uint32_t>(inside);
    counts.sides += static_cast<std::uint32_t>(inside);
    count_rim();
  }
  counts.triangles += lattice.triangle_count();
  if (rim.tips.empty()) return lattice;
  std::vector<LimitTriangle> triangles;
  for (std::uint32_t t = 0; t < lattice.triangle_count(); ++t) triangles.push_back(triangle_of(lattice, t));
  take_sides_of_tips(placed, rim.tips, triangles, [&](const LimitCorner& corner, const glm::dvec3& normal) {
    const auto at = std::find_if(lattice.rim.begin(), lattice.rim.end(), [&](const auto& place) { return place.node == corner.node; });
    return seams.side_of(seam_of[static_cast<size_t>(at - lattice.rim.begin())], normal, counts.sides);
  });
  lattice.with_tips = std::move(triangles);
  return lattice;
}

/// Lattices whose rims are in the grid, and room for what is inside them.
LimitGrid number_grid(const PlacedLimitSurface& placed, const std::vector<PatchRim>& rims) {
  LimitGrid grid;
  SeamNodes seams(same_place(rims));
  GridCounts counts;
  for (size_t k = 0; k < rims.size(); ++k) {
    if (!rims[k].valid) {
      grid.invalid_patches.push_back(k);
      continue;
    }
    grid.lattices.push_back(number_lattice(placed, static_cast<std::uint32_t>(k), rims[k], seams, counts));
    grid.tip_px = std::max(grid.tip_px, rims[k].tip_px);
  }
  grid.positions.resize(counts.nodes);
  grid.normals.resize(counts.sides);
  grid.node_of_side.resize(counts.sides);
  for (const SeamNodes::Node& node : seams.nodes()) grid.positions[node.number] = node.position;
  for (const SeamNodes::Side& side : seams.sides()) {
    grid.normals[side.number] = side.normal;
    grid.node_of_side[side.number] = side.node;
  }
  return grid;
}

/// False where some of them have no normal.
bool sample_inside(const PlacedLimitSurface& placed, const LimitLattice& lattice, LimitGrid& grid) {
  const int n = lattice.steps;
  bool valid = true;
  for (int row = 1; row < n; ++row) {
    const auto [node, side] = lattice.inside[static_cast<size_t>(row)];
    for (int column = 1; column < lattice.cells(row); ++column) {
      const LimitSample s = sample_at(placed, lattice.patch, n, column, row);
      const auto at = static_cast<std::uint32_t>(column - 1);
      grid.positions[node + at] = s.position;
      grid.normals[side + at] = s.normal;
      grid.node_of_side[side + at] = node + at;
      valid = valid && s.valid;
    }
  }
  return valid;
}

/// What is inside the lattices, and their blocks. Patches that have no surface there are marked: then the grid is of no use.
bool fill_lattices(const PlacedLimitSurface& placed, std::vector<PatchRim>& rims, LimitGrid& grid) {
  std::vector<size_t> first_block{0};
  for (const LimitLattice& lattice : grid.lattices) first_block.push_back(first_block.back() + block_count(lattice));
  grid.blocks.resize(first_block.back());
  std::atomic<bool> all_valid = true;
  parallel_for(size_t{0}, grid.lattices.size(), [&](size_t i) {
    const LimitLattice& lattice = grid.lattices[i];
    if (!sample_inside(placed, lattice, grid)) {
      rims[lattice.patch].valid = false;
      all_valid = false;
      return;
    }
    // While what was written is near.
    write_blocks(grid, lattice, grid.blocks.data() + first_block[i]);
  });
  return all_valid;
}

}  // namespace

const LimitLattice& lattice_of(const LimitGrid& grid, std::uint32_t t) {
  const auto after = std::upper_bound(grid.lattices.begin(), grid.lattices.end(), t,
                                      [](std::uint32_t at, const LimitLattice& lattice) { return at < lattice.first_triangle; });
  return *std::prev(after);
}

std::vector<PatchSide> patch_sides(const PlacedLimitSurface& placed) {
  std::vector<PatchSide> sides;
  for (size_t k = 0; k < placed.patches.size(); ++k) {
    const bool quad = !placed.patches[k].triangle, share = placed.patches[k].share;
    const std::array<glm::dvec2, 4> corners{{{0, 0}, {1, 0}, quad ? glm::dvec2(1, 1) : glm::dvec2(0.5, 0.5), {0, 1}}};
    std::array<LimitSample, 4> samples;
    for (size_t i = 0; i < 4; ++i) samples[i] = sample(placed, k, corners[i]);
    for (size_t i = 0; i < 4; ++i) {
      const LimitSample &a = samples[i], &b = samples[(i + 1) % 4];
      if (a.valid && b.valid)
        sides.push_back({0.5 * (a.position + b.position), (share ? 2.0 : 1.0) * glm::distance(a.position, b.position)});
    }
  }
  return sides;
}

LatticeSteps lattice_steps(const PlacedLimitSurface& placed, const std::vector<PatchSide>& sides, const Camera& camera, double cell_px,
                           std::int64_t max_triangles) {
  const double longest_px = longest_side_px(sides, camera);
  LatticeSteps result{steps_for(placed, longest_px, cell_px)};
  while (result.steps > 2 && triangles_of(placed, result.steps) > max_triangles) result.steps -= 2;
  result.cell_px = longest_px / result.steps;
  result.triangles = triangles_of(placed, result.steps);
  return result;
}

LimitGrid sample_grid(const PlacedLimitSurface& placed, const Camera& camera, int steps) {
  std::vector<PatchRim> rims(placed.patches.size());
  parallel_for(size_t{0}, placed.patches.size(),
               [&](size_t k) { rims[k] = sample_rim(placed, k, steps_of(placed.patches[k], steps), camera); });
  LimitGrid grid = number_grid(placed, rims);
  while (!fill_lattices(placed, rims, grid)) grid = number_grid(placed, rims);
  find_seams(grid);
  return grid;
}

LimitGrid sample_grid(const PlacedLimitSurface& placed, const Camera& camera, double cell_px, std::int64_t max_triangles,
                      double& used_cell_px) {
  const LatticeSteps lattice = lattice_steps(placed, patch_sides(placed), camera, cell_px, max_triangles);
  used_cell_px = lattice.cell_px;
  return sample_grid(placed, camera, lattice.steps);
}

}  // namespace limn
