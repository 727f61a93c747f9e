#include "sdf/level_set_reconstruction.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "sdf/field_program.h"
#include "sdf/gradients/hull_lanes.h"
#include "sdf/gradients/spline_blocks.h"
#include "sdf/gradients/spline_edges.h"
#include "sdf/gradients/spline_jet.h"
#include "sdf/level_set_data.h"
#include "sdf/number_interval.h"

namespace limn {
namespace {

/// Coefficients of the cells that a thread looked at last: putting them together takes longer than a value.
struct CellCache {
  struct Entry {
    nanovdb::Coord node{std::numeric_limits<int>::max(), 0, 0};
    SplineCoefficients coefficients{};
  };
  std::vector<Entry> entries{kCells};

  static constexpr size_t kCells = 512;
  static size_t place_of(const nanovdb::Coord& node) {
    const auto part = [&](nanovdb::Coord::IndexType axis) { return static_cast<size_t>(static_cast<std::uint32_t>(node[axis])) & 7u; };
    return part(0) * 64 + part(1) * 8 + part(2);
  }
};

struct Spline {
  LevelSet level_set;
  std::shared_ptr<const SplineBlocks> blocks = std::make_shared<const SplineBlocks>(level_set.data());
  std::shared_ptr<tbb::enumerable_thread_specific<CellCache>> caches = std::make_shared<tbb::enumerable_thread_specific<CellCache>>();
  /// One factor leads to index coordinates.
  bool is_uniform = level_set.data().index_from_world.linear == glm::dmat3(level_set.data().index_from_world.linear[0][0]);

