// Where rays meet the offset of a field: boxes are divided where bounds of its value, and of its gradient, leave it open.

#include <iterator>

#include "raymarch/scene/rays_of_box.h"
#include "raymarch/surface/offset.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

/// A box that the shell may pass, and the field with what matters in it or around it.
struct Part {
  Box box;
  Field field;
};

/// Parts are taken out of the field while boxes are this large; then they hold little that does not matter.
constexpr int kRestricted = 4;
constexpr int kMostDivisions = 24;
constexpr size_t kMostParts = 200'000;

class Division {
 public:
  Division(const Field& field, const OffsetWidth& width, const MeetingRequest& request)
      : width_(width), request_(request), source_(ray_source(request.camera)), exact_(field.traits().exact_distance) {}

  /// Those of the part's octants (or halves and quarters, where it is long) that are met: to be divided, or good as they are.
  void divide(const Part& part, int depth, std::vector<Part>& next, std::vector<Box>& places) const {
    FieldEvaluator evaluator(part.field);
    const glm::dvec3 middle = part.box.center();
    for (int octant = 0; octant < 8; ++octant) {
      Box box = part.box;
      bool is_there = true;
      for (int axis = 0; axis < 3; ++axis) {
        const bool upper = (octant >> axis & 1) != 0;
        if (part.box.size()[axis] < 0.6 * part.box.longest_side())
          is_there = is_there && !upper;
        else
          (upper ? box.lower : box.upper)[axis] = middle[axis];
      }
      if (!is_there || !may_be_met(evaluator, box)) continue;
      if (longest_px(request_.camera, box) <= request_.side_px || (request_.is_divided && !request_.is_divided(box)))
        places.push_back(box);
      else
        next.push_back({box, depth < kRestricted ? evaluator.restricted(dilate(box, farthest(box))) : part.field});
    }
  }

 private:
  /// How far from the surface hits in the box may lie: by the width and the last step beyond it (field_offset.cpp). What jets tell may be
  /// two thirds of |f| over the steepest slope around (distance_from_jet).
  double farthest(const Box& box) const {
    constexpr double kBeyond = 1.05, kFromJets = 1.5;
    return (exact_ ? kBeyond : kBeyond * kFromJets) * largest_width(box);
  }

  bool may_be_met(FieldEvaluator& evaluator, const Box& box) const {
    constexpr double kInside = 0.05;  // rays end at the surface, but for rounding
    const double lipschitz = evaluator.field().traits().lipschitz, reach = farthest(box);
    const Interval value = evaluator.bounds(box);
    if (value.lower > lipschitz * reach || value.upper < -kInside * lipschitz * reach) return false;
    if (!request_.facing_away && exact_) return true;
    const auto g = evaluator.gradient_bounds(exact_ ? box : dilate(box, reach)).gradient;
    if (value.lower > magnitude(norm(g[0], g[1], g[2])) * reach) return false;
    return !request_.facing_away || may_face_away(g, ways_to(source_, box));
  }

  /// OffsetWidth::at is no larger: |z| is no longer than the way to the eye.
  double largest_width(const Box& box) const {
    if (width_.per_depth == 0.0) return width_.world;
    const double z = std::abs(glm::dot(box.center() - width_.eye, width_.backward)) + box.radius();
    return width_.world + width_.per_depth * z;
  }

  const OffsetWidth& width_;
  const MeetingRequest& request_;
  RaySource source_;
  bool exact_;
};

}  // namespace

std::vector<Box> field_meeting_places(const Field& field, const Box& clip, const OffsetWidth& width, const MeetingRequest& request) {
  if (clip.empty()) return {};
  if (!clip.finite()) return {clip};
  const Division division(field, width, request);
  std::vector<Box> places;
  std::vector<Part> parts{{clip, field}};
  for (int depth = 0; !parts.empty(); ++depth) {
    if (depth == kMostDivisions || parts.size() > kMostParts) {
      for (const Part& part : parts) places.push_back(part.box);
      break;
    }
    // In the order of the parts, whichever thread divides them.
    std::vector<std::vector<Part>> next(parts.size());
    std::vector<std::vector<Box>> met(parts.size());
    parallel_parts(parts.size(), size_t{16}, [&](const IndexRange<size_t>& range) {
      for (size_t i = range.begin(); i < range.end(); ++i) division.divide(parts[i], depth, next[i], met[i]);
    });
    parts.clear();
    for (std::vector<Part>& of_one : next) std::move(of_one.begin(), of_one.end(), std::back_inserter(parts));
    for (const std::vector<Box>& of_one : met) places.insert(places.end(), of_one.begin(), of_one.end());
  }
  return places;
}

}  // namespace limn
