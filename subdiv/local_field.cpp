#include "subdiv/local_field.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sdf/error.h"
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

double LocalField::value(const glm::dvec3& point) { return (holds(point) ? part_ : whole_).value(point); }

void LocalField::gradients(std::span<const glm::dvec3> points, std::span<double> values, std::span<glm::dvec3> gradients) {
  if (std::all_of(points.begin(), points.end(), [&](const glm::dvec3& p) { return holds(p); }))
    return part_.gradients(points, values, gradients);
  for (size_t i = 0; i < points.size(); ++i)
    (holds(points[i]) ? part_ : whole_).gradients(points.subspan(i, 1), values.subspan(i, 1), gradients.subspan(i, 1));
}

void LocalField::gradient(const glm::dvec3& point, double& value, glm::dvec3& gradient) {
  gradients(std::span(&point, 1), std::span(&value, 1), std::span(&gradient, 1));
}

glm::dvec3 LocalField::unit_gradient(const glm::dvec3& point) {
  glm::dvec3 slope;
  double value = 0.0;
  gradient(point, value, slope);
  return direction_of(slope);
}

double LocalField::distance_off(const glm::dvec3& point) {
  glm::dvec3 slope;
  double value = 0.0;
  gradient(point, value, slope);
  return distance_by(value, slope);
}

Landing LocalField::project(const glm::dvec3& point) { return project(std::span(&point, 1)).front(); }

std::vector<Landing> LocalField::project(std::span<const glm::dvec3> points) {
  constexpr double kTolerance = 1e-12;
  std::vector<SurfaceProjection> projections;
  projections.reserve(points.size());
  for (const glm::dvec3& point : points) projections.emplace_back(point, extent_, kTolerance);
  std::vector<size_t> open(points.size());
  std::iota(open.begin(), open.end(), size_t{0});
  std::vector<glm::dvec3> asked, slopes;
  std::vector<double> values;
  while (!open.empty()) {
    asked.clear();
    for (const size_t i : open) asked.push_back(projections[i].asks());
    values.resize(open.size()), slopes.resize(open.size());
    gradients(asked, values, slopes);
    for (size_t k = 0; k < open.size(); ++k) projections[open[k]].answer(values[k], slopes[k]);
    std::erase_if(open, [&](size_t i) { return projections[i].done(); });
  }
  std::vector<Landing> landings;
  landings.reserve(points.size());
  for (const SurfaceProjection& one : projections) landings.push_back({one.position(), one.reached(), one.value(), one.gradient()});
  return landings;
}

namespace {

using Evaluators = tbb::enumerable_thread_specific<FieldEvaluator>;

/// Points in a group: bounding the field over a box takes as long as a few values of it.
constexpr size_t kGroup = 32;

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
  if (members.size() <= kGroup) {
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
