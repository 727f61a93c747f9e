#include "raymarch/lines/chain_places.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "sdf/geometry.h"

namespace limn {
namespace {

constexpr double kSpacing_px = 1.0;
constexpr int kLeastPlaces = 5;       // of an edge
constexpr double kSharpScale = 0.2;   // of the scale of normals: between a smooth place and one on a sharp edge
constexpr double kNormalScale = 0.1;  // of the radius of all places: normals as a tie-break

/// Places at equal lengths along an edge.
void add_places(const LineEdge& edge, int edge_index, int chain, PlacedChains& out) {
  std::vector<double> along{0.0};
  for (size_t i = 1; i < edge.points.size(); ++i) along.push_back(along.back() + glm::distance(edge.points[i].px, edge.points[i - 1].px));
  const double length = along.back();
  const int count = std::max(kLeastPlaces, static_cast<int>(std::ceil(length / kSpacing_px)));
  size_t step = 0;
  for (int k = 0; k < count; ++k) {
    const double at = length * (k + 0.5) / count;
    while (step + 2 < along.size() && along[step + 1] < at) ++step;
    const LinePoint &a = edge.points[step], &b = edge.points[step + 1];
    const double width = along[step + 1] - along[step], t = width > 0.0 ? std::clamp((at - along[step]) / width, 0.0, 1.0) : 0.5;
    out.places.push_back({glm::mix(a.position, b.position, t), glm::mix(a.normal, b.normal, t), glm::mix(a.px, b.px, t), length / count,
                          edge_index, chain, edge.crease});
  }
}

double coordinate(const ChainPlace& place, int axis) { return place.p[axis]; }

/// Sorts indices so that the middle one of each range splits it along an axis that takes turns.
void split(const std::vector<ChainPlace>& places, std::vector<int>& order, size_t from, size_t to, int axis) {
  if (to - from < 2) return;
  const size_t middle = from + (to - from) / 2;
  const auto begin = order.begin();
  std::nth_element(begin + static_cast<std::ptrdiff_t>(from), begin + static_cast<std::ptrdiff_t>(middle),
                   begin + static_cast<std::ptrdiff_t>(to), [&](int a, int b) {
                     const double x = coordinate(places[static_cast<size_t>(a)], axis),
                                  y = coordinate(places[static_cast<size_t>(b)], axis);
                     return std::tie(x, a) < std::tie(y, b);
                   });
  split(places, order, from, middle, (axis + 1) % 3);
  split(places, order, middle + 1, to, (axis + 1) % 3);
}

struct Nearest {
  const std::vector<ChainPlace>& places;
  const std::vector<int>& order;
  const ChainPlace& wanted;
  double normal_scale;
  int best = -1;
  double least = std::numeric_limits<double>::infinity();

