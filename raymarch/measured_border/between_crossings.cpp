#include "raymarch/measured_border/between_crossings.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "raymarch/curves/curve_geometry.h"
#include "raymarch/measured_border/edge_node.h"
#include "raymarch/measured_border/growing_chain.h"
#include "raymarch/scene/threads.h"
#include "sdf/segment.h"

namespace limn {
namespace {

constexpr size_t kNone = ChainNode::kNone;
/// Chords shorter than this are not halved.
constexpr double kShortest_px = 0.03;
constexpr int kMostHalvings = 10;
/// The first ray beside a chord, and by how much each further one goes beyond the one before.
constexpr double kFirstStep_px = 0.02;
constexpr double kGrowth = 2.5;
constexpr double kLongestStep_px = 0.25;
/// Tips of wedges are followed outwards so far at a time.
constexpr double kTip_px = 8.0;
/// Beyond a thin neck lies what another curve bounds: a tip that comes this near to a curve of the grid's own crossings is none.
constexpr double kNeck_px = 0.25;
/// A sheet's end is one from this step of depth on, px at the nearer sheet; and where the step stays while its bracket shrinks by as much
/// more as find_crossings() asks: a sheet that goes on would close it.
constexpr double kLeastJump_px = 0.3;
constexpr double kProof = 16.0;
/// Where the other side's depth is not known, a sheet ends where depth grows by more px for each px.
constexpr double kSteepest = 10.0;
/// Curves are followed no farther beyond their last crossings, and not in smaller steps.
constexpr double kFarthest_px = 4.0;
constexpr double kFirstEndStep_px = 0.25;
constexpr double kLastEndStep_px = 0.02;
/// The direction of an end, from so far before it at most.
constexpr double kEnd_px = 0.3;

/// A line across a chord, or across a curve's continuation, on which the border is looked for.
struct Search {
  size_t curve = 0;
  size_t from = 0, to = kNone;      ///< Nodes of the chord; `to` is kNone beyond an end.
  glm::dvec2 middle{0.0};           ///< Where the line starts.
  glm::dvec2 outward{0.0};          ///< Its direction, unit: away from what the curve bounds.
  double depth = 0.0, other = 0.0;  ///< Expected of what is bounded, and of the other side.
  double limit = 0.0;               ///< How far to look.
  int halvings = 0;
  glm::dvec2 chord[2]{};                        ///< Ends of the chord between two crossings that it came from by halving.
  std::optional<EdgeNode> inside{}, outside{};  ///< The nearest known of either side.
  std::optional<double> step_before{};          ///< Of a silhouette: the step of depth when its proof began, px.
  bool by_steps = false;                        ///< A silhouette's other side begins where depth jumps, however deep it lies.
  // Beyond an end:
  bool at_last = false;    ///< Which end.
  double step = 0.0;       ///< From the end.
  double beyond_px = 0.0;  ///< Followed so far.
};

glm::dvec2 outward_of(const glm::dvec2& along) { return glm::dvec2(-along.y, along.x) / glm::length(along); }

/// Between two steps, radians, 0..pi.
double turn_between(const glm::dvec2& a, const glm::dvec2& b) { return std::abs(std::atan2(a.x * b.y - a.y * b.x, glm::dot(a, b))); }

class Refiner {
 public:
  Refiner(const SceneModel& model, const Camera& camera, const MeasuredBorderSettings& settings, const ExecutionSettings& how,
          const ChainedCurves& chains)
      : model_(model),
        camera_(camera),
        settings_(settings),
        how_(how),
        known_{CurveIndex(chains.border, CurveKind::silhouette), CurveIndex(chains.border, CurveKind::inner)} {
    for (size_t c = 0; c < chains.border.curves.size(); ++c)
      chains_.push_back(growing_chain(chains.border.curves[c], chains.other_depths[c]));
  }

  void refine() {
    for (size_t c = 0; c < chains_.size(); ++c) look_at_bends(c);
    run();
    cut_all_tears();
    // Where a chord was torn nothing is known any more.
    const BorderCurves now = curves();
    known_[0] = CurveIndex(now, CurveKind::silhouette);
    known_[1] = CurveIndex(now, CurveKind::inner);
    for (size_t c = 0; c < chains_.size(); ++c) {
      if (chains_[c].closed) continue;
      for (const bool at_last : {false, true}) look_beyond(c, at_last, kFirstEndStep_px, 0.0);
    }
    run();
  }

  BorderCurves curves() const {
    BorderCurves result;
    for (const GrowingChain& chain : chains_) {
      BorderCurve curve = curve_of(chain);
      if (curve.points.size() > 1) result.curves.push_back(std::move(curve));
    }
    return result;
  }

  std::int64_t rays = 0;

 private:
  ChainNode& node(size_t curve, size_t i) { return chains_[curve].nodes[i]; }
  glm::dvec2 px(size_t curve, size_t i) { return node(curve, i).point.px; }

  bool is_torn(const ChainNode& a, const ChainNode& b) const { return limn::is_torn(camera_, a, b); }

