#include "sdf/level_set.h"

#include <fmt/format.h>

#include <array>
#include <limits>

#include "sdf/error.h"
#include "sdf/level_set_data.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

using Leaf = nanovdb::FloatGrid::TreeType::LeafNodeType;
using Accessor = nanovdb::FloatGrid::AccessorType;

/// What one pass over the leaves finds out; merged by minima, maxima and sums, so that the order of the leaves does not matter.
struct Survey {
  std::int64_t active = 0;
  std::int64_t holes = 0;
  Box crossings;  ///< Index coordinates.
  double outside_width = std::numeric_limits<double>::infinity();
  double inside_width = std::numeric_limits<double>::infinity();
  double largest = 0.0;
  // Whole numbers, because their sum does not depend on the order: slopes per voxel at the surface, in 2^-20 of the background.
  std::int64_t slope_sum = 0;
  std::int64_t slope_count = 0;

  void join(const Survey& other) {
    active += other.active;
    holes += other.holes;
    crossings = merge(crossings, other.crossings);
    outside_width = std::min(outside_width, other.outside_width);
    inside_width = std::min(inside_width, other.inside_width);
    largest = std::max(largest, other.largest);
    slope_sum += other.slope_sum;
    slope_count += other.slope_count;
  }
};

/// A leaf with one layer of its neighbours around it, in node coordinates -1..8.
struct Neighbourhood {
  std::array<float, 1000> value;
  std::array<bool, 1000> active;
  static size_t index(int x, int y, int z) { return static_cast<size_t>(((x + 1) * 10 + y + 1) * 10 + z + 1); }

  Neighbourhood(const Leaf& leaf, const Accessor& accessor) {
    const nanovdb::Coord origin = leaf.origin();
    for (int x = -1; x <= 8; ++x)
      for (int y = -1; y <= 8; ++y)
        for (int z = -1; z <= 8; ++z) {
          const bool within = x >= 0 && x < 8 && y >= 0 && y < 8 && z >= 0 && z < 8;
          const auto n = static_cast<std::uint32_t>((x & 7) << 6 | (y & 7) << 3 | (z & 7));
          const nanovdb::Coord at = origin.offsetBy(x, y, z);
          value[index(x, y, z)] = within ? leaf.getValue(n) : accessor.getValue(at);
          active[index(x, y, z)] = within ? leaf.isActive(n) : accessor.isActive(at);
        }
  }
};

constexpr std::array<size_t, 3> kStride{100, 10, 1};

/// The distance at an inactive node next to an active one, carried on from inside the band: the width that the band really has there.
double width_beyond(const Neighbourhood& near, size_t active, size_t inactive) {
  const double value = std::abs(static_cast<double>(near.value[active]));
  const size_t opposite = 2 * active - inactive;
  if (opposite >= near.active.size() || !near.active[opposite]) return value;
  const double before = std::abs(static_cast<double>(near.value[opposite]));
  return std::max(value, 2.0 * value - before);
}

constexpr double kSlopeUnits = 1 << 20;

std::int64_t slope_at(const Neighbourhood& near, size_t here, double background) {
  double squared = 0.0;
  for (const size_t stride : kStride) {
    const double difference = 0.5 * (static_cast<double>(near.value[here + stride]) - static_cast<double>(near.value[here - stride]));
    squared += difference * difference;
  }
  return static_cast<std::int64_t>(kSlopeUnits * std::min(1000.0, std::sqrt(squared) / background));
}

void survey_node(const Neighbourhood& near, const glm::ivec3& local, const glm::dvec3& node, double background, Survey& found) {
  const size_t here = Neighbourhood::index(local.x, local.y, local.z);
  const bool negative = near.value[here] < 0.0f;
  for (int axis = 0; axis < 3; ++axis) {
    const size_t stride = kStride[static_cast<size_t>(axis)];
    const size_t next = here + stride;
    if (negative != (near.value[next] < 0.0f)) {
      const double a = static_cast<double>(near.value[here]), b = static_cast<double>(near.value[next]);
      glm::dvec3 crossing = node;
      crossing[axis] += a / (a - b);
      found.crossings = include(found.crossings, crossing);
      found.slope_sum += slope_at(near, here, background);
      ++found.slope_count;
    }
    // Cells are looked after by the leaf of their lowest node; where that is no leaf, nobody would see a change of sign.
    if (local[axis] == 0 && !near.active[here - stride] && negative != (near.value[here - stride] < 0.0f)) ++found.holes;
    if (!near.active[here]) continue;
    for (const size_t neighbour : {next, here - stride})
      if (!near.active[neighbour]) {
        double& width = negative ? found.inside_width : found.outside_width;
        width = std::min(width, width_beyond(near, here, neighbour));
      }
  }
}

bool is_hole(const Neighbourhood& near, size_t here) {
  bool any_negative = false, any_positive = false, all_active = true;
  for (int corner = 0; corner < 8; ++corner) {
    const size_t at = here + ((corner & 1) ? 100 : 0) + ((corner & 2) ? 10 : 0) + ((corner & 4) ? 1 : 0);
    (near.value[at] < 0.0f ? any_negative : any_positive) = true;
    all_active = all_active && near.active[at];
  }
  return any_negative && any_positive && !all_active;
}

