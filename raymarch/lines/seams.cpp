#include "raymarch/lines/seams.h"

#include <algorithm>

#include "raymarch/truth/parts.h"

namespace limn {
namespace {

constexpr double kAtSample = 1e-9;  // of a step

/// Positive where `towards` (image direction) leads to the left of the step from a to b; as long as the step.
double leftness(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& towards) {
  const glm::dvec2 step = b - a;
  const double length = glm::length(towards);
  return length > 0.0 ? (towards.x * step.y - towards.y * step.x) / length : 0.0;
}

/// Of each side of a seam: 1 where it lies on the left in the image of who walks along it while it faces the eye, -1 where on the right.
std::vector<int> sides_on_left(const Seam& seam) {
  const size_t n = seam.samples.size();
  std::vector<double> left(seam.samples.front().sides.size(), 0.0);
  for (size_t i = 0; i + (seam.closed ? 0 : 1) < n; ++i) {
    const SeamSample &a = seam.samples[i], &b = seam.samples[(i + 1) % n];
    for (const SeamSample* at : {&a, &b}) {
      for (size_t k = 0; k < left.size(); ++k) left[k] += glm::dot(glm::cross(b.p - a.p, at->sides[k].into), at->sides[k].normal);
    }
  }
  std::vector<int> result;
  result.reserve(left.size());
  for (const double x : left) result.push_back(x > 0.0 ? 1 : -1);
  return result;
}

/// A side of a step that turns from front to back or the other way round.
struct Turn {
  double t = 0.0;
  size_t side = 0;
};

std::vector<Turn> turns_between(const SeamSample& a, const SeamSample& b) {
  std::vector<Turn> turns;
  for (size_t k = 0; k < a.sides.size(); ++k) {
    const double fa = a.sides[k].facing, fb = b.sides[k].facing;
    if ((fa > 0.0) != (fb > 0.0)) turns.push_back({std::clamp(fa / (fa - fb), 0.0, 1.0), k});
  }
  std::sort(turns.begin(), turns.end(), [](const Turn& x, const Turn& y) { return x.t < y.t; });
  return turns;
}

/// A point of a seam within the step from sample `from`, or at its beginning, with what is true of the rest of that step: which of its
/// sides face the eye. `seam` is the sample nearest to it.
CurveSample curve_sample(const Camera& camera, const Seam& whole, size_t from, const SeamSample& seam, const glm::dvec3& p,
                         const std::vector<int>& on_left, const std::vector<bool>& front) {
  CurveSample sample;
  sample.p = p;
  const auto lower = [](const SeamSide& a, const SeamSide& b) { return a.facing < b.facing; };
  sample.high = std::max_element(seam.sides.begin(), seam.sides.end(), lower)->normal;
  sample.low = std::min_element(seam.sides.begin(), seam.sides.end(), lower)->normal;
  sample.lift = view_vector(camera, p);
  sample.object = seam.object;
  int left = 0;
  for (size_t k = 0; k < on_left.size(); ++k) left += (on_left[k] > 0) == front[k];
  const int all = static_cast<int>(on_left.size());
  sample.more_on_left = 2 * left - all;
  // What two objects share is their intersection whichever way they face: its folds are hidden by one of them.
  const bool shared = whole.line_class == LineClass::intersection || whole.line_class == LineClass::material;
  const bool contour = all > 1 && (left == 0 || left == all) && !shared, materials = whole.samples[from].materials_meet;
  sample.line_class =
      contour ? (materials ? whole.fold_of_materials : LineClass::contour) : (materials ? whole.edge_of_materials : whole.line_class);
  project_sample(camera, sample);
  return sample;
}

}  // namespace

SurfaceCurve curve_of_seam(const Camera& camera, const Seam& seam) {
  SurfaceCurve curve{seam.closed, false, {}};
  const std::vector<int> on_left = sides_on_left(seam);
  const size_t n = seam.samples.size(), steps = seam.closed ? n : n - 1;
  std::vector<bool> front(on_left.size()), turns_at(n, false);
  for (size_t i = 0; i < n; ++i) {
    const SeamSample& a = seam.samples[i];
    for (size_t k = 0; k < front.size(); ++k) front[k] = a.sides[k].facing > 0.0;
    curve.samples.push_back(curve_sample(camera, seam, i, a, a.p, on_left, front));
    curve.samples.back().joint = turns_at[i];
    // What is drawn of the seam goes on there, and the line that ends on it has its vertex.
    if (a.line_ends && i > 0 && curve.samples[curve.samples.size() - 2].line_class == curve.samples.back().line_class && !turns_at[i])
      curve.samples.back().pierced.push_back({0.0, 0});
    if (i >= steps) break;
    const SeamSample& b = seam.samples[(i + 1) % n];
    for (const Turn& turn : turns_between(a, b)) {
      front[turn.side] = !front[turn.side];
      // Where a side turns at a sample that is the joint.
      if (turn.t > 1.0 - kAtSample) {
        turns_at[(i + 1) % n] = true;
        continue;
      }
      if (turn.t < kAtSample) curve.samples.pop_back();
      curve.samples.push_back(curve_sample(camera, seam, i, turn.t < 0.5 ? a : b, glm::mix(a.p, b.p, turn.t), on_left, front));
      curve.samples.back().joint = true;
    }
  }
  if (turns_at[0]) curve.samples.front().joint = true;
  return curve;
}

void set_fold(const Camera& camera, SurfaceCurve& curve) {
  double left = 0.0;
  const size_t n = curve.samples.size();
  const auto to_empty_side = [&](const CurveSample& at) {
    const glm::dvec2 outwards = image_direction(camera, at.p, at.high);
    return at.radial_curvature < 0.0 ? outwards : -outwards;
  };
  glm::dvec2 from_a = to_empty_side(curve.samples[0]);
  for (size_t i = 0; i + (curve.closed ? 0 : 1) < n; ++i) {
    const CurveSample &a = curve.samples[i], &b = curve.samples[(i + 1) % n];
    const glm::dvec2 from_b = to_empty_side(b);
    left += leftness(a.px, b.px, from_a);
    left += leftness(a.px, b.px, from_b);
    from_a = from_b;
  }
  for (CurveSample& sample : curve.samples) sample.more_on_left = left > 0.0 ? 2 : -2;
}

}  // namespace limn
