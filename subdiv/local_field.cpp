#include "subdiv/local_field.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sdf/error.h"
#include "sdf/field_program.h"
#include "sdf/parallel.h"
#include "sdf/project_to_surface.h"

namespace limn {

glm::dvec3 direction_of(const glm::dvec3& gradient) {
  const double length = glm::length(gradient);
  return length > 0.0 && std::isfinite(length) ? gradient / length : glm::dvec3(0.0);
}

double distance_by(double value, const glm::dvec3& gradient) {
  const double length = glm::length(gradient);
  return length > 0.0 ? std::abs(value) / length : std::abs(value);
}

LocalField::LocalField(FieldEvaluator& whole, const Field& part, const Box& box)
    : whole_(whole), part_(part), box_(box), extent_(extent_of(whole.field().traits().bounds)) {}

bool LocalField::holds(const glm::dvec3& point) const {
  return glm::all(glm::greaterThanEqual(point, box_.lower)) && glm::all(glm::lessThanEqual(point, box_.upper));
}

bool LocalField::hold_all(std::span<const glm::dvec3> points) const {
  return std::all_of(points.begin(), points.end(), [&](const glm::dvec3& p) { return holds(p); });
}

double LocalField::value(const glm::dvec3& point) { return (holds(point) ? part_ : whole_).value(point); }

void LocalField::values(std::span<const glm::dvec3> points, std::span<double> values) {
  if (hold_all(points)) return part_.values(points, values);
  for (size_t i = 0; i < points.size(); ++i) values[i] = value(points[i]);
}

void LocalField::gradients(std::span<const glm::dvec3> points, std::span<double> values, std::span<glm::dvec3> gradients) {
  if (hold_all(points)) return part_.gradients(points, values, gradients);
  // Those within the box together.
  std::vector<glm::dvec3> held;
  for (const glm::dvec3& point : points)
    if (holds(point)) held.push_back(point);
  std::vector<double> held_values(held.size());
  std::vector<glm::dvec3> held_gradients(held.size());
  part_.gradients(held, held_values, held_gradients);
  size_t k = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    if (holds(points[i]))
      values[i] = held_values[k], gradients[i] = held_gradients[k], ++k;
    else
      whole_.gradients(points.subspan(i, 1), values.subspan(i, 1), gradients.subspan(i, 1));
  }
}

void LocalField::gradient(const glm::dvec3& point, double& value, glm::dvec3& gradient) {
  gradients(std::span(&point, 1), std::span(&value, 1), std::span(&gradient, 1));
}

glm::dvec3 LocalField::unit_gradient(const glm::dvec3& point) { return unit_gradients(std::span(&point, 1)).front(); }

std::vector<glm::dvec3> LocalField::unit_gradients(std::span<const glm::dvec3> points) {
  std::vector<double> values(points.size());
  std::vector<glm::dvec3> slopes(points.size());
  gradients(points, values, slopes);
  for (glm::dvec3& slope : slopes) slope = direction_of(slope);
  return slopes;
}

double LocalField::distance_off(const glm::dvec3& point) { return distances_off(std::span(&point, 1)).front(); }

std::vector<double> LocalField::distances_off(std::span<const glm::dvec3> points) {
  std::vector<double> distances(points.size());
  std::vector<glm::dvec3> slopes(points.size());
  gradients(points, distances, slopes);
  for (size_t i = 0; i < points.size(); ++i) distances[i] = distance_by(distances[i], slopes[i]);
  return distances;
}

Landing LocalField::project(const glm::dvec3& point) { return project(std::span(&point, 1)).front(); }

std::vector<Landing> LocalField::project(std::span<const glm::dvec3> points) {
  constexpr double kTolerance = 1e-12;
  const std::vector<SurfaceProjection> projections =
      project_together([this](std::span<const glm::dvec3> asked, std::span<double> values,
                              std::span<glm::dvec3> slopes) { gradients(asked, values, slopes); },
                       points, extent_, kTolerance);
  std::vector<Landing> landings;
  landings.reserve(points.size());
  for (const SurfaceProjection& one : projections) landings.push_back({one.position(), one.reached(), one.value(), one.gradient()});
  return landings;
}

namespace {

using Evaluators = tbb::enumerable_thread_specific<FieldEvaluator>;

/// Points in a group: bounding the field over a box takes as long as a few values of it.
constexpr size_t kLeast = 32;
/// Where little of the field is left, leaving out more of it saves little: points times instructions, and points, of a group that is not
/// halved again.
constexpr size_t kLeastWork = 512, kMost = 256;

bool is_group(size_t points, const Field& part) {
  return points <= kLeast || (points <= kMost && points * part.program().instructions.size() <= kLeastWork);
}

struct Visit {
  std::span<const glm::dvec3> points;
  std::span<const double> reach;
  const std::function<void(LocalField&, std::span<const std::uint32_t>)>& visit;
  Evaluators& whole;
};

/// The members on the lower side of the middle of their longest extent first; where they all lie on one side, half of them.
size_t halve(const Visit& job, std::span<std::uint32_t> members) {
  Box box;
  for (const std::uint32_t i : members) box = include(box, job.points[i]);
  const glm::dvec3 size = box.size(), middle = box.center();
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const auto upper = std::partition(members.begin(), members.end(), [&](std::uint32_t i) { return job.points[i][axis] < middle[axis]; });
  const auto lower_count = static_cast<size_t>(upper - members.begin());
  return lower_count == 0 || lower_count == members.size() ? members.size() / 2 : lower_count;
}

void split(const Visit& job, const Field& around, std::span<std::uint32_t> members) {
  Box box;
  for (const std::uint32_t i : members) {
    box.lower = glm::min(box.lower, job.points[i] - job.reach[i]);
    box.upper = glm::max(box.upper, job.points[i] + job.reach[i]);
  }
  const Field part = FieldEvaluator(around).restricted(box);
  if (is_group(members.size(), part)) {
    LocalField local(job.whole.local(), part, box);
    job.visit(local, members);
    return;
  }
  const size_t half = halve(job, members);
  parallel_invoke([&] { split(job, part, members.first(half)); }, [&] { split(job, part, members.subspan(half)); });
}

}  // namespace

void visit_groups(const Field& field, std::span<const glm::dvec3> points, std::span<const double> reach, std::vector<std::uint32_t> which,
                  const std::function<void(LocalField&, std::span<const std::uint32_t>)>& visit) {
  LIMN_CHECK(points.size() == reach.size());
  if (which.empty()) return;
  Evaluators whole([&field] { return FieldEvaluator(field); });
  split({points, reach, visit, whole}, field, which);
}

void visit_groups(const Field& field, std::span<const glm::dvec3> points, double reach,
                  const std::function<void(LocalField&, std::span<const std::uint32_t>)>& visit) {
  std::vector<std::uint32_t> all(points.size());
  std::iota(all.begin(), all.end(), 0u);
  visit_groups(field, points, std::vector<double>(points.size(), reach), std::move(all), visit);
}

}  // namespace limn
