// The zero surface of trilinear values, found slowly: every cell that a ray crosses near the surface, its cubic from four values, its
// first root between the cubic's extrema.

#include <unistd.h>

#include <array>
#include <cmath>
#include <filesystem>

#include "tests/bench/truth.h"
#include "tests/bench/vdb_grid.h"

namespace limn::bench {
namespace {

using Accessor = openvdb::FloatGrid::ConstUnsafeAccessor;

struct GridReader {
  openvdb::FloatGrid::Ptr grid;
  glm::dvec3 lower{0.0};  ///< World place of node (0, 0, 0).
  double voxel_size = 1.0;
  glm::dvec3 box_lower{0.0}, box_upper{0.0};  ///< Nodes of the band; index coordinates.

  glm::dvec3 index(const glm::dvec3& world) const { return (world - lower) / voxel_size; }
};

double node_value(const Accessor& accessor, const glm::ivec3& at) {
  return static_cast<double>(accessor.getValue(openvdb::Coord(at.x, at.y, at.z)));
}

template <class At>
auto trilinear(const At& at, const glm::dvec3& p, const glm::ivec3& cell) {
  const glm::dvec3 f = p - glm::dvec3(cell);
  auto sum = 0.0 * at(cell);
  for (int corner = 0; corner < 8; ++corner) {
    const glm::ivec3 offset(corner & 1, (corner >> 1) & 1, corner >> 2);
    const glm::dvec3 weights = glm::mix(1.0 - f, f, glm::dvec3(offset));
    sum += weights.x * weights.y * weights.z * at(cell + offset);
  }
  return sum;
}

double value_at(const Accessor& accessor, const glm::dvec3& p) {
  return trilinear([&](const glm::ivec3& node) { return node_value(accessor, node); }, p, glm::ivec3(glm::floor(p)));
}

glm::dvec3 gradient_at(const Accessor& accessor, const glm::dvec3& p) {
  const auto central = [&](const glm::ivec3& node) {
    glm::dvec3 g;
    for (int axis = 0; axis < 3; ++axis) {
      glm::ivec3 step(0);
      step[axis] = 1;
      g[axis] = node_value(accessor, node + step) - node_value(accessor, node - step);
    }
    return g;
  };
  return trilinear(central, p, glm::ivec3(glm::floor(p)));
}

/// First root in [0, 1] of the cubic through values at 0, 1/3, 2/3 and 1; negative: none. The ray is outside before.
double first_root(const std::array<double, 4>& v) {
  if (v[0] <= 0.0) return 0.0;
  // Newton's forward differences, as a polynomial of x = 3 s.
  const double d1 = v[1] - v[0], d2 = v[2] - 2.0 * v[1] + v[0], d3 = v[3] - 3.0 * v[2] + 3.0 * v[1] - v[0];
  const double c1 = d1 - d2 / 2.0 + d3 / 3.0, c2 = d2 / 2.0 - d3 / 2.0, c3 = d3 / 6.0;
  const auto value = [&](double x) { return v[0] + x * (c1 + x * (c2 + x * c3)); };
  std::array<double, 4> ends = {0.0, 3.0, 3.0, 3.0};
  size_t count = 1;
  const double root = c2 * c2 - 3.0 * c1 * c3;
  if (root > 0.0) {
    const double q = -(c2 + std::copysign(std::sqrt(root), c2));
    std::array<double, 2> extrema = {c3 != 0.0 ? q / (3.0 * c3) : -1.0, q != 0.0 ? c1 / q : -1.0};
    if (extrema[0] > extrema[1]) std::swap(extrema[0], extrema[1]);
    for (const double x : extrema)
      if (x > 0.0 && x < 3.0) ends[count++] = x;
  }
  ends[count] = 3.0;
  for (size_t part = 0; part < count; ++part) {
    double a = ends[part], b = ends[part + 1];
    if (value(b) > 0.0) continue;
    for (int step = 0; step < 60; ++step) (value(0.5 * (a + b)) > 0.0 ? a : b) = 0.5 * (a + b);
    return b / 3.0;
  }
  return -1.0;
}

/// Where a line enters and leaves a box; from > to: it does not.
std::pair<double, double> clip(const glm::dvec3& o, const glm::dvec3& d, const glm::dvec3& lower, const glm::dvec3& upper) {
  const glm::dvec3 a = (lower - o) / d, b = (upper - o) / d;
  const glm::dvec3 near = glm::min(a, b), far = glm::max(a, b);
  return {std::max({0.0, near.x, near.y, near.z}), std::min({far.x, far.y, far.z})};
}

/// The ray's root in the cell that it is in at t, or a negative number; moves t to where it leaves the cell.
double root_in_cell(const Accessor& accessor, const glm::dvec3& o, const glm::dvec3& d, double& t) {
  const glm::dvec3 inside = o + (t + 1e-7) * d;
  const glm::ivec3 cell(glm::floor(inside));
  double end = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    if (d[axis] == 0.0) continue;
    end = std::min(end, (cell[axis] + (d[axis] > 0.0 ? 1.0 : 0.0) - o[axis]) / d[axis]);
  }
  end = std::max(end, t + 1e-7);
  std::array<double, 4> values{};
  for (int k = 0; k < 4; ++k) {
    const glm::dvec3 p = o + (t + (end - t) * k / 3.0) * d;
    values[static_cast<size_t>(k)] = trilinear([&](const glm::ivec3& node) { return node_value(accessor, node); }, p, cell);
  }
  const double root = first_root(values), start = t;
  t = end;
  return root < 0.0 ? -1.0 : start + (end - start) * root;
}

TrueSurface::Hit first_hit(const GridReader& reader, const glm::dvec3& origin, const glm::dvec3& d) {
  const Accessor accessor(reader.grid->tree());
  const glm::dvec3 o = reader.index(origin);
  auto [t, last] = clip(o, d, reader.box_lower, reader.box_upper);
  while (t < last) {
    // Values grow by no more than 1 a voxel and the interpolation is off by less than one: nothing is stepped over.
    const double value = value_at(accessor, o + t * d) / reader.voxel_size;
    if (value > 2.0) {
      t += value - 1.5;
      continue;
    }
    const double root = root_in_cell(accessor, o, d, t);
    if (root < 0.0) continue;
    const glm::dvec3 gradient = gradient_at(accessor, o + root * d);
    return {root * reader.voxel_size, glm::normalize(gradient)};
  }
  return {};
}

Lowest lowest(const GridReader& reader, const glm::dvec3& origin, const glm::dvec3& d, double from, double to) {
  const Accessor accessor(reader.grid->tree());
  const glm::dvec3 o = reader.index(origin);
  const auto [first, last] = clip(o, d, reader.box_lower, reader.box_upper);
  Lowest best;
  const double end = std::min(last, to / reader.voxel_size);
  for (double t = std::max(first, from / reader.voxel_size); t <= end;) {
    const double value = value_at(accessor, o + t * d);
    if (value < best.value) best = {value, t * reader.voxel_size};
    t += std::max(0.02, 0.4 * std::fabs(value) / reader.voxel_size);
  }
  return best;
}

}  // namespace

