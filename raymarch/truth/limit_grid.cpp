#include "raymarch/truth/limit_grid.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "raymarch/truth/limit_cone_tips.h"
#include "raymarch/truth/seam_nodes.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

// Two evaluations of one place differ by rounding, and around extraordinary vertices by what patches approximate.
constexpr double kSamePlace = 1e-6;  // of the extent
constexpr double kRounding = 1e-12;  // of the largest coordinate: no two evaluations agree better
constexpr int kFinestSteps = 256;    // along a patch's side
constexpr size_t kSeamPart = 16384;  // triangles
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

struct PatchLattice {
  int steps = 1;
  std::vector<LimitSample> samples{};  ///< Rows of v, each of u from 0; a triangle's rows grow shorter.
  bool valid = true;
  // Of a valid one:
  Box extent{};
  std::vector<glm::dvec2> tips{};  ///< cone_tips()
  double tip_px = 0.0;             ///< LimitGrid::tip_px
};

size_t lattice_index(const LimitPatch& patch, int steps, int i, int j) {
  const auto row = static_cast<size_t>(j), n = static_cast<size_t>(steps);
  const size_t before = patch.triangle ? row * (n + 1) - row * (row - 1) / 2 : row * (n + 1);
  return before + static_cast<size_t>(i);
}

/// From the tips of a patch to the samples around them.
double tip_px(const PlacedLimitSurface& placed, size_t k, const PatchLattice& lattice, const Camera& camera) {
  const LimitPatch& patch = placed.patches[k];
  double widest = 0.0;
  for (size_t corner = 0; corner < 4; ++corner) {
    if (!is_tip(placed, patch, corner)) continue;
    const auto px = [&](int i, int j) {
      const std::array<int, 2> at = kCornerPlaces[corner];
      const int u = at[0] ? lattice.steps - i : i, v = at[1] ? lattice.steps - j : j;
      return glm::dvec2(project(camera, lattice.samples[lattice_index(patch, lattice.steps, u, v)].position));
    };
    widest = std::max({widest, glm::distance(px(0, 0), px(1, 0)), glm::distance(px(0, 0), px(0, 1)), glm::distance(px(0, 0), px(1, 1))});
  }
  return widest;
}

size_t samples_of(const LimitPatch& patch, int steps) {
  const auto n = static_cast<size_t>(steps) + 1;
  return patch.triangle ? n * (n + 1) / 2 : n * n;
}

PatchLattice sample_lattice(const PlacedLimitSurface& placed, size_t k, int steps, const Camera& camera) {
  PatchLattice lattice;
  lattice.steps = steps;
  const LimitPatch& patch = placed.patches[k];
  lattice.samples.reserve(samples_of(patch, steps));
  for (int j = 0; j <= steps; ++j) {
    for (int i = 0; i <= (patch.triangle ? steps - j : steps); ++i) {
      lattice.samples.push_back(sample(placed, k, glm::dvec2(i, j) / double(steps)));
      lattice.valid = lattice.valid && lattice.samples.back().valid;
    }
  }
  if (!lattice.valid) return lattice;
  for (const LimitSample& s : lattice.samples) lattice.extent = include(lattice.extent, s.position);
  lattice.tips = cone_tips(placed, k, steps);
  lattice.tip_px = tip_px(placed, k, lattice, camera);
  return lattice;
}

/// Samples nearer to each other than this are one node. Never so little beside the coordinates that cells of that size cannot be counted.
double same_place(const std::vector<PatchLattice>& lattices) {
  Box extent;
  for (const PatchLattice& lattice : lattices) {
    if (lattice.valid) extent = merge(extent, lattice.extent);
  }
  if (extent.empty()) return 1.0;
  const glm::dvec3 farthest = glm::max(glm::abs(extent.lower), glm::abs(extent.upper));
  const double largest = std::max({farthest.x, farthest.y, farthest.z});
  return std::max({kSamePlace * extent.radius(), kRounding * largest, 1e-300});
}

bool on_rim(const LimitPatch& patch, int steps, int i, int j) {
  return i == 0 || j == 0 || (patch.triangle ? i + j == steps : i == steps || j == steps);
}

/// What the samples of a patch are in the grid. They are counted by one thread, in order; all else is done by many.
struct LatticeNumbers {
  struct RimCorner {
    std::uint32_t node = 0, side = 0;
    std::uint32_t seam = 0;  ///< Of SeamNodes.
  };
  std::vector<RimCorner> rim{};  ///< In the order of the samples.
  struct Row {
    std::uint32_t first_node = 0, first_side = 0;  ///< Of the samples inside.
  };
  std::vector<Row> rows{};
  size_t first_triangle = 0;
  std::vector<LimitTriangle> with_tips{};  ///< All triangles, where some of their corners have two sides.
};

