#include "raymarch/truth/strands.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <mutex>

#include "raymarch/truth/cell_scope.h"
#include "sdf/segment.h"

namespace limn {
namespace {

constexpr double kBracket = 1e-11;        // of the extent, to which ends are bracketed
constexpr double kFinestStepPx = 0.02;    // unproven steps are cut down to this
constexpr double kNearLevel = 0.1;        // of N.V: so near the level a side is looked at more often
constexpr double kNearLevelStepPx = 0.1;  // so often
constexpr double kThinning = 0.1;         // of the tolerance
constexpr double kLongestChordPx = 4.0;
constexpr size_t kManyBranches = 12;
constexpr double kAround = 1.0 / 24.0;  // of the extent
constexpr double kBulge = 1.2;          // a curve's length over its chord's, at most
constexpr double kOvershoot = 0.02;     // of a bracket's width, beyond the root that its ends tell
constexpr int kBracketSteps = 60;
constexpr double kNearlyTurned = 0.03;  // of N.V: a seam's side whose N.V is less may turn within a step and back
constexpr double kCloseTurnsPx = 1.0;   // farther apart the contours that end there tell them from each other

/// A point of a strand and whether the border goes through it.
struct Spot {
  CurvePoint point{};
  glm::dvec2 px{0.0};
  double scale = 1.0;   ///< Pixels per world unit.
  double margin = 0.0;  ///< surface_margin.
  double clear = 1.0;   ///< The lesser |N.V - c| of a seam's sides.
  bool on = false;
  bool first_high = false;         ///< Of a seam's sides the first has the higher N.V.
  std::array<double, 2> facing{};  ///< Of a seam's sides: N.V - c.
  bool keep = false;               ///< Stays a point of the curve.
};

class Cutter {
 public:
  Cutter(const Strand& strand, const StrandSettings& settings)
      : strand_(strand),
        settings_(settings),
        evaluators_(settings.scope.evaluators()),
        sides_(margin_sides(settings.sharp, strand.first, strand.second)) {
    values_.resize(evaluators_.size());
    for (size_t i = 0; i < evaluators_.size(); ++i) near_.push_back(i);
    set_changing();
    if (strand.second >= 0) intersection_ = meet_as_intersection(settings.sharp, strand.first, strand.second);
  }

  std::vector<FieldCurve> run() {
    const size_t n = strand_.points.size();
    std::vector<Spot> spots;
    Spot last = spot(strand_.points[0]);
    for (size_t i = 0; i < n; ++i) {
      spots.push_back(last);
      if (i + 1 == n && !strand_.closed) break;
      last = i + 1 == n ? spots.front() : spot(strand_.points[i + 1]);
      scan(spots.back(), last, 0, spots);
    }
    if (strand_.whole) add_close_turns(spots);
    return runs_of(spots);
  }

 private:
  FieldEvaluator& evaluator(int branch) { return evaluators_[static_cast<size_t>(branch)]; }

  void look_around(const glm::dvec3& p) {
    const glm::ivec3 cube = settings_.scope.cube_of(p);
    if (looked_around_ && cube == cube_) return;
    cube_ = cube;
    looked_around_ = true;
    const StrandScope::Around& around = settings_.scope.around(cube);
    near_ = around.near;
    values_ = around.values;
    for (const int branch : {strand_.first, strand_.second}) {
      if (branch >= 0 && std::find(near_.begin(), near_.end(), static_cast<size_t>(branch)) == near_.end())
        near_.push_back(static_cast<size_t>(branch));
    }
    set_changing();
  }

  /// What is asked for from now on changes with the branches near by; what others have stays.
  void set_changing() {
    changing_ = nodes_above(settings_.sharp, near_);
    node_values(settings_.sharp, values_, nodes_);
  }

