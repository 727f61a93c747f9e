#include "raymarch/lines/form_tracing.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

#include "sdf/parallel.h"
#include "sdf/segment.h"

namespace limn {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kShareOfTolerance = 0.48;  // for the chords; the rest is the thinning's
constexpr double kAlongView = 2.0;          // times as far may chords lie off in depth
constexpr int kMostParts = 4;
constexpr double kAtQuarter = 0.75;  // of an arc's height lies a quarter of it off its chord
constexpr double kRoom = 1.1;        // for bends that differ along a step
constexpr double kBulge = 0.1;       // of a step's length, in space
constexpr int kEllipsePieces = 16, kSweptPieces = 48;
constexpr int kDeepest = 44;
constexpr double kBehind = 1e-3;        // of the extent: steps that lead behind the eye are cut down to this
constexpr double kShortest = 1e-7;      // of the extent
constexpr double kShortestPx = 1e-3;    // of straight contours, which may be seen along their length
constexpr double kBesideCusp = 1e-3;    // of a step: its arms begin there
constexpr double kNearlyTurned = 0.03;  // N.V, or the radial curvature times the extent: changes by less than this within a step and back
constexpr double kTouching = 1e-6;      // the sine of the angle between two surfaces

struct Sample {
  double s = 0.0;
  glm::dvec3 p{0.0};
  glm::dvec2 px{0.0};
  double depth = 0.0;
};

class Tracer {
 public:
  Tracer(const FormBody& body, const FormCurve& curve, const Camera& camera, const Viewer& viewer, double tolerance_px)
      : body_(body), curve_(curve), camera_(camera), viewer_(viewer), tolerance_px_(kShareOfTolerance * tolerance_px) {}

  /// Nothing where the surfaces touch along the curve.
  std::optional<FormTrace> run(const FormArc& arc) {
    sample(arc);
    const bool seam = curve_.second >= 0;
    FormTrace trace{{0.0, arc.closed, seam, arc.concave, {}, curve_.first, curve_.second}, curve_, {}};
    FieldCurve& found = trace.curve;
    if (curve_.kind == FormCurve::Kind::tube || seam) add_turns();
    add_within_frame();
    for (const Sample& sample : samples_) trace.parameters.push_back(sample.s);
    if (arc.closed) samples_.pop_back();
    if (!seam && curve_.kind == FormCurve::Kind::line && glm::distance(samples_.front().px, samples_.back().px) < kShortestPx) return trace;
    int touching = 0;
    for (const Sample& at : samples_) {
      found.points.push_back(seam ? seam_point(at) : contour_point(at, arc));
      const CurvePoint& point = found.points.back();
      touching = seam && glm::length(glm::cross(point.high, point.low)) < kTouching ? touching + 1 : 0;
      if (touching > 2) return {};
    }
    return trace;
  }

 private:
  Sample at(double s) const {
    Sample sample{s, point_of(curve_, curve_.closed && s > curve_.end ? s - kTurn : s), {}, 0.0};
    const glm::dvec3 image = project(camera_, sample.p);
    sample.px = glm::dvec2(image);
    sample.depth = image.z;
    return sample;
  }
  const FormSurface& surface(int number) const { return body_.surfaces[static_cast<size_t>(number)]; }

  void sample(const FormArc& arc) {
    samples_ = {at(arc.from)};
    const double per_turn = curve_.kind == FormCurve::Kind::ellipse ? kEllipsePieces : kSweptPieces;
    const int pieces =
        curve_.kind == FormCurve::Kind::line ? 1 : std::max(3, static_cast<int>(std::ceil(per_turn * (arc.to - arc.from) / kTurn)));
    for (int i = 1; i <= pieces; ++i) {
      const Sample next = at(arc.from + (arc.to - arc.from) * i / pieces);
      add_step(Sample(samples_.back()), next, kDeepest);
    }
  }
  /// Into as many parts as the bend in the middle asks for: that of a part is less by the square of their number. Few parts of
  /// an ellipse are taken at their word, others are looked at again.
  void add_step(const Sample& a, const Sample& b, int depth) {
    if (depth > 0 && curve_.kind != FormCurve::Kind::line && glm::distance(a.p, b.p) > kShortest * body_.extent) {
      const Sample middle = at(0.5 * (a.s + b.s));
      const double parts = parts_of(a, middle, b);
      if (parts > 1.0) {
        const int count = std::min(kMostParts, static_cast<int>(std::ceil(parts)));
        const bool again = parts > kMostParts || curve_.kind != FormCurve::Kind::ellipse;
        for (int i = 1; i <= count; ++i) {
          const Sample next = i == count ? b : 2 * i == count ? middle : at(glm::mix(a.s, b.s, static_cast<double>(i) / count));
          again ? add_step(Sample(samples_.back()), next, depth - 1) : samples_.push_back(next);
        }
        return;
      }
    }
    if (depth > 0 && curve_.kind == FormCurve::Kind::line && (a.depth > 0.0) != (b.depth > 0.0) &&
        glm::distance(a.p, b.p) > kBehind * body_.extent) {
      const Sample middle = at(0.5 * (a.s + b.s));
      add_step(a, middle, depth - 1);
      add_step(middle, b, depth - 1);
      return;
    }
    samples_.push_back(b);
  }
  double parts_of(const Sample& a, const Sample& middle, const Sample& b) const {
    const double chord = glm::distance(a.p, b.p);
    const int before = (a.depth > 0.0) + (b.depth > 0.0) + (middle.depth > 0.0);
    if (before > 0 && before < 3) return chord > kBehind * body_.extent ? kMostParts + 1.0 : 1.0;
    const double bulge = distance_to_segment(middle.p, a.p, b.p);
    if (bulge > kBulge * chord) return kMostParts + 1.0;
    if (before < 3) return 1.0;
    // Where a curve bends one way and then the other its middle lies on the chord, and a quarter does not.
    double much = off_chord(a, middle, b);
    if (much <= 1.0) much = std::max(much, off_chord(a, at(glm::mix(a.s, b.s, 0.25)), b) / kAtQuarter);
    return much <= 1.0 ? 1.0 : std::sqrt(kRoom * much);
  }
  /// Over what is tolerated.
  double off_chord(const Sample& a, const Sample& between, const Sample& b) const {
    const double across_px = distance_to_segment(between.px, a.px, b.px),
                 along_px = distance_to_segment(between.p, a.p, b.p) * pixels_per_unit_at(camera_, between.depth);
    return std::max(across_px / tolerance_px_, along_px / (kAlongView * tolerance_px_));
  }

