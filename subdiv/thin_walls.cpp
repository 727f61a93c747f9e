#include "subdiv/thin_walls.h"

#include <algorithm>
#include <cmath>

#include "subdiv/lattice_edges.h"

namespace limn {
namespace {

/// Stretches that are a smaller share of their edge have two sides that no vertex can tell apart.
constexpr double kThinnest = 1e-4;
/// Cosines between the normals of a wall's sides, and of what keeps nodes apart, are less than these.
constexpr double kWall = -0.7, kApart = 0.5;
/// Parts of an edge between places that are asked whether they keep its ends apart.
constexpr int kParts = 8;
constexpr int kMostSteps = 24;
/// The first steps go on though the tangents meet before zero: where the field is curved it may reach beyond them.
constexpr int kSureSteps = 3;

/// The field at a place on an edge, turned so that it is positive at the nodes.
struct Place {
  double t = 0.0, value = 0.0, slope = 0.0;
};

/// The part of an edge between whose ends the field falls and rises again.
struct Valley {
  size_t edge = 0;
  double sign = 1.0;
  Place from{}, to{};
  double beyond = -1.0;  ///< A place with the other sign.
  bool open = true;      ///< Still searched.
};

glm::dvec3 point_on(const LatticeEdge& edge, double t) { return edge.from + t * (edge.to - edge.from); }

double lowest_by_tangents(const Valley& valley, double& t) {
  const Place &a = valley.from, &b = valley.to;
  const double width = b.t - a.t;
  // a.value + a.slope s = b.value + b.slope (s - width)
  const double s = (b.value - b.slope * width - a.value) / (a.slope - b.slope);
  t = a.t + std::clamp(s, 0.02 * width, 0.98 * width);
  return a.value + a.slope * s;
}

std::vector<Valley> valleys(LocalField& field, std::span<const LatticeEdge> edges) {
  std::vector<glm::dvec3> points, gradients;
  for (const LatticeEdge& edge : edges) points.push_back(edge.from), points.push_back(edge.to);
  gradients.resize(points.size());
  std::vector<double> values(points.size());
  field.gradients(points, values, gradients);
  std::vector<Valley> found;
  for (size_t i = 0; i < edges.size(); ++i) {
    Valley valley{.edge = i, .sign = values[2 * i] < 0.0 ? -1.0 : 1.0};
    const auto place = [&](size_t k, double t) {
      return Place{t, valley.sign * values[k], valley.sign * glm::dot(gradients[k], edges[i].to - edges[i].from)};
    };
    valley.from = place(2 * i, 0.0), valley.to = place(2 * i + 1, 1.0);
    if (valley.from.slope < 0.0 && valley.to.slope > 0.0 && valley.to.value >= 0.0) found.push_back(valley);
  }
  return found;
}

/// Cutting planes: each step asks where the tangents meet, and goes on in the half that falls towards it.
void descend(LocalField& field, std::span<const LatticeEdge> edges, std::vector<Valley>& valleys) {
  std::vector<size_t> asked;
  std::vector<glm::dvec3> points, gradients;
  std::vector<double> places, values;
  for (int step = 0; step < kMostSteps; ++step) {
    asked.clear(), points.clear(), places.clear();
    for (size_t i = 0; i < valleys.size(); ++i) {
      Valley& valley = valleys[i];
      if (!valley.open) continue;
      double t = 0.0;
      const double lowest = lowest_by_tangents(valley, t);
      valley.open = (lowest < 0.0 || step < kSureSteps) && valley.to.t - valley.from.t > kThinnest;
      if (!valley.open) continue;
      asked.push_back(i), places.push_back(t), points.push_back(point_on(edges[valley.edge], t));
    }
    if (asked.empty()) return;
    values.resize(points.size()), gradients.resize(points.size());
    field.gradients(points, values, gradients);
    for (size_t k = 0; k < asked.size(); ++k) {
      Valley& valley = valleys[asked[k]];
      const LatticeEdge& edge = edges[valley.edge];
      const Place here{places[k], valley.sign * values[k], valley.sign * glm::dot(gradients[k], edge.to - edge.from)};
      if (here.value < 0.0) valley.beyond = here.t, valley.open = false;
      (here.slope < 0.0 ? valley.from : valley.to) = here;
    }
  }
}

/// The ends of the stretches about `beyond`, by bisection.
std::vector<Interval> stretches(LocalField& field, std::span<const LatticeEdge> edges, std::span<const Valley> valleys) {
  std::vector<Interval> result(valleys.size());
  std::vector<glm::dvec3> points(valleys.size());
  std::vector<double> values(valleys.size()), in(valleys.size()), out(valleys.size());
  for (const bool upper : {false, true}) {
    for (size_t i = 0; i < valleys.size(); ++i) in[i] = valleys[i].beyond, out[i] = upper ? 1.0 : 0.0;
    for (int halving = 0; halving < kMostSteps; ++halving) {
      for (size_t i = 0; i < valleys.size(); ++i) points[i] = point_on(edges[valleys[i].edge], 0.5 * (in[i] + out[i]));
      field.values(points, values);
      for (size_t i = 0; i < valleys.size(); ++i) (valleys[i].sign * values[i] < 0.0 ? in[i] : out[i]) = 0.5 * (in[i] + out[i]);
    }
    for (size_t i = 0; i < valleys.size(); ++i) (upper ? result[i].upper : result[i].lower) = in[i];
  }
  return result;
}

/// The cosine between the normals at the two ends of each stretch.
std::vector<double> cosines(LocalField& field, std::span<const LatticeEdge> edges, std::span<const Valley> valleys,
                            std::span<const Interval> within) {
  std::vector<glm::dvec3> points, gradients;
  for (size_t i = 0; i < valleys.size(); ++i)
    for (const double t : {within[i].lower, within[i].upper}) points.push_back(point_on(edges[valleys[i].edge], t));
  gradients.resize(points.size());
  std::vector<double> values(points.size());
  field.gradients(points, values, gradients);
  std::vector<double> result(valleys.size());
  for (size_t i = 0; i < result.size(); ++i) result[i] = glm::dot(direction_of(gradients[2 * i]), direction_of(gradients[2 * i + 1]));
  return result;
}

/// Of the edges of a group.
std::vector<std::optional<double>> walls_on(LocalField& field, std::span<const LatticeEdge> edges) {
  std::vector<std::optional<double>> middles(edges.size());
  std::vector<Valley> found = valleys(field, edges);
  descend(field, edges, found);
  std::erase_if(found, [](const Valley& valley) { return valley.beyond < 0.0; });
  if (found.empty()) return middles;
  const std::vector<Interval> within = stretches(field, edges, found);
  const std::vector<double> between = cosines(field, edges, found, within);
  for (size_t i = 0; i < found.size(); ++i)
    if (between[i] < kWall && within[i].upper - within[i].lower > kThinnest)
      middles[found[i].edge] = 0.5 * (within[i].lower + within[i].upper);
  return middles;
}

std::vector<char> apart_on(LocalField& field, std::span<const LatticeEdge> edges) {
  std::vector<char> apart(edges.size(), 0);
  std::vector<glm::dvec3> points;
  for (const LatticeEdge& edge : edges)
    for (int k = 0; k < kParts; ++k) points.push_back(point_on(edge, static_cast<double>(k) / kParts));
  std::vector<double> values(points.size());
  field.values(points, values);
  std::vector<Valley> beyond;
  for (size_t i = 0; i < edges.size(); ++i) {
    const double sign = values[i * kParts] < 0.0 ? -1.0 : 1.0;
    for (size_t k = 1; k < kParts; ++k)
      if (sign * values[i * kParts + k] < 0.0) beyond.push_back({.edge = i, .sign = sign, .beyond = static_cast<double>(k) / kParts});
  }
  if (beyond.empty()) return apart;
  const std::vector<double> between = cosines(field, edges, beyond, stretches(field, edges, beyond));
  for (size_t i = 0; i < beyond.size(); ++i)
    if (between[i] < kApart) apart[beyond[i].edge] = 1;
  return apart;
}

}  // namespace

std::vector<std::optional<double>> find_thin_walls(const Field& field, std::span<const LatticeEdge> edges) {
  return by_groups<std::optional<double>>(field, edges, walls_on);
}

std::vector<char> are_apart(const Field& field, std::span<const LatticeEdge> edges) { return by_groups<char>(field, edges, apart_on); }

}  // namespace limn
