#include "raymarch/lines/curve_events.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>

#include "raymarch/lines/curvature_jumps.h"
#include "raymarch/lines/curve_walk.h"
#include "raymarch/lines/frame_crossings.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr double kLeastBend = 1e-7;  // of the radial curvature times the scene's radius: less is rounding
constexpr double kArm_px = 0.15;     // so far from a cusp its arms are compared
constexpr double kOneCusp_px = 0.03;
constexpr double kSwallowtail_px = 0.2;  // around one whose cusps are closer than that
constexpr double kLongestNarrow_px = 20.0;
constexpr double kShortestTail_px = 1.0;
constexpr double kMostShared_px = 0.5;  // to which the crossing of its arms is known
constexpr double kMostLensSteps = 400.0;
constexpr double kLensEnds_px = 0.1;  // by which two sides of a short lens may differ in length
constexpr double kLongestOwnLens_px = 0.05;
// How thin a lens between two lines may be: those in closed form and those of smooth surfaces are followed more closely where they touch.
constexpr double kExactLens_px = 1e-5, kSmoothLens_px = 0.002;
constexpr double kTangency_px = 3.0;  // along one curve, from a cusp

class EventFinder {
 public:
  EventFinder(const EventSearch& search, std::uint32_t number, const CurveWalk& walk)
      : curves_(search.curves),
        have_ends_(search.have_ends),
        curve_(search.curves[number]),
        number_(number),
        camera_(search.camera),
        extent_(search.extent),
        walk_(walk) {}

  std::vector<CurveEvent> run(const std::vector<NearerCrossing>& crossings) {
    if (curve_.smooth) find_sign_changes();
    for (const NearerCrossing& crossing : without_narrow_lenses(crossings)) {
      if (!is_tangency(crossing))
        events_.push_back({VertexKind::crossing, crossing.at, crossing.layers, crossing.curve, crossing.on_nearer});
    }
    for (size_t i = 0; i < steps_of(curve_); ++i) {
      const CurveSample &a = walk_.at(i), &b = walk_.at(i + 1);
      const double place = static_cast<double>(i);
      for (const double share : frame_shares(camera_, a, b)) events_.push_back({VertexKind::frame, place + share, {}, 0, 0.0});
      for (const Piercing& piercing : a.pierced)
        events_.push_back({VertexKind::joint, place + std::min(piercing.t, 1.0 - 1e-9), piercing.layers, 0, 0.0, piercing.unclear_px});
      if (a.joint && (i > 0 || curve_.closed)) events_.push_back({VertexKind::joint, place, {}, 0, 0.0});
      const bool differs = (i > 0 && a.object != walk_.at(i - 1).object) ||
                           ((i > 0 || curve_.closed) && a.line_class != walk_.at((i > 0 ? i : walk_.size()) - 1).line_class);
      if (differs && !a.joint) events_.push_back({VertexKind::joint, place, 0, 0, 0.0});
    }
    if (curve_.smooth) find_cusps();
    if (!curve_.closed) {
      events_.push_back({VertexKind::end, 0.0, {}, 0, 0.0});
      events_.push_back({VertexKind::end, static_cast<double>(steps_of(curve_)), {}, 0, 0.0});
    }
    std::stable_sort(events_.begin(), events_.end(), [](const CurveEvent& a, const CurveEvent& b) { return a.at < b.at; });
    return std::move(events_);
  }

 private:
  /// Where the radial curvature changes its sign, but for rounding.
  void find_sign_changes() {
    const auto sign_of = [&](size_t i) {
      const double bend = walk_.at(i).radial_curvature * extent_;
      return bend > kLeastBend ? 1 : bend < -kLeastBend ? -1 : 0;
    };
    size_t first = 0;
    while (first < walk_.size() && sign_of(first) == 0) ++first;
    size_t last = first;
    for (size_t k = first + 1; k < first + walk_.size() + (curve_.closed ? 1 : 0) && (curve_.closed || k < walk_.size()); ++k) {
      if (sign_of(k) == 0) continue;
      if (sign_of(k) != sign_of(last)) changes_.push_back({last, k});
      last = k;
    }
    join_near_changes();
  }

