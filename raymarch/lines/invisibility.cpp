#include "raymarch/lines/invisibility.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>

#include "sdf/parallel.h"
#include "sdf/segment.h"

namespace limn {
namespace {

constexpr double kLeastBend = 1e-7;  // of the radial curvature times the scene's radius: less is rounding
constexpr double kArm_px = 0.15;     // so far from a cusp its arms are compared
constexpr double kLongestNarrow_px = 20.0;
constexpr double kMostLensSteps = 400.0;
constexpr double kTangency_px = 3.0;   // along either curve, from the place where they touch
constexpr double kTogether_px = 0.03;  // polylines of curves that touch lie no farther apart
constexpr double kShort_px = 1.0;      // pieces shorter than this are not asked by rays of their own
constexpr double kNearEnd_px = 0.3;    // pieces in which no ray starts farther from their ends tell little

size_t steps_of(const SurfaceCurve& curve) { return curve.closed ? curve.samples.size() : curve.samples.size() - 1; }

/// Every point is near a polyline.
bool lies_along(const std::vector<glm::dvec2>& px, const std::vector<glm::dvec2>& line) {
  return std::all_of(px.begin(), px.end(), [&](const glm::dvec2& p) {
    double least = glm::distance(p, line[0]);
    for (size_t i = 0; i + 1 < line.size(); ++i) least = std::min(least, distance_to_segment(p, line[i], line[i + 1]));
    return least < kTogether_px;
  });
}

/// One curve being cut.
class Cutter {
 public:
  Cutter(const std::vector<SurfaceCurve>& curves, std::uint32_t number, const Camera& camera, double extent,
         const LayersBefore& layers_before)
      : curves_(curves), curve_(curves[number]), number_(number), camera_(camera), extent_(extent), layers_before_(layers_before) {
    lengths_.push_back(0.0);
    for (size_t i = 0; i < steps_of(curve_); ++i) {
      const glm::dvec2 &a = curve_.samples[i].px, &b = curve_.samples[(i + 1) % size()].px;
      lengths_.push_back(lengths_.back() + glm::distance(a, b));
    }
  }

  CutCurve run(const std::vector<NearerCrossing>& crossings) {
    find_events(crossings);
    make_pieces();
    settle();
    return std::move(cut_);
  }
  std::vector<LineConflict> conflicts{};
  std::int64_t rays = 0;

 private:
  size_t size() const { return curve_.samples.size(); }
  const CurveSample& at(size_t i) const { return curve_.samples[i % size()]; }
  bool in_frame(const CurveSample& q) const {
    return q.depth > 0.0 && q.px.x >= 0.0 && q.px.y >= 0.0 && q.px.x <= camera_.width_px && q.px.y <= camera_.height_px;
  }
  /// Image length from the curve's first point to a place, which may lie beyond the last.
  double length_to(double place) const {
    const double steps = static_cast<double>(steps_of(curve_));
    const double turns = curve_.closed ? std::floor(place / steps) : 0.0;
    const double rest = place - turns * steps;
    const auto i = std::min(static_cast<size_t>(rest), steps_of(curve_) - 1);
    return turns * lengths_.back() + glm::mix(lengths_[i], lengths_[i + 1], rest - static_cast<double>(i));
  }

  void find_events(const std::vector<NearerCrossing>& crossings) {
    for (const NearerCrossing& crossing : without_narrow_lenses(crossings)) {
      if (!is_tangency(crossing))
        cut_.events.push_back({VertexKind::crossing, crossing.at, crossing.layers, crossing.curve, crossing.on_nearer});
    }
    for (size_t i = 0; i < steps_of(curve_); ++i) {
      const CurveSample &a = at(i), &b = at(i + 1);
      const double place = static_cast<double>(i);
      if (in_frame(a) != in_frame(b)) cut_.events.push_back({VertexKind::frame, place + frame_share(a, b), {}, 0, 0.0});
      for (const Piercing& piercing : a.pierced)
        cut_.events.push_back({VertexKind::joint, place + std::min(piercing.t, 1.0 - 1e-9), piercing.layers, 0, 0.0});
      if (a.joint && (i > 0 || curve_.closed)) cut_.events.push_back({VertexKind::joint, place, {}, 0, 0.0});
      const bool differs = i > 0 && (a.object != at(i - 1).object || a.line_class != at(i - 1).line_class);
      if (differs && !a.joint) cut_.events.push_back({VertexKind::joint, place, 0, 0, 0.0});
    }
    if (curve_.smooth) find_cusps();
    if (!curve_.closed) {
      cut_.events.push_back({VertexKind::end, 0.0, {}, 0, 0.0});
      cut_.events.push_back({VertexKind::end, static_cast<double>(steps_of(curve_)), {}, 0, 0.0});
    }
    std::stable_sort(cut_.events.begin(), cut_.events.end(), [](const CurveEvent& a, const CurveEvent& b) { return a.at < b.at; });
  }

