#pragma once
// Internal: runs of equal samples as findings, and the sums of a row.

#include "samples/judge/judge_lines.h"
#include "samples/judge/matching.h"

namespace limn {

/// What was matched, and the shift that was taken out before.
struct JudgedMatches {
  std::vector<TrackMatch> lines{};  ///< Of JudgedTracks::visible.
  std::vector<InkMatch> ink{};      ///< Of JudgedTracks::drawn.
  std::vector<bool> crowded{};      ///< Of JudgedTracks::visible: nearer to another line than DrawnLines::apart_px.
  glm::dvec2 shift{0.0};
};

/// The samples of a visible chain in order.
struct ChainSamples {
  LineClass line_class = LineClass::contour;
  bool closed = false;
  std::vector<int> samples{};
};
std::vector<ChainSamples> visible_chains(const ViewGraph& graph, const Tracks& visible);

/// Of the lines: missed and displaced ones. Adds gaps and pieces to the rows, the first of which is that over all.
void find_in_lines(const std::vector<ChainSamples>& chains, const JudgedTracks& tracks, const JudgedMatches& matches,
                   const JudgeSettings& settings, std::vector<JudgeRow>& rows, std::vector<JudgeFinding>& findings);
/// Of the drawing: false, hidden and doubled ones.
void find_in_ink(const ViewGraph& graph, const JudgedTracks& tracks, const JudgedMatches& matches, const JudgeSettings& settings,
                 std::vector<JudgeFinding>& findings);
/// By kind, the longest first; displaced ones by distance.
void sort_findings(std::vector<JudgeFinding>& findings);

/// The class of a track's edge.
inline LineClass class_of(const ViewGraph& graph, const Tracks& lines, int sample) {
  const int track = lines.samples[static_cast<size_t>(sample)].track;
  return graph.edges[static_cast<size_t>(lines.tracks[static_cast<size_t>(track)].source)].line_class;
}

}  // namespace limn
