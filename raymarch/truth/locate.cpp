#include "raymarch/truth/locate.h"

#include <cmath>

namespace limn {
namespace {

constexpr double kViewTurn = 1e-10;
constexpr double kCreaseAngle = 1e-5;  // normals that differ by more where a bisection ended: the surface has a crease there
constexpr double kFastestTurn = 20.0;  // of N.V over the reach of Newton's iteration
constexpr int kRootSteps = 80;
constexpr int kNewtonSteps = 12;

bool below(double x, double c) { return x < c; }

double value_at(FieldEvaluator& evaluator, const glm::dvec3& p) { return evaluator.value(p); }

glm::dvec3 unit(const glm::dvec3& v) {
  const double length = glm::length(v);
  return length > 0.0 ? v / length : v;
}

CurvePoint smooth_point(const glm::dvec3& p, const FieldJet& jet, const glm::dvec3& v, const glm::dvec3& uphill) {
  CurvePoint result;
  result.p = p;
  const double length = glm::length(jet.gradient);
  result.high = result.low = jet.gradient / length;
  const glm::dvec3 w = v - glm::dot(result.high, v) * result.high;
  result.radial_curvature = glm::dot(w, jet.hessian * w) / (length * glm::dot(w, w));
  result.uphill = uphill;
  return result;
}

}  // namespace

Viewer make_viewer(const Camera& camera, const glm::dvec3& scene_center) {
  Viewer viewer{camera};
  const glm::dvec3 across = 0.8 * camera.world_from_camera[0] + 0.6 * camera.world_from_camera[1];
  if (camera.projection == Projection::perspective) {
    viewer.facing.eye += kViewTurn * glm::length(camera.eye - scene_center) * across;
  } else {
    viewer.facing.world_from_camera[2] += kViewTurn * across;
  }
  return viewer;
}

double facing_of(const Viewer& viewer, const glm::dvec3& p, const glm::dvec3& gradient) {
  const double length = glm::length(gradient);
  return length > 0.0 ? glm::dot(gradient, viewer.toward_eye(p)) / length : 0.0;
}

SurfaceSample sample_surface(FieldEvaluator& evaluator, const Viewer& viewer, const glm::dvec3& p) {
  SurfaceSample sample;
  sample.p = p;
  double value = 0.0;
  evaluator.gradients(std::span(&p, 1), std::span(&value, 1), std::span(&sample.gradient, 1));
  sample.facing = facing_of(viewer, p, sample.gradient);
  return sample;
}

// The Illinois variant of false position (Dowell & Jarratt 1971), with a bisection where it stalls.
glm::dvec3 root_between(FieldEvaluator& evaluator, glm::dvec3 a, glm::dvec3 b, double fa, double fb) {
  double ta = 0.0, tb = 1.0;
  const glm::dvec3 start = a, way = b - a;
  int last_side = 0;
  for (int step = 0; step < kRootSteps && tb - ta > 1e-15; ++step) {
    double t = ta + (tb - ta) * fa / (fa - fb);
    if (!(t > ta && t < tb) || step % 16 == 15) t = 0.5 * (ta + tb);
    const double f = value_at(evaluator, start + t * way);
    if (f == 0.0) return start + t * way;
    if (below(f, 0.0) == below(fa, 0.0)) {
      const double moved = t - ta;
      ta = t;
      fa = f;
      if (last_side == -1) fb *= 0.5;
      last_side = -1;
      if (moved < 1e-15) break;
    } else {
      const double moved = tb - t;
      tb = t;
      fb = f;
      if (last_side == 1) fa *= 0.5;
      last_side = 1;
      if (moved < 1e-15) break;
    }
  }
  return start + (std::fabs(fa) < std::fabs(fb) ? ta : tb) * way;
}

std::optional<CurvePoint> polish(FieldEvaluator& evaluator, const Viewer& viewer, double c, const glm::dvec3& start, double reach,
                                 double close) {
  glm::dvec3 p = start;
  const bool perspective = viewer.facing.projection == Projection::perspective;
  for (int step = 0; step < kNewtonSteps; ++step) {
    const FieldJet jet = evaluator.jet(p);
    const double length = glm::length(jet.gradient);
    if (!(length > 0.0) || !std::isfinite(length)) return {};
    const glm::dvec3 to_eye = viewer.facing.eye - p;
    const double away = glm::length(to_eye);
    const glm::dvec3 n = jet.gradient / length, v = perspective ? to_eye * (1.0 / away) : viewer.toward_eye(p);
    const double facing = glm::dot(n, v);
    const glm::dvec3 hv = jet.hessian * v, hn = jet.hessian * n;
    glm::dvec3 slope = (hv - facing * hn) / length;
    if (perspective) slope += (facing * v - n) / away;
    const double f = jet.value / length, h = facing - c;
    const double nn = 1.0, ns = glm::dot(n, slope), ss = glm::dot(slope, slope);
    // The distance around a sharp edge is rounded outside: what turns that fast is the edge and no smooth surface.
    if (!(ss * reach * reach < kFastestTurn * kFastestTurn)) return {};
    const double determinant = nn * ss - ns * ns;
    if (!(determinant > 1e-12 * ss) || !std::isfinite(determinant)) return {};
    const double on_n = (ss * f - ns * h) / determinant, on_s = (nn * h - ns * f) / determinant;
    const glm::dvec3 move = on_n * n + on_s * slope;
    p -= move;
    const glm::dvec3 moved = p - start;
    if (!(glm::dot(moved, moved) <= reach * reach)) return {};
    if (glm::dot(move, move) < close * close * reach * reach) return smooth_point(p, jet, v, slope - ns * n);
  }
  return {};
}

std::optional<CurvePoint> polish_seam(FieldEvaluator& first, FieldEvaluator& second, const glm::dvec3& start, double reach) {
  glm::dvec3 p = start;
  const auto at = [&p](FieldEvaluator& evaluator, double& value) {
    glm::dvec3 gradient;
    evaluator.gradients(std::span(&p, 1), std::span(&value, 1), std::span(&gradient, 1));
    const double length = glm::length(gradient);
    value /= length;
    return gradient / length;
  };
  for (int step = 0; step < kNewtonSteps; ++step) {
    double f = 0.0, g = 0.0;
    const glm::dvec3 n = at(first, f), m = at(second, g);
    const double nm = glm::dot(n, m), determinant = 1.0 - nm * nm;
    if (!(determinant > 1e-12) || !std::isfinite(f + g)) return {};
    const glm::dvec3 move = ((f - nm * g) * n + (g - nm * f) * m) / determinant;
    p -= move;
    if (!(glm::length(p - start) <= reach)) return {};
    if (glm::length(move) < 1e-7 * reach) {
      CurvePoint point;
      point.p = p;
      point.crease = true;
      return point;
    }
  }
  return {};
}

std::optional<SurfaceSample> Fan::at(FieldEvaluator& evaluator, const Viewer& viewer, double s) const {
  // A sharp edge may reach through the far side: there the segment is followed beyond it.
  for (const double reach : {1.0, 2.0, 4.0, 8.0}) {
    const glm::dvec3 far = apex + reach * (middle + s * side - apex);
    const double far_value = value_at(evaluator, far);
    if (below(far_value, 0.0) == below(apex_value, 0.0)) continue;
    return sample_surface(evaluator, viewer, root_between(evaluator, apex, far, apex_value, far_value));
  }
  return {};
}

namespace {

/// Where the tangent planes at a and b meet in the fan's plane, as its parameter: near a crease, off by the square of the distance.
double crease_guess(const Fan& fan, const SurfaceSample& a, const SurfaceSample& b) {
  const glm::dvec3 to_middle = fan.middle - fan.apex, m = glm::cross(to_middle, fan.side);
  const glm::dvec3 tangent = glm::cross(a.gradient, m);
  const double share = glm::dot(b.gradient, b.p - a.p) / glm::dot(b.gradient, tangent);
  const glm::dvec3 y = a.p + share * tangent - fan.apex;
  return -glm::dot(glm::cross(y, to_middle), m) / glm::dot(glm::cross(y, fan.side), m);
}

/// The next parameter to try between sa and sb. Guesses overshoot a little towards the farther end, so that both ends come near.
double next_parameter(const Fan& fan, double sa, double sb, const SurfaceSample& a, const SurfaceSample& b, double c, int step) {
  const double width = std::fabs(sb - sa), middle = 0.5 * (sa + sb);
  if (step < 3) return sa + std::clamp((c - a.facing) / (b.facing - a.facing), 0.1, 0.9) * (sb - sa);
  if (step % 4 == 3) return middle;
  const double guess = crease_guess(fan, a, b), away = std::max(0.1 * width * std::min(width, 1.0), 1e-13);
  const double tried = guess + (guess < middle ? away : -away);
  return tried > std::min(sa, sb) && tried < std::max(sa, sb) ? tried : middle;
}

}  // namespace

std::optional<CurvePoint> bisect(FieldEvaluator& evaluator, const Viewer& viewer, double c, const Fan& fan, double sa, double sb,
                                 SurfaceSample a, SurfaceSample b, double smooth_reach) {
  const glm::dvec3 uphill = a.facing > b.facing ? a.p - b.p : b.p - a.p;
  const bool a_below = below(a.facing, c);
  const double near = 1e-11 * (glm::length(a.p) + glm::length(fan.middle - fan.apex));
  for (int step = 0; step < 80; ++step) {
    // Three guided steps, then Newton; what Newton cannot finish is cut down, whatever it is.
    if (step == 3) {
      auto finished = polish(evaluator, viewer, c, a.p + (c - a.facing) / (b.facing - a.facing) * (b.p - a.p), smooth_reach);
      if (finished) {
        finished->uphill = uphill;
        return finished;
      }
    }
    const double s = next_parameter(fan, sa, sb, a, b, c, step);
    const auto middle = fan.at(evaluator, viewer, s);
    if (!middle) return {};
    (below(middle->facing, c) == a_below ? a : b) = *middle;
    (below(middle->facing, c) == a_below ? sa : sb) = s;
    if (step > 3 && (glm::length(b.p - a.p) < near || std::fabs(sb - sa) < 1e-14)) break;
  }
  // Where the fan's segments meet the surface more than once the root may jump from one sheet to the next: that is no crossing.
  if (!(glm::length(b.p - a.p) < 1e-3 * glm::length(uphill))) return {};
  CurvePoint result;
  const SurfaceSample &high = a_below ? b : a, &low = a_below ? a : b;
  result.p = 0.5 * (a.p + b.p);
  result.high = unit(high.gradient);
  result.low = unit(low.gradient);
  result.crease = glm::length(result.high - result.low) > kCreaseAngle;
  result.uphill = uphill;
  return result;
}

namespace {

/// A fan of segments from inside the body (or, for a notch, from outside it) outwards along `way`, opened until the signs at its ends
/// differ.
std::optional<CurvePoint> search_fan(FieldEvaluator& evaluator, const Viewer& viewer, double c, const glm::dvec3& middle, double radius,
                                     const glm::dvec3& way, const glm::dvec3& side) {
  Fan fan{middle - radius * way, middle + radius * way, 2.0 * radius * side};
  fan.apex_value = value_at(evaluator, fan.apex);
  for (const double opening : {0.5, 1.0, 2.0}) {
    const auto left = fan.at(evaluator, viewer, -opening), right = fan.at(evaluator, viewer, opening);
    if (!left || !right || below(left->facing, c) == below(right->facing, c)) continue;
    if (auto point = bisect(evaluator, viewer, c, fan, -opening, opening, *left, *right, 0.4 * radius)) return point;
  }
  return {};
}

}  // namespace

std::optional<CurvePoint> point_between(FieldEvaluator& evaluator, const Viewer& viewer, double c, const CurvePoint& a, const CurvePoint& b,
                                        const glm::dvec3& middle, double reach) {
  const double length = glm::length(b.p - a.p);
  if (!(length > 0.0)) return {};
  const glm::dvec3 along = (b.p - a.p) / length;
  if (!a.crease || !b.crease) {
    auto point = polish(evaluator, viewer, c, middle, 0.5 * reach * length);
    const double place = point ? glm::dot(point->p - a.p, along) / length : -1.0;
    if (point && place > 0.0 && place < 1.0) return point;
  }
  const glm::dvec3 at_a = unit(a.high + a.low), at_b = unit(b.high + b.low);
  for (const glm::dvec3& outward : {at_a + at_b, a.crease ? at_a : at_b, a.crease ? at_b : at_a}) {
    const glm::dvec3 n = unit(outward - glm::dot(outward, along) * along);
    for (const double radius : {0.5 * reach * length, 0.1 * reach * length}) {
      for (const double inward : {1.0, -1.0}) {
        auto point = search_fan(evaluator, viewer, c, middle, radius, inward * n, glm::cross(along, n));
        if (point && glm::length(point->p - middle) < reach * length) return point;
      }
    }
  }
  return {};
}

namespace {

/// Across N and the gradient of N.V, or along the edge where two sides meet.
glm::dvec3 tangent_at(FieldEvaluator& evaluator, const Viewer& viewer, const CurvePoint& point) {
  if (point.crease) return unit(glm::cross(point.high, point.low));
  const FieldJet jet = evaluator.jet(point.p);
  const double length = glm::length(jet.gradient);
  const glm::dvec3 n = jet.gradient / length, v = viewer.toward_eye(point.p);
  const double facing = glm::dot(n, v);
  glm::dvec3 slope = (jet.hessian * v - facing * (jet.hessian * n)) / length;
  if (viewer.facing.projection == Projection::perspective) slope += (facing * v - n) / glm::length(viewer.facing.eye - point.p);
  return unit(glm::cross(n, slope));
}

/// The curve's point beside `guess`, which lies along the tangent from `from`.
std::optional<CurvePoint> beside(FieldEvaluator& evaluator, const Viewer& viewer, double c, const CurvePoint& from,
                                 const glm::dvec3& tangent, const glm::dvec3& guess) {
  const double away = glm::length(guess - from.p);
  std::optional<CurvePoint> found;
  if (!from.crease) {
    found = polish(evaluator, viewer, c, guess, 0.5 * away);
  } else {
    const glm::dvec3 way = unit(from.high + from.low);
    for (const double inward : {1.0, -1.0}) {
      if (!found) found = search_fan(evaluator, viewer, c, guess, 0.2 * away, inward * way, glm::cross(tangent, way));
    }
  }
  if (!found || found->crease != from.crease || !(glm::length(found->p - guess) < 0.5 * away)) return {};
  return found;
}

}  // namespace

std::optional<CornerSides> close_in(FieldEvaluator& evaluator, const Viewer& viewer, double c, const CurvePoint& first,
                                    const CurvePoint& second) {
  const glm::dvec3 u = tangent_at(evaluator, viewer, first), v = tangent_at(evaluator, viewer, second), between = second.p - first.p;
  const double uv = glm::dot(u, v), determinant = 1.0 - uv * uv, length = glm::length(between);
  if (!(determinant > 1e-6)) return {};
  const double along_u = (glm::dot(between, u) - uv * glm::dot(between, v)) / determinant;
  const double along_v = (uv * glm::dot(between, u) - glm::dot(between, v)) / determinant;
  if (!(std::max(std::fabs(along_u), std::fabs(along_v)) < 3.0 * length)) return {};
  const auto a = beside(evaluator, viewer, c, first, u, first.p + 0.5 * along_u * u);
  const auto b = beside(evaluator, viewer, c, second, v, second.p + 0.5 * along_v * v);
  if (!a || !b || !(glm::length(a->p - b->p) < 0.9 * length)) return {};
  return CornerSides{*a, *b};
}

}  // namespace limn
