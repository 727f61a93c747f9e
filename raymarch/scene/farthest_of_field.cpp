#include <array>
#include <limits>
#include <memory>
#include <queue>

#include "raymarch/scene/farthest_points.h"

namespace limn {
namespace {

constexpr int kFinest = 10;         // halvings of the bounds' sides
constexpr int kRestricted = 2;      // a box's field is restricted to it after so many
constexpr int kMostBoxes = 20'000;  // for one direction; beyond it the answer lies too far out rather than too near

/// A part of the bounds that may hold a part of the solid.
struct Part {
  double along = 0.0;  ///< How far it reaches in the direction.
  int depth = 0;
  Box box{};
  std::shared_ptr<FieldEvaluator> field{};  ///< Equal to the whole field in the box.
};

/// What reaches farther first, of several the smaller, which is nearer to an answer.
struct Behind {
  bool operator()(const Part& a, const Part& b) const { return a.along != b.along ? a.along < b.along : a.depth < b.depth; }
};

double reach(const Box& box, const glm::dvec3& direction) {
  return glm::dot(box.center(), direction) + 0.5 * glm::dot(box.size(), glm::abs(direction));
}

/// Halved along the longest side. The part where the field is above 0 throughout is left out.
void add_halves(const Part& part, const glm::dvec3& direction, std::priority_queue<Part, std::vector<Part>, Behind>& parts) {
  const glm::dvec3 size = part.box.size();
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  std::shared_ptr<FieldEvaluator> field = part.field;
  if (part.depth > 0 && part.depth % (3 * kRestricted) == 0) field = std::make_shared<FieldEvaluator>(field->restricted(part.box));
  for (const bool upper : {true, false}) {
    Part half{0.0, part.depth + 1, part.box, field};
    (upper ? half.box.lower : half.box.upper)[axis] = part.box.center()[axis];
    if (field->bounds(half.box).lower > 0.0) continue;
    half.along = reach(half.box, direction);
    parts.push(std::move(half));
  }
}

/// Best first: the part that reaches farthest is halved until it is small.
glm::dvec3 farthest(const std::shared_ptr<FieldEvaluator>& field, const Box& bounds, const glm::dvec3& direction) {
  std::priority_queue<Part, std::vector<Part>, Behind> parts;
  parts.push({reach(bounds, direction), 0, bounds, field});
  for (int boxes = 0; !parts.empty(); ++boxes) {
    const Part part = parts.top();
    if (part.depth >= 3 * kFinest || boxes >= kMostBoxes || part.box.longest_side() <= bounds.longest_side() * std::ldexp(1.0, -kFinest))
      return part.box.center();
    parts.pop();
    add_halves(part, direction, parts);
  }
  return bounds.center();  // an empty solid
}

}  // namespace

FarthestPoints farthest_of_field(const Field& field) {
  return [field](std::span<const glm::dvec3> directions) {
    const auto whole = std::make_shared<FieldEvaluator>(field);
    std::vector<glm::dvec3> points;
    points.reserve(directions.size());
    for (const glm::dvec3& direction : directions) points.push_back(farthest(whole, field.traits().bounds, direction));
    return points;
  };
}

}  // namespace limn
