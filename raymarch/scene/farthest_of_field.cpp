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

constexpr size_t kTogether = 32;  // parts, of a field that takes little longer for many points than for one

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

using Parts = std::priority_queue<Part, std::vector<Part>, Behind>;

/// Of a part, halved along its longest side.
void add_halves(const Part& part, const glm::dvec3& direction, std::vector<Part>& halves) {
  const glm::dvec3 size = part.box.size();
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  std::shared_ptr<FieldEvaluator> field = part.field;
  if (part.depth > 0 && part.depth % (3 * kRestricted) == 0) field = std::make_shared<FieldEvaluator>(field->restricted(part.box));
  for (const bool upper : {true, false}) {
    Part half{0.0, part.depth + 1, part.box, field};
    (upper ? half.box.lower : half.box.upper)[axis] = part.box.center()[axis];
    half.along = reach(half.box, direction);
    halves.push_back(std::move(half));
  }
}

/// But for those where the field is above 0 throughout. What is asked together is one part's, or all parts of one field.
void push(std::vector<Part>& halves, Parts& parts) {
  std::vector<Box> boxes;
  boxes.reserve(halves.size());
  for (const Part& half : halves) boxes.push_back(half.box);
  std::vector<Interval> bounds(boxes.size());
  halves.front().field->bounds(boxes, bounds);
  for (size_t i = 0; i < halves.size(); ++i)
    if (!(bounds[i].lower > 0.0)) parts.push(std::move(halves[i]));
}

/// Best first: the part that reaches farthest is halved until it is small; with it the next ones where they take no longer together.
glm::dvec3 farthest(const std::shared_ptr<FieldEvaluator>& field, const Box& bounds, const glm::dvec3& direction) {
  const size_t at_once = field->asks_together() ? kTogether : 1;
  Parts parts;
  parts.push({reach(bounds, direction), 0, bounds, field});
  std::vector<Part> halves;
  for (int boxes = 0; !parts.empty();) {
    const Part& first = parts.top();
    if (first.depth >= 3 * kFinest || boxes >= kMostBoxes || first.box.longest_side() <= bounds.longest_side() * std::ldexp(1.0, -kFinest))
      return first.box.center();
    halves.clear();
    for (size_t k = 0; k < at_once && !parts.empty(); ++k, ++boxes) {
      const Part part = parts.top();
      parts.pop();
      add_halves(part, direction, halves);
    }
    push(halves, parts);
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