  void search(size_t from, size_t to, int axis) {
    if (from >= to) return;
    const size_t middle = from + (to - from) / 2;
    const int index = order[middle];
    const ChainPlace& place = places[static_cast<size_t>(index)];
    glm::dvec3 way = place.p - wanted.p;
    double squared = glm::dot(way, way);
    if (place.sharp != wanted.sharp) {
      // A contour may run so close beside a sharp edge that only this tells them apart.
      squared += kSharpScale * kSharpScale * normal_scale * normal_scale;
    } else if (!place.sharp) {
      const glm::dvec3 turn = normal_scale * (place.normal - wanted.normal);
      squared += glm::dot(turn, turn);
    }
    if (std::tie(squared, index) < std::tie(least, best) || best < 0) {
      least = squared;
      best = index;
    }
    const double off = coordinate(wanted, axis) - coordinate(place, axis);
    const bool lower_first = off < 0.0;
    const int next = (axis + 1) % 3;
    lower_first ? search(from, middle, next) : search(middle + 1, to, next);
    if (off * off <= least) lower_first ? search(middle + 1, to, next) : search(from, middle, next);
  }
};

ChainEnd end_of(const ViewGraph& graph, const ChainLink& link, bool at_end) {
  const LineEdge& edge = graph.edges[static_cast<size_t>(link.edge)];
  const bool last = link.reversed != at_end;
  ChainEnd end{last ? edge.end : edge.begin, VertexKind::end, last ? edge.points.back().px : edge.points.front().px, link.edge};
  if (end.vertex >= 0) end.kind = graph.vertices[static_cast<size_t>(end.vertex)].kind;
  return end;
}

}  // namespace

PlacedChains place_chains(const ViewGraph& graph) {
  PlacedChains out;
  out.graph = &graph;
  Box box;
  for (size_t c = 0; c < graph.chains.size(); ++c) {
    const LineChain& chain = graph.chains[c];
    ChainShape shape;
    shape.visible = chain.invisibility == 0;
    const size_t first = out.places.size();
    for (const ChainLink& link : chain.links) {
      const size_t before = out.places.size();
      add_places(graph.edges[static_cast<size_t>(link.edge)], link.edge, static_cast<int>(c), out);
      if (link.reversed) std::reverse(out.places.begin() + static_cast<std::ptrdiff_t>(before), out.places.end());
    }
    for (size_t i = first; i < out.places.size(); ++i) {
      shape.length_px += out.places[i].length_px;
      shape.places.push_back(static_cast<int>(i));
      box = include(box, out.places[i].p);
    }
    if (!chain.closed) shape.ends = {end_of(graph, chain.links.front(), false), end_of(graph, chain.links.back(), true)};
    out.chains.push_back(std::move(shape));
  }
  out.radius = box.empty() ? 0.0 : box.radius();
  for (size_t i = 0; i < out.places.size(); ++i) {
    const LineEdge& edge = graph.edges[static_cast<size_t>(out.places[i].edge)];
    out.trees[{edge.line_class, edge.object}].order.push_back(static_cast<int>(i));
  }
  for (auto& [kind, tree] : out.trees) split(out.places, tree.order, 0, tree.order.size(), 0);
  return out;
}

int nearest_place(const PlacedChains& chains, const ChainPlace& place, std::pair<LineClass, int> kind, double normal_scale) {
  const auto tree = chains.trees.find(kind);
  if (tree == chains.trees.end()) return -1;
  Nearest nearest{chains.places, tree->second.order, place, normal_scale};
  nearest.search(0, tree->second.order.size(), 0);
  return nearest.best;
}

ChainOverlaps overlaps_of(const PlacedChains& before, const PlacedChains& after) {
  const double scale = kNormalScale * std::max(before.radius, after.radius);
  ChainOverlaps overlaps;
  std::map<std::pair<int, int>, double> there, back;
  const auto look_up = [&](const PlacedChains& from, const PlacedChains& to, bool forward, std::vector<int>& nearest) {
    for (const ChainPlace& place : from.places) {
      const LineEdge& edge = from.graph->edges[static_cast<size_t>(place.edge)];
      const int found = nearest_place(to, place, {edge.line_class, edge.object}, scale);
      nearest.push_back(found);
      if (found < 0) continue;
      const int other = to.places[static_cast<size_t>(found)].chain;
      (forward ? there[{place.chain, other}] : back[{other, place.chain}]) += place.length_px;
    }
  };
  look_up(before, after, true, overlaps.nearest_after);
  look_up(after, before, false, overlaps.nearest_before);
  for (const auto& [pair, length] : there) {
    const auto other = back.find(pair);
    if (other != back.end()) overlaps.common_px[pair] = std::min(length, other->second);
  }
  return overlaps;
}

ChainMatch match_chains(const PlacedChains& before, const PlacedChains& after, const ChainOverlaps& overlaps) {
  ChainMatch match;
  match.after_of.assign(before.chains.size(), -1);
  match.before_of.assign(after.chains.size(), -1);
  std::vector<std::tuple<double, int, int>> pairs;
  for (const auto& [pair, common] : overlaps.common_px) {
    const bool same_class = before.graph->chains[static_cast<size_t>(pair.first)].line_class ==
                            after.graph->chains[static_cast<size_t>(pair.second)].line_class;
    const bool same_sight =
        before.chains[static_cast<size_t>(pair.first)].visible == after.chains[static_cast<size_t>(pair.second)].visible;
    if (same_class && same_sight) pairs.emplace_back(-common, pair.first, pair.second);
  }
  std::sort(pairs.begin(), pairs.end());
  for (const auto& [common, one, other] : pairs) {
    int &after_of = match.after_of[static_cast<size_t>(one)], &before_of = match.before_of[static_cast<size_t>(other)];
    if (after_of >= 0 || before_of >= 0) continue;
    after_of = other;
    before_of = one;
  }
  return match;
}

}  // namespace limn
