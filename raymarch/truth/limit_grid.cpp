#include "raymarch/truth/limit_grid.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_map>

#include "raymarch/truth/limit_cone_tips.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

// Two evaluations of one place differ by rounding, and around extraordinary vertices by what patches approximate.
constexpr double kSamePlace = 1e-6;  // of the extent
constexpr double kRounding = 1e-12;  // of the largest coordinate: no two evaluations agree better
constexpr int kFinestSteps = 256;    // along a patch's side
constexpr std::uint32_t kBlockTriangles = 16;
constexpr size_t kSeamPart = 16384;   // triangles
constexpr double kBlockSlack = 1e-7;  // radians
constexpr double kTip_px = 0.005;     // the patches' side is so far from its ends after one step, where it shrinks as the step's square

bool has_normal(const glm::dvec3& n) { return std::isfinite(n.x) && glm::dot(n, n) > 0.5; }

/// Where a patch degenerates (a collapsed side, a corner without derivatives) the normal of a point a little inside serves.
glm::dvec2 inwards(const LimitPatch& patch, const glm::dvec2& uv) {
  const glm::dvec2 middle(patch.triangle ? 1.0 / 3.0 : 0.5);
  return glm::mix(uv, middle, 1e-4);
}

/// Nodes by place: a hash of cells twice as wide as the tolerance, of which a point's neighbourhood touches at most eight.
class Places {
 public:
  explicit Places(double tolerance) : tolerance_(tolerance) {}
  std::uint32_t find_or_add(const glm::dvec3& p, std::vector<glm::dvec3>& nodes) {
    const double side = 2.0 * tolerance_;
    const glm::dvec3 low = glm::floor((p - tolerance_) / side), high = glm::floor((p + tolerance_) / side);
    for (double x = low.x; x <= high.x; ++x) {
      for (double y = low.y; y <= high.y; ++y) {
        for (double z = low.z; z <= high.z; ++z) {
          const auto [first, last] = cells_.equal_range(key({x, y, z}));
          for (auto it = first; it != last; ++it) {
            if (glm::distance(nodes[it->second], p) <= tolerance_) return it->second;
          }
        }
      }
    }
    const auto node = static_cast<std::uint32_t>(nodes.size());
    nodes.push_back(p);
    cells_.emplace(key(glm::floor(p / side)), node);
    return node;
  }

 private:
  static std::uint64_t key(const glm::dvec3& cell) {
    const auto mixed = [](double v, std::uint64_t factor) { return static_cast<std::uint64_t>(static_cast<std::int64_t>(v)) * factor; };
    return mixed(cell.x, 0x9e3779b97f4a7c15u) ^ mixed(cell.y, 0xc2b2ae3d27d4eb4fu) ^ mixed(cell.z, 0x165667b19e3779f9u);
  }
  double tolerance_;
  std::unordered_multimap<std::uint64_t, std::uint32_t> cells_;
};

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
  std::vector<LimitSample> samples;  ///< Rows of v, each of u from 0; a triangle's rows grow shorter.
  bool valid = true;
};

size_t lattice_index(const LimitPatch& patch, int steps, int i, int j) {
  const auto row = static_cast<size_t>(j), n = static_cast<size_t>(steps);
  const size_t before = patch.triangle ? row * (n + 1) - row * (row - 1) / 2 : row * (n + 1);
  return before + static_cast<size_t>(i);
}

PatchLattice sample_lattice(const PlacedLimitSurface& placed, size_t k, int steps) {
  PatchLattice lattice;
  lattice.steps = steps;
  const LimitPatch& patch = placed.patches[k];
  for (int j = 0; j <= steps; ++j) {
    for (int i = 0; i <= (patch.triangle ? steps - j : steps); ++i) {
      lattice.samples.push_back(sample(placed, k, glm::dvec2(i, j) / double(steps)));
      lattice.valid = lattice.valid && lattice.samples.back().valid;
    }
  }
  return lattice;
}

