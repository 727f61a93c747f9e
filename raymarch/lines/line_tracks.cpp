#include "raymarch/line_tracks.h"

#include <algorithm>
#include <array>

#include "raymarch/lines/chain_changes.h"
#include "raymarch/lines/surface_curves.h"

namespace limn {
namespace {

constexpr double kBeside_px = 4.0;
constexpr int kCutOffHalvings = 2;  // where a line may appear whole, however near two times are

/// A graph at a time, with the ids of its chains.
struct Moment {
  double time = 0.0;
  const PlacedChains& chains;
};

class Follower {
 public:
  Follower(const GraphAt& graph_at, const TrackSettings& settings, LineTracks& tracks)
      : graph_at_(graph_at), settings_(settings), tracks_(tracks) {}

  std::vector<int> follow(const Moment& before, const std::vector<int>& ids, const Moment& after, int halvings) {
    const ChainOverlaps overlaps = overlaps_of(before.chains, after.chains);
    const ChainMatch match = match_chains(before.chains, after.chains, overlaps);
    const std::vector<FoundChange> changes = changes_between(before.chains, after.chains, overlaps, match, settings_);
    const bool settled = std::all_of(changes.begin(), changes.end(), [&](const FoundChange& change) {
      return change.settled || (halvings >= kCutOffHalvings && ends_by_cut_off(change, before, after));
    });
    if (!settled && halvings < settings_.most_halvings) {
      double time = 0.5 * (before.time + after.time);
      ViewGraph graph = solve(time);
      // A moment whose certificate has conflicts is left for one near by that has none.
      for (const double share : {0.4375, 0.5625}) {
        if (graph.conflicts.empty()) break;
        const double other_time = glm::mix(before.time, after.time, share);
        ViewGraph other = solve(other_time);
        if (other.conflicts.size() >= graph.conflicts.size()) continue;
        time = other_time;
        graph = std::move(other);
      }
      const PlacedChains chains = place_chains(graph);
      const Moment between{time, chains};
      return follow(between, follow(before, ids, between, halvings + 1), after, halvings + 1);
    }
    std::vector<int> ids_after;
    for (const int chain : match.before_of) ids_after.push_back(chain >= 0 ? ids[static_cast<size_t>(chain)] : tracks_.ids++);
    for (const FoundChange& change : changes) add_event(change, before, ids, after, ids_after);
    return ids_after;
  }

 private:
  ViewGraph solve(double time) {
    ++tracks_.solved;
    return graph_at_(time);
  }

  static const PlacedChains& chains_of(const FoundChange& change, const Moment& before, const Moment& after) {
    return change.change == ChainChange::birth || change.change == ChainChange::split ? after.chains : before.chains;
  }
  static int chain_of(const FoundChange& change) {
    return change.change == ChainChange::birth || change.change == ChainChange::split ? change.after : change.before;
  }
  /// Of a line of curvature, an end of which no vertex explains.
  static bool ends_by_cut_off(const FoundChange& change, const Moment& before, const Moment& after) {
    const auto chain = static_cast<size_t>(chain_of(change));
    const PlacedChains& chains = chains_of(change, before, after);
    if (!is_of_curvature(chains.graph->chains[chain].line_class)) return false;
    const std::vector<ChainEnd>& ends = chains.chains[chain].ends;
    return ends.empty() || std::any_of(ends.begin(), ends.end(), [](const ChainEnd& end) { return end.kind == VertexKind::end; });
  }

  void add_event(const FoundChange& change, const Moment& before, const std::vector<int>& ids, const Moment& after,
                 const std::vector<int>& ids_after) {
    const int chain = chain_of(change);
    const PlacedChains& placed = chains_of(change, before, after);
    const bool appears = &placed == &after.chains;
    const std::vector<int>&own = appears ? ids_after : ids, &others = appears ? ids : ids_after;
    const ViewGraph& graph = *placed.graph;
    ChainEvent event;
    event.change = change.change;
    event.cause = change.settled ? change.cause : ends_by_cut_off(change, before, after) ? ChainCause::cut_off : ChainCause::unexplained;
    event.line_class = graph.chains[static_cast<size_t>(chain)].line_class;
    event.id = own[static_cast<size_t>(chain)];
    event.other = change.other >= 0 ? others[static_cast<size_t>(change.other)] : -1;
    event.from = before.time;
    event.to = after.time;
    event.px = change.px;
    event.length_px = change.length_px;
    for (const PlacedChains* chains : {&before.chains, &after.chains}) {
      for (const LineConflict& conflict : chains->graph->conflicts)
        event.beside_conflict = event.beside_conflict || glm::distance(conflict.px, change.px) <= change.length_px + kBeside_px;
    }
    tracks_.events.push_back(event);
  }

  const GraphAt& graph_at_;
  const TrackSettings& settings_;
  LineTracks& tracks_;
};

}  // namespace

const char* name_of(ChainChange change) {
  constexpr std::array<const char*, 5> kNames = {"birth", "death", "split", "merge", "exchange"};
  return kNames[static_cast<size_t>(change)];
}

const char* name_of(ChainCause cause) {
  constexpr std::array<const char*, 11> kNames = {"lips",  "beak to beak", "swallowtail", "cusp crossing", "tangency",   "triple point",
                                                  "joint", "frame",        "cut-off",     "edge on",       "unexplained"};
  return kNames[static_cast<size_t>(cause)];
}

std::vector<int> first_ids(const ViewGraph& graph, LineTracks& tracks) {
  std::vector<int> ids;
  for (size_t i = 0; i < graph.chains.size(); ++i) ids.push_back(tracks.ids++);
  return ids;
}

std::vector<int> follow_chains(const ViewGraph& before, const std::vector<int>& ids_before, double time_before, const ViewGraph& after,
                               double time_after, const GraphAt& graph_at, const TrackSettings& settings, LineTracks& tracks) {
  const PlacedChains chains_before = place_chains(before), chains_after = place_chains(after);
  return Follower(graph_at, settings, tracks).follow({time_before, chains_before}, ids_before, {time_after, chains_after}, 0);
}

int unexplained(const LineTracks& tracks) {
  return static_cast<int>(std::count_if(tracks.events.begin(), tracks.events.end(),
                                        [](const ChainEvent& event) { return event.cause == ChainCause::unexplained; }));
}

}  // namespace limn
