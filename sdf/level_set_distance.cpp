#include "sdf/level_set_distance.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sdf/error.h"
#include "sdf/level_set_lanes.h"
#include "sdf/project_to_surface.h"
#include "sdf/tape_jets.h"

namespace limn {

// With q the closest point and n the normal there, f(q + d n) = d |g(q)| + d^2 n'Hn / 2 + O(d^3) and |g(q)| = |g(p)| - d n'Hn + O(d^2),
// so f = d |g| - d^2 n'Hn / 2 at p; n at p differs from n at q by O(d), which moves n'Hn d^2 by O(d^3). The root nearest to f / |g|.
JetDistance distance_from_jet(const FieldJet& jet) {
  const double slope = glm::length(jet.gradient);
  const double first = jet.value / slope;
  if (!std::isfinite(first)) return {std::copysign(std::numeric_limits<double>::infinity(), jet.value), false};
  const glm::dvec3 n = jet.gradient / slope;
  const double bend = glm::dot(n, jet.hessian * n);
  const double root = 1.0 - 2.0 * bend * first / slope;  // of the discriminant, relative to slope^2
  if (!(root >= 0.25 && root <= 4.0)) return {first, false};
  return {2.0 * first / (1.0 + std::sqrt(root)), true};
}

namespace {

/// Whether the tape serves for the field's own values.
bool has_tape(DistanceEvaluator& distance) {
  if (!distance.tape) {
    distance.tape.emplace(distance.evaluator.field());
    distance.has_bits_of_field = has_bits_of_field(*distance.tape);
  }
  return distance.has_bits_of_field;
}

}  // namespace

void turn_to(const Field& field, std::optional<DistanceEvaluator>& distance) {
  if (distance && &distance->evaluator.field().program() == &field.program()) return;
  distance.emplace(field, distance ? std::move(distance->scratch) : TapeScratch());
}

void field_values(DistanceEvaluator& distance, const LanePoints& points, LaneNumbers& values) {
  const bool by_tape = has_tape(distance) && !distance.evaluator.asks_together();
  if (by_tape) return tape_values_at(*distance.tape, points, distance.scratch, values);
  std::array<glm::dvec3, kMostLanePoints> places;
  for (size_t i = 0; i < points.count; ++i) places[i] = points.point(i);
  distance.evaluator.values(std::span(places).first(points.count), std::span(values.at).first(points.count));
  std::fill(values.at + points.count, values.at + (points.count + 15) / 16 * 16, 0.0);
}

namespace {

/// Where the jet tells nothing, at the points `which`: as far as Newton's method has to go. Never below the true distance, as it ends on
/// the surface.
void project_points(FieldEvaluator& evaluator, const NearPoints& near, std::span<const std::uint16_t> which, LaneNumbers& estimates) {
  std::vector<glm::dvec3> points;
  points.reserve(which.size());
  for (const std::uint16_t k : which) points.push_back(near.points.point(k));
  const std::vector<SurfaceProjection> feet =
      project_together([&](std::span<const glm::dvec3> asked, std::span<double> values,
                           std::span<glm::dvec3> gradients) { evaluator.gradients(asked, values, gradients); },
                       points, extent_of(evaluator.field().traits().bounds), 1e-9);
  for (size_t i = 0; i < which.size(); ++i) {
    const size_t k = which[i];
    const double found = feet[i].reached() ? glm::distance(feet[i].position(), points[i]) : std::abs(estimates[k]);
    estimates[k] = std::copysign(std::max(near.no_less[k], found), near.value[k]);
  }
}

}  // namespace

void signed_distances(DistanceEvaluator& distance, const LanePoints& points, double half_width, LaneNumbers& distances) {
  FieldEvaluator& evaluator = distance.evaluator;
  const FieldTraits& traits = evaluator.field().traits();
  field_values(distance, points, distances);
  if (traits.exact_distance) return;

  NearPoints near;
  select_near(points, distance.lipschitz, half_width, distances, near);
  LaneNumbers estimates;
  LaneFlags reasonable;
  tape_distances(*distance.tape, near.points, distance.scratch, estimates, reasonable);
  sign_sizes(near, estimates);
  std::array<std::uint16_t, kMostLanePoints> unclear;
  size_t count = 0;
  for (size_t first = 0; first < near.points.count; first += 16) {
    if (reasonable[first / 16] == 0xffffu) continue;
    // Far out by its first-order estimate as well, a point is not worth the iteration.
    for (size_t k = first; k < std::min(first + 16, near.points.count); ++k)
      if (!flag_of(reasonable, k) && near.no_less[k] < half_width) unclear[count++] = static_cast<std::uint16_t>(k);
  }
  if (count > 0) project_points(distance.projects ? *distance.projects : evaluator, near, std::span(unclear).first(count), estimates);
  for (size_t k = 0; k < near.points.count; ++k) distances[near.index[k]] = estimates[k];
}

void signed_distances(DistanceEvaluator& distance, std::span<const glm::dvec3> points, double half_width, std::span<double> distances) {
  LIMN_CHECK(points.size() == distances.size() && points.size() <= kMostLanePoints);
  LanePoints lanes;
  for (const glm::dvec3& point : points) lanes.add(point);
  lanes.fill_up();
  LaneNumbers found;
  signed_distances(distance, lanes, half_width, found);
  std::copy_n(found.at, points.size(), distances.begin());
}

}  // namespace limn