  /// There the line of sight follows the contour, and of its two arms the one farther from the eye lies behind the other one's sheet
  /// (Koenderink & van Doorn 1982).
  void find_cusps() {
    std::vector<CurveEvent> cusps;
    for (const SignChange& change : apart_) add_cusp(change, cusps);
    for (const CurveEvent& event : events_) {
      if (event.kind == VertexKind::crossing && event.nearer == number_) add_own_crossing(event.at, event.on_nearer);
    }
    for (const NearerCrossing& crossing : undone_crossings_) add_own_crossing(crossing.at, crossing.on_nearer);
    settle_narrow_swallowtails(cusps);
    events_.insert(events_.end(), cusps.begin(), cusps.end());
  }

  /// Of the curve with itself, with its places' image lengths along the curve.
  struct OwnCrossing {
    double at = 0.0, on_nearer = 0.0, at_px = 0.0, on_nearer_px = 0.0;
  };
  void add_own_crossing(double at, double on_nearer) {
    own_crossings_.push_back({at, on_nearer, walk_.length_to(at), walk_.length_to(on_nearer)});
  }

  /// Samples around a change of the radial curvature's sign.
  struct SignChange {
    size_t before = 0, after = 0;
    double place = 0.0;
    double turn = 0.0;  ///< Where the polyline turns back in the image: of a jump at a sample beside the place.
    std::optional<CurvatureJump> jump{};
  };
  SignChange located(SignChange change) const {
    const double a = walk_.at(change.before).radial_curvature, b = walk_.at(change.after).radial_curvature;
    double t = a / (a - b);
    change.jump = jump_at({curve_, change.before, change.after, camera_});
    if (change.jump) t = change.jump->t;
    change.place = glm::mix(static_cast<double>(change.before), static_cast<double>(change.after), std::clamp(t, 0.0, 1.0 - 1e-9));
    change.turn = change.jump ? turn_of(change) : change.place;
    return change;
  }
  double turn_of(const SignChange& change) const {
    double turn = change.place, least = 0.0;
    const size_t n = walk_.size();
    for (size_t i = change.before; i <= change.after; ++i) {
      if (!curve_.closed && (i == 0 || i + 1 >= n)) continue;
      const glm::dvec2 comes = walk_.at(i).px - walk_.at(i + n - 1).px, goes = walk_.at(i + 1).px - walk_.at(i).px;
      const double lengths = glm::length(comes) * glm::length(goes);
      if (!(lengths > 0.0) || glm::dot(comes, goes) >= least * lengths) continue;
      least = glm::dot(comes, goes) / lengths;
      turn = static_cast<double>(i);
    }
    return turn;
  }
  /// Image length from one change to the next.
  double length_between(const SignChange& one, const SignChange& next) const {
    return walk_.length_to(static_cast<double>(next.before)) - walk_.length_to(static_cast<double>(one.after));
  }
  /// Changes so close to each other that nobody can tell them apart are one, or none where the last undoes the first.
  void join_near_changes() {
    const size_t n = walk_.size();
    if (curve_.closed && !changes_.empty()) {
      // Around the curve from the widest gap on.
      size_t start = 0;
      double widest = length_between(changes_.back(), {changes_[0].before + n, changes_[0].after + n});
      for (size_t k = 1; k < changes_.size(); ++k) {
        if (const double gap = length_between(changes_[k - 1], changes_[k]); gap > widest) start = k, widest = gap;
      }
      for (size_t k = 0; k < start; ++k) changes_.push_back({changes_[k].before + n, changes_[k].after + n});
      changes_.erase(changes_.begin(), changes_.begin() + static_cast<std::ptrdiff_t>(start));
    }
    for (size_t k = 0; k < changes_.size();) {
      size_t end = k + 1;
      while (end < changes_.size() && length_between(changes_[end - 1], changes_[end]) < one_cusp_px()) ++end;
      if ((end - k) % 2 == 1)
        apart_.push_back(located({changes_[k].before, changes_[end - 1].after}));
      else
        undone_.push_back({changes_[k].before, changes_[end - 1].after});
      k = end;
    }
  }