/// Samples nearer to each other than this are one node. Never so little beside the coordinates that cells of that size cannot be counted.
double same_place(const std::vector<PatchLattice>& lattices) {
  Box extent;
  for (const PatchLattice& lattice : lattices) {
    if (!lattice.valid) continue;
    for (const LimitSample& s : lattice.samples) extent = include(extent, s.position);
  }
  if (extent.empty()) return 1.0;
  const glm::dvec3 farthest = glm::max(glm::abs(extent.lower), glm::abs(extent.upper));
  const double largest = std::max({farthest.x, farthest.y, farthest.z});
  return std::max({kSamePlace * extent.radius(), kRounding * largest, 1e-300});
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

using SidesOfNodes = std::unordered_map<std::uint32_t, std::vector<std::uint32_t>>;

std::uint32_t add_side(std::uint32_t node, const glm::dvec3& normal, LimitGrid& grid) {
  grid.normals.push_back(normal);
  grid.node_of_side.push_back(node);
  return static_cast<std::uint32_t>(grid.normals.size() - 1);
}

/// The side of a seam's node that has this normal, or a new one.
std::uint32_t seam_side(std::uint32_t node, const glm::dvec3& normal, SidesOfNodes& sides, LimitGrid& grid) {
  std::vector<std::uint32_t>& here = sides[node];
  for (const std::uint32_t side : here) {
    if (glm::distance(grid.normals[side], normal) < kSameNormal) return side;
  }
  here.push_back(add_side(node, normal, grid));
  return here.back();
}

void add_lattice(const PlacedLimitSurface& placed, std::uint32_t k, const PatchLattice& lattice, Places& places, SidesOfNodes& sides,
                 LimitGrid& grid) {
  const LimitPatch& patch = placed.patches[k];
  const int n = lattice.steps;
  std::vector<LimitCorner> corners;
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= (patch.triangle ? n - j : n); ++i) {
      const LimitSample& s = lattice.samples[lattice_index(patch, n, i, j)];
      const bool seam = i == 0 || j == 0 || (patch.triangle ? i + j == n : i == n || j == n);
      LimitCorner corner{static_cast<std::uint32_t>(grid.positions.size()), 0, 0, glm::dvec2(i, j) / double(n)};
      if (seam) {
        corner.node = places.find_or_add(s.position, grid.positions);
        corner.side = seam_side(corner.node, s.normal, sides, grid);
      } else {
        grid.positions.push_back(s.position);
        corner.side = add_side(corner.node, s.normal, grid);
      }
      corner.side_back = corner.side;
      corners.push_back(corner);
    }
  }
  const size_t first_triangle = grid.triangles.size();
  const auto add = [&](std::array<int, 2> a, std::array<int, 2> b, std::array<int, 2> c) {
    const auto at = [&](std::array<int, 2> ij) { return corners[lattice_index(patch, n, ij[0], ij[1])]; };
    grid.triangles.push_back({k, {at(a), at(b), at(c)}});
  };
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < (patch.triangle ? n - j : n); ++i) {
      add({i, j}, {i + 1, j}, {i, j + 1});
      if (!patch.triangle || i + j + 1 < n) add({i + 1, j}, {i + 1, j + 1}, {i, j + 1});
    }
  }
  take_sides_of_tips(placed, n, first_triangle, grid,
                     [&](std::uint32_t node, const glm::dvec3& normal) { return seam_side(node, normal, sides, grid); });
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
        if (a.node != b.node && on_side(placed.patches[grid.triangles[t].patch], a.uv, b.uv))
          uses[part].push_back({static_cast<std::uint32_t>(t), from});
      }
    }
  });
  for (const auto& part : uses) {
    for (const SeamUse& use : part)
      grid.seams[std::minmax(corner_of(use.triangle, use.from).node, corner_of(use.triangle, use.from + 1).node)].push_back(use);
  }
  const auto starts_at = [&](const SeamUse& use) { return grid.triangles[use.triangle].corners[static_cast<size_t>(use.from)].node; };
  grid.sheet = std::any_of(grid.seams.begin(), grid.seams.end(), [&](const auto& seam) {
    return seam.second.size() != 2 || starts_at(seam.second[0]) == starts_at(seam.second[1]);
  });
}

LimitBlock block_of(const LimitGrid& grid, std::uint32_t first, std::uint32_t end) {
  LimitBlock block{first, end};
  Box box;
  const auto for_sides = [&](const auto& visit) {
    for (std::uint32_t t = first; t < end; ++t) {
      for (const LimitCorner& corner : grid.triangles[t].corners) {
        visit(corner.side);
        if (corner.side_back != corner.side) visit(corner.side_back);
      }
    }
  };
  for_sides([&](std::uint32_t side) {
    box = include(box, grid.positions[grid.node_of_side[side]]);
    block.axis += grid.normals[side];
  });
  block.center = box.center();
  block.radius = box.radius();
  const double length = glm::length(block.axis);
  block.axis = length > 0.0 ? block.axis / length : glm::dvec3(0.0);
  double least = 1.0;
  for_sides([&](std::uint32_t side) { least = std::min(least, glm::dot(block.axis, grid.normals[side])); });
  // Cosines say little of small angles.
  block.angle = length > 0.0 ? std::acos(std::max(least, -1.0)) + kBlockSlack : std::numbers::pi;
  block.sine = std::sin(block.angle);
  block.cosine = std::cos(block.angle);
  return block;
}

std::vector<LimitBlock> blocks_of(const LimitGrid& grid) {
  std::vector<LimitBlock> blocks;
  const auto count = static_cast<std::uint32_t>(grid.triangles.size());
  for (std::uint32_t first = 0; first < count;) {
    std::uint32_t end = first + 1;
    while (end < std::min(first + kBlockTriangles, count) && grid.triangles[end].patch == grid.triangles[first].patch) ++end;
    blocks.push_back({first, end});
    first = end;
  }
  parallel_parts(blocks.size(), size_t{256}, [&](const IndexRange<size_t>& range) {
    for (size_t b = range.begin(); b < range.end(); ++b) blocks[b] = block_of(grid, blocks[b].first, blocks[b].end);
  });
  return blocks;
}

