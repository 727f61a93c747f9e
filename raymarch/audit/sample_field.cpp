// Points of a field's surface: nodes of a lattice near it, brought onto it along the gradient.

#include <algorithm>
#include <cmath>
#include <limits>

#include "raymarch/audit/facts.h"
#include "raymarch/scene/curvature.h"

namespace limn {
namespace {

constexpr int kCells = 32;  // along the longest side
/// Of the lattice against the bounds: no face of a box lies half way between two sheets of nodes, to be counted twice.
constexpr double kPhase = 0.63;
constexpr size_t kMost = 1500;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Nodes no further than half a cell from the surface by value over slope, so that each stands for as much of its area.
std::vector<glm::dvec3> nodes_near(FieldEvaluator& evaluator, const Box& box, double cell) {
  const glm::ivec3 count = glm::ivec3(glm::ceil(box.size() / cell)) + 1;
  const double limit = evaluator.field().traits().lipschitz * cell;
  std::vector<glm::dvec3> row(static_cast<size_t>(count.z)), near, gradients;
  std::vector<double> values(row.size());
  for (int x = 0; x < count.x; ++x)
    for (int y = 0; y < count.y; ++y) {
      for (int z = 0; z < count.z; ++z) row[static_cast<size_t>(z)] = box.lower + cell * glm::dvec3(x, y, z);
      evaluator.values(row, values);
      for (size_t z = 0; z < row.size(); ++z)
        if (std::abs(values[z]) <= limit) near.push_back(row[z]);
    }
  values.resize(near.size());
  gradients.resize(near.size());
  evaluator.gradients(near, values, gradients);
  size_t kept = 0;
  for (size_t i = 0; i < near.size(); ++i)
    if (std::abs(values[i]) <= 0.5 * cell * glm::length(gradients[i])) near[kept++] = near[i];
  near.resize(kept);
  return near;
}

/// Newton's iteration along the gradient; what does not arrive, or wanders off, is dropped.
std::vector<glm::dvec3> projected(FieldEvaluator& evaluator, const std::vector<glm::dvec3>& nodes, double cell) {
  std::vector<glm::dvec3> points = nodes, gradients(nodes.size());
  std::vector<double> values(nodes.size());
  for (int round = 0; round < 12; ++round) {
    evaluator.gradients(points, values, gradients);
    for (size_t i = 0; i < points.size(); ++i) {
      const double squared = glm::dot(gradients[i], gradients[i]);
      if (squared > 0.0) points[i] -= values[i] / squared * gradients[i];
    }
  }
  evaluator.gradients(points, values, gradients);
  std::vector<glm::dvec3> found;
  for (size_t i = 0; i < points.size(); ++i) {
    const bool arrived = std::abs(values[i]) <= 1e-6 * cell * glm::length(gradients[i]);
    if (arrived && glm::distance(points[i], nodes[i]) < cell) found.push_back(points[i]);
  }
  return found;
}

std::vector<glm::dvec3> thinned(const std::vector<glm::dvec3>& points) {
  if (points.size() <= kMost) return points;
  std::vector<glm::dvec3> kept;
  for (size_t i = 0; i < kMost; ++i) kept.push_back(points[i * points.size() / kMost]);
  return kept;
}

/// How far from each point along `side` times its normal the sign is that of the other side again. Steps grow with the distance, so that
/// what is found to a share is the distance, near or far.
std::vector<double> first_return(FieldEvaluator& evaluator, const SurfaceSamples& samples, double side) {
  constexpr double kFirst = 1e-4, kGrowth = 1.15;
  const double length = samples.longest_side;
  std::vector<double> found(samples.points.size(), kInfinity), values(samples.points.size());
  std::vector<glm::dvec3> at(samples.points.size());
  const auto is_back = [&](size_t i, double value) { return side * value < -1e-6 * length * samples.slopes[i]; };
  std::vector<double> low(found.size(), 0.0);
  for (double t = kFirst * length; t < length; t *= kGrowth) {
    for (size_t i = 0; i < at.size(); ++i) at[i] = samples.points[i] + side * t * samples.normals[i];
    evaluator.values(at, values);
    for (size_t i = 0; i < at.size(); ++i) {
      if (std::isfinite(found[i])) continue;
      if (is_back(i, values[i]))
        found[i] = t;
      else
        low[i] = t;
    }
  }
  for (int round = 0; round < 16; ++round) {
    for (size_t i = 0; i < at.size(); ++i)
      at[i] = samples.points[i] + side * (std::isfinite(found[i]) ? 0.5 * (low[i] + found[i]) : 0.0) * samples.normals[i];
    evaluator.values(at, values);
    for (size_t i = 0; i < at.size(); ++i) {
      if (!std::isfinite(found[i])) continue;
      (is_back(i, values[i]) ? found[i] : low[i]) = 0.5 * (low[i] + found[i]);
    }
  }
  return found;
}

}  // namespace

SurfaceSamples sample_field(const Field& field) {
  SurfaceSamples samples;
  const Box& bounds = field.traits().bounds;
  samples.longest_side = bounds.longest_side();
  if (!(samples.longest_side > 0.0)) return samples;
  const double cell = samples.longest_side / kCells;
  FieldEvaluator evaluator(field);
  const std::vector<glm::dvec3> points = thinned(projected(evaluator, nodes_near(evaluator, dilate(bounds, kPhase * cell), cell), cell));
  std::vector<FieldJet> jets(points.size());
  evaluator.jets(points, jets);
  for (size_t i = 0; i < points.size(); ++i) {
    const double slope = glm::length(jets[i].gradient);
    if (!(slope > 0.0)) continue;
    samples.points.push_back(points[i]);
    samples.slopes.push_back(slope);
    samples.normals.push_back(jets[i].gradient / slope);
    const SurfaceCurvature curvature = curvature_of_jet(jets[i]);
    samples.bending.push_back(std::max(std::abs(curvature.k1), std::abs(curvature.k2)) * samples.longest_side);
  }
  samples.walls = first_return(evaluator, samples, -1.0);
  samples.gaps = first_return(evaluator, samples, 1.0);
  return samples;
}

}  // namespace limn