  double facing(int number, const Sample& sample) const {
    return glm::dot(normal_at(surface(number), sample.p), viewer_.toward_eye(sample.p));
  }
  double radial_curvature(const Sample& sample) const {
    return curvature_along(surface(curve_.first), sample.p, viewer_.toward_eye(sample.p));
  }

  /// Samples where a seam's sides turn away from the eye, and on either side of cusps.
  void add_turns() {
    if (curve_.kind == FormCurve::Kind::line) return;
    if (curve_.second < 0) {
      add_zeros([&](const Sample& sample) { return body_.extent * radial_curvature(sample); }, true);
      return;
    }
    for (const int number : {curve_.first, curve_.second}) {
      if (surface(number).kind != ClosedFormKind::half_space)
        add_zeros([&](const Sample& sample) { return facing(number, sample); }, false);
    }
  }
  template <class Value>
  double zero_between(const Value& value, double a, double b) const {
    const bool above = value(at(a)) > 0.0;
    for (int k = 0; k < 60 && b - a > 1e-16 * (1.0 + std::fabs(b)); ++k)
      ((value(at(0.5 * (a + b))) > 0.0) == above ? a : b) = 0.5 * (a + b);
    return 0.5 * (a + b);
  }
  /// Within a step at whose ends the value has one sign: the place of its extremum, where it has the other one there.
  template <class Value>
  std::optional<double> dip_between(const Value& value, double a, double fa, double b, double fb) const {
    const double least = std::min(std::fabs(fa), std::fabs(fb));
    if (!(least < kNearlyTurned)) return {};
    const double fm = value(at(0.5 * (a + b)));
    // Of the parabola through the three.
    const double bend = fa - 2.0 * fm + fb, share = 0.5 + 0.25 * (fa - fb) / bend;
    if (!(share > 0.0 && share < 1.0)) return {};
    const double s = glm::mix(a, b, share);
    if ((value(at(s)) > 0.0) == (fa > 0.0)) return {};
    return s;
  }
  template <class Value>
  void add_zeros(const Value& value, bool beside) {
    std::vector<Sample> all = {samples_[0]};
    double before = value(samples_[0]);
    const auto add = [&](double s, double limit) {
      if (s > all.back().s && s < limit) all.push_back(at(s));
    };
    for (size_t i = 1; i < samples_.size(); ++i) {
      const double now = value(samples_[i]), a = samples_[i - 1].s, b = samples_[i].s;
      const auto add_zero = [&](double low, double high) {
        const double zero = zero_between(value, low, high), aside = beside ? kBesideCusp * (high - low) : 0.0;
        add(zero - aside, b);
        if (beside) add(zero + aside, b);
      };
      if ((before > 0.0) != (now > 0.0)) {
        add_zero(a, b);
      } else if (const std::optional<double> dip = dip_between(value, a, before, b, now)) {
        add_zero(a, *dip);
        add(*dip, b);
        add_zero(*dip, b);
      }
      all.push_back(samples_[i]);
      before = now;
    }
    samples_ = std::move(all);
  }

