#include "sdf/vm/extent.h"

#include <algorithm>
#include <queue>

namespace limn::vm {
namespace {

// Boxes looked at for each of six directions, twice: in all of space and then within what was found. Fewer for long programs.
int most_boxes(const RegisterProgram& program) {
  return static_cast<int>(std::clamp<size_t>(2'000'000 / program.steps.size(), 1000, 20'000));
}

/// Evaluates over boxes and at points, keeping its memory.
class Evaluator {
 public:
  explicit Evaluator(const RegisterProgram& program) : program_(program) {}

  Interval over(const Box& box) {
    const Interval x{box.lower.x, box.upper.x}, y{box.lower.y, box.upper.y}, z{box.lower.z, box.upper.z};
    Interval value;
    run(program_, &x, &y, &z, &value, 1, intervals_);
    return checked(value);
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
  bool operator<(const Candidate& other) const { return reach < other.reach; }
};

/// Where a long stretch is cut: at 0, and then towards it, since what there is may be of any size.
double cut_of(double lower, double upper) {
  if (lower < 0.0 && upper > 0.0) return upper > -4.0 * lower ? upper / 8.0 : lower < -4.0 * upper ? lower / 8.0 : 0.0;
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
  bool may_hold(const Box& box) const { return !(evaluator.over(box).lower > level); }

  int longest(const Box& box) const {
    int best = axis;
    for (int i = 0; i < 3; ++i) {
      if (reads_axis[i] && box.upper[i] - box.lower[i] > box.upper[best] - box.lower[best]) best = i;
    }
    return best;
  }

  /// How far anything reaches at most; -infinity where there is nothing. `outside`: a point was found close to the region's end.
  double run(const Box& region, double tolerance, bool& outside) const {
    std::priority_queue<Candidate> queue;
    if (may_hold(region)) queue.push({region, reach(region)});
    for (int looked = 0; !queue.empty(); ++looked) {
      const Candidate farthest = queue.top();
      const int cut_axis = longest(farthest.box);
      const double length = farthest.box.upper[cut_axis] - farthest.box.lower[cut_axis];
      if (farthest.reach >= kFarthest) {
        const glm::dvec3 p = farthest.box.center();
        outside = outside || ((upwards ? p[axis] : -p[axis]) > 0.25 * farthest.reach && evaluator.at(p) <= level);
      }
      if (outside || length <= tolerance * std::max(1e-3, std::fabs(farthest.reach)) || looked >= most_boxes) return farthest.reach;
      queue.pop();
      const double cut = cut_of(farthest.box.lower[cut_axis], farthest.box.upper[cut_axis]);
      for (const bool high : {false, true}) {
        Box half = farthest.box;
        (high ? half.lower : half.upper)[cut_axis] = cut;
        if (may_hold(half)) queue.push({half, reach(half)});
      }
    }
    return -kInfinity;
  }
};

}  // namespace

Extent find_extent(const RegisterProgram& program, const bool reads_axis[3], double level) {
  Evaluator evaluator(program);
  const Box everything{glm::dvec3(-kFarthest), glm::dvec3(kFarthest)};
  Extent extent;
  Box found = everything;
  for (const double tolerance : {0.05, 0.004}) {
    for (int axis = 0; axis < 3; ++axis) {
      if (!reads_axis[axis]) continue;
      for (const bool upwards : {false, true}) {
        bool& proven = extent.proven[axis][upwards ? 1 : 0];
        if (proven) continue;
        const Search search{evaluator, reads_axis, level, axis, upwards, most_boxes(program)};
        bool outside = false;
        const double reach = search.run(found, tolerance, outside);
        if (reach == -kInfinity) return {};
        if (outside && reach >= kFarthest) proven = true;
        (upwards ? found.upper : found.lower)[axis] = upwards ? reach : -reach;
      }
    }
  }
  extent.box = found;
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