  /// Where the radial curvature changes its sign, but for rounding: the line of sight follows the contour there, and of its two arms the
  /// one farther from the eye lies behind the other one's sheet (Koenderink & van Doorn 1982).
  void find_cusps() {
    const auto sign_of = [&](size_t i) {
      const double bend = at(i).radial_curvature * extent_;
      return bend > kLeastBend ? 1 : bend < -kLeastBend ? -1 : 0;
    };
    size_t first = 0;
    while (first < size() && sign_of(first) == 0) ++first;
    if (first == size()) return;
    std::vector<CurveEvent> cusps;
    size_t last = first;
    for (size_t k = first + 1; k < first + size() + (curve_.closed ? 1 : 0) && (curve_.closed || k < size()); ++k) {
      if (sign_of(k) == 0) continue;
      if (sign_of(k) != sign_of(last)) {
        const CurveSample &a = at(last), &b = at(k);
        const double t = std::clamp(a.radial_curvature / (a.radial_curvature - b.radial_curvature), 0.0, 1.0 - 1e-9);
        const glm::dvec2 px = glm::mix(a.px, b.px, t);
        const Arm back = arm_from(px, last, -1), ahead = arm_from(px, k, 1);
        const double reach = std::min(back.reach_px(), ahead.reach_px());
        double place = glm::mix(static_cast<double>(last), static_cast<double>(k), t);
        if (place >= static_cast<double>(size()) && curve_.closed) place -= static_cast<double>(size());
        cusps.push_back({VertexKind::cusp, place, ahead.depth_at(reach) > back.depth_at(reach) ? 1 : -1, 0, 0.0});
      }
      last = k;
    }
    drop_narrow_swallowtails(cusps);
    cut_.events.insert(cut_.events.end(), cusps.begin(), cusps.end());
  }

  /// Depth along one of the arms of a cusp, by image distance from it. Where the curvature jumps both may lead away from the eye.
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
    const auto n = static_cast<std::ptrdiff_t>(size());
    for (std::ptrdiff_t count = 0; count < n; ++count, i += way) {
      if (!curve_.closed && (i < 0 || i >= n)) break;
      const CurveSample& sample = at(static_cast<size_t>(i + n));
      const double distance = glm::distance(sample.px, cusp_px);
      if (!arm.points.empty() && distance < arm.points.back().first) break;
      arm.points.emplace_back(distance, sample.depth);
      if (distance > kArm_px) break;
    }
    return arm;
  }

