#include "sdf/vm/extent.h"

#include <algorithm>
#include <array>
#include <queue>
#include <span>

namespace limn::vm {
namespace {

// Boxes looked at for each of six directions, twice: in all of space and then within what was found. Fewer for long programs.
int most_boxes(const RegisterProgram& program) {
  return static_cast<int>(std::clamp<size_t>(1'500'000 / program.steps.size(), 300, 20'000));
}

/// Evaluates over boxes and at points, keeping its memory.
class Evaluator {
 public:
  explicit Evaluator(const RegisterProgram& program) : program_(program) {}

  /// Of a box and its halves along three axes at most.
  static constexpr size_t kMostBoxes = 6;
  void over(std::span<const Box> boxes, std::span<Interval> values) {
    Interval at[3][kMostBoxes];
    for (size_t k = 0; k < boxes.size(); ++k)
      for (int axis = 0; axis < 3; ++axis) at[axis][k] = {boxes[k].lower[axis], boxes[k].upper[axis]};
    run(program_, at[0], at[1], at[2], values.data(), boxes.size(), intervals_);
    for (Interval& value : values) value = checked(value);
  }
  double at(const glm::dvec3& p) {
    double value = 0.0;
    run(program_, &p.x, &p.y, &p.z, &value, 1, numbers_);
    return value;
  }
  /// Bounds of the derivative along an axis.
  Interval slope(const Box& box, int axis) {
    Slope p[3];
    for (int i = 0; i < 3; ++i) p[i] = {{box.lower[i], box.upper[i]}, i == axis ? Interval{1.0, 1.0} : Interval{0.0, 0.0}};
    Slope value;
    run(program_, &p[0], &p[1], &p[2], &value, 1, slopes_);
    return checked(value).slope;
  }

 private:
  const RegisterProgram& program_;
  std::vector<Interval> intervals_;
  std::vector<double> numbers_;
  std::vector<Slope> slopes_;
};

struct Candidate {
  Box box;
  double reach = 0.0;  ///< How far it lies in the direction looked at.
  double deficit = 0.0;
  bool operator<(const Candidate& other) const { return reach < other.reach; }
};

/// Where a long stretch is cut: towards 0, since what there is may be of any size, with the far part by itself, which most often is empty.
double cut_of(double lower, double upper) {
  if (lower < 0.0 && upper > 0.0) return upper > -lower ? upper / 8.0 : lower / 8.0;
  const double low = std::min(std::fabs(lower), std::fabs(upper)), high = std::max(std::fabs(lower), std::fabs(upper));
  const double size = low > 0.0 && high > 4.0 * low ? std::sqrt(low * high) : low > 0.0 ? 0.5 * (low + high) : high / 8.0;
  return upper > 0.0 ? size : -size;
}

struct Search {
  Evaluator& evaluator;
  const bool* reads_axis;
  double level;
  int axis;
  bool upwards;
  int most_boxes;

  double reach(const Box& box) const { return upwards ? box.upper[axis] : -box.lower[axis]; }

  double longest_side(const Box& box) const {
    double side = 0.0;
    for (int i = 0; i < 3; ++i) {
      if (reads_axis[i]) side = std::max(side, box.upper[i] - box.lower[i]);
    }
    return side;
  }
  /// How far the bounds over boxes lie below the level; 0: one holds nothing.
  void deficits(std::span<const Box> boxes, double* to) const {
    std::array<Interval, Evaluator::kMostBoxes> values;
    evaluator.over(boxes, std::span(values).first(boxes.size()));
    for (size_t k = 0; k < boxes.size(); ++k) to[k] = std::min(std::max(level - values[k].lower, 0.0), 1e200);
  }

  /// A box in two, with the deficits of both.
  struct Halves {
    Box box[2]{};
    double deficit[2] = {kInfinity, kInfinity};
    double sum() const { return deficit[0] + deficit[1]; }
  };
  /// Along the longest side if that tells something; else where it tells most: a long side counts for nothing where the value hardly
  /// depends on it.
  Halves best_halves(const Candidate& candidate) const {
    constexpr double kTelling = 0.75;
    // All halves are asked together: reading the program's steps takes longer than a bound.
    std::array<Box, Evaluator::kMostBoxes> boxes;
    std::array<double, Evaluator::kMostBoxes> found;
    size_t count = 0;
    for (int i = 0; i < 3; ++i) {
      if (!reads_axis[i]) continue;
      boxes[count] = boxes[count + 1] = candidate.box;
      boxes[count].upper[i] = boxes[count + 1].lower[i] = cut_of(candidate.box.lower[i], candidate.box.upper[i]);
      count += 2;
    }
    deficits(std::span(boxes).first(count), found.data());
    Halves best, longest;
    double side = -1.0;
    size_t at = 0;
    for (int i = 0; i < 3; ++i) {
      if (!reads_axis[i]) continue;
      const Halves halves{{boxes[at], boxes[at + 1]}, {found[at], found[at + 1]}};
      at += 2;
      if (halves.sum() < best.sum()) best = halves;
      const double length = candidate.box.upper[i] - candidate.box.lower[i];
      if (length > side) longest = halves, side = length;
    }
    const double enough = kTelling * 2.0 * candidate.deficit;
    return longest.sum() <= enough || best.sum() > enough ? longest : best;
  }

  /// How far anything reaches at most; -infinity where there is nothing. `outside`: a point was found close to the region's end.
  double run(const Box& region, double tolerance, bool& outside) const {
    std::priority_queue<Candidate> queue;
    double first = 0.0;
    deficits(std::span(&region, 1), &first);
    if (first > 0.0) queue.push({region, reach(region), first});
    for (int looked = 0; !queue.empty(); ++looked) {
      const Candidate farthest = queue.top();
      if (farthest.reach >= kFarthest) {
        const glm::dvec3 p = farthest.box.center();
        outside = outside || ((upwards ? p[axis] : -p[axis]) > 0.25 * farthest.reach && evaluator.at(p) < level);
      }
      const double length = longest_side(farthest.box);
      if (outside || length <= tolerance * std::max(1e-3, std::fabs(farthest.reach)) || looked >= most_boxes) return farthest.reach;
      queue.pop();
      const Halves halves = best_halves(farthest);
      for (int k = 0; k < 2; ++k) {
        if (halves.deficit[k] > 0.0) queue.push({halves.box[k], reach(halves.box[k]), halves.deficit[k]});
      }
    }
    return -kInfinity;
  }
};

}  // namespace

Extent find_extent(const RegisterProgram& program, const bool reads_axis[3], double level) {
  Evaluator evaluator(program);
  // What is thinner than rounding has no inside: sheets where two planes face each other at no distance.
  double largest = 1.0;
  for (const RegisterStep& step : program.steps) largest = std::max(largest, std::fabs(step.constant));
  const double below = level - 1e-13 * std::min(largest, 1e6);
  const Box everything{glm::dvec3(-kFarthest), glm::dvec3(kFarthest)};
  Extent extent;
  Box found = everything;
  for (const double tolerance : {0.05, 0.004}) {
    for (int axis = 0; axis < 3; ++axis) {
      if (!reads_axis[axis]) continue;
      for (const bool upwards : {false, true}) {
        bool& proven = extent.proven[axis][upwards ? 1 : 0];
        if (proven) continue;
        const Search search{evaluator, reads_axis, below, axis, upwards, most_boxes(program)};
        bool outside = false;
        const double reach = search.run(found, tolerance, outside);
        if (reach == -kInfinity) return {};
        if (outside && reach >= kFarthest) proven = true;
        (upwards ? found.upper : found.lower)[axis] = upwards ? reach : -reach;
      }
    }
  }
  // A surface at the very end lies within, whatever rounding does to it.
  double side = 0.0;
  for (int i = 0; i < 3; ++i) {
    if (reads_axis[i] && found.upper[i] - found.lower[i] < kFarthest) side = std::max(side, found.upper[i] - found.lower[i]);
  }
  extent.box = {found.lower - 1e-6 * side, found.upper + 1e-6 * side};
  for (int axis = 0; axis < 3; ++axis) {
    if (!reads_axis[axis] || found.lower[axis] <= -kFarthest) extent.box.lower[axis] = -kInfinity;
    if (!reads_axis[axis] || found.upper[axis] >= kFarthest) extent.box.upper[axis] = kInfinity;
    if (!reads_axis[axis]) extent.proven[axis][0] = extent.proven[axis][1] = true;
  }
  return extent;
}

double steepest(const RegisterProgram& program, const Box& box, const bool reads_axis[3]) {
  constexpr int kCells = 6;
  Evaluator evaluator(program);
  int cells[3];
  for (int i = 0; i < 3; ++i) cells[i] = reads_axis[i] ? kCells : 1;
  double most = 0.0;
  for (int k = 0; k < cells[0] * cells[1] * cells[2]; ++k) {
    const int index[3] = {k % cells[0], k / cells[0] % cells[1], k / (cells[0] * cells[1])};
    Box cell;
    for (int i = 0; i < 3; ++i) {
      const double size = box.upper[i] - box.lower[i];
      cell.lower[i] = box.lower[i] + size * index[i] / cells[i];
      cell.upper[i] = index[i] + 1 == cells[i] ? box.upper[i] : box.lower[i] + size * (index[i] + 1) / cells[i];
    }
    double squares = 0.0;
    for (int i = 0; i < 3; ++i) {
      if (!reads_axis[i]) continue;
      const double slope = magnitude(evaluator.slope(cell, i));
      squares += slope * slope;
    }
    most = std::max(most, squares);
    if (!std::isfinite(most)) return kInfinity;
  }
  return std::sqrt(most) * (1.0 + 1e-12);
}

}  // namespace limn::vm
