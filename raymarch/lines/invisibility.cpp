#include "raymarch/lines/invisibility.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <map>

#include "raymarch/lines/curve_events.h"
#include "raymarch/lines/curve_walk.h"
#include "raymarch/lines/missed_changes.h"
#include "raymarch/lines/piece_rays.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr double kShort_px = 1.0;      // pieces shorter than this are not asked by rays of their own
constexpr double kBesideNearer = 0.3;  // of the way to a nearer line that runs along: so far off the curve rays start
constexpr double kWorthAsking_px = 3.0;
constexpr size_t kAskedOf = 6;  // pieces in a row: no more steps than that go by without a ray that confirms them
constexpr int kMostSearches = 4;
constexpr double kTouch_px = 0.01;  // two polylines, each known to half of this: so near their lines may cross where they do not

/// One curve being cut.
class Cutter {
 public:
  Cutter(const SurfaceCurve& curve, std::uint32_t number, const CurveWalk& walk, const Camera& camera, const NearerFolds& folds,
         const LayersBefore& layers_before)
      : curve_(curve),
        number_(number),
        camera_(camera),
        folds_(folds),
        layers_before_(layers_before),
        walk_(walk),
        starts_(curve, number, walk, camera, folds, cut_.events) {}

  CutCurve run(std::vector<CurveEvent> events) {
    cut_.events = std::move(events);
    for (int searches = kMostSearches; searches >= 0; --searches) {
      cut_.pieces.clear();
      conflicts.clear();
      missed_.clear();
      may_search_ = searches > 0;
      make_pieces();
      settle();
      if (missed_.empty()) break;
      cut_.events.insert(cut_.events.end(), missed_.begin(), missed_.end());
      std::stable_sort(cut_.events.begin(), cut_.events.end(), [](const CurveEvent& a, const CurveEvent& b) { return a.at < b.at; });
    }
    return std::move(cut_);
  }
  std::vector<LineConflict> conflicts{};
  std::vector<CurveSample> grazing{};  ///< See CutCurves.
  std::int64_t rays = 0;

 private:
  void make_pieces() {
    const size_t n = cut_.events.size();
    if (n == 0) {
      if (in_frame(camera_, walk_.at(0))) add_piece(-1, -1, 0.0, static_cast<double>(steps_of(curve_)));
      return;
    }
    for (size_t k = 0; k < n; ++k) {
      const bool last = k + 1 == n;
      if (last && !curve_.closed) break;
      const double from = cut_.events[k].at;
      const double to = last ? cut_.events[0].at + static_cast<double>(steps_of(curve_)) : cut_.events[k + 1].at;
      if (in_frame(camera_, sample_at(curve_, 0.5 * (from + to), camera_)))
        add_piece(static_cast<int>(k), static_cast<int>((k + 1) % n), from, to);
    }
  }
  void add_piece(int begin, int end, double from, double to) {
    cut_.pieces.push_back({number_, begin, end, from, to, walk_.length_to(to) - walk_.length_to(from), 0, true});
  }

