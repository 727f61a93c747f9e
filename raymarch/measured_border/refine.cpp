#include "raymarch/measured_border/refine.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "raymarch/curves/curve_geometry.h"
#include "raymarch/measured_border/edge_node.h"
#include "raymarch/scene/threads.h"

namespace limn {
namespace {

constexpr size_t kNone = static_cast<size_t>(-1);
/// Chords shorter than this are not halved.
constexpr double kShortest_px = 0.03;
constexpr int kMostHalvings = 10;
/// The first ray beside a chord, and by how much each further one goes beyond the one before.
constexpr double kFirstStep_px = 0.02;
constexpr double kGrowth = 2.5;
constexpr double kLongestStep_px = 0.5;
/// Tips of wedges are followed outwards so far at a time.
constexpr double kTip_px = 8.0;
/// Beyond a thin neck lies what another curve bounds: a tip that comes this near to a curve of the grid's own crossings is none.
constexpr double kNeck_px = 0.25;
/// A sheet's end is one from this step of depth on, px at the nearer sheet.
constexpr double kLeastJump_px = 0.3;
/// Along a curve depth changes by no more than this and so much for each px; where rays between find no smaller steps, two sheets' curves
/// were joined where they cross in the image.
constexpr double kLeastTear_px = 1.0;
constexpr double kSteepest = 10.0;
/// Curves are followed no farther beyond their last crossings, and not in smaller steps.
constexpr double kFarthest_px = 1.5;
constexpr double kFirstEndStep_px = 0.25;
constexpr double kLastEndStep_px = 0.02;

/// A point of a chain that grows: neighbours by index, so that points can be put between them.
struct Node {
  BorderPoint point{};
  double other_depth = 0.0;
  size_t next = kNone;
};

/// A line across a chord, or across a curve's continuation, on which the border is looked for.
struct Search {
  size_t curve = 0;
  size_t from = 0, to = kNone;      ///< Nodes of the chord; `to` is kNone beyond an end.
  glm::dvec2 middle{0.0};           ///< Where the line starts.
  glm::dvec2 outward{0.0};          ///< Its direction, unit: away from what the curve bounds.
  double depth = 0.0, other = 0.0;  ///< Expected of what is bounded, and of the other side.
  double limit = 0.0;               ///< How far to look.
  int halvings = 0;
  std::optional<EdgeNode> inside{}, outside{};  ///< The nearest known of either side.
  // Beyond an end:
  bool at_last = false;    ///< Which end.
  double step = 0.0;       ///< From the end.
  double beyond_px = 0.0;  ///< Followed so far.
};

/// One curve as a list of nodes.
struct Chain {
  CurveKind kind = CurveKind::silhouette;
  int object = 0;
  bool closed = false;
  std::vector<Node> nodes{};
  size_t first = 0, last = 0;
};

Chain chain_of(const BorderCurve& curve, const std::vector<double>& other_depths) {
  Chain chain{curve.kind, curve.object, curve.closed, {}, 0, curve.points.size() - 1};
  for (size_t i = 0; i < curve.points.size(); ++i) chain.nodes.push_back({curve.points[i], other_depths[i], i + 1});
  chain.nodes.back().next = curve.closed ? 0 : kNone;
  return chain;
}

BorderCurve curve_of(const Chain& chain) {
  BorderCurve curve{chain.kind, chain.object, chain.closed, {}};
  size_t i = chain.first;
  do {
    curve.points.push_back(chain.nodes[i].point);
    i = chain.nodes[i].next;
  } while (i != kNone && i != chain.first);
  return curve;
}

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
    for (size_t c = 0; c < chains.border.curves.size(); ++c) chains_.push_back(chain_of(chains.border.curves[c], chains.other_depths[c]));
  }

  void refine() {
    for (size_t c = 0; c < chains_.size(); ++c) look_at_bends(c);
    run();
    for (size_t c = 0, count = chains_.size(); c < count; ++c) cut_tears(c);
    for (size_t c = 0; c < chains_.size(); ++c) {
      if (chains_[c].closed) continue;
      for (const bool at_last : {false, true}) look_beyond(c, at_last, kFirstEndStep_px, 0.0);
    }
    run();
  }