  void add_cusp(const SignChange& change, std::vector<CurveEvent>& cusps) {
    const CurveSample &a = walk_.at(change.before), &b = walk_.at(change.after);
    double place = change.place;
    if (place >= static_cast<double>(walk_.size()) && curve_.closed) place -= static_cast<double>(walk_.size());
    // Where the surface folds back on itself at a cuspidal edge its normal turns round, and the curvature's sign with it, past infinity:
    // how many sheets begin there only rays tell.
    if (glm::dot(a.high, b.high) < 0.0) {
      events_.push_back({VertexKind::joint, place, {}, 0, 0.0});
      return;
    }
    if (change.jump) {
      // Rays tell, too, what a jump of the curvature does not.
      const std::optional<int> layers = change.jump->layers;
      (layers ? cusps : events_).push_back({VertexKind::cusp, place, layers, 0, 0.0});
      return;
    }
    const double t = (change.place - static_cast<double>(change.before)) / static_cast<double>(change.after - change.before);
    const glm::dvec2 px = glm::mix(a.px, b.px, t);
    const Arm back = arm_from(px, change.before, -1), ahead = arm_from(px, change.after, 1);
    const double reach = std::min(back.reach_px(), ahead.reach_px());
    cusps.push_back({VertexKind::cusp, place, ahead.depth_at(reach) > back.depth_at(reach) ? 1 : -1, 0, 0.0});
  }

  /// Depth along one of the arms of a cusp, by image distance from it.
  struct Arm {
    std::vector<std::pair<double, double>> points{};  ///< Distance, px, and depth; the distance grows.
    double reach_px() const { return points.back().first; }
    double depth_at(double distance) const {
      for (size_t i = 1; i < points.size(); ++i) {
        if (points[i].first < distance) continue;
        const double width = points[i].first - points[i - 1].first;
        return glm::mix(points[i - 1].second, points[i].second, width > 0.0 ? (distance - points[i - 1].first) / width : 1.0);
      }
      return points.back().second;
    }
  };
  Arm arm_from(const glm::dvec2& cusp_px, size_t first, int way) const {
    Arm arm;
    auto i = static_cast<std::ptrdiff_t>(first);
    const auto n = static_cast<std::ptrdiff_t>(walk_.size());
    for (std::ptrdiff_t count = 0; count < n; ++count, i += way) {
      if (!curve_.closed && (i < 0 || i >= n)) break;
      const CurveSample& sample = walk_.at(static_cast<size_t>(i + n));
      const double distance = glm::distance(sample.px, cusp_px);
      if (!arm.points.empty() && distance < arm.points.back().first) break;
      arm.points.emplace_back(distance, sample.depth);
      if (distance > kArm_px) break;
    }
    return arm;
  }