  LayersSeen look(double place, double lift_share = 1.0) {
    ++rays;
    CurveSample sample = sample_at(curve_, place, camera_);
    sample.lift_share *= lift_share;
    return layers_before_(sample);
  }
  int cast(double place) { return look(place).count; }

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
      const std::optional<int> offset = offset_by_rays(arc, relative, around);
      if (offset && *offset + lowest >= 0) {
        for (size_t k = 0; k < arc.size(); ++k) pieces[arc[k]].invisibility = *offset + relative[k];
        return;
      }
    }
    // In pieces that nearer lines run along, and in short ones, only where nothing else explains it.
    for (const double least_unclear_px : {std::numeric_limits<double>::infinity(), kWorthAsking_px, kShort_px}) {
      if (may_search_ && search_missed(arc, relative, around, least_unclear_px)) return;
    }
    settle_by_rays(arc, around);
  }

  /// Places along an arc that rays are cast at, rising even where the arc goes past the curve's first sample.
  struct Probe {
    double at = 0.0;
    LayersSeen unexplained{};
  };
  /// Where rays disagree along an arc the line may go through a sheet that nobody saw, or behind a nearer line that only touches it as far
  /// as polylines tell: true where that explains something.
  bool search_missed(const std::vector<size_t>& arc, const std::vector<int>& relative, bool around, double least_unclear_px) {
    const auto steps = static_cast<double>(steps_of(curve_));
    std::vector<double> begins;
    for (const size_t k : arc) {
      double from = cut_.pieces[k].from;
      while (!begins.empty() && from < begins.back()) from += steps;
      begins.push_back(from);
    }
    const int once_around = around ? relative.back() + step_into(arc[0]) : 0;
    const auto unexplained = [&](double place) {
      const bool again = around && place >= begins[0] + steps;
      const auto next = std::upper_bound(begins.begin() + 1, begins.end(), again ? place - steps : place);
      LayersSeen seen = look(place);
      seen.count -= relative[static_cast<size_t>(next - begins.begin() - 1)] + (again ? once_around : 0);
      return seen;
    };
    std::vector<Probe> probes;
    for (size_t k = 0; k < arc.size(); ++k) {
      const CurvePiece& piece = cut_.pieces[arc[k]];
      if (piece.length_px < kNearEnd_px) continue;
      for (const double share : {0.15, 0.5, 0.85}) {
        const bool clear_only = piece.length_px < least_unclear_px || starts_.told_by_lines(piece);
        const std::optional<double> ray = clear_only ? starts_.clear_ray_at(piece, share) : starts_.telling_ray_at(piece, share);
        if (!ray) continue;
        const double place = begins[k] + (*ray - piece.from);
        if (probes.empty() || place > probes.back().at) probes.push_back({place, unexplained(place)});
      }
    }
    const ChangeSearch search{walk_, unexplained, [&](double place) {
                                return pixels_per_unit_at(camera_, std::max(1e-9, sample_at(curve_, place, camera_).depth));
                              }};
    if (around && probes.size() > 1) probes.push_back({probes[0].at + steps, unexplained(probes[0].at + steps)});
    const size_t before = missed_.size();
    for (size_t i = 0; i + 1 < probes.size(); ++i) {
      if (probes[i].unexplained.count == probes[i + 1].unexplained.count) continue;
      const auto found = find_missed(search, probes[i].at, probes[i + 1].at);
      if (!found) continue;
      if (!found->piercing) grazing.push_back(sample_at(curve_, std::fmod(found->with_more, steps), camera_));
      const double at = std::fmod(found->at, steps);
      if (found->piercing)
        missed_.push_back({VertexKind::joint, at, found->layers, 0, 0.0});
      else if (const auto nearer = folds_.nearest(sample_at(curve_, at, camera_), number_, at, kTouch_px))
        missed_.push_back({VertexKind::crossing, at, found->layers, nearer->curve, nearer->on_nearer});
      else if (const CurveEvent* denied = denied_crossing(at, found->layers))
        missed_.push_back({VertexKind::crossing, at, found->layers, denied->nearer, denied->on_nearer});
    }
    return missed_.size() > before;
  }

  /// A crossing of the line with itself beside a cusp, which rays on both sides of it deny: there its arms touch only.
  const CurveEvent* denied_crossing(double at, int layers) const {
    const auto is_it = [&](const CurveEvent& event) {
      return event.kind == VertexKind::crossing && event.nearer == number_ && event.layers == -layers &&
             walk_.apart_px(event.at, at) < kTouch_px;
    };
    const auto found = std::find_if(cut_.events.begin(), cut_.events.end(), is_it);
    return found == cut_.events.end() ? nullptr : &*found;
  }

  /// All of three rays say that something lies in front: from places clear of nearer lines where there are any. Where there are none rays
  /// that start nearer to the curve have to say so, too.
  bool is_hidden(const CurvePiece& piece) {
    for (const double share : {0.5, 0.3, 0.7}) {
      const std::optional<double> clear = starts_.clear_ray_at(piece, share);
      const double place = clear.value_or(starts_.ray_at(piece, share));
      if (cast(place) == 0) return false;
      if (clear) continue;
      const double room_px = folds_.clearance_px(sample_at(curve_, place, camera_), number_, place, starts_.least_clear_px);
      if (look(place, kBesideNearer * room_px / starts_.least_clear_px).count == 0) return false;
    }
    return true;
  }

  std::optional<int> offset_by_rays(const std::vector<size_t>& arc, const std::vector<int>& relative, bool around) {
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
    const int offset =
        cast(starts_.telling_ray_at(cut_.pieces[arc[first]], same ? 0.35 : 0.5).value_or(starts_.ray_at(cut_.pieces[arc[first]], 0.5))) -
        relative[first];
    const auto denies = [&](size_t k, double share) {
      const std::optional<double> place = starts_.telling_ray_at(cut_.pieces[arc[k]], share);
      return place && cast(*place) - relative[k] != offset;
    };
    if (denies(second, same ? 0.65 : 0.5)) return {};
    // Both ends of an open arc, between which every step lies.
    if (!around) {
      for (const size_t k : {size_t{0}, arc.size() - 1}) {
        if (k != first && k != second && length(k) >= kWorthAsking_px && denies(k, 0.5)) return {};
      }
    }
    // The longest hidden piece, too, and all that are drawn as visible, from a pixel on.
    std::optional<size_t> hidden;
    for (size_t k = 0; k < arc.size(); ++k) {
      if (offset + relative[k] != 0 && (!hidden || length(k) > length(*hidden))) hidden = k;
    }
    const auto is_asked = [&](size_t k) { return k == first || k == second; };
    if (hidden && !is_asked(*hidden) && length(*hidden) >= kWorthAsking_px && denies(*hidden, 0.5)) return {};
    for (size_t from = 0; from < arc.size(); from += kAskedOf) {
      size_t longest = from;
      for (size_t k = from; k < std::min(from + kAskedOf, arc.size()); ++k) {
        if (length(k) > length(longest)) longest = k;
      }
      if (is_asked(longest) || (hidden && longest == *hidden) || length(longest) < kWorthAsking_px) continue;
      if (const auto place = starts_.clear_ray_at(cut_.pieces[arc[longest]], 0.5); place && cast(*place) - relative[longest] != offset)
        return {};
    }
    for (size_t k = 0; k < arc.size(); ++k) {
      if (offset + relative[k] != 0 || is_asked(k) || length(k) < kShort_px) continue;
      if (is_hidden(cut_.pieces[arc[k]]) && !starts_.told_by_lines(cut_.pieces[arc[k]])) return {};
    }
    return offset;
  }

  /// What most of three rays say; nothing for a piece too short to ask, and where they disagree beside nearer lines. `least_px` 0: at any
  /// rate something.
  std::optional<int> by_vote(const CurvePiece& piece, double least_px) {
    if (piece.length_px < least_px) return {};
    std::map<int, int> votes;
    for (const double share : {0.5, 0.3, 0.7}) {
      if (const auto place = starts_.clear_ray_at(piece, share)) ++votes[cast(*place)];
    }
    if (votes.empty() && piece.length_px >= kWorthAsking_px && !starts_.told_by_lines(piece)) {
      // Nearer lines run along it: rays from points on the curve itself, if they agree.
      for (const double share : {0.5, 0.3, 0.7}) {
        if (const auto place = starts_.telling_ray_at(piece, share)) ++votes[cast(*place)];
      }
      if (votes.size() > 1 && least_px > 0.0) return {};
    }
    if (votes.empty() && least_px > 0.0) return {};
    if (votes.empty()) ++votes[cast(starts_.ray_at(piece, 0.5))];
    return std::max_element(votes.begin(), votes.end(), [](const auto& a, const auto& b) { return a.second < b.second; })->first;
  }

  /// What rays say of the pieces of an arc, at least of one of them.
  std::vector<std::optional<int>> votes_on(const std::vector<size_t>& arc) {
    const auto& pieces = cut_.pieces;
    std::vector<std::optional<int>> seen;
    seen.reserve(arc.size());
    for (const size_t k : arc) seen.push_back(by_vote(pieces[k], kShort_px));
    if (std::none_of(seen.begin(), seen.end(), [](const auto& s) { return s.has_value(); })) {
      const auto shorter = [&](size_t a, size_t b) { return pieces[a].length_px < pieces[b].length_px; };
      const auto longest = std::max_element(arc.begin(), arc.end(), shorter);
      seen[static_cast<size_t>(longest - arc.begin())] = by_vote(pieces[*longest], 0.0);
    }
    return seen;
  }

  void settle_by_rays(std::vector<size_t> arc, bool around) {
    auto& pieces = cut_.pieces;
    std::vector<std::optional<int>> seen = votes_on(arc);
    auto first = std::find_if(seen.begin(), seen.end(), [](const auto& s) { return s.has_value(); }) - seen.begin();
    // An arc that closes begins with a piece that rays were asked about: so the last step, too, lies between two of them.
    if (around) {
      std::rotate(arc.begin(), arc.begin() + first, arc.end());
      std::rotate(seen.begin(), seen.begin() + first, seen.end());
      first = 0;
    }
    auto last = static_cast<size_t>(first);
    int steps = 0;
    for (size_t k = last + 1; k < arc.size(); ++k) {
      steps += step_into(arc[k]);
      if (!seen[k]) continue;
      if (*seen[last] + steps != *seen[k]) conflict(arc[k], *seen[last] + steps, *seen[k]);
      last = k;
      steps = 0;
    }
    if (around && *seen[last] + steps + step_into(arc[0]) != *seen[0]) conflict(arc[0], *seen[last] + steps + step_into(arc[0]), *seen[0]);
    // Pieces too short for rays take what their neighbours and the steps say.
    for (auto k = static_cast<size_t>(first); k < arc.size(); ++k)
      pieces[arc[k]].invisibility = seen[k] ? *seen[k] : std::max(0, pieces[arc[k - 1]].invisibility + step_into(arc[k]));
    for (auto k = static_cast<size_t>(first); k-- > 0;)
      pieces[arc[k]].invisibility = std::max(0, pieces[arc[k + 1]].invisibility - step_into(arc[k + 1]));
  }

  void conflict(size_t k, int expected, int found) {
    CurvePiece& piece = cut_.pieces[k];
    piece.certain = false;
    conflicts.push_back({fmt::format("{} layers lie in front by the steps along the line, {} by rays", expected, found),
                         sample_at(curve_, piece.from, camera_).px});
  }

  const SurfaceCurve& curve_;
  std::uint32_t number_;
  const Camera& camera_;
  const NearerFolds& folds_;
  const LayersBefore& layers_before_;
  const CurveWalk& walk_;
  CutCurve cut_;
  PieceRays starts_;
  std::vector<CurveEvent> missed_{};  ///< Found by the last search.
  bool may_search_ = true;
};

}  // namespace

