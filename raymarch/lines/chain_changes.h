#pragma once
// Internal: what became of visible chains between two view graphs, and the events of the graph that did it.

#include "raymarch/line_tracks.h"
#include "raymarch/lines/chain_places.h"

namespace limn {

/// A change, and whether it is small enough to be one event.
struct FoundChange {
  ChainChange change = ChainChange::birth;
  ChainCause cause = ChainCause::unexplained;
  int before = -1, after = -1;  ///< Chains: the one that appears or goes; of an exchange one of each graph.
  int other = -1;               ///< The chain before that it came from, or the one after that it went into.
  glm::dvec2 px{0.0};
  double length_px = 0.0;
  bool settled = false;
};

/// Births, deaths, splits and merges of the visible chains without partner, and exchanges between those that have one; partners that have
/// less than half of the shorter one in common are an exchange that nothing explains.
std::vector<FoundChange> changes_between(const PlacedChains& before, const PlacedChains& after, const ChainOverlaps& overlaps,
                                         const ChainMatch& match, const TrackSettings& settings);

}  // namespace limn