  /// Two cusps one after the other in the same direction make a swallowtail, whose arms cross. Where it is so narrow that they lie on each
  /// other the crossing cannot be found: of one too short for rays to tell none of the three is there, in a longer one, as of a flat face
  /// seen edge-on, the arms cross where they lie on each other.
  void settle_narrow_swallowtails(std::vector<CurveEvent>& cusps) {
    for (size_t k = 0; k + 1 < cusps.size();) {
      if (cusps[k].layers == cusps[k + 1].layers && is_narrow(cusps[k].at, cusps[k + 1].at)) {
        if (const auto crossing = crossing_of_arms(cusps[k], cusps[k + 1])) {
          events_.push_back(*crossing);
          add_own_crossing(crossing->at, crossing->on_nearer);
          k += 2;
          continue;
        }
        cusps.erase(cusps.begin() + static_cast<std::ptrdiff_t>(k), cusps.begin() + static_cast<std::ptrdiff_t>(k) + 2);
        k = k > 0 ? k - 1 : 0;
      } else {
        ++k;
      }
    }
  }
  /// One of the arms runs along the tail; the other one leaves it soon, and they cross in the middle of what they have in common. Nothing
  /// where that is long, or the tail is short.
  std::optional<CurveEvent> crossing_of_arms(const CurveEvent& first, const CurveEvent& second) const {
    const double length = walk_.length_to(second.at) - walk_.length_to(first.at);
    if (length < kShortestTail_px) return {};
    const bool ahead_along =
        lies_along(px_between(curve_, first.at, second.at, camera_), walk_.px_from(second.at, length, 1), arms_apart_px());
    const CurveEvent &leaves = ahead_along ? first : second, &goes_along = ahead_along ? second : first;
    const int way = ahead_along ? -1 : 1;
    const std::vector<glm::dvec2> along = walk_.px_from(goes_along.at, length, -way), leaving = walk_.px_from(leaves.at, length, way);
    size_t common = 1;
    while (common < leaving.size() && lies_along(leaving[common], along, arms_apart_px())) ++common;
    double half_px = 0.0;
    for (size_t i = 1; i < common; ++i) half_px += 0.5 * glm::distance(leaving[i - 1], leaving[i]);
    if (half_px > kMostShared_px) return {};
    const double on_leaving = place_from(leaves.at, half_px, way),
                 on_along = place_beside(sample_at(curve_, on_leaving, camera_).px, goes_along.at, length, -way);
    // The deeper one lies behind.
    const bool along_behind = (*first.layers > 0) == ahead_along;
    return CurveEvent{VertexKind::crossing, along_behind ? on_along : on_leaving, -2 * *first.layers, number_,
                      along_behind ? on_leaving : on_along};
  }
  double wrapped(double place) const {
    const auto steps = static_cast<double>(steps_of(curve_));
    if (!curve_.closed) return std::clamp(place, 0.0, steps);
    return place < 0.0 ? place + steps : place >= steps ? place - steps : place;
  }
  /// So far along the image of the curve from a place on it.
  double place_from(double place, double length_px, int way) const {
    const double wanted = walk_.length_to(place) + way * length_px;
    double near = place, far = place;
    while (way * (walk_.length_to(far) - wanted) < 0.0 && std::fabs(far - place) < static_cast<double>(walk_.size()))
      near = far, far += way;
    for (int step = 0; step < 40; ++step) {
      const double middle = 0.5 * (near + far);
      (way * (walk_.length_to(middle) - wanted) < 0.0 ? near : far) = middle;
    }
    return wrapped(near);
  }
  /// The place nearest to an image point, within such a length from another place.
  double place_beside(const glm::dvec2& px, double from, double length_px, int way) const {
    constexpr int kPlaces = 256;
    double best = from, least = std::numeric_limits<double>::infinity();
    for (int k = 0; k <= kPlaces; ++k) {
      const double place = place_from(from, length_px * k / kPlaces, way);
      const double apart = glm::distance(sample_at(curve_, place, camera_).px, px);
      if (apart < least) best = place, least = apart;
    }
    return best;
  }
  bool is_narrow(double first, double second) const {
    const double length = walk_.length_to(second) - walk_.length_to(first);
    if (length > kLongestNarrow_px) return false;
    const auto steps = static_cast<double>(steps_of(curve_));
    // From one place to another, the shorter way round.
    const auto way = [&](double from, double to) { return curve_.closed ? std::remainder(to - from, steps) : to - from; };
    const double from_px = walk_.length_to(first), to_px = walk_.length_to(second);
    const auto crosses_itself = [&](const OwnCrossing& crossing) {
      const auto near = [&](double px) {
        return std::min(walk_.apart_of_lengths(px, from_px), walk_.apart_of_lengths(px, to_px)) < length + kTangency_px;
      };
      if (!near(crossing.at_px) || !near(crossing.on_nearer_px)) return false;
      // Both places on one side of the two cusps: of another swallowtail.
      const bool before = way(first, crossing.at) < 0.0 && way(first, crossing.on_nearer) < 0.0;
      return !before && !(way(second, crossing.at) > 0.0 && way(second, crossing.on_nearer) > 0.0);
    };
    if (std::any_of(own_crossings_.begin(), own_crossings_.end(), crosses_itself)) return false;
    const std::vector<glm::dvec2> middle = px_between(curve_, first, second, camera_);
    return lies_along(middle, walk_.px_from(second, length, 1), arms_apart_px()) ||
           lies_along(middle, walk_.px_from(first, length, -1), arms_apart_px());
  }
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
          undone_crossings_.insert(undone_crossings_.end(), {kept[before.back()], crossing});
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
  /// Of a curve that is known between its samples everything wider than what its polyline leaves it by can be told apart: cusps along it,
  /// and its arms, which cross where their polylines do.
  double one_cusp_px() const { return curve_.between ? kSmoothLens_px : kOneCusp_px; }
  double arms_apart_px() const { return curve_.between ? kSmoothLens_px : curve_.apart_px; }