  Spot spot(const CurvePoint& point) {
    Spot result{point};
    const glm::dvec3 image = project(settings_.camera, point.p);
    result.px = glm::dvec2(image);
    result.scale = pixels_per_unit_at(settings_.camera, std::max(image.z, 1e-9 * settings_.extent));
    if (evaluators_.size() > kManyBranches) look_around(point.p);
    for (const size_t i : near_) values_[i] = evaluators_[i].value(point.p);
    update_node_values(settings_.sharp, values_, changing_, nodes_);
    result.margin = surface_margin(sides_, nodes_);
    if (strand_.second >= 0) {
      result.on = describe_seam(result) && result.margin > 0.0;
    } else {
      // Where a crease of a branch lies within another's face there is none of the whole.
      const double least = point.crease ? settings_.sharp.epsilon * static_cast<double>(evaluators_.size()) : 0.0;
      result.on = result.margin > least;
    }
    return result;
  }

  /// Normals of the sides; true where c lies between their N.V.
  bool describe_seam(Spot& spot) {
    CurvePoint& point = spot.point;
    const SurfaceSample a = sample_surface(evaluator(strand_.first), settings_.viewer, point.p),
                        b = sample_surface(evaluator(strand_.second), settings_.viewer, point.p);
    const glm::dvec3 n = glm::normalize(a.gradient), m = glm::normalize(b.gradient);
    // The surface leaves the seam along either side to where the other one is negative, or positive.
    const double way = intersection_ ? -1.0 : 1.0, nm = glm::dot(n, m);
    const glm::dvec3 along_a = way * (m - nm * n), along_b = way * (n - nm * m);
    const bool a_high = a.facing > b.facing;
    spot.first_high = a_high;
    point.crease = true;
    point.high = a_high ? n : m;
    point.low = a_high ? m : n;
    point.uphill = a_high ? along_a - along_b : along_b - along_a;
    spot.facing = {a.facing - strand_.c, b.facing - strand_.c};
    spot.clear = std::min(std::fabs(spot.facing[0]), std::fabs(spot.facing[1]));
    return strand_.whole || (a.facing < strand_.c) != (b.facing < strand_.c);
  }

  std::optional<Spot> between(const Spot& a, const Spot& b) {
    const glm::dvec3 middle = 0.5 * (a.point.p + b.point.p);
    std::optional<CurvePoint> point;
    if (strand_.second >= 0) {
      point = polish_seam(evaluator(strand_.first), evaluator(strand_.second), middle, 0.5 * glm::distance(a.point.p, b.point.p));
    } else {
      point = point_between(evaluator(strand_.first), settings_.viewer, strand_.c, a.point, b.point, middle);
      if (point && glm::dot(point->uphill, a.point.uphill + b.point.uphill) < 0.0) point->uphill = a.point.uphill;
    }
    if (!point) return {};
    return spot(*point);
  }

  /// The seam's sides change places between the two: where they are equal, c is not between them, be it for a thousandth of a pixel.
  bool swapped(const Spot& a, const Spot& b) const { return !strand_.whole && a.on && b.on && a.first_high != b.first_high; }

  /// Nothing can change between the two: the margin is no steeper than the field.
  bool settled(const Spot& a, const Spot& b, double length) const {
    const bool inside = a.margin > 0.0;
    if (inside != (b.margin > 0.0)) return false;
    const bool proven = std::fabs(a.margin) + std::fabs(b.margin) > kBulge * settings_.lipschitz * length;
    if (!proven || !inside || strand_.second < 0 || strand_.whole) return proven;
    return std::min(a.clear, b.clear) > kNearLevel || a.scale * length < kNearLevelStepPx;
  }

  /// The seam's own bend: others are refined when they are cut.
  bool straight(const Spot& a, const Spot& middle, const Spot& b) const {
    const glm::dvec2 off = middle.px - 0.5 * (a.px + b.px);
    return glm::length(off) < 0.25 * settings_.tolerance_px;
  }