  /// The first piece of each chain stays in its place.
  void cut_all_tears() {
    for (size_t c = 0, count = chains_.size(); c < count; ++c) {
      std::vector<GrowingChain> pieces = cut_tears(camera_, chains_[c]);
      chains_[c] = std::move(pieces.front());
      for (size_t p = 1; p < pieces.size(); ++p) chains_.push_back(std::move(pieces[p]));
    }
  }

  /// A bend of `turn` over a chord bulges by an eighth of their product, as on a circle.
  void look_at_bends(size_t c) {
    const GrowingChain& chain = chains_[c];
    const size_t n = chain.nodes.size(), chords = chain.closed ? n : n - 1;
    const auto step = [&](size_t i) { return chain.nodes[(i + 1) % n].point.px - chain.nodes[i % n].point.px; };
    for (size_t i = 0; i < chords; ++i) {
      double turn = 0.0;
      if (i > 0 || chain.closed) turn = turn_between(step(i + n - 1), step(i));
      if (i + 1 < chords || chain.closed) turn = std::max(turn, turn_between(step(i), step(i + 1)));
      const bool bulges = 0.125 * turn * glm::length(step(i)) > kChordTolerance_px;
      if (bulges || is_torn(chain.nodes[i], chain.nodes[(i + 1) % n])) look_beside(c, i, (i + 1) % n);
    }
  }

  void look_beside(size_t c, size_t from, size_t to, const Search* halved = nullptr) {
    const ChainNode &a = node(c, from), &b = node(c, to);
    const double length = glm::distance(a.point.px, b.point.px);
    const int halvings = halved != nullptr ? halved->halvings + 1 : 0;
    if (length < kShortest_px || halvings > kMostHalvings) return;
    Search search;
    search.curve = c;
    search.from = from;
    search.to = to;
    search.middle = 0.5 * (a.point.px + b.point.px);
    search.outward = outward_of(b.point.px - a.point.px);
    search.depth = 0.5 * (a.point.depth + b.point.depth);
    search.other = 0.5 * (a.other_depth + b.other_depth);
    search.limit = std::max(2.0 * length, kTip_px);
    search.halvings = halvings;
    search.chord[0] = halved != nullptr ? halved->chord[0] : a.point.px;
    search.chord[1] = halved != nullptr ? halved->chord[1] : b.point.px;
    active_.push_back(search);
  }

  void look_beyond(size_t c, bool at_last, double step, double beyond) {
    // The shorter the step, the nearer to the end its direction is taken from: there a curve may turn.
    const auto direction = end_direction(chains_[c], at_last, std::clamp(2.0 * step, kShortest_px, kEnd_px));
    if (!direction || step < kLastEndStep_px || beyond + step > kFarthest_px) return;
    const size_t end = at_last ? chains_[c].last : chains_[c].first;
    Search search;
    search.curve = c;
    search.from = end;
    search.middle = px(c, end) + step * *direction;
    search.outward = outward_of(at_last ? *direction : -*direction);
    search.depth = node(c, end).point.depth;
    search.other = node(c, end).other_depth;
    search.limit = 0.6 * step;
    search.at_last = at_last;
    search.step = step;
    search.beyond_px = beyond;
    active_.push_back(search);
  }

  double next_point(const Search& search) const {
    if (search.inside && search.outside) return 0.5 * (search.inside->t + search.outside->t);
    if (!search.inside && !search.outside) return 0.0;
    const double sign = search.inside ? 1.0 : -1.0, reached = std::abs((search.inside ? search.inside : search.outside)->t);
    const double further = reached == 0.0 ? kFirstStep_px : std::min(kGrowth * reached, reached + kLongestStep_px);
    return sign * std::min(further, search.limit);
  }

  void run() {
    std::vector<glm::dvec2> points;
    std::vector<PointSample> samples;
    while (!active_.empty()) {
      points.clear();
      for (const Search& search : active_) points.push_back(search.middle + next_point(search) * search.outward);
      samples.resize(points.size());
      trace(points, samples);
      std::vector<Search> searches;
      searches.swap(active_);
      for (size_t i = 0; i < searches.size(); ++i) {
        const double t = next_point(searches[i]);
        const EdgeLine line{searches[i].middle, searches[i].outward};
        advance(searches[i], node_of_sample(camera_, samples[i], line, t));
      }
    }
  }

  void trace(const std::vector<glm::dvec2>& points, std::vector<PointSample>& samples) {
    if (how_.cancelled && how_.cancelled()) throw Cancelled{};
    rays += static_cast<std::int64_t>(points.size());
    parallel_parts(points.size(), size_t{64}, [&](const IndexRange<size_t>& range) {
      const size_t count = range.end() - range.begin();
      sample_points(model_, camera_, std::span(points).subspan(range.begin(), count), std::span(samples).subspan(range.begin(), count),
                    PointRays::in_packets);
    });
  }

