// Edges joined into strokes.

#include <algorithm>
#include <tuple>

#include "raymarch/lines/graph_building.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

/// An edge's end at a vertex.
struct EdgeEnd {
  int edge = 0;
  bool at_end = false;
};

/// Unit image direction in which an edge leaves its vertex.
glm::dvec2 direction_out(const LineEdge& edge, bool at_end) {
  const auto& points = edge.points;
  const size_t n = points.size();
  constexpr double kFar_px = 1.0;
  const glm::dvec2 from = at_end ? points[n - 1].px : points[0].px;
  for (size_t k = 1; k < n; ++k) {
    const glm::dvec2 to = at_end ? points[n - 1 - k].px : points[k].px;
    const double length = glm::distance(from, to);
    if (length > kFar_px || (k + 1 == n && length > 0.0)) return (to - from) / length;
  }
  return glm::dvec2(0.0);
}

constexpr double kSameFace = 0.9;  // cosine between normals

/// The normal of the face that a contour bounds, where an edge leaves its vertex; of the next point, since the vertex may lie on two faces.
glm::dvec3 normal_out(const LineEdge& edge, bool at_end) {
  const size_t n = edge.points.size();
  return (at_end ? edge.points[n - 2] : edge.points[1]).normal;
}

/// Of each end (2 edge + 0 for begin, 1 for end) the one that the stroke goes on at, or -1.
std::vector<int> partners_of(const ViewGraph& graph) {
  std::vector<std::vector<EdgeEnd>> at(graph.vertices.size());
  for (size_t e = 0; e < graph.edges.size(); ++e) {
    const LineEdge& edge = graph.edges[e];
    if (edge.begin >= 0) at[static_cast<size_t>(edge.begin)].push_back({static_cast<int>(e), false});
    if (edge.end >= 0) at[static_cast<size_t>(edge.end)].push_back({static_cast<int>(e), true});
  }
  std::vector<int> partner(2 * graph.edges.size(), -1);
  struct Pair {
    bool turned;      ///< What is bounded on the left of the one would be on the right of the other.
    bool other_face;  ///< The contours bound different faces. Arms that leave side by side differ in that, whatever their directions.
    double cosine;    ///< -1: straight on.
    EdgeEnd a, b;
  };
  // Each end lies at one vertex.
  parallel_for(size_t{0}, at.size(), [&](size_t v) {
    const std::vector<EdgeEnd>& ends = at[v];
    std::vector<Pair> pairs;
    for (size_t i = 0; i < ends.size(); ++i) {
      for (size_t j = 0; j < i; ++j) {
        const LineEdge &a = graph.edges[static_cast<size_t>(ends[i].edge)], &b = graph.edges[static_cast<size_t>(ends[j].edge)];
        if (a.line_class != b.line_class || a.invisibility != b.invisibility) continue;
        const bool sided = a.line_class == LineClass::contour || a.line_class == LineClass::boundary;
        const bool other_face =
            a.line_class == LineClass::contour && glm::dot(normal_out(a, ends[i].at_end), normal_out(b, ends[j].at_end)) < kSameFace;
        pairs.push_back({sided && ends[i].at_end == ends[j].at_end, other_face,
                         glm::dot(direction_out(a, ends[i].at_end), direction_out(b, ends[j].at_end)), ends[i], ends[j]});
      }
    }
    std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
      return std::tie(a.turned, a.other_face, a.cosine) < std::tie(b.turned, b.other_face, b.cosine);
    });
    for (const Pair& pair : pairs) {
      const auto number = [](const EdgeEnd& end) { return 2 * static_cast<size_t>(end.edge) + (end.at_end ? 1 : 0); };
      const size_t a = number(pair.a), b = number(pair.b);
      if (partner[a] >= 0 || partner[b] >= 0) continue;
      partner[a] = static_cast<int>(b);
      partner[b] = static_cast<int>(a);
    }
  });
  return partner;
}

}  // namespace

void add_chains(ViewGraph& graph) {
  const std::vector<int> partner = partners_of(graph);
  graph.chains.reserve(graph.edges.size());
  std::vector<bool> taken(graph.edges.size(), false);
  const auto walk = [&](int start) {  // from an edge's end: in at it, out at the other
    const LineEdge& first = graph.edges[static_cast<size_t>(start / 2)];
    LineChain chain{first.line_class, first.object, first.invisibility, first.begin < 0, {}};
    int in = start;
    while (in >= 0 && !taken[static_cast<size_t>(in / 2)]) {
      taken[static_cast<size_t>(in / 2)] = true;
      chain.links.push_back({in / 2, in % 2 == 1});
      in = partner[static_cast<size_t>(in ^ 1)];
    }
    if (in == start) chain.closed = true;
    // A stroke of edges that all run backwards is turned round.
    if (std::all_of(chain.links.begin(), chain.links.end(), [](const ChainLink& link) { return link.reversed; })) {
      std::reverse(chain.links.begin(), chain.links.end());
      for (ChainLink& link : chain.links) link.reversed = false;
    }
    graph.chains.push_back(std::move(chain));
  };
  for (int end = 0; end < static_cast<int>(partner.size()); ++end) {
    if (!taken[static_cast<size_t>(end / 2)] && partner[static_cast<size_t>(end)] < 0) walk(end);
  }
  for (int edge = 0; edge < static_cast<int>(graph.edges.size()); ++edge) {
    if (!taken[static_cast<size_t>(edge)]) walk(2 * edge);
  }
}

std::vector<LinePoint> points_of(const ViewGraph& graph, const LineChain& chain) {
  // Edges that meet at a vertex end at the same place, mostly; where seams lie close together, up to a few hundredths of a pixel from it.
  constexpr double kSame_px = 1e-4;
  const auto same = [](const LinePoint& a, const LinePoint& b) { return glm::distance(a.px, b.px) < kSame_px; };
  std::vector<LinePoint> points;
  const auto append = [&](auto first, auto last) {
    if (!points.empty() && same(points.back(), *first)) ++first;
    points.insert(points.end(), first, last);
  };
  for (const ChainLink& link : chain.links) {
    const std::vector<LinePoint>& own = graph.edges[static_cast<size_t>(link.edge)].points;
    if (link.reversed)
      append(own.rbegin(), own.rend());
    else
      append(own.begin(), own.end());
  }
  const bool repeats = chain.closed && !chain.links.empty() && graph.edges[static_cast<size_t>(chain.links[0].edge)].begin >= 0;
  if (repeats && points.size() > 1 && same(points.front(), points.back())) points.pop_back();
  return points;
}

}  // namespace limn