/// A lattice's corners, by lattice_index().
std::vector<LimitCorner> corners_of(const LimitPatch& patch, int steps, const LatticeNumbers& numbers) {
  const auto n = static_cast<std::uint16_t>(steps);
  std::vector<LimitCorner> corners;
  corners.reserve(samples_of(patch, steps));
  auto rim = numbers.rim.begin();
  for (int j = 0; j <= steps; ++j) {
    LatticeNumbers::Row inside = numbers.rows[static_cast<size_t>(j)];
    for (int i = 0; i <= (patch.triangle ? steps - j : steps); ++i) {
      LimitCorner corner{0, 0, 0, static_cast<std::uint16_t>(i), static_cast<std::uint16_t>(j), n};
      if (on_rim(patch, steps, i, j)) {
        corner.node = rim->node;
        corner.side = rim->side;
        ++rim;
      } else {
        corner.node = inside.first_node++;
        corner.side = inside.first_side++;
      }
      corner.side_back = corner.side;
      corners.push_back(corner);
    }
  }
  return corners;
}

/// Two triangles a cell, each diagonal from the upper left to the lower right.
void write_triangles(const LimitPatch& patch, std::uint32_t k, int n, const std::vector<LimitCorner>& corners, LimitTriangle* to) {
  const auto at = [&](int i, int j) { return corners[lattice_index(patch, n, i, j)]; };
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < (patch.triangle ? n - j : n); ++i) {
      *to++ = {k, {at(i, j), at(i + 1, j), at(i, j + 1)}};
      if (!patch.triangle || i + j + 1 < n) *to++ = {k, {at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)}};
    }
  }
}

struct GridCounts {
  std::uint32_t nodes = 0, sides = 0;
  size_t triangles = 0;
};

LatticeNumbers number_lattice(const PlacedLimitSurface& placed, std::uint32_t k, const PatchLattice& lattice, SeamNodes& seams,
                              GridCounts& counts) {
  const LimitPatch& patch = placed.patches[k];
  const int n = lattice.steps;
  LatticeNumbers numbers;
  numbers.rim.reserve(4 * static_cast<size_t>(n));
  numbers.rows.resize(static_cast<size_t>(n) + 1);
  const auto count_rim = [&](int i, int j) {
    const LimitSample& s = lattice.samples[lattice_index(patch, n, i, j)];
    const std::uint32_t seam = seams.node_at(s.position, counts.nodes);
    numbers.rim.push_back({seams.nodes()[seam].number, seams.side_of(seam, s.normal, counts.sides), seam});
  };
  for (int j = 0; j <= n; ++j) {
    const int last = patch.triangle ? n - j : n;
    for (int i = 0; i <= last; ++i) {
      if (on_rim(patch, n, i, j)) {
        count_rim(i, j);
        continue;
      }
      numbers.rows[static_cast<size_t>(j)] = {counts.nodes, counts.sides};
      const auto inside = static_cast<std::uint32_t>(last - 1);
      counts.nodes += inside;
      counts.sides += inside;
      i = last - 1;
    }
  }
  numbers.first_triangle = counts.triangles;
  const size_t triangles = static_cast<size_t>(patch.triangle ? n * n : 2 * n * n);
  counts.triangles += triangles;
  if (lattice.tips.empty()) return numbers;
  numbers.with_tips.resize(triangles);
  write_triangles(patch, k, n, corners_of(patch, n, numbers), numbers.with_tips.data());
  take_sides_of_tips(placed, lattice.tips, numbers.with_tips, [&](const LimitCorner& corner, const glm::dvec3& normal) {
    const auto rim = std::find_if(numbers.rim.begin(), numbers.rim.end(), [&](const auto& one) { return one.node == corner.node; });
    return seams.side_of(rim->seam, normal, counts.sides);
  });
  return numbers;
}

/// The triangles of a patch, and its samples but for those on its rim.
void write_lattice(const PlacedLimitSurface& placed, std::uint32_t k, const PatchLattice& lattice, const LatticeNumbers& numbers,
                   LimitGrid& grid) {
  const LimitPatch& patch = placed.patches[k];
  const int n = lattice.steps;
  for (int j = 1; j < n; ++j) {
    const auto [node, side] = numbers.rows[static_cast<size_t>(j)];
    for (int i = 1; i < (patch.triangle ? n - j : n); ++i) {
      const LimitSample& s = lattice.samples[lattice_index(patch, n, i, j)];
      const auto at = static_cast<std::uint32_t>(i - 1);
      grid.positions[node + at] = s.position;
      grid.normals[side + at] = s.normal;
      grid.node_of_side[side + at] = node + at;
    }
  }
  LimitTriangle* const triangles = grid.triangles.data() + numbers.first_triangle;
  if (numbers.with_tips.empty()) {
    write_triangles(patch, k, n, corners_of(patch, n, numbers), triangles);
  } else {
    std::copy(numbers.with_tips.begin(), numbers.with_tips.end(), triangles);
  }
}

void write_seams(const SeamNodes& seams, LimitGrid& grid) {
  for (const SeamNodes::Node& node : seams.nodes()) grid.positions[node.number] = node.position;
  for (const SeamNodes::Side& side : seams.sides()) {
    grid.normals[side.number] = side.normal;
    grid.node_of_side[side.number] = side.node;
  }
}

