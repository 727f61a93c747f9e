#include "raymarch/truth/field_cells.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <optional>
#include <unordered_set>

#include "sdf/field_program.h"
#include "sdf/number.h"
#include "sdf/number_interval.h"

namespace limn {
namespace {

constexpr int kTaskLevel = 4;      // subtrees below it are one task each
constexpr int kRestrictEvery = 2;  // levels between shortenings of the program
constexpr double kViewMargin = 1e-9;
constexpr double kClear = 0.02;  // of N.V
constexpr int kNearCells = 2;    // so near a found curve, cells that bounds do not exclude say nothing

/// The subtree that one task walks.
struct Walk {
  const CellSearch& search;
  CellOutput output{};
  std::int64_t cells = 0;
  std::vector<glm::ivec3> crossed{}, quiet{};  ///< Finest cells, with and without a curve.
};

Interval coordinate(const Box& box, int axis) { return {box.lower[axis], box.upper[axis]}; }

/// Families whose N.V - c may vanish in the box, given the bounds of the gradient: of its sign the product with the view vector says
/// enough, without a division.
FamilyMask may_cross(const CellSearch& search, const Box& box, const GradientBounds& bounds, FamilyMask families) {
  std::array<Interval, 3> view;
  const bool perspective = search.camera.projection == Projection::perspective;
  for (int axis = 0; axis < 3; ++axis) {
    const double eye = search.camera.eye[axis], backward = search.camera.world_from_camera[2][axis];
    view[static_cast<size_t>(axis)] = perspective ? -(coordinate(box, axis) - eye) : Interval{backward, backward};
  }
  const auto& g = bounds.gradient;
  const Interval gradient_length = norm(g[0], g[1], g[2]);
  const Interval view_length = perspective ? norm(view[0], view[1], view[2]) : Interval{1.0, 1.0};
  const Interval product = g[0] * view[0] + g[1] * view[1] + g[2] * view[2];
  const Interval lengths = gradient_length * view_length;
  FamilyMask result = 0;
  for (size_t family = 0; family < kCurveFamilies; ++family) {
    if (!(families >> family & 1u)) continue;
    const Interval h = product - lengths * search.levels[family];
    const double margin = kViewMargin * lengths.upper;
    if (!(h.lower > margin || h.upper < -margin)) result |= 1u << family;
  }
  return result;
}

FamilyMask surviving(const CellSearch& search, FieldEvaluator& evaluator, const Box& box, FamilyMask families) {
  if (!evaluator.bounds(box).contains(0.0)) return 0;
  const GradientBounds bounds = evaluator.gradient_bounds(box);
  if (!bounds.value.contains(0.0)) return 0;
  return may_cross(search, box, bounds, families);
}

Box box_of(const CellSearch& search, int level, const glm::ivec3& cell) {
  const int scale = 1 << (search.level - level);
  return {search.grid.vertex(cell * scale), search.grid.vertex((cell + 1) * scale)};
}

void descend(Walk& walk, FieldEvaluator& evaluator, int level, const glm::ivec3& cell, FamilyMask families) {
  const CellSearch& search = walk.search;
  const Box box = box_of(search, level, cell);
  families = surviving(search, evaluator, box, families);
  if (families == 0) return;
  if (level == search.level) {
    ++walk.cells;
    const bool crossed = march_cell(evaluator, search.viewer, search.grid, cell, search.levels, families, walk.output);
    (crossed ? walk.crossed : walk.quiet).push_back(cell);
    return;
  }
  std::optional<FieldEvaluator> restricted;
  if (level % kRestrictEvery == 0 && evaluator.field().program().instructions.size() > 1) {
    Field field = evaluator.restricted(dilate(box, kMarchReach * search.grid.side));
    if (&field.program() != &evaluator.field().program()) restricted.emplace(field);
  }
  for (int i = 0; i < 8; ++i) {
    descend(walk, restricted ? *restricted : evaluator, level + 1, 2 * cell + glm::ivec3(i & 1, i >> 1 & 1, i >> 2 & 1), families);
  }
}

/// Cells of the task level whose bounds hold the surface.
std::vector<glm::ivec3> task_cells(const CellSearch& search, int task_level) {
  FieldEvaluator evaluator(search.field);
  std::vector<glm::ivec3> cells = {glm::ivec3(0)};
  for (int level = 0; level < task_level; ++level) {
    std::vector<glm::ivec3> next;
    for (const glm::ivec3& cell : cells) {
      for (int i = 0; i < 8; ++i) {
        const glm::ivec3 child = 2 * cell + glm::ivec3(i & 1, i >> 1 & 1, i >> 2 & 1);
        if (evaluator.bounds(box_of(search, level + 1, child)).contains(0.0)) next.push_back(child);
      }
    }
    cells = std::move(next);
  }
  return cells;
}

std::uint64_t packed(const glm::ivec3& cell) {
  const auto part = [](int v) { return static_cast<std::uint64_t>(v + 16); };
  return (part(cell.x) << 20 | part(cell.y)) << 20 | part(cell.z);
}

/// At a crease bounds hold the hull of both sides, however small the box: there the box's corners say whether N.V is clear of the levels.
bool clear_at_corners(const CellSearch& search, FieldEvaluator& evaluator, const Box& box, FamilyMask families) {
  std::array<glm::dvec3, 8> points, gradients;
  std::array<double, 8> values;
  for (size_t i = 0; i < 8; ++i)
    points[i] = {(i & 1 ? box.upper : box.lower).x, (i & 2 ? box.upper : box.lower).y, (i & 4 ? box.upper : box.lower).z};
  evaluator.gradients(points, values, gradients);
  for (size_t family = 0; family < kCurveFamilies; ++family) {
    if (!(families >> family & 1u)) continue;
    int above = 0, below = 0;
    for (size_t i = 0; i < 8; ++i) {
      const double h = facing_of(search.viewer, points[i], gradients[i]) - search.levels[family];
      above += h > kClear;
      below += h < -kClear;
    }
    if (above < 8 && below < 8) return false;
  }
  return true;
}

bool stays(const CellSearch& search, FieldEvaluator& evaluator, const Box& box, int cuts) {
  const FamilyMask families = surviving(search, evaluator, box, search.families);
  if (families == 0) return false;
  if (cuts == 0) return !clear_at_corners(search, evaluator, box, families);
  const glm::dvec3 middle = box.center();
  for (int i = 0; i < 8; ++i) {
    Box child = box;
    for (int axis = 0; axis < 3; ++axis) ((i >> axis & 1) ? child.lower : child.upper)[axis] = middle[axis];
    if (stays(search, evaluator, child, cuts - 1)) return true;
  }
  return false;
}

/// Quiet cells apart from every curve that bounds do not exclude however finely they are cut.
std::int64_t count_unsettled(const CellSearch& search, const std::vector<Walk>& walks) {
  std::unordered_set<std::uint64_t> crossed;
  std::vector<glm::ivec3> apart;
  for (const Walk& walk : walks) {
    for (const glm::ivec3& cell : walk.crossed) crossed.insert(packed(cell));
  }
  for (const Walk& walk : walks) {
    for (const glm::ivec3& cell : walk.quiet) {
      bool near = false;
      for (int i = 0; i < 125 && !near; ++i) {
        near = crossed.contains(packed(cell + glm::ivec3(i % 5 - kNearCells, i / 5 % 5 - kNearCells, i / 25 - kNearCells)));
      }
      if (!near) apart.push_back(cell);
    }
  }
  std::vector<std::uint8_t> left(apart.size(), 0);
  tbb::parallel_for(tbb::blocked_range<size_t>(0, apart.size(), 16), [&](const tbb::blocked_range<size_t>& range) {
    FieldEvaluator whole(search.field);
    for (size_t i = range.begin(); i < range.end(); ++i) {
      const Box box = search.grid.cell(apart[i]);
      FieldEvaluator evaluator(whole.restricted(box));
      left[i] = stays(search, evaluator, box, kSettlingCuts);
    }
  });
  return std::count(left.begin(), left.end(), 1);
}

}  // namespace

CellResult search_cells(const CellSearch& search, const ExecutionSettings& how) {
  const int task_level = std::min(kTaskLevel, search.level);
  const std::vector<glm::ivec3> tasks = task_cells(search, task_level);
  std::vector<Walk> walks(tasks.size(), Walk{search});
  tbb::parallel_for(size_t{0}, tasks.size(), [&](size_t i) {
    if (how.cancelled && how.cancelled()) throw Cancelled{};
    FieldEvaluator whole(search.field);
    FieldEvaluator evaluator(whole.restricted(dilate(box_of(search, task_level, tasks[i]), kMarchReach * search.grid.side)));
    descend(walks[i], evaluator, task_level, tasks[i], search.families);
  });
  CellResult result;
  result.unsettled = count_unsettled(search, walks);
  for (Walk& walk : walks) {
    result.cells += walk.cells;
    for (size_t family = 0; family < kCurveFamilies; ++family) {
      CellCurves &from = walk.output.families[family], &to = result.families[family];
      to.crossings.insert(to.crossings.end(), from.crossings.begin(), from.crossings.end());
      to.links.insert(to.links.end(), from.links.begin(), from.links.end());
    }
  }
  return result;
}

}  // namespace limn