  /// A step that goes through the picture from outside to outside gets a sample within.
  void add_within_frame() {
    const auto inside = [&](const Sample& q) {
      return q.px.x >= 0.0 && q.px.y >= 0.0 && q.px.x <= camera_.width_px && q.px.y <= camera_.height_px;
    };
    for (size_t i = 0; i + 1 < samples_.size(); ++i) {
      const Sample a = samples_[i], b = samples_[i + 1];
      if (!(a.depth > 0.0 && b.depth > 0.0) || inside(a) || inside(b)) continue;
      double t0 = 0.0, t1 = 1.0;
      const glm::dvec2 d = b.px - a.px, size(camera_.width_px, camera_.height_px);
      for (int axis = 0; axis < 2; ++axis) {
        const double u = -a.px[axis] / d[axis], v = (size[axis] - a.px[axis]) / d[axis];
        t0 = std::max(t0, std::min(u, v));
        t1 = std::min(t1, std::max(u, v));
      }
      if (!(t0 < t1)) continue;
      // From the share of the image to that of the step.
      const double t = 0.5 * (t0 + t1),
                   w = camera_.projection == Projection::perspective ? t * a.depth / (b.depth + t * (a.depth - b.depth)) : t;
      samples_.insert(samples_.begin() + static_cast<std::ptrdiff_t>(i) + 1, at(glm::mix(a.s, b.s, w)));
      ++i;
    }
  }

  CurvePoint seam_point(const Sample& sample) const {
    CurvePoint point;
    point.p = sample.p;
    point.high = normal_at(surface(curve_.first), sample.p);
    point.low = normal_at(surface(curve_.second), sample.p);
    point.crease = true;
    return point;
  }
  CurvePoint contour_point(const Sample& sample, const FormArc& arc) const {
    // All along a straight line of a cylinder or cone the normal is the same, and at a cone's tip it is not known.
    const Sample from = curve_.kind == FormCurve::Kind::line ? at(0.5 * (arc.from + arc.to)) : sample;
    CurvePoint point;
    point.p = sample.p;
    point.high = point.low = normal_at(surface(curve_.first), from.p);
    point.radial_curvature = radial_curvature(from);
    return point;
  }

  const FormBody& body_;
  const FormCurve& curve_;
  const Camera& camera_;
  const Viewer& viewer_;
  double tolerance_px_;
  std::vector<Sample> samples_{};
};

}  // namespace

glm::dvec3 point_at(const FormTrace& trace, double parameter) {
  return point_of(trace.form, trace.form.closed && parameter > trace.form.end ? parameter - kTurn : parameter);
}

double parameter_beside(const FormTrace& trace, size_t step, double share) {
  const double a = trace.parameters[step], b = trace.parameters[step + 1];
  const auto point = [&](double s) { return point_at(trace, s); };
  const glm::dvec3 start = point(a), chord = point(b) - start;
  const double squared = glm::dot(chord, chord);
  if (!(squared > 0.0)) return a;
  // Where the plane across the chord meets the curve: false position.
  double low = a, high = b, off_low = -share, off_high = 1.0 - share;
  double s = glm::mix(a, b, share);
  for (int i = 0; i < 8; ++i) {
    const double off = glm::dot(point(s) - start, chord) / squared - share;
    if (std::fabs(off) < 1e-9) break;
    (off < 0.0 ? low : high) = s;
    (off < 0.0 ? off_low : off_high) = off;
    s = low + (high - low) * off_low / (off_low - off_high);
  }
  return s;
}

glm::dvec3 point_beside(const FormTrace& trace, size_t step, double share) { return point_at(trace, parameter_beside(trace, step, share)); }

std::optional<std::vector<FormTrace>> trace_form_curves(const FormMeetings& meetings, const Camera& camera, const Viewer& viewer,
                                                        double tolerance_px, const ExecutionSettings& execution) {
  if (!meetings.known) return {};
  const FormBody& body = meetings.body;
  std::vector<std::vector<FormTrace>> found(meetings.all.size());
  std::atomic<bool> known = true;
  parallel_for(size_t{0}, meetings.all.size(), [&](size_t i) {
    if (execution.cancelled && execution.cancelled()) throw Cancelled{};
    const FormMeeting& meeting = meetings.all[i];
    const auto trace = [&](const FormCurve& curve, const std::vector<FormArc>& arcs) {
      for (const FormArc& arc : arcs) {
        if (!known) return;
        std::optional<FormTrace> traced = Tracer(body, curve, camera, viewer, tolerance_px).run(arc);
        if (!traced) known = false;
        if (traced && traced->curve.points.size() > 1) found[i].push_back(std::move(*traced));
      }
    };
    for (const auto& [curve, arcs] : meeting.seams) trace(curve, arcs);
    if (meeting.second >= 0) return;
    for (const FormCurve& curve : contours_of(body, meeting.first, viewer.facing))
      trace(curve, trimmed(body, curve, meeting.box, meeting.tree));
  });
  if (!known) return {};
  std::vector<FormTrace> result;
  for (auto& curves : found) result.insert(result.end(), std::make_move_iterator(curves.begin()), std::make_move_iterator(curves.end()));
  return result;
}

}  // namespace limn