Survey survey_leaf(const Leaf& leaf, const Accessor& accessor, double background) {
  Survey found;
  const Neighbourhood near(leaf, accessor);
  const nanovdb::Coord origin = leaf.origin();
  for (int x = 0; x < 8; ++x)
    for (int y = 0; y < 8; ++y)
      for (int z = 0; z < 8; ++z) {
        const size_t here = Neighbourhood::index(x, y, z);
        found.active += near.active[here] ? 1 : 0;
        if (near.active[here]) found.largest = std::max(found.largest, std::abs(static_cast<double>(near.value[here])));
        survey_node(near, {x, y, z}, glm::dvec3(origin[0] + x, origin[1] + y, origin[2] + z), background, found);
        found.holes += is_hole(near, here) ? 1 : 0;
      }
  return found;
}

Survey survey(const nanovdb::FloatGrid& grid) {
  const auto* leaves = grid.tree().getFirstNode<0>();
  const double background = static_cast<double>(grid.tree().background());
  return parallel_reduce(
      grid.tree().nodeCount(0), std::uint32_t{64}, Survey{},
      [&](const IndexRange<std::uint32_t>& range, Survey found) {
        const Accessor accessor = grid.getAccessor();
        for (std::uint32_t i = range.begin(); i < range.end(); ++i) found.join(survey_leaf(leaves[i], accessor, background));
        return found;
      },
      [](Survey a, const Survey& b) {
        a.join(b);
        return a;
      });
}

/// In voxels. Grids that were scaled after they were made, or that hold no true distances, are measured by their own slope at the
/// surface; a slope within a tenth of the voxel size is the voxel size. What the grid says of itself (its background) holds unless the
/// values at the band's edge say otherwise by half a voxel.
double measured_width(const Survey& found, double background, double voxel_size) {
  const double counted = static_cast<double>(std::max<std::int64_t>(found.slope_count, 1));
  const double slope = static_cast<double>(found.slope_sum) / counted / kSlopeUnits * background;
  const double per_voxel = slope > 0.0 && std::abs(slope / voxel_size - 1.0) > 0.1 ? slope : voxel_size;
  const double seen = std::min(found.outside_width, found.inside_width);
  const double measured = (std::isfinite(seen) ? seen : found.largest) / per_voxel;
  const double said = background / per_voxel;
  return measured > said - 0.5 ? said : measured;
}

}  // namespace

std::shared_ptr<LevelSetData> make_level_set(nanovdb::GridHandle<nanovdb::HostBuffer> handle, const Affine& world_from_index,
                                             const std::string& name, double nominal_half_width) {
  auto data = std::make_shared<LevelSetData>();
  data->handle = std::move(handle);
  data->grid = data->handle.grid<float>();
  LIMN_CHECK(data->grid != nullptr);
  data->index_from_world = inverse(world_from_index);

  const Survey found = survey(*data->grid);
  data->holes = found.holes;
  LevelSetInfo& info = data->info;
  info.name = name;
  info.world_from_index = world_from_index;
  const glm::dmat3& axes = world_from_index.linear;
  info.voxel_size = std::min({glm::length(axes[0]), glm::length(axes[1]), glm::length(axes[2])});
  info.active_voxels = found.active;
  info.bytes = static_cast<std::int64_t>(data->handle.size());
  info.bounds = transform(world_from_index, found.crossings);
  info.half_width_voxels = nominal_half_width > 0.0
                               ? nominal_half_width
                               : measured_width(found, static_cast<double>(data->grid->tree().background()), info.voxel_size);
  return data;
}

const LevelSetInfo& LevelSet::info() const { return data_->info; }

void check_half_width(const LevelSet& level_set, const GradientDescriptor& gradient, const std::string& file) {
  const double there = level_set.info().half_width_voxels;
  // A thousandth of a voxel: widths go through files and decimal fractions.
  if (there >= gradient.half_width_voxels - 1e-3) return;
  std::string suitable;
  for (const GradientDescriptor& other : gradients())
    if (there >= other.half_width_voxels - 1e-3) suitable += (suitable.empty() ? "" : ", ") + other.about.name;
  throw InputError({.file = file,
                    .field = "half width",
                    .value = fmt::format("{:.2f} voxels", there),
                    .problem = fmt::format("the narrow band is too thin for the gradient '{}'", gradient.about.name),
                    .expected = fmt::format("at least {:.2f} voxels on each side{}", gradient.half_width_voxels,
                                            suitable.empty() ? std::string{} : "; this band is enough for: " + suitable)});
}

void level_set_values(const LevelSet& level_set, std::span<const glm::dvec3> points, std::span<double> values) {
  LIMN_CHECK(points.size() == values.size());
  const LevelSetData& data = level_set.data();
  const auto accessor = data.accessor();
  for (size_t i = 0; i < points.size(); ++i) {
    const CellPoint at = cell_point(data.index_from_world.point(points[i]));
    const std::array<double, 8> v = cell_values(accessor, at.node);
    const auto along_x = [&](size_t corner) { return v[corner] + at.local.x * (v[corner + 1] - v[corner]); };
    const double low = along_x(0) + at.local.y * (along_x(2) - along_x(0));
    const double high = along_x(4) + at.local.y * (along_x(6) - along_x(4));
    values[i] = low + at.local.z * (high - low);
  }
}

}  // namespace limn
