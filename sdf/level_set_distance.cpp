#include "sdf/level_set_distance.h"

#include <array>
#include <cmath>

#include "sdf/error.h"
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

void field_values(DistanceEvaluator& distance, std::span<const glm::dvec3> points, std::span<double> values) {
  if (!distance.tape) {
    distance.tape.emplace(distance.evaluator.field());
    distance.has_bits_of_field = has_bits_of_field(*distance.tape);
  }
  if (distance.has_bits_of_field)
    tape_values_at(*distance.tape, points, distance.scratch, values);
  else
    distance.evaluator.values(points, values);
}

namespace {

/// Where the jet tells nothing: as far as Newton's method has to go. Never below the true distance, as it ends on the surface.
double projected_distance(FieldEvaluator& evaluator, const glm::dvec3& point, double at_least, double otherwise) {
  glm::dvec3 foot = point;
  if (!project_to_surface(evaluator, foot, 1e-9)) return std::max(at_least, otherwise);
  return std::max(at_least, glm::distance(foot, point));
}

}  // namespace

void signed_distances(DistanceEvaluator& distance, std::span<const glm::dvec3> points, double half_width, std::span<double> distances) {
  LIMN_CHECK(points.size() == distances.size() && points.size() <= 512);
  FieldEvaluator& evaluator = distance.evaluator;
  const FieldTraits& traits = evaluator.field().traits();
  field_values(distance, points, distances);
  if (traits.exact_distance) return;

  std::array<glm::dvec3, 512> near;
  std::array<size_t, 512> index;
  std::array<double, 512> no_less;  // than the distance there
  size_t count = 0;
  // Without a branch: in a block that the band's edge cuts, it would be guessed wrong once a row.
  for (size_t i = 0; i < points.size(); ++i) {
    const double at_least = std::abs(distances[i]) / traits.lipschitz;
    const bool far = at_least > half_width;
    near[count] = points[i];
    index[count] = i;
    no_less[count] = at_least;
    count += far ? 0 : 1;
    distances[i] = far ? std::copysign(at_least, distances[i]) : distances[i];
  }
  if (count == 0) return;
  distance.estimates.resize(std::max(distance.estimates.size(), count));
  const auto estimates = std::span(distance.estimates).first(count);
  tape_distances(*distance.tape, std::span(near).first(count), distance.scratch, estimates);
  for (size_t k = 0; k < count; ++k) {
    const double value = distances[index[k]], at_least = no_less[k];
    const JetDistance& estimate = estimates[k];
    double size = std::max(std::abs(estimate.distance), at_least);
    // Far out by its first-order estimate as well, it is not worth the iteration.
    if (!estimate.reasonable && at_least < half_width) size = projected_distance(evaluator, near[k], at_least, size);
    distances[index[k]] = std::copysign(size, value);
  }
}

}  // namespace limn
