#include "sdf/level_set_distance.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sdf/error.h"
#include "sdf/level_set_lanes.h"
#include "sdf/shape.h"
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
  if (has_tape(distance)) return tape_values_at(*distance.tape, points, distance.scratch, values);
  std::array<glm::dvec3, kMostLanePoints> places;
  for (size_t i = 0; i < points.count; ++i) places[i] = points.point(i);
  distance.evaluator.values(std::span(places).first(points.count), std::span(values.at).first(points.count));
  std::fill(values.at + points.count, values.at + (points.count + 15) / 16 * 16, 0.0);
}

namespace {

/// Where the jet tells nothing: as far as Newton's method has to go. Never below the true distance, as it ends on the surface.
double projected_distance(FieldEvaluator& evaluator, const glm::dvec3& point, double at_least, double otherwise) {
  glm::dvec3 foot = point;
  if (!project_to_surface(evaluator, foot, 1e-9)) return std::max(at_least, otherwise);
  return std::max(at_least, glm::distance(foot, point));
}

}  // namespace

void signed_distances(DistanceEvaluator& distance, const LanePoints& points, double half_width, LaneNumbers& distances) {
  FieldEvaluator& evaluator = distance.evaluator;
  const FieldTraits& traits = evaluator.field().traits();
  field_values(distance, points, distances);
  if (traits.exact_distance) return;

  NearPoints near;
  select_near(points, traits.lipschitz, half_width, distances, near);
  LaneNumbers estimates;
  LaneFlags reasonable;
  tape_distances(*distance.tape, near.points, distance.scratch, estimates, reasonable);
  sign_sizes(near, estimates);
  for (size_t first = 0; first < near.points.count; first += 16) {
    const size_t end = std::min(first + 16, near.points.count);
    for (size_t k = first; reasonable[first / 16] != 0xffffu && k < end; ++k) {
      // Far out by its first-order estimate as well, it is not worth the iteration.
      if (flag_of(reasonable, k) || near.no_less[k] >= half_width) continue;
      const double size = projected_distance(distance.projects ? *distance.projects : evaluator, near.points.point(k), near.no_less[k],
                                             std::abs(estimates[k]));
      estimates[k] = std::copysign(size, near.value[k]);
    }
    for (size_t k = first; k < end; ++k) distances[near.index[k]] = estimates[k];
  }
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