openvdb::FloatGrid::Ptr openvdb_grid(const LevelSet& level_set) {
  openvdb::initialize();
  const std::filesystem::path file = std::filesystem::temp_directory_path() / ("limn-bench-" + std::to_string(::getpid()) + ".vdb");
  write_level_set(level_set, file);
  openvdb::io::File reader(file.string());
  reader.open(false);
  openvdb::GridBase::Ptr grid = reader.readGrid(reader.beginName().gridName());
  reader.close();
  std::filesystem::remove(file);
  return openvdb::gridPtrCast<openvdb::FloatGrid>(grid);
}

TrueSurface true_grid_surface(const LevelSet& level_set) {
  auto reader = std::make_shared<GridReader>();
  reader->grid = openvdb_grid(level_set);
  reader->voxel_size = level_set.info().voxel_size;
  reader->lower = level_set.info().world_from_index.point(glm::dvec3(0.0));
  const openvdb::CoordBBox box = reader->grid->evalActiveVoxelBoundingBox();
  reader->box_lower = glm::dvec3(box.min().x(), box.min().y(), box.min().z()) - 1.0;
  reader->box_upper = glm::dvec3(box.max().x(), box.max().y(), box.max().z()) + 1.0;
  return {[reader](const glm::dvec3& o, const glm::dvec3& d) { return first_hit(*reader, o, d); },
          [reader](const glm::dvec3& o, const glm::dvec3& d, double from, double to) { return lowest(*reader, o, d, from, to); }};
}

}  // namespace limn::bench
