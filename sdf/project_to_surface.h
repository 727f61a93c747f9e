#pragma once
// Damped Newton onto a surface, over whatever gives the field's value and gradient.

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include "sdf/geometry.h"

namespace limn {

/// One point on its way onto the surface, a question at a time, so that many can be asked together: what project_to_surface (sdf/shape.h)
/// does. `extent` is the radius of the field's bounds; not above 0: they are not finite.
class SurfaceProjection {
 public:
  SurfaceProjection(const glm::dvec3& start, double extent, double tolerance)
      : asked_(start), tolerance_(tolerance), extent_(extent > 0.0 ? extent : std::max(1.0, glm::length(start))) {}

  bool done() const { return done_; }
  /// Where the field is to be evaluated next. Must not be done.
  const glm::dvec3& asks() const { return asked_; }
  void answer(double value, const glm::dvec3& gradient) {
    if (!begun_ || std::fabs(value) < std::fabs(value_)) {
      steps_ += begun_;
      begun_ = true;
      position_ = asked_, value_ = value, gradient_ = gradient;
      return begin_step();
    }
    // Halved until it brings the surface nearer.
    if (++halvings_ == kMostHalvings) return finish(false);
    move_ *= 0.5;
    asked_ = position_ + move_;
  }

  /// Once done: whether the surface was reached, the last place and the field there.
  bool reached() const { return reached_; }
  const glm::dvec3& position() const { return position_; }
  double value() const { return value_; }
  const glm::dvec3& gradient() const { return gradient_; }

 private:
  static constexpr int kMostSteps = 50, kMostHalvings = 30;

  bool close_enough() const {
    // Below a few units in the last place of the coordinates there is nothing left to improve.
    const double rounding = 4.0 * std::numeric_limits<double>::epsilon() * (extent_ + glm::length(position_));
    return std::fabs(value_) <= std::max(tolerance_ * extent_, rounding);
  }
  void finish(bool reached) { done_ = true, reached_ = reached; }
  void begin_step() {
    if (close_enough()) return finish(true);
    const double squared = glm::dot(gradient_, gradient_);
    if (steps_ == kMostSteps || !(squared > 0.0)) return finish(false);
    // A step beyond the whole object is never of use.
    move_ = (-value_ / squared) * gradient_;
    const double longest = 2.0 * (extent_ + glm::length(position_));
    if (glm::length(move_) > longest) move_ *= longest / glm::length(move_);
    halvings_ = 0;
    asked_ = position_ + move_;
  }

  glm::dvec3 asked_, position_{0.0}, gradient_{0.0}, move_{0.0};
  double value_ = 0.0, tolerance_, extent_;
  int steps_ = 0, halvings_ = 0;
  bool begun_ = false, done_ = false, reached_ = false;
};

/// For SurfaceProjection.
inline double extent_of(const Box& bounds) { return bounds.finite() ? bounds.radius() : 0.0; }

/// Points on their way together, each as it goes by itself: `gradients_at(points, values, gradients)` evaluates the field at all places
/// that are asked next.
template <class GradientsAt>
std::vector<SurfaceProjection> project_together(const GradientsAt& gradients_at, std::span<const glm::dvec3> points, double extent,
                                                double tolerance) {
  std::vector<SurfaceProjection> projections;
  projections.reserve(points.size());
  for (const glm::dvec3& point : points) projections.emplace_back(point, extent, tolerance);
  std::vector<size_t> open(points.size());
  std::iota(open.begin(), open.end(), size_t{0});
  std::vector<glm::dvec3> asked, gradients;
  std::vector<double> values;
  while (!open.empty()) {
    asked.clear();
    for (const size_t i : open) asked.push_back(projections[i].asks());
    values.resize(open.size()), gradients.resize(open.size());
    gradients_at(std::span<const glm::dvec3>(asked), std::span(values), std::span(gradients));
    for (size_t k = 0; k < open.size(); ++k) projections[open[k]].answer(values[k], gradients[k]);
    std::erase_if(open, [&](size_t i) { return projections[i].done(); });
  }
  return projections;
}

/// `bounds` are the field's, `gradient_at(point, value, gradient)` evaluates it.
template <class GradientAt>
bool project_with(const GradientAt& gradient_at, const Box& bounds, glm::dvec3& point, double tolerance) {
  SurfaceProjection projection(point, extent_of(bounds), tolerance);
  while (!projection.done()) {
    glm::dvec3 gradient;
    double value = 0.0;
    gradient_at(projection.asks(), value, gradient);
    projection.answer(value, gradient);
  }
  point = projection.position();
  return projection.reached();
}

}  // namespace limn
