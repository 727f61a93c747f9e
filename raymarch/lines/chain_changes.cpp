#include "raymarch/lines/chain_changes.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "sdf/segment.h"

namespace limn {
namespace {

constexpr double kAround_px = 2.0;  // beyond what appears or vanishes, where the graph is looked at
constexpr double kMostOfIt = 0.9;   // of a chain that lies on other lines
constexpr double kLongestThin_px = 40.0;
constexpr double kSameEdge = 1e-6;  // of the radius
constexpr double kLeastKept = 0.5;  // of the shorter of two partners

/// Both graphs, seen from the one that a chain is in and the other lacks. Forwards for births and splits, backwards for deaths and merges.
struct Side {
  const PlacedChains& with;                                ///< Has the chain.
  const PlacedChains& without;                             ///< Has none that continues it.
  const std::map<std::pair<int, int>, double>& common_px;  ///< By chain of `without` and chain of `with`.
  const std::vector<int>& partner_of;                      ///< Of chains of `without`, in `with`.
  const std::vector<int>& nearest;                         ///< Of places of `with`, in `without`.
};

/// Where a part of a chain ends: at an end of the chain, or within it.
struct PartEnd {
  glm::dvec2 px{0.0};
  std::optional<ChainEnd> end{};
};

struct Gap {
  double length_px = std::numeric_limits<double>::infinity();
  PartEnd one{}, other{};
};

glm::dvec2 middle_of(const PlacedChains& chains, int chain) {
  const ChainShape& shape = chains.chains[static_cast<size_t>(chain)];
  return chains.places[static_cast<size_t>(shape.places[shape.places.size() / 2])].px;
}

double radius_of(const PlacedChains& chains, int chain, const glm::dvec2& px) {
  double most = 0.0;
  for (const int place : chains.chains[static_cast<size_t>(chain)].places)
    most = std::max(most, glm::distance(px, chains.places[static_cast<size_t>(place)].px));
  return most;
}

/// Every place lies beside a line of another visible chain.
bool lies_on_others(const PlacedChains& chains, const std::vector<glm::dvec2>& px, const std::vector<int>& own, double thin_px) {
  std::vector<const LineEdge*> near;
  for (size_t c = 0; c < chains.chains.size(); ++c) {
    if (!chains.chains[c].visible || std::find(own.begin(), own.end(), static_cast<int>(c)) != own.end()) continue;
    for (const ChainLink& link : chains.graph->chains[c].links) near.push_back(&chains.graph->edges[static_cast<size_t>(link.edge)]);
  }
  return std::all_of(px.begin(), px.end(), [&](const glm::dvec2& p) {
    return std::any_of(near.begin(), near.end(), [&](const LineEdge* edge) {
      for (size_t i = 0; i + 1 < edge->points.size(); ++i) {
        if (distance_to_segment(p, edge->points[i].px, edge->points[i + 1].px) <= thin_px) return true;
      }
      return false;
    });
  });
}

using LocalGraph = std::multiset<std::vector<int>>;

/// What the graph has near an image point, in a form that can be compared: vertices by kind with the edges that meet there.
LocalGraph local_graph(const ViewGraph& graph, const glm::dvec2& px, double radius) {
  std::map<int, std::vector<int>> at;
  LocalGraph all;
  for (const LineEdge& edge : graph.edges) {
    const int what = 64 * static_cast<int>(edge.line_class) + std::min(edge.invisibility, 63);
    if (edge.begin >= 0) at[edge.begin].push_back(what);
    if (edge.end >= 0) at[edge.end].push_back(what);
    const auto inside = [&](const LinePoint& point) { return glm::distance(point.px, px) <= radius; };
    if (edge.begin < 0 && std::any_of(edge.points.begin(), edge.points.end(), inside)) all.insert({-1, what});
  }
  for (auto& [vertex, edges] : at) {
    const LineVertex& one = graph.vertices[static_cast<size_t>(vertex)];
    if (glm::distance(one.px, px) > radius) continue;
    std::sort(edges.begin(), edges.end());
    edges.insert(edges.begin(), static_cast<int>(one.kind));
    all.insert(edges);
  }
  return all;
}

int curve_in_front(const ViewGraph& graph, const ChainEnd& end) {
  const int edge = end.vertex < 0 ? -1 : graph.vertices[static_cast<size_t>(end.vertex)].crossed_by;
  return edge < 0 ? -1 : graph.edges[static_cast<size_t>(edge)].curve;
}

/// By the kinds of the ends that come into being: of a chain, or of the gap between two.
ChainCause cause_of(const ViewGraph& graph, const std::vector<ChainEnd>& ends, bool gap) {
  const auto count = [&](VertexKind kind) {
    return std::count_if(ends.begin(), ends.end(), [&](const ChainEnd& end) { return end.kind == kind; });
  };
  if (ends.empty()) return ChainCause::lips;
  if (count(VertexKind::frame) > 0) return ChainCause::frame;
  if (count(VertexKind::joint) + count(VertexKind::end) > 0) return ChainCause::joint;
  if (count(VertexKind::crossing) == 0) return gap ? ChainCause::beak_to_beak : ChainCause::lips;
  if (count(VertexKind::cusp) > 0) {
    const ChainEnd& crossing = ends[ends[0].kind == VertexKind::crossing ? 0 : 1];
    const int own = graph.edges[static_cast<size_t>(crossing.edge)].curve;
    return curve_in_front(graph, crossing) == own ? ChainCause::swallowtail : ChainCause::cusp_crossing;
  }
  const int one = curve_in_front(graph, ends.front()), other = curve_in_front(graph, ends.back());
  return one >= 0 && one == other ? ChainCause::tangency : ChainCause::triple_point;
}

class ChangeFinder {
 public:
  ChangeFinder(const TrackSettings& settings) : settings_(settings) {}

