#include "samples/judge/helpers/svg_curves.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "samples/judge/svg_file.h"

namespace limn {
namespace {

constexpr double kFarthest_px = 1e6;
constexpr int kMostPieces = 20'000;

/// 1 for what is no number: then a point is none, either.
int pieces_of(double wanted) { return wanted > 1.0 ? static_cast<int>(std::ceil(std::min(wanted, 1.0 * kMostPieces))) : 1; }

/// The transform's larger singular value.
double scale_of(const glm::dmat3& m) {
  const double a = m[0].x, b = m[0].y, c = m[1].x, d = m[1].y;
  const double sum = 0.5 * (a * a + b * b + c * c + d * d);
  const double det = a * d - b * c;
  return std::sqrt(sum + std::sqrt(std::max(0.0, sum * sum - det * det)));
}

}  // namespace

void CurveFlattener::line(const glm::dvec2& to, std::vector<glm::dvec2>& points) const {
  const glm::dvec2 p(transform * glm::dvec3(to, 1.0));
  if (!(std::fabs(p.x) <= kFarthest_px && std::fabs(p.y) <= kFarthest_px))
    throw std::runtime_error("a point lies more than a million pixels away; coordinates near the viewBox");
  if (points.empty() || points.back() != p) points.push_back(p);
}

void CurveFlattener::cubic(const std::array<glm::dvec2, 4>& c, std::vector<glm::dvec2>& points) const {
  // n chords of equal parameter lie within M / n^2 * 3/4 of the curve, M the largest second difference of the control points (Wang 1984,
  // "The subdivision method for finding the intersection between two Bezier curves or surfaces").
  const double bend = scale_of(transform) * std::max(glm::length(c[0] - 2.0 * c[1] + c[2]), glm::length(c[1] - 2.0 * c[2] + c[3]));
  const int count = pieces_of(std::sqrt(0.75 * bend / kSvgFlatness_px));
  for (int i = 1; i <= count; ++i) {
    const double t = static_cast<double>(i) / count, s = 1.0 - t;
    line(i == count ? c[3] : s * s * s * c[0] + 3.0 * s * s * t * c[1] + 3.0 * s * t * t * c[2] + t * t * t * c[3], points);
  }
}

void CurveFlattener::arc(const EllipticArc& one, std::vector<glm::dvec2>& points) const {
  // From two ends to centre and angles: SVG 1.1 (W3C 2011), appendix F.6.
  double rx = std::fabs(one.radii.x), ry = std::fabs(one.radii.y);
  if (rx == 0.0 || ry == 0.0 || one.from == one.to) {
    line(one.to, points);
    return;
  }
  const double phi = one.rotation_deg * std::numbers::pi / 180.0, cosine = std::cos(phi), sine = std::sin(phi);
  const glm::dvec2 half = 0.5 * (one.from - one.to);
  const glm::dvec2 p(cosine * half.x + sine * half.y, -sine * half.x + cosine * half.y);
  const double reach = (p.x / rx) * (p.x / rx) + (p.y / ry) * (p.y / ry);
  if (reach > 1.0) rx *= std::sqrt(reach), ry *= std::sqrt(reach);
  const double product = rx * rx * p.y * p.y + ry * ry * p.x * p.x;
  double factor = product > 0.0 ? std::sqrt(std::max(0.0, rx * rx * ry * ry / product - 1.0)) : 0.0;
  if (one.large == one.sweep) factor = -factor;
  const glm::dvec2 q(factor * rx * p.y / ry, -factor * ry * p.x / rx);
  const glm::dvec2 center = glm::dvec2(cosine * q.x - sine * q.y, sine * q.x + cosine * q.y) + 0.5 * (one.from + one.to);
  const double begin = std::atan2((p.y - q.y) / ry, (p.x - q.x) / rx);
  double turn = std::atan2((-p.y - q.y) / ry, (-p.x - q.x) / rx) - begin;
  if (one.sweep && turn < 0.0) turn += 2.0 * std::numbers::pi;
  if (!one.sweep && turn > 0.0) turn -= 2.0 * std::numbers::pi;
  const double radius = scale_of(transform) * std::max(rx, ry);
  // A chord of angle w lies within radius (1 - cos(w / 2)) of the arc.
  const double widest = 2.0 * std::acos(std::max(0.0, 1.0 - kSvgFlatness_px / std::max(radius, kSvgFlatness_px)));
  const int count = pieces_of(std::fabs(turn) / widest);
  for (int i = 1; i < count; ++i) {
    const double angle = begin + turn * i / count;
    const glm::dvec2 r(rx * std::cos(angle), ry * std::sin(angle));
    line(center + glm::dvec2(cosine * r.x - sine * r.y, sine * r.x + cosine * r.y), points);
  }
  line(one.to, points);
}

}  // namespace limn