/// The lattices as one grid, without what LimitGrid says of its seams and blocks.
LimitGrid joined(const PlacedLimitSurface& placed, const std::vector<PatchLattice>& lattices) {
  LimitGrid grid;
  SeamNodes seams(same_place(lattices));
  GridCounts counts;
  std::vector<LatticeNumbers> numbers(lattices.size());
  for (size_t k = 0; k < lattices.size(); ++k) {
    if (!lattices[k].valid) {
      grid.invalid_patches.push_back(k);
      continue;
    }
    numbers[k] = number_lattice(placed, static_cast<std::uint32_t>(k), lattices[k], seams, counts);
    grid.tip_px = std::max(grid.tip_px, lattices[k].tip_px);
  }
  grid.positions.resize(counts.nodes);
  grid.normals.resize(counts.sides);
  grid.node_of_side.resize(counts.sides);
  grid.triangles.resize(counts.triangles);
  parallel_for(size_t{0}, lattices.size(), [&](size_t k) {
    if (lattices[k].valid) write_lattice(placed, static_cast<std::uint32_t>(k), lattices[k], numbers[k], grid);
  });
  write_seams(seams, grid);
  return grid;
}

void find_seams(const PlacedLimitSurface& placed, LimitGrid& grid) {
  const auto on_side = [](const LimitPatch& patch, const glm::dvec2& a, const glm::dvec2& b) {
    const auto both = [&](auto&& test) { return test(a) && test(b); };
    if (both([](const glm::dvec2& p) { return p.x == 0.0; }) || both([](const glm::dvec2& p) { return p.y == 0.0; })) return true;
    if (patch.triangle) return both([](const glm::dvec2& p) { return p.x + p.y > 1.0 - 1e-9; });
    return both([](const glm::dvec2& p) { return p.x == 1.0; }) || both([](const glm::dvec2& p) { return p.y == 1.0; });
  };
  const auto corner_of = [&](size_t t, int i) -> const LimitCorner& { return grid.triangles[t].corners[static_cast<size_t>(i % 3)]; };
  const size_t parts = (grid.triangles.size() + kSeamPart - 1) / kSeamPart;
  std::vector<std::vector<SeamUse>> uses(parts);
  parallel_for(size_t{0}, parts, [&](size_t part) {
    for (size_t t = part * kSeamPart; t < std::min((part + 1) * kSeamPart, grid.triangles.size()); ++t) {
      for (int from = 0; from < 3; ++from) {
        const LimitCorner &a = corner_of(t, from), &b = corner_of(t, from + 1);
        if (a.node != b.node && on_side(placed.patches[grid.triangles[t].patch], a.uv(), b.uv()))
          uses[part].push_back({static_cast<std::uint32_t>(t), from});
      }
    }
  });
  using Nodes = std::pair<std::uint32_t, std::uint32_t>;
  std::vector<std::pair<Nodes, SeamUse>> all;
  for (const auto& part : uses) {
    for (const SeamUse& use : part)
      all.emplace_back(std::minmax(corner_of(use.triangle, use.from).node, corner_of(use.triangle, use.from + 1).node), use);
  }
  parallel_sort(all.begin(), all.end(), [](const auto& a, const auto& b) {
    return std::tie(a.first, a.second.triangle, a.second.from) < std::tie(b.first, b.second.triangle, b.second.from);
  });
  grid.seam_uses.reserve(all.size());
  for (const auto& [nodes, use] : all) grid.seam_uses.push_back(use);
  for (size_t first = 0, end = 0; first < all.size(); first = end) {
    while (end < all.size() && all[end].first == all[first].first) ++end;
    grid.seams.push_back({all[first].first, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(end)});
  }
  const auto starts_at = [&](const SeamUse& use) { return grid.triangles[use.triangle].corners[static_cast<size_t>(use.from)].node; };
  grid.sheet = std::any_of(grid.seams.begin(), grid.seams.end(), [&](const LimitSeam& seam) {
    const std::span<const SeamUse> both = uses_of(grid, seam);
    return both.size() != 2 || starts_at(both[0]) == starts_at(both[1]);
  });
}

}  // namespace

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
  std::vector<PatchLattice> lattices(placed.patches.size());
  parallel_for(size_t{0}, placed.patches.size(),
               [&](size_t k) { lattices[k] = sample_lattice(placed, k, steps_of(placed.patches[k], steps), camera); });
  LimitGrid grid = joined(placed, lattices);
  find_seams(placed, grid);
  grid.blocks = blocks_of(grid);
  return grid;
}

LimitGrid sample_grid(const PlacedLimitSurface& placed, const Camera& camera, double cell_px, std::int64_t max_triangles,
                      double& used_cell_px) {
  const LatticeSteps lattice = lattice_steps(placed, patch_sides(placed), camera, cell_px, max_triangles);
  used_cell_px = lattice.cell_px;
  return sample_grid(placed, camera, lattice.steps);
}

}  // namespace limn