  /// Of a visible chain without partner.
  FoundChange lone(const Side& side, int chain, bool forward) const {
    FoundChange change;
    const ChainShape& shape = side.with.chains[static_cast<size_t>(chain)];
    (forward ? change.after : change.before) = chain;
    change.px = middle_of(side.with, chain);
    change.length_px = shape.length_px;
    std::vector<glm::dvec2> places;
    for (const int place : shape.places) places.push_back(side.with.places[static_cast<size_t>(place)].px);
    const bool thin = shape.length_px <= kLongestThin_px && lies_on_others(side.with, places, {chain}, settings_.thin_px);
    if (shape.length_px <= settings_.short_px || thin) {
      change.change = forward ? ChainChange::birth : ChainChange::death;
      change.settled = true;
      explain(side, shape.ends, false, radius_of(side.with, chain, change.px), change);
      if (shape.ends.empty() && side.with.graph->chains[static_cast<size_t>(chain)].line_class != LineClass::contour &&
          change.cause == ChainCause::lips)
        change.cause = ChainCause::joint;
      return change;
    }
    if (const int other = source_of(side, chain); other >= 0) {
      change.change = forward ? ChainChange::split : ChainChange::merge;
      change.other = other;
      part(side, gaps_of(side, chain, other), change);
      return change;
    }
    change.change = forward ? ChainChange::birth : ChainChange::death;
    if (turned_edge_on(side, chain)) {
      change.cause = ChainCause::edge_on;
      change.settled = true;
    }
    return change;
  }

 private:
  /// The visible chain of the other graph that most of this one was part of.
  static int source_of(const Side& side, int chain) {
    int best = -1;
    double most = 0.0;
    const ChainShape& shape = side.with.chains[static_cast<size_t>(chain)];
    for (const auto& [pair, common] : side.common_px) {
      if (pair.second != chain || !side.without.chains[static_cast<size_t>(pair.first)].visible) continue;
      if (common > most) {
        most = common;
        best = pair.first;
      }
    }
    return most > 0.5 * shape.length_px ? best : -1;
  }

  /// The ends of a chain, and those of the longest part of it that came of a chain of the other graph.
  static std::vector<PartEnd> part_ends(const Side& side, int chain, int source) {
    const ChainShape& shape = side.with.chains[static_cast<size_t>(chain)];
    std::vector<PartEnd> ends;
    for (const ChainEnd& end : shape.ends) ends.push_back({end.px, end});
    const auto is_part = [&](size_t k) {
      const int found = side.nearest[static_cast<size_t>(shape.places[k])];
      return found >= 0 && side.without.places[static_cast<size_t>(found)].chain == source;
    };
    const auto px = [&](size_t k) { return side.with.places[static_cast<size_t>(shape.places[k])].px; };
    size_t begin = 0, from = 0, to = 0;
    for (size_t k = 0; k < shape.places.size(); ++k) {
      if (!is_part(k)) begin = k + 1;
      if (k + 1 - begin > to - from) from = begin, to = k + 1;
    }
    if (from < to && from > 0) ends.push_back({0.5 * (px(from - 1) + px(from)), {}});
    if (from < to && to < shape.places.size()) ends.push_back({0.5 * (px(to - 1) + px(to)), {}});
    return ends;
  }