LimitSample sample_of(const PlacedLimitSurface& placed, size_t k, const glm::dvec2& uv, const LimitPoint& point) {
  LimitSample out;
  out.position = placed.world_from_cage.point(point.position);
  const bool mirrored = glm::determinant(placed.world_from_cage.linear) < 0.0;
  const auto normal_of = [&](const LimitPoint& at) {
    const glm::dvec3 cross = glm::cross(placed.world_from_cage.vector(at.du), placed.world_from_cage.vector(at.dv));
    return mirrored ? -cross : cross;
  };
  glm::dvec3 cross = normal_of(point);
  double length = glm::length(cross);
  if (!(length > 1e-12 * (glm::dot(point.du, point.du) + glm::dot(point.dv, point.dv)))) {
    const LimitPatch& patch = placed.patches[k];
    const glm::dvec2 in = inwards(patch, uv);
    LimitPoint inner = point;
    placed.surface.evaluate(patch.face, patch.sub_face, in.x, in.y, inner, LimitOrder::first);
    cross = normal_of(inner);
    length = glm::length(cross);
  }
  out.normal = cross / length;
  out.valid = has_normal(out.normal) && std::isfinite(out.position.x + out.position.y + out.position.z);
  return out;
}

SurfaceCurvature no_curvature() {
  SurfaceCurvature none;
  none.k1 = none.k2 = std::numeric_limits<double>::quiet_NaN();
  return none;
}

SurfaceCurvature placed_curvature(const PlacedLimitSurface& placed, const LimitPoint& p) {
  const Affine& map = placed.world_from_cage;
  LimitPoint moved{map.point(p.position), map.vector(p.du), map.vector(p.dv), map.vector(p.duu), map.vector(p.duv), map.vector(p.dvv)};
  if (glm::determinant(map.linear) < 0.0) {
    std::swap(moved.du, moved.dv);
    std::swap(moved.duu, moved.dvv);
  }
  return curvature(moved);
}

}  // namespace

PlacedLimitSurface place(const LimitSurface& surface, const Affine& world_from_cage) {
  PlacedLimitSurface placed{surface, world_from_cage, {}};
  for (int face = 0; face < surface.face_count(); ++face) {
    if (surface.is_hole(face)) continue;
    const bool sub_faces = surface.has_sub_faces(face);
    const int size = surface.face_size(face), parts = sub_faces ? size : 1;
    for (int part = 0; part < parts; ++part) placed.patches.push_back({face, part, sub_faces, size == 3 && !sub_faces});
  }
  return placed;
}

LimitSample sample(const PlacedLimitSurface& placed, size_t k, const glm::dvec2& uv) {
  const LimitPatch& patch = placed.patches[k];
  LimitPoint point;
  if (!placed.surface.evaluate(patch.face, patch.sub_face, uv.x, uv.y, point, LimitOrder::first)) return {};
  return sample_of(placed, k, uv, point);
}

CurvedLimitSample curved_sample(const PlacedLimitSurface& placed, size_t k, const glm::dvec2& uv) {
  const LimitPatch& patch = placed.patches[k];
  LimitPoint point;
  if (!placed.surface.evaluate(patch.face, patch.sub_face, uv.x, uv.y, point)) return {{}, no_curvature()};
  return {sample_of(placed, k, uv, point), placed_curvature(placed, point)};
}

SurfaceCurvature curvature_at(const PlacedLimitSurface& placed, size_t k, const glm::dvec2& uv) {
  const LimitPatch& patch = placed.patches[k];
  LimitPoint p;
  if (!placed.surface.evaluate(patch.face, patch.sub_face, uv.x, uv.y, p)) return no_curvature();
  return placed_curvature(placed, p);
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
  while (result.steps > 4 && triangles_of(placed, result.steps) > max_triangles) result.steps -= 2;
  result.cell_px = longest_px / result.steps;
  return result;
}

LimitGrid sample_grid(const PlacedLimitSurface& placed, const Camera& camera, int steps) {
  std::vector<PatchLattice> lattices(placed.patches.size());
  parallel_for(size_t{0}, placed.patches.size(),
               [&](size_t k) { lattices[k] = sample_lattice(placed, k, steps_of(placed.patches[k], steps)); });
  LimitGrid grid;
  size_t samples = 0;
  for (const PatchLattice& lattice : lattices) samples += lattice.samples.size();
  grid.positions.reserve(samples);
  grid.normals.reserve(samples);
  grid.node_of_side.reserve(samples);
  grid.triangles.reserve(static_cast<size_t>(triangles_of(placed, steps)));
  Places places(same_place(lattices));
  SidesOfNodes sides;
  for (size_t k = 0; k < lattices.size(); ++k) {
    if (!lattices[k].valid) {
      grid.invalid_patches.push_back(k);
      continue;
    }
    add_lattice(placed, static_cast<std::uint32_t>(k), lattices[k], places, sides, grid);
    grid.tip_px = std::max(grid.tip_px, tip_px(placed, k, lattices[k], camera));
  }
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
