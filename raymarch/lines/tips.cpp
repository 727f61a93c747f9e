#include "raymarch/lines/tips.h"

#include <optional>

namespace limn {
namespace {

constexpr double kReach_px = 6.0;
constexpr double kMeet_px = 0.02;    // so near to each other tangents have to come
constexpr double kApart_px = 1e-3;   // ends nearer than this meet already
constexpr size_t kTangentOver = 2;   // samples
constexpr double kTurn = 0.9995, kStraight = 1.0 - 1e-7;  // cosines
constexpr double kSteps_px[3] = {1.0, 2.5, 4.0};           // from the step across a tip
constexpr double kCutOff_px = 0.01;

struct End {
  size_t curve = 0;
  bool at_back = false;
  glm::dvec3 p{0.0}, way{0.0};  ///< Unit, on out of the curve.
  double pixel = 1.0;           ///< World units.
};

std::vector<End> ends_of(const Camera& camera, const std::vector<SurfaceCurve>& curves) {
  std::vector<End> ends;
  for (size_t c = 0; c < curves.size(); ++c) {
    const auto& samples = curves[c].samples;
    if (!curves[c].smooth || curves[c].closed || samples.size() <= kTangentOver) continue;
    for (const bool back : {false, true}) {
      const CurveSample &end = back ? samples.back() : samples.front(),
                        &inner = back ? samples[samples.size() - 1 - kTangentOver] : samples[kTangentOver];
      const double length = glm::distance(end.p, inner.p);
      if (!(length > 0.0) || !(end.depth > 0.0)) continue;
      ends.push_back({c, back, end.p, (end.p - inner.p) / length, 1.0 / pixels_per_unit_at(camera, end.depth)});
    }
  }
  return ends;
}

/// Where the ways on from two ends come nearest to each other.
std::optional<glm::dvec3> meeting_of(const End& a, const End& b) {
  const double apart = glm::distance(a.p, b.p);
  if (apart > kReach_px * a.pixel || apart < kApart_px * a.pixel) return {};
  const double cosine = glm::dot(a.way, b.way), sine2 = 1.0 - cosine * cosine;
  if (sine2 < 1e-6) return {};
  const glm::dvec3 between = b.p - a.p;
  const double s = (glm::dot(between, a.way) - cosine * glm::dot(between, b.way)) / sine2,
               t = (cosine * glm::dot(between, a.way) - glm::dot(between, b.way)) / sine2;
  const glm::dvec3 p = a.p + s * a.way, q = b.p + t * b.way;
  if (s < 0.0 || t < 0.0 || s > kReach_px * a.pixel || t > kReach_px * b.pixel || glm::distance(p, q) > kMeet_px * a.pixel) return {};
  return 0.5 * (p + q);
}

void draw_on(const Camera& camera, const End& end, const glm::dvec3& tip, SurfaceCurve& curve) {
  CurveSample sample = end.at_back ? curve.samples.back() : curve.samples.front();
  sample.p = tip;
  project_sample(camera, sample);
  curve.samples.insert(end.at_back ? curve.samples.end() : curve.samples.begin(), sample);
}

bool same_way(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 u = b - a, v = c - b;
  return glm::dot(u, v) > kStraight * glm::length(u) * glm::length(v);
}

/// The sample on a curve at least so far from sample i, along it, backwards or forwards: samples crowd where a tip was closed in on.
std::optional<size_t> sample_beyond(const SurfaceCurve& curve, size_t i, int way, double reach) {
  const auto n = static_cast<std::ptrdiff_t>(curve.samples.size());
  double length = 0.0;
  for (auto at = static_cast<std::ptrdiff_t>(i), count = std::ptrdiff_t{0}; count < n; ++count) {
    const std::ptrdiff_t next = at + way;
    if (!curve.closed && (next < 0 || next >= n)) return {};
    const auto k = static_cast<size_t>((next + n) % n);
    length += glm::distance(curve.samples[static_cast<size_t>((at + n) % n)].p, curve.samples[k].p);
    if (length >= reach) return k;
    at = next;
  }
  return {};
}

struct Tip {
  size_t before = 0, after = 0;  ///< What lies between these samples is replaced.
  glm::dvec3 p{0.0};
};

/// A curve that goes past a tip cuts it off by one step, beside which points are known to a cell only: where it runs straight on either side
/// of a step, and turns between, the lines meet at the tip.
std::optional<Tip> tip_at(const Camera& camera, const SurfaceCurve& curve, size_t i) {
  const auto p = [&](size_t k) -> const glm::dvec3& { return curve.samples[k].p; };
  const size_t next = (i + 1) % curve.samples.size();
  if (!(curve.samples[i].depth > 0.0)) return {};
  const double pixel = 1.0 / pixels_per_unit_at(camera, curve.samples[i].depth);
  if (glm::distance(p(i), p(next)) < kCutOff_px * pixel) return {};
  std::optional<size_t> back[3], ahead[3];
  for (int k = 0; k < 3; ++k) {
    back[k] = sample_beyond(curve, i, -1, kSteps_px[k] * pixel);
    ahead[k] = sample_beyond(curve, next, 1, kSteps_px[k] * pixel);
    if (!back[k] || !ahead[k]) return {};
  }
  const bool straight = same_way(p(*back[0]), p(*back[1]), p(*back[2])) && same_way(p(*ahead[0]), p(*ahead[1]), p(*ahead[2]));
  const glm::dvec3 in = glm::normalize(p(*back[0]) - p(*back[2])), out = glm::normalize(p(*ahead[0]) - p(*ahead[2]));
  if (!straight || -glm::dot(in, out) > kTurn) return {};
  const auto meeting = meeting_of({0, true, p(*back[0]), in, pixel}, {0, false, p(*ahead[0]), out, pixel});
  return meeting ? std::optional<Tip>({*back[0], *ahead[0], *meeting}) : std::nullopt;
}

void lead_through_tips(const Camera& camera, SurfaceCurve& curve) {
  const size_t n = curve.samples.size();
  if (!curve.smooth || n < 6) return;
  for (size_t i = 0; i + 1 < n; ++i) {
    const std::optional<Tip> tip = tip_at(camera, curve, i);
    if (!tip || tip->before > i || tip->after <= i) continue;
    CurveSample sample = curve.samples[tip->before];
    sample.p = tip->p;
    project_sample(camera, sample);
    auto& samples = curve.samples;
    samples.erase(samples.begin() + static_cast<std::ptrdiff_t>(tip->before) + 1, samples.begin() + static_cast<std::ptrdiff_t>(tip->after));
    samples.insert(samples.begin() + static_cast<std::ptrdiff_t>(tip->before) + 1, sample);
    return;
  }
}

}  // namespace

void draw_on_to_tips(const Camera& camera, std::vector<SurfaceCurve>& curves) {
  for (SurfaceCurve& curve : curves) lead_through_tips(camera, curve);
  const std::vector<End> ends = ends_of(camera, curves);
  std::vector<bool> done(ends.size(), false);
  for (size_t i = 0; i < ends.size(); ++i) {
    for (size_t j = 0; j < i && !done[i]; ++j) {
      if (done[j]) continue;
      const std::optional<glm::dvec3> tip = meeting_of(ends[i], ends[j]);
      if (!tip) continue;
      draw_on(camera, ends[i], *tip, curves[ends[i].curve]);
      draw_on(camera, ends[j], *tip, curves[ends[j].curve]);
      done[i] = done[j] = true;
    }
  }
}

}  // namespace limn
