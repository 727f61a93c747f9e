#pragma once
// Internal: chains of two view graphs compared by where their curves run on the surface.

#include <array>
#include <map>

#include "raymarch/lines.h"

namespace limn {

/// A place on a chain, and how much of its length it stands for.
struct ChainPlace {
  glm::dvec3 p{0.0}, normal{0.0};
  glm::dvec2 px{0.0};
  double length_px = 0.0;
  int edge = 0, chain = 0;
  bool sharp = false;  ///< On a crease or an open edge, whose normal says nothing.
};

/// Where an open chain ends.
struct ChainEnd {
  int vertex = -1;  ///< Into ViewGraph::vertices.
  VertexKind kind = VertexKind::end;
  glm::dvec2 px{0.0};
  int edge = 0;
};

struct ChainShape {
  bool visible = false;
  double length_px = 0.0;
  std::vector<ChainEnd> ends{};  ///< Two, or none of a closed chain.
  std::vector<int> places{};     ///< Into PlacedChains::places, in order.
};

/// Search trees over the places of one class and object.
struct PlaceTree {
  std::vector<int> order{};  ///< Indices of places; the middle of each range splits it.
};

/// A graph's chains as places. Keeps a reference to the graph.
struct PlacedChains {
  const ViewGraph* graph = nullptr;
  std::vector<ChainPlace> places{};
  std::vector<ChainShape> chains{};
  std::map<std::pair<LineClass, int>, PlaceTree> trees{};
  double radius = 0.0;  ///< Of all places, world units.
};
PlacedChains place_chains(const ViewGraph& graph);

/// The place of the same class and object nearest to this one; -1 where there is none. Distances in space, and between normals times
/// `normal_scale` (world units).
int nearest_place(const PlacedChains& chains, const ChainPlace& place, std::pair<LineClass, int> kind, double normal_scale);

/// Of each pair of chains the length that they have in common: the lesser of what of one is nearest to the other, both ways.
struct ChainOverlaps {
  std::map<std::pair<int, int>, double> common_px{};   ///< By chain before and chain after.
  std::vector<int> nearest_after{}, nearest_before{};  ///< Of each place the nearest in the other graph, or -1.
};
ChainOverlaps overlaps_of(const PlacedChains& before, const PlacedChains& after);

/// One to one between chains of the same class and visibility, the longest common stretch first. Of each chain its partner, or -1.
struct ChainMatch {
  std::vector<int> after_of{}, before_of{};
};
ChainMatch match_chains(const PlacedChains& before, const PlacedChains& after, const ChainOverlaps& overlaps);

}  // namespace limn