  bool bounded(const Search& search, const EdgeNode& at) const {
    if (!at.hit()) return false;
    if (chains_[search.curve].kind == CurveKind::inner) return double{at.n_dot_v} < settings_.threshold;
    if (search.by_steps && search.inside && at.t > search.inside->t) {
      const double most = kLeastJump_px + kSteepest * (at.t - search.inside->t);
      if (depth_step_px(camera_, *search.inside, at) > most) return false;
    }
    return std::abs(at.depth - search.depth) < std::abs(at.depth - search.other);
  }

  void advance(Search& search, const EdgeNode& at) {
    (bounded(search, at) ? search.inside : search.outside) = at;
    if (search.inside && search.outside) {
      const double length = std::abs(search.inside->t - search.outside->t);
      const bool jump = chains_[search.curve].kind == CurveKind::silhouette && search.outside->hit();
      if (length <= settings_.precision_px && jump && !search.step_before) {
        search.step_before = depth_step_px(camera_, *search.inside, *search.outside);
      } else if (length <= settings_.precision_px / (jump ? kProof : 1.0)) {
        return take(search);
      }
    } else if (std::abs(at.t) >= search.limit) {
      if (!begin_anew(search)) return give_up(search);
    }
    active_.push_back(search);
  }

  /// Another sheet may lie behind a silhouette than at the points that its other side is known from: it is looked for again by steps of
  /// depth.
  bool begin_anew(Search& search) const {
    if (search.by_steps || chains_[search.curve].kind != CurveKind::silhouette || !search.inside) return false;
    search.by_steps = true;
    search.inside.reset();
    return true;
  }

  /// That the two rays see the two sides of this curve, and not an end of another sheet that crosses it.
  bool proven(const Search& search) const {
    const EdgeNode &in = *search.inside, &out = *search.outside;
    const GrowingChain& chain = chains_[search.curve];
    if (in.id != chain.object) return false;
    const double step = out.hit() ? depth_step_px(camera_, in, out) : std::numeric_limits<double>::infinity();
    if (chain.kind == CurveKind::silhouette) return step > kLeastJump_px && step > 2.0 * search.step_before.value_or(0.0) / kProof;
    const double length = std::abs(in.t - out.t), slope = std::min(std::abs(in.slope), std::abs(out.slope));
    return out.hit() && std::abs(step) <= 0.05 + 20.0 * length * (1.0 + slope);
  }

  void take(const Search& search) {
    if (!proven(search)) return give_up(search);
    const EdgeNode &in = *search.inside, &out = *search.outside;
    double t = 0.5 * (in.t + out.t);
    if (chains_[search.curve].kind == CurveKind::inner) {
      const double low = settings_.threshold - double{in.n_dot_v}, high = double{out.n_dot_v} - settings_.threshold;
      if (low + high > 0.0) t = in.t + (out.t - in.t) * low / (low + high);
    }
    ChainNode found;
    found.point.px = search.middle + t * search.outward;
    found.point.depth = in.depth;
    found.other_depth = out.depth;
    if (search.to != kNone) {
      put_between(search, found, t);
    } else {
      put_beyond(search, found);
    }
  }

  void put_between(const Search& search, ChainNode found, double off) {
    const GrowingChain& chain = chains_[search.curve];
    if (std::abs(off) <= kChordTolerance_px && !is_torn(chain.nodes[search.from], chain.nodes[search.to])) return;
    const bool at_known = known_[chain.kind == CurveKind::inner].nearest(found.point.px, chain.object, kNeck_px).has_value();
    if (at_known && distance_to_segment(found.point.px, search.chord[0], search.chord[1]) > 1.2 * kNeck_px) return;
    const size_t middle = limn::put_between(chains_[search.curve], search.from, search.to, found);
    look_beside(search.curve, search.from, middle, &search);
    look_beside(search.curve, middle, search.to, &search);
  }

  void put_beyond(const Search& search, ChainNode found) {
    GrowingChain& chain = chains_[search.curve];
    // What goes on there is another curve already.
    if (known_[chain.kind == CurveKind::inner].nearest(found.point.px, chain.object, std::min(0.05, 0.4 * search.step))) return;
    const double went = glm::distance(found.point.px, chain.nodes[search.from].point.px);
    limn::put_beyond(chain, search.at_last, found);
    look_beyond(search.curve, search.at_last, search.step, search.beyond_px + went);
  }

  void give_up(const Search& search) {
    if (search.to == kNone) look_beyond(search.curve, search.at_last, 0.5 * search.step, search.beyond_px);
  }

  const SceneModel& model_;
  const Camera& camera_;
  const MeasuredBorderSettings& settings_;
  const ExecutionSettings& how_;
  CurveIndex known_[2];  ///< Silhouettes, inner borders: what the crossings were joined to.
  std::vector<GrowingChain> chains_{};
  std::vector<Search> active_{};
};

}  // namespace

BorderCurves refine_chains(const SceneModel& model, const Camera& camera, const MeasuredBorderSettings& settings,
                           const ChainedCurves& chains, const ExecutionSettings& how, std::int64_t& rays) {
  Refiner refiner(model, camera, settings, how, chains);
  ThreadArena arena(how.threads);
  arena.execute([&] { refiner.refine(); });
  rays += refiner.rays;
  return refiner.curves();
}

}  // namespace limn