  BorderCurves curves() const {
    BorderCurves result;
    for (const Chain& chain : chains_) {
      BorderCurve curve = curve_of(chain);
      if (curve.points.size() > 1) result.curves.push_back(std::move(curve));
    }
    return result;
  }

  std::int64_t rays = 0;

 private:
  Node& node(size_t curve, size_t i) { return chains_[curve].nodes[i]; }
  glm::dvec2 px(size_t curve, size_t i) { return node(curve, i).point.px; }

  bool is_torn(const Node& a, const Node& b) const {
    const double nearer = std::min(a.point.depth, b.point.depth), step = std::abs(a.point.depth - b.point.depth);
    return step * pixels_per_unit_at(camera_, nearer) > kLeastTear_px + kSteepest * glm::distance(a.point.px, b.point.px);
  }

  /// Makes several chains of one that joins different sheets; the first of them stays in its place.
  void cut_tears(size_t c) {
    std::vector<std::vector<Node>> pieces(1);
    const Chain chain = chains_[c];
    bool closing_torn = true;
    size_t i = chain.first;
    do {
      const Node& node = chain.nodes[i];
      pieces.back().push_back(node);
      i = node.next;
      if (i == kNone) break;
      const bool torn = is_torn(node, chain.nodes[i]);
      if (i == chain.first) {
        closing_torn = torn;
      } else if (torn) {
        pieces.emplace_back();
      }
    } while (i != chain.first);
    if (pieces.size() == 1 && (!chain.closed || !closing_torn)) return;
    if (chain.closed && !closing_torn) {
      pieces.back().insert(pieces.back().end(), pieces.front().begin(), pieces.front().end());
      pieces.erase(pieces.begin());
    }
    for (size_t p = 0; p < pieces.size(); ++p) {
      Chain piece{chain.kind, chain.object, false, std::move(pieces[p]), 0, 0};
      piece.last = piece.nodes.size() - 1;
      for (size_t k = 0; k < piece.nodes.size(); ++k) piece.nodes[k].next = k < piece.last ? k + 1 : kNone;
      if (p == 0) {
        chains_[c] = std::move(piece);
      } else {
        chains_.push_back(std::move(piece));
      }
    }
  }

  /// A bend of `turn` over a chord bulges by an eighth of their product, as on a circle.
  void look_at_bends(size_t c) {
    const Chain& chain = chains_[c];
    const size_t n = chain.nodes.size(), chords = chain.closed ? n : n - 1;
    const auto step = [&](size_t i) { return chain.nodes[(i + 1) % n].point.px - chain.nodes[i % n].point.px; };
    for (size_t i = 0; i < chords; ++i) {
      double turn = 0.0;
      if (i > 0 || chain.closed) turn = turn_between(step(i + n - 1), step(i));
      if (i + 1 < chords || chain.closed) turn = std::max(turn, turn_between(step(i), step(i + 1)));
      const bool bulges = 0.125 * turn * glm::length(step(i)) > kChordTolerance_px;
      if (bulges || is_torn(chain.nodes[i], chain.nodes[(i + 1) % n])) look_beside(c, i, (i + 1) % n, 0);
    }
  }

  void look_beside(size_t c, size_t from, size_t to, int halvings) {
    const Node &a = node(c, from), &b = node(c, to);
    const double length = glm::distance(a.point.px, b.point.px);
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
    active_.push_back(search);
  }

  /// From about a third of a pixel before the end towards it: the last chord alone may be too short to have a direction.
  std::optional<glm::dvec2> end_direction(size_t c, bool at_last) {
    const Chain& chain = chains_[c];
    const glm::dvec2 end = px(c, at_last ? chain.last : chain.first);
    std::optional<glm::dvec2> best;
    for (size_t i = chain.first; i != kNone; i = chain.nodes[i].next) {
      const glm::dvec2 from = chain.nodes[i].point.px;
      if (!(glm::distance(from, end) > 0.0)) continue;
      if (at_last && (!best || glm::distance(from, end) >= 0.3)) best = from;
      if (!at_last) {
        best = from;
        if (glm::distance(from, end) >= 0.3) break;
      }
    }
    if (!best) return std::nullopt;
    return (end - *best) / glm::distance(end, *best);
  }

