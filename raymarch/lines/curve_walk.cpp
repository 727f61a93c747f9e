#include "raymarch/lines/curve_walk.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "sdf/segment.h"

namespace limn {
namespace {

constexpr double kParabolasApart_px = 0.01, kAlikeParabolas_px = 0.002;
constexpr double kCorner = 0.9;  // a cosine

/// Four samples of a curve, the second and third of them the ends of a step, and their places over their chords' lengths.
struct FourSamples {
  std::array<glm::dvec3, 4> p{};
  std::array<double, 4> s{};
  double least_turn = 1.0;  ///< The cosine of the sharper turn, at the second or the third.
};
/// Nothing at the ends of an open curve, and where neighbours are much nearer or farther than the step is long: those say little, and much
/// of rounding.
template <class Curve>
std::optional<FourSamples> around_step(const Curve& curve, size_t i) {
  const size_t n = curve.samples.size();
  const bool inner = curve.closed ? n >= 4 : i >= 1 && i + 2 < n;
  if (curve.straight || !inner) return {};
  // A division takes longer than the rest.
  const auto at = [&](size_t k) -> decltype(curve.samples[0]) { return curve.samples[k < n ? k : k % n]; };
  FourSamples four{{at(i > 0 ? i - 1 : n - 1).p, at(i).p, at(i + 1).p, at(i + 2).p}, {}};
  const double h = glm::distance(four.p[1], four.p[2]), back = glm::distance(four.p[0], four.p[1]),
               ahead = glm::distance(four.p[2], four.p[3]);
  if (!(h > 0.0) || back < 0.05 * h || ahead < 0.05 * h || back > 20.0 * h || ahead > 20.0 * h) return {};
  const glm::dvec3 way = (four.p[2] - four.p[1]) / h;
  const double turn_back = glm::dot(four.p[1] - four.p[0], way) / back, turn_ahead = glm::dot(four.p[3] - four.p[2], way) / ahead;
  four.least_turn = std::min(turn_back, turn_ahead);
  // Where three of them turn as at a corner the curve may have one: a contour where the surface's curvature jumps.
  const auto jumps = [&](size_t j) { return at(j).radial_curvature * at(j + 1).radial_curvature < 0.0; };
  if (turn_back < kCorner && (!curve.smooth || jumps(i + n - 1))) return {};
  if (turn_ahead < kCorner && (!curve.smooth || jumps(i + 1))) return {};
  four.s = {-back, 0.0, h, h + ahead};
  return four;
}

/// At one place: the parabolas through all samples but one, and the cubic through all of them.
struct Interpolated {
  glm::dvec3 without_last{0.0}, without_first{0.0}, cubic{0.0};
};
/// From lines through two samples up (Neville 1934, "Iterative interpolation").
Interpolated interpolated(const FourSamples& four, double t) {
  const std::array<double, 4>& s = four.s;
  const double x = t * s[2];
  const auto joined = [&](const glm::dvec3& lower, const glm::dvec3& upper, size_t first, size_t last) {
    return lower + (x - s[first]) / (s[last] - s[first]) * (upper - lower);
  };
  const glm::dvec3 before = joined(four.p[0], four.p[1], 0, 1), here = joined(four.p[1], four.p[2], 1, 2),
                   after = joined(four.p[2], four.p[3], 2, 3), without_last = joined(before, here, 0, 2),
                   without_first = joined(here, after, 1, 3);
  return {without_last, without_first, joined(without_last, without_first, 0, 3)};
}

/// Between samples i and i + 1: where the curve is smooth by the cubic through four of them. Its image may turn back at a cusp there, the
/// curve itself does not.
template <class Curve>
glm::dvec3 by_neighbours(const Curve& curve, size_t i, double t) {
  if (const auto four = around_step(curve, i)) return interpolated(*four, t).cubic;
  const size_t n = curve.samples.size();
  return glm::mix(curve.samples[i % n].p, curve.samples[(i + 1) % n].p, t);
}

/// The middle of a step by the cubic through four samples, where the parabolas through the step and either neighbour agree to within
/// `apart_px`: their mean, the cubic, is far nearer to the curve than they are to each other.
std::optional<glm::dvec3> middle_by_neighbours(const SurfaceCurve& curve, size_t i, const Camera& camera, double apart_px) {
  const auto four = around_step(curve, i);
  if (!four || four->least_turn < kCorner) return {};
  const Interpolated middle = interpolated(*four, 0.5);
  const double scale = pixels_per_unit_at(camera, std::max(curve.samples[i].depth, 1e-9));
  if (!(glm::distance(middle.without_last, middle.without_first) * scale < apart_px)) return {};
  return middle.cubic;
}

/// The middle of a step as far as it is known.
std::optional<glm::dvec3> known_middle(const SurfaceCurve& curve, size_t i, const Camera& camera) {
  if (!curve.between) return middle_by_neighbours(curve, i, camera, kParabolasApart_px);
  // The cubic costs little beside a search for the curve's own point.
  if (const auto middle = middle_by_neighbours(curve, i, camera, kAlikeParabolas_px)) return middle;
  return point_at(curve, i, 0.5);
}

}  // namespace

glm::dvec3 point_at(const SurfaceCurve& curve, size_t i, double share) {
  return curve.between ? curve.between(i % curve.samples.size(), share) : by_neighbours(curve, i, share);
}

CurvePath path_of(const SurfaceCurve& curve) {
  CurvePath path{curve.closed, curve.smooth, curve.straight, {}};
  path.samples.reserve(curve.samples.size());
  for (const CurveSample& sample : curve.samples) path.samples.push_back({sample.p, sample.radial_curvature});
  return path;
}

glm::dvec3 point_between(const CurvePath& path, size_t i, double share) { return by_neighbours(path, i, share); }

size_t steps_of(const SurfaceCurve& curve) { return curve.closed ? curve.samples.size() : curve.samples.size() - 1; }

double sag_px(const SurfaceCurve& curve, size_t step, const Camera& camera) {
  if (curve.straight) return 0.0;
  const CurveSample &a = curve.samples[step], &b = curve.samples[step + 1 < curve.samples.size() ? step + 1 : 0];
  if (!(a.depth > 0.0 && b.depth > 0.0) || (a.radial_curvature > 0.0) != (b.radial_curvature > 0.0)) return 0.0;
  const auto known = known_middle(curve, step, camera);
  if (!known) return 0.0;
  const glm::dvec3 middle = project(camera, *known);
  return middle.z > 0.0 ? distance_to_segment(glm::dvec2(middle), a.px, b.px) : 0.0;
}

bool in_frame(const Camera& camera, const CurveSample& q) {
  return q.depth > 0.0 && q.px.x >= 0.0 && q.px.y >= 0.0 && q.px.x <= camera.width_px && q.px.y <= camera.height_px;
}

CurveSample sample_at(const SurfaceCurve& curve, double at, const Camera& camera) {
  const size_t n = curve.samples.size();
  const auto i = static_cast<size_t>(at);
  const double t = at - static_cast<double>(i);
  const CurveSample &a = curve.samples[i % n], &b = curve.samples[(i + 1) % n];
  if (t == 0.0) return a;
  CurveSample sample = t < 0.5 ? a : b;
  sample.line_class = a.line_class;
  sample.object = a.object;
  sample.more_on_left = a.more_on_left;
  sample.edge = a.edge;
  sample.faces = a.faces;
  sample.joint = false;
  sample.on_chord = !curve.between;
  sample.p = point_at(curve, i, t);
  sample.radial_curvature = glm::mix(a.radial_curvature, b.radial_curvature, t);
  project_sample(camera, sample);
  return sample;
}

std::vector<glm::dvec2> px_between(const SurfaceCurve& curve, double from, double to, const Camera& camera) {
  return px_between(curve, sample_at(curve, from, camera).px, from, to, sample_at(curve, to, camera).px);
}

std::vector<glm::dvec2> px_between(const SurfaceCurve& curve, const glm::dvec2& from_px, double from, double to, const glm::dvec2& to_px) {
  const size_t n = curve.samples.size();
  std::vector<glm::dvec2> px{from_px};
  for (double i = std::floor(from) + 1.0; i < to; i += 1.0) px.push_back(curve.samples[static_cast<size_t>(i) % n].px);
  px.push_back(to_px);
  return px;
}

glm::dvec2 chord_px(const SurfaceCurve& curve, double place, const Camera& camera) {
  const size_t n = curve.samples.size();
  const auto i = static_cast<size_t>(place);
  const double t = place - static_cast<double>(i);
  return glm::dvec2(project(camera, glm::mix(curve.samples[i % n].p, curve.samples[(i + 1) % n].p, t)));
}

bool lies_along(const glm::dvec2& px, const std::vector<glm::dvec2>& line, double apart_px) {
  if (glm::distance(px, line[0]) < apart_px) return true;
  for (size_t i = 0; i + 1 < line.size(); ++i) {
    if (distance_to_segment(px, line[i], line[i + 1]) < apart_px) return true;
  }
  return false;
}

bool lies_along(const std::vector<glm::dvec2>& px, const std::vector<glm::dvec2>& line, double apart_px) {
  return std::all_of(px.begin(), px.end(), [&](const glm::dvec2& p) { return lies_along(p, line, apart_px); });
}

CurveWalk::CurveWalk(const SurfaceCurve& curve, const Camera& camera) : curve_(curve), camera_(camera) {
  lengths_.push_back(0.0);
  for (size_t i = 0; i < steps_of(curve); ++i) lengths_.push_back(lengths_.back() + glm::distance(at(i).px, at(i + 1).px));
}

double CurveWalk::length_to(double place) const {
  const double steps = static_cast<double>(steps_of(curve_));
  const double turns = curve_.closed ? std::floor(place / steps) : 0.0;
  const double rest = place - turns * steps;
  const auto i = std::min(static_cast<size_t>(rest), steps_of(curve_) - 1);
  return turns * lengths_.back() + glm::mix(lengths_[i], lengths_[i + 1], rest - static_cast<double>(i));
}

double CurveWalk::apart_of_lengths(double one_px, double other_px) const {
  const double way = std::fabs(one_px - other_px);
  return curve_.closed ? std::min(way, lengths_.back() - way) : way;
}

std::vector<glm::dvec2> CurveWalk::px_from(double place, double length_px, int way) const {
  std::vector<glm::dvec2> px{sample_at(curve_, place, camera_).px};
  const auto n = static_cast<std::ptrdiff_t>(size());
  auto i = static_cast<std::ptrdiff_t>(place) + (way > 0 ? 1 : 0);
  for (double length = 0.0; length < length_px + 0.5 && (curve_.closed || (i >= 0 && i < n)); i += way) {
    px.push_back(at(static_cast<size_t>((i + n) % n)).px);
    length += glm::distance(px.back(), px[px.size() - 2]);
    if (static_cast<std::ptrdiff_t>(px.size()) > n) break;
  }
  return px;
}

}  // namespace limn
