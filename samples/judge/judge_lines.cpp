#include "samples/judge/judge_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "samples/judge/judge_findings.h"
#include "samples/judge/matching.h"
#include "samples/judge/tracks.h"
#include "sdf/error.h"
#include "sdf/quantile.h"

namespace limn {
namespace {

constexpr double kMostDrawn_px = 1e6;

void add_lines_of(const ViewGraph& graph, JudgedTracks& tracks) {
  for (size_t i = 0; i < graph.edges.size(); ++i) {
    const LineEdge& edge = graph.edges[i];
    std::vector<glm::dvec2> points;
    for (const LinePoint& point : edge.points) points.push_back(point.px);
    // A closed edge without a vertex does not repeat its first point.
    if (edge.begin < 0 && edge.end < 0 && !points.empty()) points.push_back(points.front());
    add_track(edge.invisibility == 0 ? tracks.visible : tracks.hidden, points, static_cast<int>(i));
  }
  finish_tracks(tracks.visible);
  finish_tracks(tracks.hidden);
}

/// Chains so short that a file's digits may not have them are not missed: ten times the last digit that drawings are written with.
void excuse_shortest(const std::vector<ChainSamples>& chains, const JudgedTracks& tracks, JudgedMatches& matches) {
  constexpr double kShortest_px = 0.001;
  for (const ChainSamples& chain : chains) {
    double length = 0.0;
    for (const int i : chain.samples) length += tracks.visible.samples[static_cast<size_t>(i)].length_px;
    if (length >= kShortest_px) continue;
    for (const int i : chain.samples) {
      matches.lines[static_cast<size_t>(i)].found = true;
      matches.crowded[static_cast<size_t>(i)] = true;
    }
  }
}

/// The drawing within the frame, moved by -shift.
Tracks drawn_tracks(const DrawnLines& drawing, const glm::dvec2& shift) {
  Tracks tracks;
  double length = 0.0;
  for (size_t i = 0; i < drawing.lines.size(); ++i) {
    std::vector<glm::dvec2> points = drawing.lines[i].points;
    if (drawing.lines[i].closed && !points.empty()) points.push_back(points.front());
    for (std::vector<glm::dvec2>& piece : clipped_to_frame(points, {drawing.width_px, drawing.height_px})) {
      for (glm::dvec2& p : piece) p -= shift;
      add_track(tracks, piece, static_cast<int>(i));
      length += tracks.tracks.empty() ? 0.0 : tracks.tracks.back().length();
    }
    if (length > kMostDrawn_px)
      throw InputError(
          {"", "DRAWING", "", "it has more than a million pixels of line in the picture", "a drawing of the lines of one view"});
  }
  finish_tracks(tracks);
  return tracks;
}

InkWidth width_of(const DrawnLines& drawing, const Tracks& drawn) {
  InkWidth width{0.0, std::numeric_limits<double>::infinity(), 0.0};
  double length = 0.0;
  for (const Track& track : drawn.tracks) {
    const double one = drawing.lines[static_cast<size_t>(track.source)].width_px;
    if (one <= 0.0) continue;
    width.mean_px += one * track.length();
    width.least_px = std::min(width.least_px, one);
    width.most_px = std::max(width.most_px, one);
    length += track.length();
  }
  if (length <= 0.0) return {};
  width.mean_px /= length;
  return width;
}

/// Displacements of a row's samples.
struct RowDistances {
  std::vector<WeightedValue> sizes{};
  double squares = 0.0, weight = 0.0, signed_sum = 0.0, signed_weight = 0.0;
};

void add_displacement(const TrackSample& sample, double across, double size, bool has_outside, RowDistances& sums, Displacement& row) {
  sums.sizes.push_back({size, sample.length_px});
  sums.squares += sample.length_px * size * size;
  sums.weight += sample.length_px;
  if (has_outside) sums.signed_sum += sample.length_px * across, sums.signed_weight += sample.length_px;
  if (row.worst >= size) return;
  row.worst = size;
  row.worst_at = sample.at;
}

void finish_displacement(RowDistances& sums, Displacement& row) {
  if (sums.weight <= 0.0) return;
  std::sort(sums.sizes.begin(), sums.sizes.end(), [](const WeightedValue& a, const WeightedValue& b) { return a.value < b.value; });
  row.p95 = nearest_rank_quantile(std::span<const WeightedValue>(sums.sizes), 0.95);
  row.rms = std::sqrt(sums.squares / sums.weight);
  if (sums.signed_weight > 0.0) row.mean = sums.signed_sum / sums.signed_weight;
}

void sum_up_row(const ViewGraph& graph, const JudgedTracks& tracks, const JudgedMatches& matches, JudgeRow& row) {
  const auto counts = [&](LineClass one) { return !row.line_class || *row.line_class == one; };
  RowDistances sums;
  for (size_t i = 0; i < tracks.visible.samples.size(); ++i) {
    const LineClass line_class = class_of(graph, tracks.visible, static_cast<int>(i));
    if (!counts(line_class)) continue;
    const TrackSample& sample = tracks.visible.samples[i];
    const TrackMatch& match = matches.lines[i];
    row.line_px += sample.length_px;
    if (matches.crowded[i]) row.crowded_px += sample.length_px;
    if (!match.found) {
      row.missed_px += sample.length_px;
      continue;
    }
    if (matches.crowded[i]) continue;
    const double across = match.across_px + glm::dot(matches.shift, glm::dvec2(-sample.tangent.y, sample.tangent.x));
    const bool has_outside = line_class == LineClass::contour || line_class == LineClass::boundary;
    add_displacement(sample, across, std::hypot(across, match.along_px), has_outside, sums, row.displacement);
  }
  finish_displacement(sums, row.displacement);
  for (size_t i = 0; i < matches.ink.size(); ++i) {
    const InkMatch& ink = matches.ink[i];
    const double length = tracks.drawn.samples[i].length_px;
    if (ink.verdict == InkVerdict::false_stroke && !row.line_class) row.false_px += length;
    if (ink.verdict == InkVerdict::hidden && counts(class_of(graph, tracks.hidden, ink.sample))) row.hidden_px += length;
    if (ink.verdict == InkVerdict::doubled && counts(class_of(graph, tracks.visible, ink.sample))) row.doubled_px += length;
  }
}

}  // namespace

const char* title_of(FindingKind kind) {
  constexpr const char* kTitles[] = {"missed", "false stroke", "hidden line shown", "doubled", "displaced"};
  return kTitles[static_cast<size_t>(kind)];
}

const char* key_of(FindingKind kind) {
  constexpr const char* kKeys[] = {"missed", "false", "hidden", "doubled", "displaced"};
  return kKeys[static_cast<size_t>(kind)];
}

Judgement judge_lines(const ViewGraph& graph, const DrawnLines& drawing, const JudgeSettings& given) {
  JudgeSettings settings = given;
  // What is shorter than the drawing's ends are certain is none of its faults.
  settings.least_px = std::max(settings.least_px, 0.8 * drawing.ends_px);
  JudgedTracks tracks;
  add_lines_of(graph, tracks);
  tracks.drawn = drawn_tracks(drawing, glm::dvec2(0.0));
  Judgement judgement;
  judgement.strokes = static_cast<int>(tracks.drawn.tracks.size());
  for (const TrackSample& sample : tracks.drawn.samples) judgement.drawn_px += sample.length_px;
  judgement.width = width_of(drawing, tracks.drawn);
  // A twentieth of what the drawing resolves is noise; strokes of a file are known to far less than 0.02 px.
  constexpr double kStrokes_px = 0.02;
  JudgedMatches matches;
  matches.crowded = crowded_samples(tracks.visible, drawing.apart_px);
  judgement.shift = fit_shift(tracks.visible, match_lines(tracks, drawing, settings, false), matches.crowded,
                              std::max(kStrokes_px, 0.05 * drawing.resolution_px));
  if (judgement.shift.significant) {
    matches.shift = judgement.shift.px;
    tracks.drawn = drawn_tracks(drawing, matches.shift);
  }
  matches.lines = match_lines(tracks, drawing, settings, true);
  matches.ink = match_ink(tracks, drawing, settings);
  excuse_crowded(tracks, drawing, matches.crowded, matches.lines, matches.ink);
  const std::vector<ChainSamples> chains = visible_chains(graph, tracks.visible);
  excuse_shortest(chains, tracks, matches);

  std::vector<JudgeRow> rows(1);
  for (const LineClassDescriptor& one : line_classes()) {
    const auto is = [&](const LineEdge& edge) { return edge.line_class == one.line_class; };
    if (std::any_of(graph.edges.begin(), graph.edges.end(), is)) rows.push_back({.line_class = one.line_class});
  }
  for (JudgeRow& row : rows) sum_up_row(graph, tracks, matches, row);
  find_in_lines(chains, tracks, matches, settings, rows, judgement.findings);
  find_in_ink(graph, tracks, matches, settings, judgement.findings);
  sort_findings(judgement.findings);
  judgement.all = rows.front();
  judgement.classes.assign(rows.begin() + 1, rows.end());
  return judgement;
}

}  // namespace limn
