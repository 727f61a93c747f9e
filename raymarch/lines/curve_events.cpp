#include "raymarch/lines/curve_events.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "raymarch/lines/curve_walk.h"
#include "raymarch/lines/frame_crossings.h"
#include "raymarch/lines/sign_changes.h"

namespace limn {
namespace {

constexpr double kArm_px = 0.15;  // so far from a cusp its arms are compared
constexpr double kShortestTail_px = 1.0;
constexpr double kMostShared_px = 0.5;  // to which the crossing of its arms is known

class EventFinder {
 public:
  EventFinder(const EventSearch& search, std::uint32_t number, const CurveWalk& walk)
      : search_(search), curve_(search.curves[number]), number_(number), camera_(search.camera), walk_(walk) {}

  std::vector<CurveEvent> run(const std::vector<NearerCrossing>& crossings) {
    const SignChanges changes = curve_.smooth ? sign_changes_of(curve_, walk_, camera_, search_.extent) : SignChanges{};
    const TrueCrossings found = true_crossings(search_, number_, walk_, changes, crossings);
    for (const NearerCrossing& crossing : found.kept)
      events_.push_back({VertexKind::crossing, crossing.at, crossing.layers, crossing.curve, crossing.on_nearer});
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
    if (curve_.smooth) find_cusps(changes.apart, found.undone);
    if (!curve_.closed) {
      events_.push_back({VertexKind::end, 0.0, {}, 0, 0.0});
      events_.push_back({VertexKind::end, static_cast<double>(steps_of(curve_)), {}, 0, 0.0});
    }
    std::stable_sort(events_.begin(), events_.end(), [](const CurveEvent& a, const CurveEvent& b) { return a.at < b.at; });
    return std::move(events_);
  }

 private:
  /// There the line of sight follows the contour, and of its two arms the one farther from the eye lies behind the other one's sheet
  /// (Koenderink & van Doorn 1982).
  void find_cusps(const std::vector<SignChange>& changes, const std::vector<NearerCrossing>& undone) {
    std::vector<CurveEvent> cusps;
    for (const SignChange& change : changes) add_cusp(change, cusps);
    for (const CurveEvent& event : events_) {
      if (event.kind == VertexKind::crossing && event.nearer == number_) add_own_crossing(event.at, event.on_nearer);
    }
    for (const NearerCrossing& crossing : undone) add_own_crossing(crossing.at, crossing.on_nearer);
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
        lies_along(px_between(curve_, first.at, second.at, camera_), walk_.px_from(second.at, length, 1), arms_apart_px(curve_));
    const CurveEvent &leaves = ahead_along ? first : second, &goes_along = ahead_along ? second : first;
    const int way = ahead_along ? -1 : 1;
    const std::vector<glm::dvec2> along = walk_.px_from(goes_along.at, length, -way), leaving = walk_.px_from(leaves.at, length, way);
    size_t common = 1;
    while (common < leaving.size() && lies_along(leaving[common], along, arms_apart_px(curve_))) ++common;
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
    return lies_along(middle, walk_.px_from(second, length, 1), arms_apart_px(curve_)) ||
           lies_along(middle, walk_.px_from(first, length, -1), arms_apart_px(curve_));
  }

  const EventSearch& search_;
  const SurfaceCurve& curve_;
  std::uint32_t number_;
  const Camera& camera_;
  const CurveWalk& walk_;
  std::vector<CurveEvent> events_{};
  std::vector<OwnCrossing> own_crossings_{};  ///< Those undone among them.
};

}  // namespace

std::vector<CurveEvent> events_of(const EventSearch& search, std::uint32_t number, const CurveWalk& walk,
                                  const std::vector<NearerCrossing>& crossings) {
  return EventFinder(search, number, walk).run(crossings);
}

}  // namespace limn
