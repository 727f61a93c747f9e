#include "raymarch/truth/field_bodies.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sdf/shape.h"

namespace limn {
namespace {

constexpr double kTouch = 1e-6;  // of the extent: objects that share less depth touch

/// Some place in the box is inside the field by more than `depth`.
bool reaches_inside(FieldEvaluator& evaluator, const Box& box, double depth, int cuts) {
  if (evaluator.bounds(box).lower > -depth) return false;
  const glm::dvec3 middle = box.center();
  if (evaluator.value(middle) < -depth) return true;
  if (cuts == 0) return false;
  for (int i = 0; i < 8; ++i) {
    Box child = box;
    for (int axis = 0; axis < 3; ++axis) ((i >> axis & 1) ? child.lower : child.upper)[axis] = middle[axis];
    if (reaches_inside(evaluator, child, depth, cuts - 1)) return true;
  }
  return false;
}

/// Two fields share space. What only touches does not, nor what shares less than some hundredth of its size.
bool overlap(const Field& a, const Field& b, double extent) {
  const Box common = intersect(a.traits().bounds, b.traits().bounds);
  if (!a.traits().bounds.finite() || !b.traits().bounds.finite() || common.empty()) return false;
  FieldEvaluator both(combine(Csg::intersection, a, b));
  return reaches_inside(both, common, kTouch * extent, 6);
}

/// Joins objects that overlap. What has no bounds stays alone.
void find_bodies(FieldBodies& solved) {
  const size_t count = solved.fields.size();
  std::vector<size_t> group(count);
  for (size_t i = 0; i < count; ++i) group[i] = i;
  const auto meet = [&](size_t i, size_t j) { return overlap(solved.fields[i], solved.fields[j], solved.extent); };
  for (size_t i = 0; i < count; ++i) {
    for (size_t j = 0; j < i; ++j) {
      if (group[i] == group[j] || !meet(i, j)) continue;
      const size_t from = std::max(group[i], group[j]), to = std::min(group[i], group[j]);
      std::replace(group.begin(), group.end(), from, to);
    }
  }
  solved.body_of.resize(count);
  for (size_t i = 0; i < count; ++i) {
    if (group[i] == i) solved.bodies.emplace_back();
    solved.body_of[i] = group[i] == i ? solved.bodies.size() - 1 : solved.body_of[group[i]];
    solved.bodies[solved.body_of[i]].push_back(i);
  }
  for (const std::vector<size_t>& body : solved.bodies) {
    std::vector<Field> parts;
    parts.reserve(body.size());
    for (const size_t i : body) parts.push_back(solved.fields[i]);
    solved.body_fields.push_back(combine(Csg::union_, parts));
  }
}

}  // namespace

int object_at(std::vector<FieldEvaluator>& evaluators, const std::vector<size_t>& body, const glm::dvec3& p, const glm::dvec3& normal,
              double extent) {
  if (body.size() == 1) return static_cast<int>(body[0]);
  double least = std::numeric_limits<double>::infinity(), best_match = -2.0;
  for (const size_t i : body) least = std::min(least, std::fabs(evaluators[i].value(p)));
  size_t best = body[0];
  for (const size_t i : body) {
    const FieldJet jet = evaluators[i].jet(p);
    const double match = glm::dot(jet.gradient, normal) / std::max(glm::length(jet.gradient), 1e-300);
    if (std::fabs(jet.value) > least + 1e-9 * extent || match <= best_match) continue;
    best_match = match;
    best = i;
  }
  return static_cast<int>(best);
}

FieldBodies field_bodies(const Scene& scene, const std::vector<size_t>& objects, const glm::dvec3& origin, double extent) {
  FieldBodies bodies;
  bodies.extent = extent;
  bodies.numbers = objects;
  for (const size_t i : objects) bodies.fields.push_back(translate(std::get<Field>(scene.objects[i].source), -origin));
  find_bodies(bodies);
  return bodies;
}

std::optional<size_t> place_of(const FieldBodies& bodies, int object) {
  const auto at = std::find(bodies.numbers.begin(), bodies.numbers.end(), static_cast<size_t>(object - 1));
  if (at == bodies.numbers.end()) return {};
  return static_cast<size_t>(at - bodies.numbers.begin());
}

std::string name_of_body(const Scene& scene, const std::vector<size_t>& numbers, const std::vector<size_t>& body) {
  std::string name;
  for (const size_t i : body) {
    const std::string& own = scene.objects[numbers[i]].name;
    name += (name.empty() ? "" : " and ") + (own.empty() ? fmt::format("object {}", numbers[i] + 1) : own);
  }
  return name;
}

}  // namespace limn