CutCurves cut_by_invisibility(const std::vector<SurfaceCurve>& curves, const Camera& camera, double extent,
                              const LayersBefore& layers_before, const ExecutionSettings& execution) {
  const NearerFolds folds(curves, camera);
  const auto crossings = folds.crossings();
  const EventSearch search(curves, camera, extent);
  CutCurves result;
  result.curves.resize(curves.size());
  std::vector<std::vector<LineConflict>> conflicts(curves.size());
  std::vector<std::vector<CurveSample>> grazing(curves.size());
  std::atomic<std::int64_t> rays = 0;
  parallel_for(size_t{0}, curves.size(), [&](size_t c) {
    if (execution.cancelled && execution.cancelled()) throw Cancelled{};
    const auto number = static_cast<std::uint32_t>(c);
    const CurveWalk walk(curves[c], camera);
    Cutter cutter(curves[c], number, walk, camera, folds, layers_before);
    result.curves[c] = cutter.run(events_of(search, number, walk, crossings[c]));
    conflicts[c] = std::move(cutter.conflicts);
    grazing[c] = std::move(cutter.grazing);
    rays += cutter.rays;
  });
  for (auto& of_curve : conflicts) result.conflicts.insert(result.conflicts.end(), of_curve.begin(), of_curve.end());
  for (auto& of_curve : grazing) result.grazing.insert(result.grazing.end(), of_curve.begin(), of_curve.end());
  result.rays = rays;
  return result;
}

}  // namespace limn
