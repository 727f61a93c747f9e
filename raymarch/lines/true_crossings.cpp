#include "raymarch/lines/true_crossings.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>

#include "raymarch/lines/curve_walk.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr double kSwallowtail_px = 0.2;  // around one whose cusps are too close to tell
constexpr double kMostLensSteps = 400.0;
constexpr double kLensEnds_px = 0.1;  // by which two sides of a short lens may differ in length
constexpr double kLongestOwnLens_px = 0.05;
// How thin a lens between two lines may be: those in closed form and those of smooth surfaces are followed more closely where they touch.
constexpr double kExactLens_px = 1e-5, kSmoothLens_px = 0.002;

class CrossingSieve {
 public:
  CrossingSieve(const EventSearch& search, std::uint32_t number, const CurveWalk& walk, const SignChanges& changes)
      : curves_(search.curves),
        have_ends_(search.have_ends),
        curve_(search.curves[number]),
        number_(number),
        camera_(search.camera),
        extent_(search.extent),
        walk_(walk),
        changes_(changes) {}

  TrueCrossings run(const std::vector<NearerCrossing>& crossings) {
    TrueCrossings found;
    for (const NearerCrossing& crossing : without_narrow_lenses(crossings)) {
      if (!is_tangency(crossing)) found.kept.push_back(crossing);
    }
    found.undone = std::move(undone_);
    return found;
  }

 private:
  /// Where a line runs along a nearer one, as two rims of a tube seen down its axis do, their polylines cross again and again: two
  /// crossings of the same pair of lines, between which these lie on each other, are none.
  std::vector<NearerCrossing> without_narrow_lenses(const std::vector<NearerCrossing>& crossings) {
    std::vector<NearerCrossing> kept;
    std::map<std::uint32_t, std::vector<size_t>> open;  // Of each nearer curve, what is kept of it, in order.
    std::vector<bool> gone;
    for (const NearerCrossing& crossing : crossings) {
      auto& before = open[crossing.curve];
      if (!before.empty() && is_lens(kept[before.back()], crossing)) {
        if (crossing.curve == number_ && joins_two_passages(kept[before.back()], crossing))
          undone_.insert(undone_.end(), {kept[before.back()], crossing});
        gone[before.back()] = true;
        before.pop_back();
        continue;
      }
      before.push_back(kept.size());
      kept.push_back(crossing);
      gone.push_back(false);
    }
    std::vector<NearerCrossing> result;
    for (size_t k = 0; k < kept.size(); ++k) {
      if (!gone[k]) result.push_back(kept[k]);
    }
    return result;
  }
  /// The crossings themselves lie on chords: along a step beside a cusp the curve's own point at the same share may be far from there.
  std::vector<glm::dvec2> px_between_crossings(const SurfaceCurve& curve, double from, double to) const {
    return px_between(curve, chord_px(curve, from, camera_), from, to, chord_px(curve, to, camera_));
  }
  /// Of one curve: the line goes over both arms of a thin part of itself at once. One of the two crossings may be that of a swallowtail,
  /// whose cusps stay.
  bool joins_two_passages(const NearerCrossing& one, const NearerCrossing& other) const {
    return walk_.apart_px(one.on_nearer, other.on_nearer) > 2.0 * walk_.apart_px(one.at, other.at) + kLensEnds_px;
  }
  bool is_lens(const NearerCrossing& one, const NearerCrossing& other) const {
    if (one.layers != -other.layers) return false;
    const SurfaceCurve& nearer = curves_[one.curve];
    const auto steps = static_cast<double>(steps_of(nearer));
    double from = std::min(one.on_nearer, other.on_nearer), to = std::max(one.on_nearer, other.on_nearer);
    if (nearer.closed && to - from > 0.5 * steps) std::tie(from, to) = std::pair(to, from + steps);
    if (to - from > kMostLensSteps || other.at - one.at > kMostLensSteps) return false;
    // Of one curve it lies between two stretches that have nothing in common, and is no swallowtail's.
    if (one.curve == number_ &&
        ((from < other.at && one.at < to) || walk_.length_to(other.at) - walk_.length_to(one.at) > kLongestOwnLens_px))
      return false;
    double apart_px = curve_.smooth && nearer.smooth ? kSmoothLens_px : apart_from(nearer);
    if (curve_.between && nearer.between) apart_px = kExactLens_px;
    const std::vector<glm::dvec2> nearer_px = px_between_crossings(nearer, from, to);
    // Most are told by the first sample in between.
    if (const double inner = std::floor(one.at) + 1.0;
        inner < other.at && !lies_along(walk_.at(static_cast<size_t>(inner)).px, nearer_px, apart_px))
      return false;
    const std::vector<glm::dvec2> own_px = px_between_crossings(curve_, one.at, other.at);
    // Of long steps the samples of one curve alone say nothing.
    return lies_along(own_px, nearer_px, apart_px) && (!long_steps(nearer) || lies_along(nearer_px, own_px, apart_px));
  }