  /// Between ends of the chain and ends of what else came of its source, the shortest first. Either may have gone on in another chain's
  /// part: then it is the end of the part that counts.
  static std::vector<Gap> gaps_of(const Side& side, int chain, int source) {
    std::vector<Gap> gaps;
    const std::vector<PartEnd> ends = part_ends(side, chain, source);
    for (const auto& [pair, common] : side.common_px) {
      const auto other = static_cast<size_t>(pair.second);
      if (pair.first != source || pair.second == chain || !side.with.chains[other].visible || common <= 0.0) continue;
      for (const PartEnd& others : part_ends(side, pair.second, source)) {
        for (const PartEnd& end : ends) gaps.push_back({glm::distance(end.px, others.px), end, others});
      }
    }
    std::stable_sort(gaps.begin(), gaps.end(), [](const Gap& a, const Gap& b) { return a.length_px < b.length_px; });
    return gaps;
  }

  /// The shortest gap at which something changed; where nothing did the shortest one, unexplained.
  void part(const Side& side, const std::vector<Gap>& gaps, FoundChange& change) const {
    std::optional<FoundChange> first;
    for (const Gap& gap : gaps) {
      FoundChange tried = change;
      tried.length_px = gap.length_px;
      tried.px = 0.5 * (gap.one.px + gap.other.px);
      tried.settled = gap.length_px <= settings_.short_px || is_thin(side, change.other, gap);
      if (gap.one.end && gap.other.end)
        explain(side, {*gap.one.end, *gap.other.end}, true, 0.5 * gap.length_px, tried);
      else
        explain_exchange(side, 0.5 * gap.length_px, tried);
      if (!first || tried.settled) first = tried;
      if (tried.settled) break;
    }
    if (first) change = *first;
  }

  /// What lies between the ends in the graph where the parts are one chain runs along another line.
  bool is_thin(const Side& side, int source, const Gap& gap) const {
    const std::vector<int>& places = side.without.chains[static_cast<size_t>(source)].places;
    const auto px = [&](size_t k) { return side.without.places[static_cast<size_t>(places[k])].px; };
    size_t one = 0, other = 0;
    for (size_t k = 1; k < places.size(); ++k) {
      if (glm::distance(px(k), gap.one.px) < glm::distance(px(one), gap.one.px)) one = k;
      if (glm::distance(px(k), gap.other.px) < glm::distance(px(other), gap.other.px)) other = k;
    }
    std::vector<glm::dvec2> between;
    double length_px = 0.0;
    for (size_t k = std::min(one, other); k <= std::max(one, other); ++k) {
      between.push_back(px(k));
      length_px += side.without.places[static_cast<size_t>(places[k])].length_px;
    }
    return length_px <= kLongestThin_px && lies_on_others(side.with, between, {}, settings_.thin_px);
  }

  void explain(const Side& side, const std::vector<ChainEnd>& ends, bool gap, double radius, FoundChange& change) const {
    const double around = radius + kAround_px;
    const bool same = local_graph(*side.with.graph, change.px, around) == local_graph(*side.without.graph, change.px, around);
    change.cause = same ? ChainCause::unexplained : cause_of(*side.with.graph, ends, gap);
    // A chain may be shorter than its own way between the two times.
    change.settled = change.settled && !same;
  }

  /// Where chains go on with parts of each other.
  static void explain_exchange(const Side& side, double radius, FoundChange& change) {
    const LocalGraph one = local_graph(*side.with.graph, change.px, radius + kAround_px),
                     other = local_graph(*side.without.graph, change.px, radius + kAround_px);
    const auto is_joint = [](const std::vector<int>& vertex) { return vertex[0] == static_cast<int>(VertexKind::joint); };
    const bool joint = std::any_of(one.begin(), one.end(), is_joint) || std::any_of(other.begin(), other.end(), is_joint);
    change.cause = one == other ? ChainCause::unexplained : joint ? ChainCause::joint : ChainCause::beak_to_beak;
    change.settled = change.settled && one != other;
  }

  /// The first place along a chain from which on it belongs to another one of the other graph.
  static std::optional<glm::dvec2> switch_of(const PlacedChains& chains, int chain, const PlacedChains& others,
                                             const std::vector<int>& nearest, int one, int other) {
    const std::vector<int>& places = chains.chains[static_cast<size_t>(chain)].places;
    const auto partner = [&](size_t k) {
      const int found = nearest[static_cast<size_t>(places[k])];
      return found < 0 ? -1 : others.places[static_cast<size_t>(found)].chain;
    };
    int last = -1;
    for (size_t k = 0; k < places.size(); ++k) {
      const int now = partner(k);
      if (now != one && now != other) continue;
      if (last >= 0 && now != last) return chains.places[static_cast<size_t>(places[k])].px;
      last = now;
    }
    return {};
  }

