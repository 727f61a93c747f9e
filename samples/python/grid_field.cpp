#include "samples/python/grid_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "sdf/error.h"
#include "sdf/field_from_functions.h"

namespace limn::python {
namespace {

struct Grid {
  GridSamples samples{};

  size_t index(int i, int j, int k) const {
    const auto wide = [](int value) { return static_cast<size_t>(value); };
    return (wide(i) * wide(samples.count.y) + wide(j)) * wide(samples.count.z) + wide(k);
  }
  double at(int i, int j, int k) const { return double{samples.values[index(i, j, k)]}; }

  /// The cell that holds a point, and its place in the cell, from 0 to 1.
  struct Place {
    glm::ivec3 cell{0};
    glm::dvec3 local{0.0};
    glm::bvec3 beyond{false};  ///< Clamped: nothing changes along that axis.
  };
  Place place(const glm::dvec3& p) const {
    Place place;
    for (int axis = 0; axis < 3; ++axis) {
      const double last = samples.count[axis] - 1;
      const double index = (p[axis] - samples.origin[axis]) / samples.spacing;
      const double inside = std::clamp(index, 0.0, last);
      place.beyond[axis] = inside != index;
      place.cell[axis] = std::min(static_cast<int>(inside), samples.count[axis] - 2);
      place.local[axis] = inside - place.cell[axis];
    }
    return place;
  }
  /// Bit 0 is z, bit 1 y, bit 2 x.
  std::array<double, 8> corners(const glm::ivec3& cell) const {
    std::array<double, 8> values;
    for (int corner = 0; corner < 8; ++corner)
      values[static_cast<size_t>(corner)] = at(cell.x + (corner >> 2), cell.y + ((corner >> 1) & 1), cell.z + (corner & 1));
    return values;
  }
  double value(const glm::dvec3& p) const {
    const Place at = place(p);
    const std::array<double, 8> v = corners(at.cell);
    const auto mix = [](double a, double b, double t) { return a + t * (b - a); };
    const double y0 = mix(mix(v[0], v[1], at.local.z), mix(v[2], v[3], at.local.z), at.local.y);
    const double y1 = mix(mix(v[4], v[5], at.local.z), mix(v[6], v[7], at.local.z), at.local.y);
    return mix(y0, y1, at.local.x);
  }
  glm::dvec3 gradient(const glm::dvec3& p) const {
    const Place at = place(p);
    const std::array<double, 8> v = corners(at.cell);
    glm::dvec3 gradient(0.0);
    for (int corner = 0; corner < 8; ++corner) {
      const glm::ivec3 side(corner >> 2, (corner >> 1) & 1, corner & 1);
      for (int axis = 0; axis < 3; ++axis) {
        if (at.beyond[axis]) continue;
        double weight = side[axis] == 1 ? 1.0 : -1.0;
        for (int other = 0; other < 3; ++other)
          if (other != axis) weight *= side[other] == 1 ? at.local[other] : 1.0 - at.local[other];
        gradient[axis] += weight * v[static_cast<size_t>(corner)];
      }
    }
    return gradient / samples.spacing;
  }
  /// Holds the interpolant over the box: the least and the greatest sample of the cells that it meets.
  Interval bounds(const Box& box) const {
    const auto corner = [this](const glm::dvec3& p) { return place(glm::clamp(p, glm::dvec3(-1e300), glm::dvec3(1e300))).cell; };
    const glm::ivec3 first = corner(box.lower), last = corner(box.upper) + 1;
    constexpr std::int64_t kMost = 4096;
    const glm::i64vec3 span = glm::i64vec3(last) - glm::i64vec3(first) + std::int64_t{1};
    if (span.x * span.y * span.z > kMost) return {};
    Interval found{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (int i = first.x; i <= last.x; ++i)
      for (int j = first.y; j <= last.y; ++j)
        for (int k = first.z; k <= last.z; ++k) {
          found.lower = std::min(found.lower, at(i, j, k));
          found.upper = std::max(found.upper, at(i, j, k));
        }
    // The interpolant's own rounding.
    const double rounding = 1e-14 * std::max(std::fabs(found.lower), std::fabs(found.upper));
    return {found.lower - rounding, found.upper + rounding};
  }
  /// No gradient of the interpolant is longer: in each cell a derivative is a mean of differences along its axis.
  double steepest() const {
    double most = 0.0;
    for (int i = 0; i + 1 < samples.count.x; ++i)
      for (int j = 0; j + 1 < samples.count.y; ++j)
        for (int k = 0; k + 1 < samples.count.z; ++k) {
          const std::array<double, 8> v = corners({i, j, k});
          glm::dvec3 largest(0.0);
          for (size_t corner = 0; corner < 8; ++corner)
            for (int axis = 0; axis < 3; ++axis) {
              const size_t other = corner ^ (size_t{4} >> axis);
              largest[axis] = std::max(largest[axis], std::fabs(v[corner] - v[other]));
            }
          most = std::max(most, glm::dot(largest, largest));
        }
    return std::sqrt(most) / samples.spacing;
  }
};

bool on_face(const glm::ivec3& at, const glm::ivec3& count) {
  return at.x == 0 || at.y == 0 || at.z == 0 || at.x == count.x - 1 || at.y == count.y - 1 || at.z == count.z - 1;
}

void check_faces(const Grid& grid) {
  const glm::ivec3& count = grid.samples.count;
  for (int i = 0; i < count.x; ++i)
    for (int j = 0; j < count.y; ++j)
      for (int k = 0; k < count.z; ++k)
        if (on_face({i, j, k}, count) && !(grid.at(i, j, k) > 0.0))
          throw InputError({"", "values", fmt::format("{}", grid.at(i, j, k)),
                            fmt::format("the surface reaches the grid's faces, at index ({}, {}, {})", i, j, k),
                            "a grid that goes on until all values are above 0"});
}

}  // namespace

Field field_from_grid(GridSamples samples) {
  const auto grid = std::make_shared<const Grid>(Grid{std::move(samples)});
  check_faces(*grid);
  const glm::dvec3 far = grid->samples.origin + grid->samples.spacing * glm::dvec3(grid->samples.count - 1);
  return field_from_functions({.value = [grid](const glm::dvec3& p) { return grid->value(p); },
                               .gradient = [grid](const glm::dvec3& p) { return grid->gradient(p); },
                               .bounds = [grid](const Box& box) { return grid->bounds(box); },
                               // A slope of 0 bounds nothing.
                               .lipschitz = std::max(grid->steepest(), 1e-12),
                               .extent = {grid->samples.origin, far}});
}

}  // namespace limn::python