  /// A crease leaves a contour, and the two arms of a cusp each other, along their common tangent: polylines of them cross again and again
  /// there, and the curves do not.
  bool is_tangency(const NearerCrossing& crossing) const {
    if (crossing.curve == number_) {
      // From one of its two passages to the other a closed curve goes two ways.
      const double from = std::min(crossing.at, crossing.on_nearer), to = std::max(crossing.at, crossing.on_nearer);
      const auto touches = [&](double one, double other) { return is_tip_of_cusp(one, other) || is_spike(one, other); };
      return closes_undone(crossing) || touches(from, to) || (curve_.closed && touches(to, from + static_cast<double>(walk_.size())));
    }
    if (have_ends_[number_] == 0 || have_ends_[crossing.curve] == 0) return false;
    const SurfaceCurve& other = curves_[crossing.curve];
    const double longest_px = std::min(curve_.tangency_px, other.tangency_px);
    for (const Stretch& own : to_ends(curve_, crossing.at, longest_px, camera_)) {
      for (const Stretch& others : to_ends(other, crossing.on_nearer, longest_px, camera_)) {
        const bool meet = glm::distance(own.end, others.end) < 1e-6 * extent_ && !own.past_cusp && !others.past_cusp;
        if (meet && run_together(own, others, other)) return true;
      }
    }
    return false;
  }

  double apart_from(const SurfaceCurve& other) const { return std::max(curve_.apart_px, other.apart_px); }

  /// Between the two passages the curve goes there and back on the same way, as beside the tip of a cone, and not by way of two cusps, as
  /// in a swallowtail, or three, as in a butterfly.
  bool is_spike(double from, double to) const {
    if (walk_.length_to(to) - walk_.length_to(from) > kLongestNarrow_px) return false;
    if (cusps_between(from, to).size() >= 2) return false;
    const std::vector<glm::dvec2> px = px_between_crossings(curve_, from, to);
    const auto farther = [&](const glm::dvec2& a, const glm::dvec2& b) { return glm::distance(a, px[0]) < glm::distance(b, px[0]); };
    const auto turn = std::max_element(px.begin(), px.end(), farther);
    const std::vector<glm::dvec2> there(px.begin(), turn + 1), back(turn, px.end());
    return lies_along(there, back, arms_apart_px(curve_)) && lies_along(back, there, arms_apart_px(curve_));
  }

  /// Of a swallowtail so small that its cusps are none, the crossing is none either.
  bool closes_undone(const NearerCrossing& crossing) const {
    const auto steps = static_cast<double>(walk_.size());
    const double one = std::min(crossing.at, crossing.on_nearer), other = std::max(crossing.at, crossing.on_nearer);
    return std::any_of(changes_.undone.begin(), changes_.undone.end(), [&](const SignChange& change) {
      const double from = static_cast<double>(change.before), to = static_cast<double>(change.after);
      const auto lies_within = [&](double low, double high) {
        return low < to && from < high && walk_.length_to(std::max(high, to)) - walk_.length_to(std::min(low, from)) < kSwallowtail_px;
      };
      return lies_within(one, other) || (curve_.closed && (lies_within(other, one + steps) || lies_within(one + steps, other + steps)));
    });
  }

