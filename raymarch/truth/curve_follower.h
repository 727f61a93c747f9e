#pragma once
// Internal: one curve N.V = c on surface that has two derivatives everywhere, followed along its tangents.

#include <functional>
#include <optional>
#include <vector>

#include "raymarch/truth/followed_curves.h"
#include "raymarch/truth/locate.h"

namespace limn {

/// For one thread. Keeps references to what it is given, but for the field.
class CurveFollower {
 public:
  CurveFollower(const Field& field, const Camera& camera, const Viewer& viewer, const FollowSettings& settings, double c)
      : evaluator_(field), camera_(camera), viewer_(viewer), settings_(settings), c_(c) {}

  /// So near to the curve, in longest steps, a seed is expected.
  static constexpr double kSeedReach = 0.25;
  /// The curve's own point within `reach` longest steps of one beside it.
  std::optional<CurvePoint> seed(const CurvePoint& point, double reach = kSeedReach);
  /// From the point around to it again; nothing where the curve is lost on the way, or `stop()`, asked now and then, is true. A step that
  /// led onto another arm may never come back: then all of it is tried in shorter steps.
  std::optional<std::vector<CurvePoint>> around(const CurvePoint& start, const std::function<bool()>& stop);

 private:
  struct Course;
  struct Ahead;

  /// The image of a way from a point, px.
  glm::dvec2 image_way(const glm::dvec3& p, const glm::dvec3& way) const;
  std::optional<std::vector<CurvePoint>> around_in_steps(const CurvePoint& start, double longest, const std::function<bool()>& stop);
  /// The image turns back and forth within a step, as at the two cusps of a swallowtail, by the parabola that its speed follows: what it is
  /// at either end and, from the chord, in the mean.
  bool turns_twice(const glm::dvec3& from, const glm::dvec3& to, const glm::dvec2& start, const glm::dvec2& end, double step) const;
  /// Somewhere along a step the curve is not where its ends and tangents lead: it goes round a fold in between.
  bool leaves_cubic(const glm::dvec3& from, const glm::dvec3& to, const glm::dvec3& start, const glm::dvec3& end);
  /// The longest step within all bounds, as far as the one to `to` tells, as a share of that: from 1 on `to` is within them.
  double fitting_share(const CurvePoint& from, const Course& course, double step, const Ahead& to) const;
  /// Between the two the curve or its image may do more than its ends tell.
  bool goes_round(const CurvePoint& from, const Course& course, double step, const Ahead& to);
  /// A step that is shortened until it stays on the curve and on its chord, and set for the next one.
  std::optional<Ahead> advance(const CurvePoint& from, const Course& course, double longest, double& step);

  FieldEvaluator evaluator_;
  const Camera& camera_;
  const Viewer& viewer_;
  const FollowSettings& settings_;
  double c_;
};

}  // namespace limn