  const SplineCoefficients& coefficients_at(const nanovdb::Coord& node) const {
    CellCache::Entry& entry = caches->local().entries[CellCache::place_of(node)];
    if (entry.node != node) {
      entry.coefficients = blocks->cell(node);
      entry.node = node;
    }
    return entry.coefficients;
  }
  double value(const glm::dvec3& p) const {
    const CellPoint at = cell_point(level_set.data().index_from_world.point(p));
    return spline_value(coefficients_at(at.node), at.local);
  }
  FieldJet slope(const glm::dvec3& p) const {
    const LevelSetData& data = level_set.data();
    const CellPoint at = cell_point(data.index_from_world.point(p));
    // The Hessian costs less in lanes than slopes alone one by one.
    FieldJet jet = spline_jet(coefficients_at(at.node), at.local);
    jet.gradient = data.world_gradient(jet.gradient);
    return jet;
  }
  /// By coordinates of which the place is a linear function: the chain rule for it and for index coordinates at once.
  FieldJet jet(const glm::dvec3& place, const glm::dmat3& motion) const {
    const Affine& index_from_world = level_set.data().index_from_world;
    const CellPoint at = cell_point(index_from_world.point(place));
    const FieldJet by_index = spline_jet(coefficients_at(at.node), at.local);
    const glm::dvec3& g = by_index.gradient;
    const glm::dmat3& h = by_index.hessian;
    // Most level sets' axes are the world's: what is left of the chain rule then, to the bit.
    if (is_uniform && motion == glm::dmat3(1.0)) {
      const double scale = index_from_world.linear[0][0];
      return {by_index.value, g * scale, {scale * (h[0] * scale), scale * (h[1] * scale), scale * (h[2] * scale)}};
    }
    const glm::dmat3 index_from = index_from_world.linear * motion, turned = h * index_from;
    const auto second = [&](int a, int b) { return glm::dot(index_from[a], turned[b]); };
    const double xy = second(0, 1), xz = second(0, 2), yz = second(1, 2);
    return {by_index.value, g * index_from, {second(0, 0), xy, xz, xy, second(1, 1), yz, xz, yz, second(2, 2)}};
  }
  Jet jet(const Jet& x, const Jet& y, const Jet& z) const {
    glm::dmat3 motion;
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<size_t>(axis);
      motion[axis] = {x.gradient[a], y.gradient[a], z.gradient[a]};
    }
    const FieldJet jet = this->jet({x.value, y.value, z.value}, motion);
    const glm::dvec3& g = jet.gradient;
    const glm::dmat3& h = jet.hessian;
    return {jet.value, {g.x, g.y, g.z}, {h[0][0], h[1][0], h[2][0], h[1][1], h[2][1], h[2][2]}};
  }
};

template <class T>
glm::dvec3 point_of(const T* x, const T* y, const T* z, size_t i) {
  return {static_cast<double>(value_of(x[i])), static_cast<double>(value_of(y[i])), static_cast<double>(value_of(z[i]))};
}

template <class T>
void evaluate(const void* shape, const T* x, const T* y, const T* z, T* values, size_t count) {
  const auto& spline = *static_cast<const Spline*>(shape);
  for (size_t i = 0; i < count; ++i) {
    if constexpr (std::is_same_v<T, Interval>) {
      values[i] = {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    } else if constexpr (std::is_same_v<T, Slope>) {
      const Interval all{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
      values[i] = {all, all};
    } else if constexpr (std::is_same_v<T, BoxSlope>) {
      const Interval all{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
      values[i] = {all, {{all, all, all}}};
    } else {
      const glm::dvec3 p = point_of(x, y, z, i);
      if constexpr (std::is_floating_point_v<T>) {
        values[i] = static_cast<T>(spline.value(p));
      } else if constexpr (std::is_same_v<T, Jet>) {
        values[i] = spline.jet(x[i], y[i], z[i]);
      } else {
        const FieldJet jet = spline.slope(p);
        // The chain rule through a rigid motion, which the leaf applies: x, y and z carry its derivatives.
        T sum = scaled(x[i], jet.gradient.x, jet.value);
        const auto add = [&](const T& coordinate, double slope) { sum = combination(sum, 1.0, coordinate, slope, jet.value); };
        add(y[i], jet.gradient.y);
        add(z[i], jet.gradient.z);
        values[i] = sum;
      }
    }
  }
}

FieldJet jet(const void* shape, const glm::dvec3& place, const glm::dmat3& object_from_world) {
  return static_cast<const Spline*>(shape)->jet(place, object_from_world);
}

double support(const void* shape, const glm::dvec3& direction, double level) {
  const Box box = dilate(static_cast<const Spline*>(shape)->level_set.info().bounds, std::max(level, 0.0));
  if (box.empty()) return -std::numeric_limits<double>::infinity();
  double sum = 0.0;
  for (int i = 0; i < 3; ++i) {
    if (direction[i] != 0.0) sum += direction[i] * (direction[i] > 0.0 ? box.upper[i] : box.lower[i]);
  }
  return sum;
}

}  // namespace

std::vector<SurfaceCell> SplineCells::that_may_hold_contours(std::span<const SurfaceCell> cells, const glm::dvec3& eye, double w) const {
  std::vector<SurfaceCell> kept;
  SplineBlocks::Reader reader(*blocks_);
  HullCells hulls;
  WaysToTarget ways;
  for (size_t begin = 0; begin < cells.size(); begin += kHullCells) {
    hulls.count = std::min(kHullCells, cells.size() - begin);
    for (size_t k = 0; k < hulls.count; ++k) {
      const glm::ivec3& node = cells[begin + k].node;
      reader.read({node.x, node.y, node.z}, &hulls.coefficients[0][k], kHullCells);
      const glm::dvec3 way = eye - w * glm::dvec3(node);
      for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<size_t>(axis);
        ways.from_low[a][k] = static_cast<float>(way[axis]);
        ways.from_high[a][k] = static_cast<float>(way[axis] - w);
      }
    }
    for (CellBits rest = may_turn_from(hulls, ways); rest != 0; rest &= rest - 1)
      kept.push_back(cells[begin + static_cast<size_t>(std::countr_zero(rest))]);
  }
  return kept;
}

struct SplineCellReader::State {
  explicit State(const LevelSetData& read, const SplineBlocks& blocks) : data(read), reader(blocks) {}

  const LevelSetData& data;
  SplineBlocks::Reader reader;
  SplineCoefficients coefficients{};
  std::array<double, 8> corners{};
};

SplineCellReader::SplineCellReader(const SplineCells& cells) : state_(std::make_unique<State>(cells.level_set_.data(), *cells.blocks_)) {}
SplineCellReader::~SplineCellReader() = default;

void SplineCellReader::read(const glm::ivec3& node) {
  SplineCoefficients& c = state_->coefficients;
  state_->reader.read({node.x, node.y, node.z}, c.data(), 1);
  // At a node three of four weights are left along each axis.
  const auto sum = [](double before, double at, double after) { return (1.0 / 6.0) * (before + after) + (2.0 / 3.0) * at; };
  std::array<double, 32> along_z{};
  for (size_t i = 0; i < 16; ++i) {
    for (size_t z = 0; z < 2; ++z) along_z[2 * i + z] = sum(c[4 * i + z], c[4 * i + z + 1], c[4 * i + z + 2]);
  }
  for (size_t corner = 0; corner < 8; ++corner) {
    const size_t x = corner & 1u, y = corner >> 1u & 1u, z = corner >> 2u;
    const auto row = [&](size_t i, size_t j) { return along_z[2 * (4 * (x + i) + y + j) + z]; };
    const auto plane = [&](size_t i) { return sum(row(i, 0), row(i, 1), row(i, 2)); };
    state_->corners[corner] = sum(plane(0), plane(1), plane(2));
  }
}

std::array<double, 8> SplineCellReader::corner_values() const { return state_->corners; }

void SplineCellReader::find_on_edges(std::span<const CellEdge> edges, double close, std::span<EdgePoint> points) const {
  EdgesOfCell lanes;
  EdgeRoots roots;
  for (size_t first = 0; first < edges.size(); first += kEdgeLanes) {
    lanes.count = std::min(kEdgeLanes, edges.size() - first);
    for (size_t k = 0; k < lanes.count; ++k) {
      const auto [from, to] = edges[first + k];
      lanes.at_start[k] = state_->corners[from];
      lanes.at_end[k] = state_->corners[to];
      for (unsigned axis = 0; axis < 3; ++axis) {
        const double start = from >> axis & 1u, end = to >> axis & 1u;
        lanes.from[axis][k] = start;
        lanes.way[axis][k] = end - start;
      }
    }
    find_roots(state_->coefficients, lanes, close, roots);
    for (size_t k = 0; k < lanes.count; ++k) {
      const glm::dvec3 gradient(roots.gradient[0][k], roots.gradient[1][k], roots.gradient[2][k]);
      points[first + k] = {(roots.found >> k & 1u) != 0, roots.share[k], state_->data.world_gradient(gradient)};
    }
  }
}

Reconstruction reconstruct(const LevelSet& level_set) {
  static constexpr ShapeFunctions functions{
      {evaluate<float>, evaluate<double>, evaluate<Dual>, evaluate<Jet>, evaluate<Interval>, evaluate<Slope>, evaluate<BoxSlope>},
      support,
      nullptr,
      nullptr,
      nullptr,
      nullptr,
      nullptr,
      jet};
  FieldLeaf leaf;
  const auto spline = std::make_shared<const Spline>(Spline{complete_band(level_set, find_gradient("cubic"))});
  leaf.shape = spline;
  leaf.functions = &functions;
  return {field_from_leaf(std::move(leaf), false), spline->level_set, SplineCells(spline->level_set, spline->blocks)};
}

}  // namespace limn