  /// Beside the one cusp between its two passages. Arms of a curve that is known between its samples may part and cross after it.
  bool is_tip_of_cusp(double from, double to) const {
    if (walk_.length_to(to) - walk_.length_to(from) > 2.0 * kTangency_px) return false;
    const std::vector<double> cusps = cusps_between(from, to);
    if (cusps.size() != 1) return false;
    if (!curve_.between) return true;
    const glm::dvec2 cusp = sample_at(curve_, cusps[0], camera_).px;
    const std::vector<glm::dvec2> there = px_between(curve_, chord_px(curve_, from, camera_), from, cusps[0], cusp),
                                  back = px_between(curve_, cusp, cusps[0], to, chord_px(curve_, to, camera_));
    return lies_along(there, back, arms_apart_px(curve_)) && lies_along(back, there, arms_apart_px(curve_));
  }
  std::vector<double> cusps_between(double from, double to) const {
    const auto steps = static_cast<double>(walk_.size());
    std::vector<double> places;
    for (const SignChange& change : changes_.apart) {
      for (const double around : {-steps, 0.0, steps})
        if (change.turn - around > from && change.turn - around < to) places.push_back(std::clamp(change.place - around, from, to));
    }
    return places;
  }

  /// From a place on a curve along it to an end or a joint.
  struct Stretch {
    glm::dvec3 end{0.0};
    std::vector<glm::dvec2> px{};
    bool past_cusp = false;  ///< The place lies on the other arm of a cusp.
  };
  static std::vector<Stretch> to_ends(const SurfaceCurve& curve, double place, double longest_px, const Camera& camera) {
    std::vector<Stretch> all;
    const auto n = static_cast<std::ptrdiff_t>(curve.samples.size());
    // Most curves have no end nearby, and the place itself need not be found.
    std::optional<CurveSample> known;
    const auto from = [&]() -> const CurveSample& {
      if (!known) known = sample_at(curve, place, camera);
      return *known;
    };
    for (const int way : {1, -1}) {
      Stretch stretch{glm::dvec3(0.0), {curve.long_steps ? from().px : glm::dvec2(0.0)}};
      double length = 0.0;
      auto i = static_cast<std::ptrdiff_t>(place) + (way > 0 ? 1 : 0);
      for (std::ptrdiff_t count = 0; count < n && length <= longest_px; ++count, i += way) {
        if (!curve.closed && (i < 0 || i >= n)) break;
        const CurveSample& sample = curve.samples[static_cast<size_t>((i + n) % n)];
        if (curve.long_steps || stretch.px.size() > 1) length += glm::distance(sample.px, stretch.px.back());
        stretch.px.push_back(sample.px);
        if (!sample.joint && (curve.closed || (i > 0 && i < n - 1))) continue;
        stretch.end = sample.p;
        stretch.px[0] = from().px;
        stretch.past_cusp = curve.smooth && from().radial_curvature * sample.radial_curvature < 0.0;
        all.push_back(stretch);
        break;
      }
    }
    return all;
  }
  bool run_together(const Stretch& one, const Stretch& two, const SurfaceCurve& other) const {
    const double apart_px = apart_from(other);
    if (long_steps(other)) return lies_along(one.px, two.px, apart_px) && lies_along(two.px, one.px, apart_px);
    // Without the place itself either stretch leaves out the part before its first sample, where the other may begin: one is enough.
    const std::vector<glm::dvec2> own(one.px.begin() + 1, one.px.end()), others(two.px.begin() + 1, two.px.end());
    return lies_along(own, others, apart_px) || lies_along(others, own, apart_px);
  }
  bool long_steps(const SurfaceCurve& other) const { return curve_.long_steps || other.long_steps; }

  const std::vector<SurfaceCurve>& curves_;
  const std::vector<char>& have_ends_;
  const SurfaceCurve& curve_;
  std::uint32_t number_;
  const Camera& camera_;
  double extent_;
  const CurveWalk& walk_;
  const SignChanges& changes_;
  std::vector<NearerCrossing> undone_{};
};

}  // namespace

EventSearch::EventSearch(const std::vector<SurfaceCurve>& all, const Camera& eye, double scene_extent)
    : curves(all), camera(eye), extent(scene_extent), have_ends(all.size()) {
  parallel_for(size_t{0}, curves.size(), [&](size_t c) {
    const SurfaceCurve& curve = curves[c];
    have_ends[c] = !curve.closed || std::any_of(curve.samples.begin(), curve.samples.end(), [](const CurveSample& s) { return s.joint; });
  });
}

double arms_apart_px(const SurfaceCurve& curve) { return curve.between ? kSmoothLens_px : curve.apart_px; }

TrueCrossings true_crossings(const EventSearch& search, std::uint32_t number, const CurveWalk& walk, const SignChanges& changes,
                             const std::vector<NearerCrossing>& crossings) {
  return CrossingSieve(search, number, walk, changes).run(crossings);
}

}  // namespace limn
