#pragma once
// Lines of a camera that moves: each chain keeps its id from frame to frame, and where a visible one appears, vanishes, breaks or joins,
// the event of the view graph that did it is named.

#include <functional>

#include "raymarch/lines.h"

namespace limn {

/// What became of a visible chain between two frames.
enum class ChainChange : std::uint8_t {
  birth,     ///< It appears, from nothing.
  death,     ///< It shrinks to nothing.
  split,     ///< It breaks off another chain, which goes on.
  merge,     ///< It joins another chain, which goes on.
  exchange,  ///< Two chains go on with a part of each other.
};
/// "birth".
const char* name_of(ChainChange change);

/// The event of the view graph behind a change. Names of the first six as in Koenderink & van Doorn 1976 and Rieger 1987.
enum class ChainCause : std::uint8_t {
  lips,           ///< A closed contour appears or vanishes, with two cusps or none.
  beak_to_beak,   ///< Two contours touch and reconnect; two cusps appear or vanish.
  swallowtail,    ///< Two cusps and the crossing of their arms appear or vanish.
  cusp_crossing,  ///< A cusp passes another contour.
  tangency,       ///< A nearer line touches the line in the image: two crossings appear or vanish.
  triple_point,   ///< Three lines cross in one image point.
  joint,          ///< A crossing, cusp or joint passes a joint of curves, or a curve's end.
  frame,          ///< The line enters or leaves the picture.
  cut_off,        ///< A suggestive contour, ridge or valley gets strong enough to be drawn, or too weak: it ends where that is decided.
  edge_on,        ///< A face of straight edges turns to or from the eye: its sharp edges change class or are hidden all at once.
  unexplained,    ///< Nothing that changed in the graph there explains it.
};
/// "beak to beak".
const char* name_of(ChainCause cause);

/// A change of a visible chain.
struct ChainEvent {
  ChainChange change = ChainChange::birth;     ///< See ChainChange.
  ChainCause cause = ChainCause::unexplained;  ///< See ChainCause.
  LineClass line_class = LineClass::contour;   ///< Of the chain.
  int id = 0;                                  ///< Of the chain that appears or goes.
  int other = -1;                              ///< Of the chain it came from, went into, or shares parts with; -1: none.
  double from = 0.0,                           ///< Time before which it does not happen; frames are 1 apart.
      to = 1.0;                                ///< Time by which it has happened.
  glm::dvec2 px{0.0};                          ///< Image point.
  /// What appears or vanishes is no longer than this at the nearer of the two times: the chain, or the gap between the parts; px.
  double length_px = 0.0;
  bool beside_conflict = false;  ///< The certificate of one of the two graphs has a conflict there.
};

/// How closely changes are followed.
struct TrackSettings {
  double short_px = 2.0;  ///< A change is settled where the chain or the gap is shorter than this, px, above 0.
  /// Or where it lies as near as this to another visible line, px, above 0: so near the solver does not tell lines apart.
  double thin_px = 0.1;
  int most_halvings = 12;  ///< The time between two frames is halved as often where that is not so; 0..30.
};

/// Ids given so far, and what happened.
struct LineTracks {
  int ids = 0;                       ///< Next free id.
  std::vector<ChainEvent> events{};  ///< In order of time.
  std::int64_t solved = 0;           ///< View graphs solved between frames.
};

/// The view graph at a time between two frames.
using GraphAt = std::function<ViewGraph(double time)>;

/// Ids of the first frame's chains, one a chain.
std::vector<int> first_ids(const ViewGraph& graph, LineTracks& tracks);

/// Ids of the chains of `after`: those of the chains of `before` whose generators they continue, and new ones. Chains are matched by where
/// their curves run on the surface, by class, object and visibility; one to one, the longest common stretch first. The same backwards in
/// time, where no graph in between has conflicts.
std::vector<int> follow_chains(const ViewGraph& before, const std::vector<int>& ids_before, double time_before, const ViewGraph& after,
                               double time_after, const GraphAt& graph_at, const TrackSettings& settings, LineTracks& tracks);

/// How many events nothing explains.
int unexplained(const LineTracks& tracks);

}  // namespace limn
