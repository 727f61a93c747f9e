#include "sdf/level_set_cubes.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "sdf/error.h"
#include "sdf/field_restriction.h"
#include "sdf/memory_text.h"
#include "sdf/number.h"
#include "sdf/number_interval.h"
#include "sdf/parallel.h"
#include "sdf/size_error.h"

namespace limn {
namespace {

/// What a block costs: NanoVDB's leaf with its share of the nodes above, and about as much for the build's lists and for what rays read.
constexpr std::int64_t kBlockBytes = 2 * 2152;

Box nodes_of(const BandCube& cube, const BandLattice& lattice) {
  return {lattice.node(cube.origin), lattice.node(cube.origin + (cube.size - 1))};
}

/// Where the cube's field may be asked: the band about its nodes, and what the search for thin places looks at beside the surface in it.
Box reach_of(const BandCube& cube, const BandLattice& lattice) {
  return dilate(nodes_of(cube, lattice), lattice.half_width + 4.0 * lattice.h);
}

/// The largest value, either way, of which a build asks more than its sign: what find_band_nodes() takes to reach the far corner of a
/// sixteenth of a block, and some room for rounding.
double exact_within(const Field& field, const BandLattice& lattice) {
  return std::max(field.traits().lipschitz, 1.0) * (lattice.half_width + 3.0 * lattice.h);
}

bool is_beyond(const Interval& values, const BandCube& cube, const BandLattice& lattice) {
  const double limit = cube.lipschitz * lattice.half_width;
  return values.lower > limit || values.upper < -limit;
}

/// False only where no node of the cube lies within the half width of the surface.
bool may_hold_band(FieldEvaluator& evaluator, const BandLattice& lattice, const BandCube& cube) {
  const FieldTraits& traits = evaluator.field().traits();
  const Box nodes = nodes_of(cube, lattice);
  const Box reach = dilate(nodes, lattice.half_width);
  if (intersect(reach, traits.bounds).empty() || is_beyond(evaluator.bounds(nodes), cube, lattice)) return false;
  return evaluator.bounds(reach).contains(0.0);
}

/// How steep a formula is at most says little of places where it is less so: by bounds of the gradient of the cube's own field in its
/// reach. Where these have told nothing new for some halvings, as of distances, they are not asked for any more. False as of
/// may_hold_band().
bool narrow_slope(FieldEvaluator& outer, const BandLattice& lattice, BandCube& cube) {
  constexpr double kWorthIt = 0.8;
  std::optional<FieldEvaluator> own;
  if (&cube.field.program() != &outer.field().program()) own.emplace(cube.field);
  FieldEvaluator& evaluator = own ? *own : outer;
  const Box nodes = nodes_of(cube, lattice);
  const auto [x, y, z] = evaluator.gradient_bounds(dilate(nodes, lattice.half_width)).gradient;
  const double steepest = norm(x, y, z).upper;
  cube.tries = steepest < kWorthIt * cube.lipschitz ? BandCube::kNarrowed : cube.tries - 1;
  if (!(steepest > 0.0 && steepest < cube.lipschitz)) return true;
  cube.lipschitz = steepest;
  return !is_beyond(evaluator.bounds(nodes), cube, lattice);
}

/// Refused before the memory is taken. Halving the cubes multiplies those on a surface by four.
void check_size(size_t cubes, int size, const LevelSetSettings& settings) {
  if (static_cast<double>(cubes) * static_cast<double>(kBlockBytes) <= static_cast<double>(settings.max_bytes)) return;
  const int blocks_along = size / kLevelSetBlock;
  const double blocks = static_cast<double>(cubes) * blocks_along * blocks_along;
  const double bytes = blocks * static_cast<double>(kBlockBytes);
  const double factor = std::sqrt(bytes / static_cast<double>(settings.max_bytes));
  throw SizeError({{},
                   "voxel size",
                   fmt::format("{:.4g}", settings.voxel_size),
                   fmt::format("building the level set needs about {} of memory, the limit is {}", memory_text(bytes),
                               memory_text(static_cast<double>(settings.max_bytes))),
                   fmt::format("a voxel size of about {:.2g} or more", settings.voxel_size * factor * 1.05)});
}

/// The octants that may hold a part of the band. Each passes its shortened field on to its own octants.
std::vector<BandCube> split(const std::vector<BandCube>& cubes, const BandLattice& lattice) {
  std::vector<std::vector<BandCube>> kept(cubes.size());
  parallel_for(size_t{0}, cubes.size(), [&](size_t i) {
    FieldEvaluator evaluator(cubes[i].field);
    const int half = cubes[i].size / 2;
    for (int octant = 0; octant < 8; ++octant) {
      BandCube child = cubes[i];
      child.origin += half * glm::ivec3(octant & 1, (octant >> 1) & 1, octant >> 2);
      child.size = half;
      if (!may_hold_band(evaluator, lattice, child)) continue;
      child.field = restricted_near_surface(cubes[i].field, reach_of(child, lattice), exact_within(cubes[i].field, lattice));
      if (child.tries > 0 && !narrow_slope(evaluator, lattice, child)) continue;
      kept[i].push_back(std::move(child));
    }
  });
  std::vector<BandCube> result;
  for (std::vector<BandCube>& children : kept) std::move(children.begin(), children.end(), std::back_inserter(result));
  return result;
}

}  // namespace

std::vector<BandCube> band_blocks(const Field& field, const BandLattice& lattice, const LevelSetSettings& settings) {
  const Box& bounds = field.traits().bounds;
  const Box reach = dilate(bounds, lattice.half_width + lattice.h);
  const glm::dvec3 lower = glm::floor((reach.lower - lattice.origin) / lattice.h / double{kLevelSetBlock});
  const glm::dvec3 upper = glm::ceil((reach.upper - lattice.origin) / lattice.h / double{kLevelSetBlock});
  const glm::dvec3 extent = upper - lower;
  const double longest = std::max({extent.x, extent.y, extent.z, 1.0});
  if (longest > double{1 << 25})
    throw InputError({.file = {},
                      .field = "voxel size",
                      .value = fmt::format("{:.4g}", settings.voxel_size),
                      .problem = fmt::format("{:.3g} voxels along the longest side", longest * kLevelSetBlock),
                      .expected = fmt::format("above {:.2g}", bounds.longest_side() * 1e-8)});
  int size = kLevelSetBlock;
  while (size < longest * kLevelSetBlock) size *= 2;
  std::vector<BandCube> cubes{{kLevelSetBlock * glm::ivec3(lower), size, field, field.traits().lipschitz}};
  while (!cubes.empty() && cubes.front().size > kLevelSetBlock) {
    cubes = split(cubes, lattice);
    check_size(cubes.size(), cubes.empty() ? kLevelSetBlock : cubes.front().size, settings);
  }
  return cubes;
}

}  // namespace limn