 public:
  /// Of two chains that have much in common and other partners.
  FoundChange exchange(const Side& side, const ChainOverlaps& overlaps, const ChainMatch& match, int before, int after) const {
    FoundChange change;
    change.change = ChainChange::exchange;
    change.before = before;
    change.after = change.other = after;
    change.length_px = overlaps.common_px.at({before, after});
    const auto from =
                   switch_of(side.without, before, side.with, overlaps.nearest_after, match.after_of[static_cast<size_t>(before)], after),
               to = switch_of(side.with, after, side.without, overlaps.nearest_before, match.before_of[static_cast<size_t>(after)], before);
    change.px = from ? *from : to ? *to : middle_of(side.without, before);
    if (!from || !to) return change;
    change.length_px = glm::distance(*from, *to);
    change.settled = change.length_px <= settings_.short_px;
    explain_exchange(side, change.length_px, change);
    return change;
  }

 private:
  /// A chain of sharp edges that are there in the other graph, too, in another class or hidden: a face turned.
  static bool turned_edge_on(const Side& side, int chain) {
    const auto& shape = side.with.chains[static_cast<size_t>(chain)];
    const ViewGraph& graph = *side.without.graph;
    double turned = 0.0;
    for (const int index : shape.places) {
      const ChainPlace& place = side.with.places[static_cast<size_t>(index)];
      if (!place.sharp) return false;
      const bool found = std::any_of(graph.edges.begin(), graph.edges.end(), [&](const LineEdge& edge) {
        if (!edge.crease) return false;
        for (size_t i = 0; i + 1 < edge.points.size(); ++i) {
          const glm::dvec3 &a = edge.points[i].position, &b = edge.points[i + 1].position;
          const glm::dvec3 way = b - a;
          const double squared = glm::dot(way, way), t = squared > 0.0 ? std::clamp(glm::dot(place.p - a, way) / squared, 0.0, 1.0) : 0.0;
          if (glm::distance(place.p, a + t * way) <= kSameEdge * side.with.radius) return true;
        }
        return false;
      });
      if (found) turned += place.length_px;
    }
    return turned > kMostOfIt * shape.length_px;
  }

  const TrackSettings& settings_;
};

}  // namespace

std::vector<FoundChange> changes_between(const PlacedChains& before, const PlacedChains& after, const ChainOverlaps& overlaps,
                                         const ChainMatch& match, const TrackSettings& settings) {
  std::map<std::pair<int, int>, double> turned;
  for (const auto& [pair, common] : overlaps.common_px) turned[{pair.second, pair.first}] = common;
  const Side forward{after, before, overlaps.common_px, match.after_of, overlaps.nearest_before},
      backward{before, after, turned, match.before_of, overlaps.nearest_after};
  const ChangeFinder finder(settings);
  std::vector<FoundChange> changes;
  for (size_t c = 0; c < before.chains.size(); ++c) {
    if (before.chains[c].visible && match.after_of[c] < 0) changes.push_back(finder.lone(backward, static_cast<int>(c), false));
  }
  for (size_t c = 0; c < after.chains.size(); ++c) {
    if (after.chains[c].visible && match.before_of[c] < 0) changes.push_back(finder.lone(forward, static_cast<int>(c), true));
  }
  for (const auto& [pair, common] : overlaps.common_px) {
    const auto one = static_cast<size_t>(pair.first), other = static_cast<size_t>(pair.second);
    if (!before.chains[one].visible || !after.chains[other].visible || common <= settings.short_px) continue;
    const int after_of = match.after_of[one], before_of = match.before_of[other];
    if (after_of < 0 || before_of < 0 || after_of == pair.second) continue;
    changes.push_back(finder.exchange(forward, overlaps, match, pair.first, pair.second));
  }
  for (size_t c = 0; c < before.chains.size(); ++c) {
    const int partner = match.after_of[c];
    if (!before.chains[c].visible || partner < 0) continue;
    const double shorter = std::min(before.chains[c].length_px, after.chains[static_cast<size_t>(partner)].length_px);
    const double common = overlaps.common_px.at({static_cast<int>(c), partner});
    if (shorter <= settings.short_px || common >= kLeastKept * shorter) continue;
    FoundChange jump{.change = ChainChange::exchange, .before = static_cast<int>(c), .after = partner, .other = partner};
    jump.px = middle_of(before, jump.before);
    jump.length_px = shorter - common;
    changes.push_back(jump);
  }
  return changes;
}

}  // namespace limn
