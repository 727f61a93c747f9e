#include "raymarch/surface/cell_distances.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sdf/field_program.h"

namespace limn {
namespace {

/// Fields of fewer shapes are evaluated as fast as their cells are told apart.
constexpr size_t kManyShapes = 6;
/// Along the box's longest side, for each shape along it, were they spread evenly.
constexpr double kCellsForAShape = 4.0, kFewestCells = 16.0, kMostCells = 32.0;
/// A cell holds a few kilobytes; beyond so many all are made anew.
constexpr size_t kMostKept = 4096;

}  // namespace

CellDistances::CellDistances(const Field& field, const Box& box) : whole_(field), box_(box) {
  const size_t shapes = field.program().leaves.size();
  if (shapes < kManyShapes || box.empty() || !box.finite() || !(box.longest_side() > 0.0)) return;
  side_ = box.longest_side() / std::clamp(std::floor(kCellsForAShape * std::cbrt(shapes)), kFewestCells, kMostCells);
  count_ = glm::max(glm::ivec3(glm::ceil(box.size() / side_)), glm::ivec3(1));
  is_whole_.resize(static_cast<size_t>(count_.x) * static_cast<size_t>(count_.y) * static_cast<size_t>(count_.z));
}

std::uint32_t CellDistances::cell_of(const glm::dvec3& point) const {
  if (count_.x == 0) return kWhole;
  const glm::dvec3 at = (point - box_.lower) / side_;
  if (!(glm::all(glm::greaterThanEqual(at, glm::dvec3(0.0))) && glm::all(glm::lessThan(at, glm::dvec3(count_))))) return kWhole;
  const glm::ivec3 place(at);
  const auto cell = static_cast<std::uint32_t>((place.x * count_.y + place.y) * count_.z + place.z);
  return is_whole_[cell] ? kWhole : cell;
}

DistanceEvaluator& CellDistances::distance_in(std::uint32_t cell) {
  if (cell == kWhole) return whole_;
  if (const auto known = cells_.find(cell); known != cells_.end()) return known->second;
  if (cells_.size() == kMostKept) cells_.clear();
  const auto number = static_cast<int>(cell);
  const glm::ivec3 place(number / (count_.y * count_.z), number / count_.z % count_.y, number % count_.z);
  const glm::dvec3 lower = box_.lower + side_ * glm::dvec3(place);
  // Wider by more than rounding moves a point across a side.
  const Box box = dilate({lower, lower + side_}, 1e-9 * (side_ + glm::length(glm::max(glm::abs(box_.lower), glm::abs(box_.upper)))));
  const Field part = whole_.evaluator.restricted(box);
  if (&part.program() == &whole_.evaluator.field().program()) {
    is_whole_[cell] = true;
    return whole_;
  }
  DistanceEvaluator distance(part);
  distance.projects = &whole_.evaluator;
  return cells_.emplace(cell, std::move(distance)).first->second;
}

void CellDistances::find_in(std::uint32_t cell, const LanePoints& points, double half_width, LaneNumbers& distances) {
  DistanceEvaluator& distance = distance_in(cell);
  std::swap(distance.scratch, scratch_);
  signed_distances(distance, points, half_width, distances);
  std::swap(distance.scratch, scratch_);
}

void CellDistances::find(const LanePoints& points, double half_width, LaneNumbers& distances) {
  if (count_.x == 0) return find_in(kWhole, points, half_width, distances);
  std::array<std::pair<std::uint32_t, std::uint32_t>, kMostLanePoints> order;
  bool is_one = true;
  for (size_t i = 0; i < points.count; ++i) {
    order[i] = {cell_of(points.point(i)), static_cast<std::uint32_t>(i)};
    is_one = is_one && order[i].first == order[0].first;
  }
  if (is_one) return points.count > 0 ? find_in(order[0].first, points, half_width, distances) : void();
  const auto end = order.begin() + static_cast<std::ptrdiff_t>(points.count);
  std::sort(order.begin(), end);
  LanePoints own;
  LaneNumbers found;
  for (auto first = order.begin(); first != end;) {
    const auto next = std::find_if(first, end, [cell = first->first](const auto& entry) { return entry.first != cell; });
    own.count = 0;
    for (auto entry = first; entry != next; ++entry) own.add(points.point(entry->second));
    own.fill_up();
    find_in(first->first, own, half_width, found);
    for (auto entry = first; entry != next; ++entry) distances[entry->second] = found[static_cast<size_t>(entry - first)];
    first = next;
  }
}

FieldJet CellDistances::jet(const glm::dvec3& point) { return distance_in(cell_of(point)).evaluator.jet(point); }

}  // namespace limn