  /// Two cusps one after the other in the same direction make a swallowtail, whose arms cross; where it is so narrow that they lie on each
  /// other, and the crossing cannot be found, none of the three is there.
  void drop_narrow_swallowtails(std::vector<CurveEvent>& cusps) const {
    for (size_t k = 0; k + 1 < cusps.size();) {
      if (cusps[k].layers == cusps[k + 1].layers && is_narrow(cusps[k].at, cusps[k + 1].at)) {
        cusps.erase(cusps.begin() + static_cast<std::ptrdiff_t>(k), cusps.begin() + static_cast<std::ptrdiff_t>(k) + 2);
        k = k > 0 ? k - 1 : 0;
      } else {
        ++k;
      }
    }
  }
  bool is_narrow(double first, double second) const {
    const double length = length_to(second) - length_to(first);
    if (length > kLongestNarrow_px) return false;
    const auto crosses_itself = [&](const CurveEvent& event) {
      return event.kind == VertexKind::crossing && event.nearer == number_ &&
             std::min(apart_px(event.at, first), apart_px(event.at, second)) < length + kTangency_px;
    };
    if (std::any_of(cut_.events.begin(), cut_.events.end(), crosses_itself)) return false;
    const std::vector<glm::dvec2> middle = px_between(curve_, first, second);
    return lies_along(middle, px_from(second, length, 1)) || lies_along(middle, px_from(first, length, -1));
  }
  std::vector<glm::dvec2> px_between(const SurfaceCurve& curve, double from, double to) const {
    const size_t n = curve.samples.size();
    std::vector<glm::dvec2> px{sample_at(curve, from, camera_).px};
    for (double i = std::floor(from) + 1.0; i < to; i += 1.0) px.push_back(curve.samples[static_cast<size_t>(i) % n].px);
    px.push_back(sample_at(curve, to, camera_).px);
    return px;
  }
  std::vector<glm::dvec2> px_from(double place, double length_px, int way) const {
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

  /// Image length between two places, the shorter way round.
  double apart_px(double one, double other) const {
    const double way = std::fabs(length_to(one) - length_to(other));
    return curve_.closed ? std::min(way, lengths_.back() - way) : way;
  }

  /// Where a line runs along a nearer one, as two rims of a tube seen down its axis do, their polylines cross again and again: two
  /// crossings of the same pair of lines, between which these lie on each other, are none.
  std::vector<NearerCrossing> without_narrow_lenses(const std::vector<NearerCrossing>& crossings) const {
    std::vector<NearerCrossing> kept;
    std::map<std::uint32_t, std::vector<size_t>> open;  // Of each nearer curve, what is kept of it, in order.
    std::vector<bool> gone;
    for (const NearerCrossing& crossing : crossings) {
      auto& before = open[crossing.curve];
      if (crossing.curve != number_ && !before.empty() && is_lens(kept[before.back()], crossing)) {
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
  bool is_lens(const NearerCrossing& one, const NearerCrossing& other) const {
    if (one.layers != -other.layers) return false;
    const SurfaceCurve& nearer = curves_[one.curve];
    const auto steps = static_cast<double>(steps_of(nearer));
    double from = std::min(one.on_nearer, other.on_nearer), to = std::max(one.on_nearer, other.on_nearer);
    if (nearer.closed && to - from > 0.5 * steps) std::tie(from, to) = std::pair(to, from + steps);
    if (to - from > kMostLensSteps || other.at - one.at > kMostLensSteps) return false;
    return lies_along(px_between(curve_, one.at, other.at), px_between(nearer, from, to));
  }

  /// A crease leaves a contour, and the two arms of a cusp each other, along their common tangent: polylines of them cross again and again
  /// there, and the curves do not.
  bool is_tangency(const NearerCrossing& crossing) const {
    if (crossing.curve == number_) return one_cusp_between(crossing.at, crossing.on_nearer) || is_spike(crossing);
    const SurfaceCurve& other = curves_[crossing.curve];
    for (const Stretch& own : to_ends(curve_, crossing.at)) {
      for (const Stretch& others : to_ends(other, crossing.on_nearer)) {
        if (glm::distance(own.end, others.end) < 1e-6 * extent_ && run_together(own, others)) return true;
      }
    }
    return false;
  }

  /// Between the two passages the curve goes there and back on the same way, as beside the tip of a cone.
  bool is_spike(const NearerCrossing& crossing) const {
    const double from = std::min(crossing.at, crossing.on_nearer), to = std::max(crossing.at, crossing.on_nearer);
    if (length_to(to) - length_to(from) > kLongestNarrow_px) return false;
    const std::vector<glm::dvec2> px = px_between(curve_, from, to);
    const auto farther = [&](const glm::dvec2& a, const glm::dvec2& b) { return glm::distance(a, px[0]) < glm::distance(b, px[0]); };
    const auto turn = std::max_element(px.begin(), px.end(), farther);
    const std::vector<glm::dvec2> there(px.begin(), turn + 1), back(turn, px.end());
    return lies_along(there, back) && lies_along(back, there);
  }

  bool one_cusp_between(double one, double other) const {
    if (std::fabs(length_to(one) - length_to(other)) > 2.0 * kTangency_px) return false;
    const auto last = static_cast<size_t>(std::max(one, other));
    int changes = 0;
    for (auto i = static_cast<size_t>(std::min(one, other)); i < last; ++i)
      changes += (at(i).radial_curvature < 0.0) != (at(i + 1).radial_curvature < 0.0);
    return changes == 1;
  }

  /// From a place on a curve along it to an end or a joint.
  struct Stretch {
    glm::dvec3 end{0.0};
    std::vector<glm::dvec2> px{};
  };
  static std::vector<Stretch> to_ends(const SurfaceCurve& curve, double place) {
    std::vector<Stretch> all;
    const auto n = static_cast<std::ptrdiff_t>(curve.samples.size());
    for (const int way : {1, -1}) {
      Stretch stretch;
      double length = 0.0;
      auto i = static_cast<std::ptrdiff_t>(place) + (way > 0 ? 1 : 0);
      for (std::ptrdiff_t count = 0; count < n && length <= kTangency_px; ++count, i += way) {
        if (!curve.closed && (i < 0 || i >= n)) break;
        const CurveSample& sample = curve.samples[static_cast<size_t>((i + n) % n)];
        if (!stretch.px.empty()) length += glm::distance(sample.px, stretch.px.back());
        stretch.px.push_back(sample.px);
        if (!sample.joint && (curve.closed || (i > 0 && i < n - 1))) continue;
        stretch.end = sample.p;
        all.push_back(stretch);
        break;
      }
    }
    return all;
  }
  static bool run_together(const Stretch& one, const Stretch& other) {
    // Each stretch leaves out the part before its first sample, where the other one may begin: one of them is enough.
    return lies_along(one.px, other.px) || lies_along(other.px, one.px);
  }

  double frame_share(const CurveSample& a, const CurveSample& b) const {
    double inside = in_frame(a) ? 0.0 : 1.0, outside = 1.0 - inside;
    for (int step = 0; step < 40; ++step) {
      const double t = 0.5 * (inside + outside);
      CurveSample q = a;
      q.p = glm::mix(a.p, b.p, t);
      project_sample(camera_, q);
      (in_frame(q) ? inside : outside) = t;
    }
    return std::clamp(inside, 0.0, 1.0 - 1e-9);
  }

  void make_pieces() {
    const size_t n = cut_.events.size();
    if (n == 0) {
      if (in_frame(at(0))) add_piece(-1, -1, 0.0, static_cast<double>(steps_of(curve_)));
      return;
    }
    for (size_t k = 0; k < n; ++k) {
      const bool last = k + 1 == n;
      if (last && !curve_.closed) break;
      const double from = cut_.events[k].at;
      const double to = last ? cut_.events[0].at + static_cast<double>(steps_of(curve_)) : cut_.events[k + 1].at;
      if (in_frame(sample_at(curve_, 0.5 * (from + to), camera_))) add_piece(static_cast<int>(k), static_cast<int>((k + 1) % n), from, to);
    }
  }
  void add_piece(int begin, int end, double from, double to) {
    cut_.pieces.push_back({number_, begin, end, from, to, length_to(to) - length_to(from), 0, true});
  }

  // ---- Invisibility ----

  /// The sample of a piece nearest to the share of its length, or a point on a chord where it holds none.
  double ray_at(const CurvePiece& piece, double share) const {
    const double begin = length_to(piece.from), wanted = begin + share * piece.length_px;
    double best = -1.0, least = std::numeric_limits<double>::infinity();
    const double shift = curve_.straight ? 0.5 : 0.0;
    for (double place = std::floor(piece.from) + 1.0 - shift; place < piece.to; place += 1.0) {
      if (place <= piece.from) continue;
      const double here = length_to(place), off = std::fabs(here - wanted), room = std::min(here - begin, begin + piece.length_px - here);
      if (off >= least || room < std::min(kNearEnd_px, 0.2 * piece.length_px)) continue;
      least = off;
      best = place;
    }
    return best >= 0.0 ? best : glm::mix(piece.from, piece.to, share);
  }
  int cast(double place) {
    ++rays;
    return layers_before_(sample_at(curve_, place, camera_));
  }

  void settle() {
    // Arcs: pieces in a row between which the steps are known.
    std::vector<std::vector<size_t>> arcs;
    const auto known = [&](const CurvePiece& before, const CurvePiece& after) {
      return before.end >= 0 && before.end == after.begin && cut_.events[static_cast<size_t>(before.end)].layers.has_value();
    };
    auto& pieces = cut_.pieces;
    for (size_t k = 0; k < pieces.size(); ++k) {
      if (k == 0 || !known(pieces[k - 1], pieces[k])) arcs.emplace_back();
      arcs.back().push_back(k);
    }
    bool around = false;
    if (curve_.closed && !pieces.empty() && known(pieces.back(), pieces.front())) {
      around = arcs.size() == 1;
      if (!around) {
        arcs.back().insert(arcs.back().end(), arcs.front().begin(), arcs.front().end());
        arcs.erase(arcs.begin());
      }
    }
    for (const auto& arc : arcs) settle_arc(arc, around);
  }

  int step_into(size_t piece) const { return *cut_.events[static_cast<size_t>(cut_.pieces[piece].begin)].layers; }

  void settle_arc(const std::vector<size_t>& arc, bool around) {
    auto& pieces = cut_.pieces;
    std::vector<int> relative(arc.size(), 0);
    for (size_t k = 1; k < arc.size(); ++k) relative[k] = relative[k - 1] + step_into(arc[k]);
    const bool adds_up = !around || relative.back() + step_into(arc[0]) == 0;
    const int lowest = *std::min_element(relative.begin(), relative.end());
    if (adds_up) {
      const std::optional<int> offset = offset_by_two_rays(arc, relative);
      if (offset && *offset + lowest >= 0) {
        for (size_t k = 0; k < arc.size(); ++k) pieces[arc[k]].invisibility = *offset + relative[k];
        return;
      }
    }
    settle_by_rays(arc, around);
  }

  std::optional<int> offset_by_two_rays(const std::vector<size_t>& arc, const std::vector<int>& relative) {
    // The two longest pieces; in a lone one, two places.
    size_t first = 0, second = 0;
    const auto length = [&](size_t k) { return cut_.pieces[arc[k]].length_px; };
    for (size_t k = 1; k < arc.size(); ++k) {
      if (length(k) > length(first)) first = k;
    }
    if (arc.size() > 1) {
      second = first == 0 ? 1 : 0;
      for (size_t k = 0; k < arc.size(); ++k) {
        if (k != first && length(k) > length(second)) second = k;
      }
      if (length(second) < 2.0 * kNearEnd_px) second = first;
    }
    const bool same = first == second;
    const int one = cast(ray_at(cut_.pieces[arc[first]], same ? 0.35 : 0.5)) - relative[first];
    const int two = cast(ray_at(cut_.pieces[arc[second]], same ? 0.65 : 0.5)) - relative[second];
    if (one != two) return {};
    return one;
  }

  /// What most of three rays say, or nothing for a piece too short to ask.
  std::optional<int> by_vote(const CurvePiece& piece, double least_px) {
    if (piece.length_px < least_px) return {};
    std::map<int, int> votes;
    for (const double share : {0.5, 0.3, 0.7}) ++votes[cast(ray_at(piece, share))];
    return std::max_element(votes.begin(), votes.end(), [](const auto& a, const auto& b) { return a.second < b.second; })->first;
  }

  void settle_by_rays(const std::vector<size_t>& arc, bool around) {
    auto& pieces = cut_.pieces;
    std::vector<std::optional<int>> seen;
    for (const size_t k : arc) seen.push_back(by_vote(pieces[k], kShort_px));
    if (std::none_of(seen.begin(), seen.end(), [](const auto& s) { return s.has_value(); })) {
      const auto shorter = [&](size_t a, size_t b) { return pieces[a].length_px < pieces[b].length_px; };
      const auto longest = std::max_element(arc.begin(), arc.end(), shorter);
      seen[static_cast<size_t>(longest - arc.begin())] = by_vote(pieces[*longest], 0.0);
    }
    std::optional<size_t> last;
    int steps = 0;
    for (size_t k = 0; k < arc.size(); ++k) {
      if (k > 0) steps += step_into(arc[k]);
      if (seen[k] && last && *seen[*last] + steps != *seen[k]) conflict(arc[k], *seen[*last] + steps, *seen[k]);
      if (seen[k]) {
        last = k;
        steps = 0;
      }
    }
    // Pieces too short for rays take what their neighbours and the steps say.
    for (size_t k = 0; k < arc.size(); ++k) {
      CurvePiece& piece = pieces[arc[k]];
      if (seen[k])
        piece.invisibility = *seen[k];
      else if (k > 0)
        piece.invisibility = std::max(0, pieces[arc[k - 1]].invisibility + step_into(arc[k]));
    }
    for (size_t k = arc.size() - 1; k-- > 0 && !seen[k];) {
      if (std::any_of(seen.begin(), seen.begin() + static_cast<std::ptrdiff_t>(k), [](const auto& s) { return s.has_value(); })) break;
      pieces[arc[k]].invisibility = std::max(0, pieces[arc[k + 1]].invisibility - step_into(arc[k + 1]));
    }
    if (around && last && seen[0]) {
      const int total = steps + step_into(arc[0]);
      if (*seen[*last] + total != *seen[0]) conflict(arc[0], *seen[*last] + total, *seen[0]);
    }
  }

  void conflict(size_t k, int expected, int found) {
    CurvePiece& piece = cut_.pieces[k];
    piece.certain = false;
    conflicts.push_back({fmt::format("{} layers lie in front by the steps along the line, {} by rays", expected, found),
                         sample_at(curve_, piece.from, camera_).px});
  }

  const std::vector<SurfaceCurve>& curves_;
  const SurfaceCurve& curve_;
  std::uint32_t number_;
  const Camera& camera_;
  double extent_;
  const LayersBefore& layers_before_;
  std::vector<double> lengths_;
  CutCurve cut_;
};

/// Between samples i and i + 1 on a smooth curve, by the cubic through four of them (Lagrange) over their chords' lengths: its image may
/// turn back at a cusp there, the curve itself does not.
glm::dvec3 point_between(const SurfaceCurve& curve, size_t i, double t) {
  const size_t n = curve.samples.size();
  const glm::dvec3 &a = curve.samples[i % n].p, &b = curve.samples[(i + 1) % n].p;
  const bool inner = curve.closed ? n >= 4 : i >= 1 && i + 2 < n;
  if (!curve.smooth || !inner) return glm::mix(a, b, t);
  const glm::dvec3 &before = curve.samples[(i + n - 1) % n].p, &after = curve.samples[(i + 2) % n].p;
  const double h = glm::distance(a, b), back = glm::distance(before, a), ahead = glm::distance(b, after);
  // Neighbours much nearer or farther say little, and much of rounding.
  if (!(h > 0.0) || back < 0.05 * h || ahead < 0.05 * h || back > 20.0 * h || ahead > 20.0 * h) return glm::mix(a, b, t);
  const double s[4] = {-back, 0.0, h, h + ahead}, x = t * h;
  const glm::dvec3* const points[4] = {&before, &a, &b, &after};
  glm::dvec3 result(0.0);
  for (int k = 0; k < 4; ++k) {
    double weight = 1.0;
    for (int j = 0; j < 4; ++j) {
      if (j != k) weight *= (x - s[j]) / (s[k] - s[j]);
    }
    result += weight * *points[k];
  }
  return result;
}

}  // namespace

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
  sample.joint = false;
  sample.on_chord = true;
  sample.p = point_between(curve, i, t);
  sample.radial_curvature = glm::mix(a.radial_curvature, b.radial_curvature, t);
  project_sample(camera, sample);
  return sample;
}

CutCurves cut_by_invisibility(const std::vector<SurfaceCurve>& curves, const Camera& camera, double extent,
                              const LayersBefore& layers_before, const ExecutionSettings& execution) {
  const auto crossings = nearer_crossings(curves, camera);
  CutCurves result;
  result.curves.resize(curves.size());
  std::vector<std::vector<LineConflict>> conflicts(curves.size());
  std::atomic<std::int64_t> rays = 0;
  parallel_for(size_t{0}, curves.size(), [&](size_t c) {
    if (execution.cancelled && execution.cancelled()) throw Cancelled{};
    Cutter cutter(curves, static_cast<std::uint32_t>(c), camera, extent, layers_before);
    result.curves[c] = cutter.run(crossings[c]);
    conflicts[c] = std::move(cutter.conflicts);
    rays += cutter.rays;
  });
  for (auto& of_curve : conflicts) result.conflicts.insert(result.conflicts.end(), of_curve.begin(), of_curve.end());
  result.rays = rays;
  return result;
}

}  // namespace limn