  void look_beyond(size_t c, bool at_last, double step, double beyond) {
    const auto direction = end_direction(c, at_last);
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
      sample_points(model_, camera_, std::span(points).subspan(range.begin(), count), std::span(samples).subspan(range.begin(), count));
    });
  }

  bool bounded(const Search& search, const EdgeNode& at) const {
    if (!at.hit()) return false;
    if (chains_[search.curve].kind == CurveKind::inner) return double{at.n_dot_v} < settings_.threshold;
    return std::abs(at.depth - search.depth) < std::abs(at.depth - search.other);
  }

  void advance(Search& search, const EdgeNode& at) {
    (bounded(search, at) ? search.inside : search.outside) = at;
    if (search.inside && search.outside) {
      if (std::abs(search.inside->t - search.outside->t) <= settings_.precision_px) return take(search);
    } else if (std::abs(at.t) >= search.limit) {
      return give_up(search);
    }
    active_.push_back(search);
  }

  /// That the two rays see the two sides of this curve, and not an end of another sheet that crosses it.
  bool proven(const Search& search) const {
    const EdgeNode &in = *search.inside, &out = *search.outside;
    const Chain& chain = chains_[search.curve];
    if (in.id != chain.object) return false;
    const double step = out.hit() ? depth_step_px(camera_, in, out) : std::numeric_limits<double>::infinity();
    if (chain.kind == CurveKind::silhouette) return step > kLeastJump_px;
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
    Node found;
    found.point.px = search.middle + t * search.outward;
    found.point.depth = in.depth;
    found.other_depth = out.depth;
    if (search.to != kNone) {
      put_between(search, found, t);
    } else {
      put_beyond(search, found);
    }
  }

  void put_between(const Search& search, Node found, double off) {
    const Chain& chain = chains_[search.curve];
    if (std::abs(off) <= kChordTolerance_px && !is_torn(chain.nodes[search.from], chain.nodes[search.to])) return;
    if (off > 1.2 * kNeck_px && known_[chain.kind == CurveKind::inner].nearest(found.point.px, chain.object, kNeck_px)) return;
    std::vector<Node>& nodes = chains_[search.curve].nodes;
    found.next = search.to;
    nodes.push_back(found);
    const size_t middle = nodes.size() - 1;
    nodes[search.from].next = middle;
    look_beside(search.curve, search.from, middle, search.halvings + 1);
    look_beside(search.curve, middle, search.to, search.halvings + 1);
  }

  void put_beyond(const Search& search, Node found) {
    Chain& chain = chains_[search.curve];
    // What goes on there is another curve already.
    if (known_[chain.kind == CurveKind::inner].nearest(found.point.px, chain.object, std::min(0.05, 0.4 * search.step))) return;
    const double went = glm::distance(found.point.px, chain.nodes[search.from].point.px);
    found.next = search.at_last ? kNone : chain.first;
    chain.nodes.push_back(found);
    const size_t end = chain.nodes.size() - 1;
    if (search.at_last) {
      chain.nodes[chain.last].next = end;
      chain.last = end;
    } else {
      chain.first = end;
    }
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
  std::vector<Chain> chains_{};
  std::vector<Search> active_{};
};

}  // namespace

BorderCurves refine_chains(const SceneModel& model, const Camera& camera, const MeasuredBorderSettings& settings, ChainedCurves chains,
                           const ExecutionSettings& how, std::int64_t& rays) {
  Refiner refiner(model, camera, settings, how, chains);
  ThreadArena arena(how.threads);
  arena.execute([&] { refiner.refine(); });
  rays += refiner.rays;
  return refiner.curves();
}

}  // namespace limn