  /// Where a side of a whole seam turns away from the eye and back within half a step: a place between, by the parabola through three
  /// values.
  std::optional<Spot> dip_between(const Spot& a, const Spot& middle, const Spot& b) {
    if (!strand_.whole || !a.on || !b.on) return {};
    for (size_t side = 0; side < 2; ++side) {
      const double fa = a.facing[side], fm = middle.facing[side], fb = b.facing[side], least = std::min(std::fabs(fa), std::fabs(fb));
      if (least > kNearlyTurned || (fa > 0.0) != (fb > 0.0) || (fa > 0.0) != (fm > 0.0)) continue;
      const double bend = fa - 2.0 * fm + fb, share = 0.5 + 0.25 * (fa - fb) / bend;
      if (!(share > 0.0 && share < 1.0)) continue;
      const double extremum = fa - 2.0 * bend * share * share;
      if ((extremum > 0.0) == (fa > 0.0) && std::fabs(extremum) > 0.1 * least) continue;
      const std::optional<Spot> dip = beside(a, b, share, 0.5 * glm::distance(a.point.p, b.point.p));
      if (dip && dip->on && (dip->facing[side] > 0.0) != (fa > 0.0)) return dip;
    }
    return {};
  }

  /// Two turns of one side so close to each other that they would be taken for one place become points of the seam.
  void add_close_turns(std::vector<Spot>& spots) {
    std::vector<std::pair<size_t, Spot>> turns;
    for (size_t side = 0; side < 2; ++side) {
      std::optional<size_t> last;
      bool last_added = false;
      for (size_t i = 0; i + 1 < spots.size(); ++i) {
        const bool turned = spots[i].on && spots[i + 1].on && (spots[i].facing[side] > 0.0) != (spots[i + 1].facing[side] > 0.0);
        if (!turned) continue;
        const bool close = last && glm::distance(spots[*last + 1].px, spots[i].px) < kCloseTurnsPx;
        if (close && !last_added) turns.emplace_back(*last, turn_between(spots[*last], spots[*last + 1], side));
        if (close) turns.emplace_back(i, turn_between(spots[i + 1], spots[i], side));
        last = i;
        last_added = close;
      }
    }
    std::stable_sort(turns.begin(), turns.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    for (const auto& [step, turn] : turns) spots.insert(spots.begin() + static_cast<std::ptrdiff_t>(step) + 1, turn);
  }
  /// The last place on the way from b to a where the side is as at b.
  Spot turn_between(Spot a, Spot b, size_t side) {
    const bool faces = a.facing[side] > 0.0;
    for (int step = 0; step < kBracketSteps && glm::distance(a.point.p, b.point.p) > kBracket * settings_.extent; ++step) {
      const std::optional<Spot> middle = between(a, b);
      if (!middle) break;
      ((middle->facing[side] > 0.0) == faces ? a : b) = *middle;
    }
    b.keep = true;
    return b;
  }

  /// The margin alone says that the border ends between the two.
  bool ends_between(const Spot& a, const Spot& b) const {
    return a.on != b.on && (a.margin > 0.0) == a.on && (b.margin > 0.0) == b.on &&
           (strand_.whole || (strand_.second < 0 && !a.point.crease && !b.point.crease));
  }

  /// The curve's point beside one of a short chord, by Newton's iteration alone.
  std::optional<Spot> beside(const Spot& a, const Spot& b, double share, double reach) {
    const glm::dvec3 way = b.point.p - a.point.p, guess = a.point.p + share * way;
    std::optional<CurvePoint> point = strand_.second >= 0 ? polish_seam(evaluator(strand_.first), evaluator(strand_.second), guess, reach)
                                                          : polish(evaluator(strand_.first), settings_.viewer, strand_.c, guess, reach);
    if (!point) return {};
    const double place = glm::dot(point->p - a.point.p, way) / glm::dot(way, way);
    if (!(place > 0.0 && place < 1.0)) return {};
    if (strand_.second < 0 && glm::dot(point->uphill, a.point.uphill + b.point.uphill) < 0.0) point->uphill = a.point.uphill;
    return spot(*point);
  }

  /// The margin is all but linear over so short a step: false position, a little beyond the root towards the end that is farther from it,
  /// so that both ends come near; halves where that does not narrow the bracket.
  void bracket_end(const Spot& a, const Spot& b, std::vector<Spot>& out) {
    const double whole = glm::distance(a.point.p, b.point.p);
    std::vector<Spot> from_a, from_b;
    for (int step = 0; step < kBracketSteps; ++step) {
      const Spot &low = from_a.empty() ? a : from_a.back(), &high = from_b.empty() ? b : from_b.back();
      const double length = glm::distance(low.point.p, high.point.p);
      if (length < kBracket * settings_.extent) break;
      double share = low.margin / (low.margin - high.margin);
      share += (share < 0.5 ? kOvershoot : -kOvershoot) * length / whole;
      if (step % 4 == 3 || !(share > 0.0 && share < 1.0)) share = 0.5;
      std::optional<Spot> middle = beside(low, high, share, 0.5 * whole);
      if (!middle) middle = between(low, high);
      if (!middle) break;
      (middle->on == a.on ? from_a : from_b).push_back(*middle);
    }
    out.insert(out.end(), from_a.begin(), from_a.end());
    out.insert(out.end(), from_b.rbegin(), from_b.rend());
  }

  void scan(const Spot& a, const Spot& b, int depth, std::vector<Spot>& out) {
    const double length = glm::distance(a.point.p, b.point.p);
    if (depth > 60 || length < kBracket * settings_.extent) return;
    const double length_px = a.scale * length;  // On the surface: seen along its length a strand is shorter in the image.
    const bool same = a.on == b.on && !swapped(a, b), quiet = same && (settled(a, b, length) || length_px < kFinestStepPx);
    const bool seam = strand_.second >= 0;
    if (quiet && (!seam || !a.on || length_px < kFinestStepPx)) return;
    if (ends_between(a, b) && length_px < kFinestStepPx) return bracket_end(a, b, out);
    const std::optional<Spot> middle = between(a, b);
    if (!middle) return;
    if (quiet && straight(a, *middle, b)) {
      const std::optional<Spot> dip = dip_between(a, *middle, b);
      const bool before = dip && glm::distance(a.point.p, dip->point.p) < glm::distance(a.point.p, middle->point.p);
      if (before) out.push_back(*dip);
      out.push_back(*middle);
      if (dip && !before) out.push_back(*dip);
      return;
    }
    scan(a, *middle, depth + 1, out);
    out.push_back(*middle);
    scan(*middle, b, depth + 1, out);
  }

  /// What ends were bracketed with, and steps were proven with, is more than the curve's shape needs: from each point on, as far as a chord
  /// goes along all between.
  FieldCurve curve_of(const std::vector<Spot>& stretch, bool closed) const {
    FieldCurve curve{strand_.c, closed, strand_.whole, strand_.whole && !intersection_, {}, strand_.first, strand_.second};
    const size_t n = stretch.size();
    for (size_t i = 0; i < n;) {
      curve.points.push_back(stretch[i].point);
      size_t next = i + 1;
      // Of followed points there are no more than are needed, beside cusps, too.
      while (!strand_.followed && next + 1 < n && is_chord(stretch, i, next + 1)) ++next;
      i = next;
    }
    return curve;
  }

  bool is_chord(const std::vector<Spot>& stretch, size_t first, size_t last) const {
    const glm::dvec2 a = stretch[first].px, d = stretch[last].px - a;
    const double squared = glm::dot(d, d), most = kThinning * settings_.tolerance_px;
    if (squared > kLongestChordPx * kLongestChordPx || stretch[first].point.crease != stretch[last].point.crease) return false;
    for (size_t i = first + 1; i < last; ++i) {
      const glm::dvec2 q = stretch[i].px - a;
      if (glm::distance(q, closest_share(q, d) * d) > most || stretch[i].keep || stretch[i].point.crease != stretch[first].point.crease)
        return false;
    }
    return !strand_.whole || turns_once(stretch, first, last);
  }

  /// On the way from one spot to the other each side of the seam turns to the eye or away from it, and not both.
  static bool turns_once(const std::vector<Spot>& stretch, size_t first, size_t last) {
    std::array<int, 2> turns{};
    for (size_t i = first; i < last; ++i) {
      for (size_t side = 0; side < 2; ++side) turns[side] += (stretch[i].facing[side] > 0.0) != (stretch[i + 1].facing[side] > 0.0);
    }
    return turns[0] <= 1 && turns[1] <= 1;
  }

  std::vector<FieldCurve> runs_of(std::vector<Spot>& spots) const {
    std::vector<FieldCurve> result;
    const size_t n = spots.size();
    const auto begins = [&](size_t i) { return !spots[i].on || ((i > 0 || strand_.closed) && swapped(spots[(i + n - 1) % n], spots[i])); };
    size_t first = 0;
    while (first < n && !begins(first)) ++first;
    if (first == n) {
      if (n > 1) result.push_back(curve_of(spots, strand_.closed));
      return result;
    }
    if (strand_.closed) std::rotate(spots.begin(), spots.begin() + static_cast<std::ptrdiff_t>(first), spots.end());
    std::vector<Spot> stretch;
    const auto finish = [&] {
      if (stretch.size() > 1) result.push_back(curve_of(stretch, false));
      stretch.clear();
    };
    for (const Spot& spot : spots) {
      if (!spot.on || (!stretch.empty() && swapped(stretch.back(), spot))) finish();
      if (spot.on) stretch.push_back(spot);
    }
    finish();
    return result;
  }

  const Strand& strand_;
  const StrandSettings& settings_;
  std::vector<FieldEvaluator>& evaluators_;
  std::vector<MarginSide> sides_;
  std::vector<double> values_, nodes_;
  std::vector<size_t> near_{};   ///< Branches that are evaluated.
  std::vector<int> changing_{};  ///< Nodes that change with them.
  glm::ivec3 cube_{0};
  bool looked_around_ = false;
  bool intersection_ = true;
};

}  // namespace

struct StrandScope::Shared {
  tbb::enumerable_thread_specific<std::vector<FieldEvaluator>> evaluators;
  std::mutex mutex;
  std::map<std::array<int, 3>, Around> around;
};

StrandScope::StrandScope(const SharpField& sharp, double extent)
    : sharp_(sharp), side_(kAround * extent), shared_(std::make_unique<Shared>()) {}
StrandScope::~StrandScope() = default;

std::vector<FieldEvaluator>& StrandScope::evaluators() {
  std::vector<FieldEvaluator>& own = shared_->evaluators.local();
  if (own.empty()) {
    for (const Field& branch : sharp_.branches) own.emplace_back(branch);
  }
  return own;
}

const StrandScope::Around& StrandScope::around(const glm::ivec3& cube) {
  const std::array<int, 3> key = {cube.x, cube.y, cube.z};
  {
    const std::lock_guard lock(shared_->mutex);
    const auto known = shared_->around.find(key);
    if (known != shared_->around.end()) return known->second;
  }
  std::vector<FieldEvaluator>& branches = evaluators();
  const glm::dvec3 corner(cube);
  Around found{relevant_branches(sharp_, branches, {side_ * (corner - 0.05), side_ * (corner + 1.05)}), {}};
  for (FieldEvaluator& branch : branches) found.values.push_back(branch.value(side_ * (corner + 0.5)));
  const std::lock_guard lock(shared_->mutex);
  return shared_->around.try_emplace(key, std::move(found)).first->second;
}

std::vector<FieldCurve> cut_to_surface(const Strand& strand, const StrandSettings& settings) {
  if (strand.points.size() < 2) return {};
  return Cutter(strand, settings).run();
}

}  // namespace limn
