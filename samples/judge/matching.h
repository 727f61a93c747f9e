#pragma once
// Internal: which samples of the lines the drawing has, and which of the drawing's samples are lines.

#include <limits>
#include <vector>

#include "samples/judge/judge_lines.h"
#include "samples/judge/tracks.h"

namespace limn {

/// The nearest place of the other side.
struct TrackMatch {
  bool found = false;
  double along_px = 0.0;   ///< From the sample to it, along the sample's tangent.
  double across_px = 0.0;  ///< Across it, positive to (-y, x) of the tangent: outwards, for contours.
  double distance_px = std::numeric_limits<double>::infinity();
  int sample = -1;  ///< Of the other side.
};

/// What a sample of the drawing is.
enum class InkVerdict : std::uint8_t { line, false_stroke, hidden, doubled };

struct InkMatch {
  InkVerdict verdict = InkVerdict::line;
  int sample = -1;  ///< Of the visible or hidden lines; -1 for a false stroke.
};

/// The three sides.
struct JudgedTracks {
  Tracks visible{}, hidden{};  ///< Track::source: edge of the graph.
  Tracks drawn{};              ///< Track::source: line of the drawing.
};

/// For each sample of the visible lines. `owned`: places of the drawing that belong to another line do not count.
std::vector<TrackMatch> match_lines(const JudgedTracks& tracks, const DrawnLines& drawing, const JudgeSettings& settings, bool owned);

/// For each sample of the drawing.
std::vector<InkMatch> match_ink(const JudgedTracks& tracks, const DrawnLines& drawing, const JudgeSettings& settings);

/// For each sample of the lines, whether another line, or another part of its own, lies nearer than this.
std::vector<bool> crowded_samples(const Tracks& lines, double apart_px);

/// Where lines are crowded, ink runs together, and the lines read from it are neither missed nor wrong: crowded lines with any ink near
/// them count as found, strokes near crowded lines as lines.
void excuse_crowded(const JudgedTracks& tracks, const DrawnLines& drawing, const std::vector<bool>& crowded, std::vector<TrackMatch>& lines,
                    std::vector<InkMatch>& ink);

/// From the matched samples of the visible lines that are not crowded. `precision_px`: what is smaller is not significant.
DrawingShift fit_shift(const Tracks& visible, const std::vector<TrackMatch>& matches, const std::vector<bool>& crowded,
                       double precision_px);

}  // namespace limn