  /// Between the two passages the curve goes there and back on the same way, as beside the tip of a cone, and not by way of two cusps, as
  /// in a swallowtail, or three, as in a butterfly.
  bool is_spike(double from, double to) const {
    if (walk_.length_to(to) - walk_.length_to(from) > kLongestNarrow_px) return false;
    if (cusps_between(from, to).size() >= 2) return false;
    const std::vector<glm::dvec2> px = px_between_crossings(curve_, from, to);
    const auto farther = [&](const glm::dvec2& a, const glm::dvec2& b) { return glm::distance(a, px[0]) < glm::distance(b, px[0]); };
    const auto turn = std::max_element(px.begin(), px.end(), farther);
    const std::vector<glm::dvec2> there(px.begin(), turn + 1), back(turn, px.end());
    return lies_along(there, back, arms_apart_px()) && lies_along(back, there, arms_apart_px());
  }

  /// Of a swallowtail so small that its cusps are none, the crossing is none either.
  bool closes_undone(const NearerCrossing& crossing) const {
    const auto steps = static_cast<double>(walk_.size());
    const double one = std::min(crossing.at, crossing.on_nearer), other = std::max(crossing.at, crossing.on_nearer);
    return std::any_of(undone_.begin(), undone_.end(), [&](const SignChange& change) {
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
    return lies_along(there, back, arms_apart_px()) && lies_along(back, there, arms_apart_px());
  }
  std::vector<double> cusps_between(double from, double to) const {
    const auto steps = static_cast<double>(walk_.size());
    std::vector<double> places;
    for (const SignChange& change : apart_) {
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
  std::vector<CurveEvent> events_{};
  std::vector<SignChange> changes_{}, apart_{}, undone_{};
  std::vector<OwnCrossing> own_crossings_{};        ///< Those undone among them.
  std::vector<NearerCrossing> undone_crossings_{};  ///< Of the curve with itself: two and two, which cancel out.
};

}  // namespace

EventSearch::EventSearch(const std::vector<SurfaceCurve>& all, const Camera& eye, double scene_extent)
    : curves(all), camera(eye), extent(scene_extent), have_ends(all.size()) {
  parallel_for(size_t{0}, curves.size(), [&](size_t c) {
    const SurfaceCurve& curve = curves[c];
    have_ends[c] = !curve.closed || std::any_of(curve.samples.begin(), curve.samples.end(), [](const CurveSample& s) { return s.joint; });
  });
}

std::vector<CurveEvent> events_of(const EventSearch& search, std::uint32_t number, const CurveWalk& walk,
                                  const std::vector<NearerCrossing>& crossings) {
  return EventFinder(search, number, walk).run(crossings);
}

}  // namespace limn
