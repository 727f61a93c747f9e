#include "raymarch/lines/feature_function.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "raymarch/scene/curvature.h"

namespace limn {
namespace {

constexpr double kWeak = 0.5;        // of a cut-off: a line goes on as far as this where it is beyond the cut-off elsewhere (hysteresis)
constexpr double kLook = 0.8;        // of what is kept at least: corners of triangles are looked at beyond it
constexpr double kLookCosine = 0.1;  // the same of the cosine between normal and view
constexpr double kRounding = 1e-9;   // of the curvature squared
constexpr double kBlunt = 0.05;      // second derivative of an extremal curvature, over its cube: less is a cylinder's or a torus'
constexpr double kAside = 0.01;      // of the radius of curvature: for that derivative

constexpr double kResolved = 0.35;  // of the curvature: it changes by less over a voxel where the voxels show it

/// The principal curvature that a class is about, and its direction.
struct Extreme {
  double k = 0.0, other = 0.0;  ///< Signed so that it is positive on lines of the class.
  glm::dvec3 along{0.0};
};

Extreme extreme_of(const FeaturePoint& point, LineClass line_class) {
  const SurfaceCurvature curvature = curvature_of_tensor(point.shape, point.normal);
  if (line_class == LineClass::ridge) return {curvature.k1, curvature.k2, curvature.direction1};
  return {-curvature.k2, -curvature.k1, glm::cross(point.normal, curvature.direction1)};
}

/// Root of the sum of both principal curvatures' squares.
double size_of(const FeaturePoint& point) {
  double squared = 0.0;
  for (int i = 0; i < 3; ++i) squared += glm::dot(point.shape[i], point.shape[i]);
  return std::sqrt(squared);
}

}  // namespace

double radial_curvature_of(const FeaturePoint& point, const glm::dvec3& view) {
  const glm::dvec3 w = view - glm::dot(view, point.normal) * point.normal;
  return glm::dot(w, point.shape * w) / glm::dot(w, w);
}

FeatureValue FeatureFunction::value(const FeaturePoint& point) const {
  if (line_class_ == LineClass::suggestive) {
    const glm::dvec3 view = view_vector(camera_, point.p);
    return {glm::dot(view, point.shape * view), glm::dvec3(0.0)};
  }
  const Extreme extreme = extreme_of(point, line_class_);
  const double slope = surface_.change(point, extreme.along);
  // Never 0, so that turning the direction round always changes the sign.
  return {slope == 0.0 ? std::numeric_limits<double>::min() : slope, extreme.along};
}

bool FeatureFunction::worth_a_look(const FeaturePoint& point) const {
  if (line_class_ == LineClass::suggestive) {
    const double most = std::cos(settings_.suggestive_angle_deg * std::numbers::pi / 180.0);
    return std::fabs(glm::dot(point.normal, view_vector(camera_, point.p))) <= most + kLookCosine;
  }
  const Extreme extreme = extreme_of(point, line_class_);
  return extreme.k * surface_.radius >= kLook * kWeak * settings_.ridge_strength && extreme.k > kLook * std::fabs(extreme.other);
}

bool FeatureFunction::is_rounding(const FeaturePoint& point, const FeatureValue& value) const {
  const double size = size_of(point);
  return std::fabs(value.value) <= kRounding * (line_class_ == LineClass::suggestive ? size : size * size);
}

/// The derivative of the radial curvature along w where that is 0: C(w, w, w) + 2 K cot(theta), w made unit (DeCarlo, Finkelstein and
/// Rusinkiewicz 2004); times the radius squared. Seen from behind the surface counts with its other normal.
double FeatureFunction::suggestion(const FeaturePoint& point) const {
  const glm::dvec3 view = view_vector(camera_, point.p);
  const double facing = glm::dot(view, point.normal);
  const glm::dvec3 across = view - facing * point.normal;
  const double sine = glm::length(across);
  if (!(sine > 0.0)) return -1.0;
  const glm::dvec3 w = across / sine, bent = point.shape * w;
  const double kr = glm::dot(w, bent), twist = glm::dot(bent, bent) - kr * kr;
  const double slope = surface_.change(point, w) - 2.0 * twist * facing / sine;
  return (facing < 0.0 ? -slope : slope) * surface_.radius * surface_.radius;
}

double FeatureFunction::strength(const FeaturePoint& point) const { return extreme_of(point, line_class_).k * surface_.radius; }

/// How fast the curvature falls off on both sides, over its cube: 3 at the vertex of a parabola, 0 on cylinders. Without a unit.
double FeatureFunction::sharpness(const FeaturePoint& point) const {
  const Extreme extreme = extreme_of(point, line_class_);
  const double aside = std::max(kAside / extreme.k, surface_.step);
  double slopes[2] = {0.0, 0.0}, places[2] = {0.0, 0.0};
  for (int side = 0; side < 2; ++side) {
    const FeaturePoint beside = surface_.beside(point, (side == 0 ? -aside : aside) * extreme.along);
    if (!beside.valid) return 0.0;
    const FeatureValue there = value(beside);
    slopes[side] = glm::dot(there.along, extreme.along) < 0.0 ? -there.value : there.value;
    places[side] = glm::dot(beside.p - point.p, extreme.along);
  }
  const double sign = line_class_ == LineClass::ridge ? 1.0 : -1.0;
  return -sign * (slopes[1] - slopes[0]) / (places[1] - places[0]) / (extreme.k * extreme.k * extreme.k);
}

double FeatureFunction::kept(const FeaturePoint& point) const {
  double least = std::numeric_limits<double>::infinity();
  if (surface_.margin) {
    least = surface_.margin(point) / surface_.radius;
    if (least < 0.0) return least;
  }
  if (line_class_ == LineClass::suggestive) {
    const double most = std::cos(settings_.suggestive_angle_deg * std::numbers::pi / 180.0);
    least = std::min(least, most - std::fabs(glm::dot(point.normal, view_vector(camera_, point.p))));
    if (least < 0.0) return least;
    const double found = suggestion(point);
    if (surface_.swings) least = std::min(least, kResolved - found / (surface_.radius * surface_.radius) * surface_.step / size_of(point));
    return std::min(least, found - kWeak * settings_.suggestive_slope);
  }
  const Extreme extreme = extreme_of(point, line_class_);
  least = std::min({least, extreme.k * surface_.radius - kWeak * settings_.ridge_strength, extreme.k - std::fabs(extreme.other)});
  return least < 0.0 ? least : std::min(least, sharpness(point) - kBlunt);
}

std::optional<double> FeatureFunction::curvature_across(const FeaturePoint& point) const {
  if (line_class_ == LineClass::suggestive) return {};
  return extreme_of(point, line_class_).k;
}

bool FeatureFunction::strong(const FeaturePoint& point) const {
  if (line_class_ == LineClass::suggestive) return suggestion(point) > settings_.suggestive_slope;
  return strength(point) > settings_.ridge_strength;
}

}  // namespace limn
