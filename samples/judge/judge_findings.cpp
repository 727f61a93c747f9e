#include "samples/judge/judge_findings.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

namespace limn {
namespace {

/// Half-open range of places in a list.
struct Run {
  size_t from = 0, to = 0;
};

/// Stretches of `count` places at which `is` holds.
template <class Is>
std::vector<Run> runs_of(size_t count, const Is& is) {
  std::vector<Run> runs;
  for (size_t i = 0; i < count; ++i) {
    if (!is(i)) continue;
    if (!runs.empty() && runs.back().to == i)
      ++runs.back().to;
    else
      runs.push_back({i, i + 1});
  }
  return runs;
}

double length_of(const Tracks& tracks, const std::vector<int>& samples, const Run& run) {
  double length = 0.0;
  for (size_t i = run.from; i < run.to; ++i) length += tracks.samples[static_cast<size_t>(samples[i])].length_px;
  return length;
}

std::vector<glm::dvec2> points_of_run(const Tracks& tracks, const std::vector<int>& samples, const Run& run, const glm::dvec2& move) {
  std::vector<glm::dvec2> points;
  for (size_t i = run.from; i < run.to; ++i) {
    const TrackSample& sample = tracks.samples[static_cast<size_t>(samples[i])];
    // Half a step to either side, so that a run of one sample has a length.
    const glm::dvec2 half = 0.5 * sample.length_px * sample.tangent;
    if (run.to - run.from == 1) points.push_back(sample.at - half + move);
    points.push_back(sample.at + (run.to - run.from == 1 ? half : glm::dvec2(0.0)) + move);
  }
  return points;
}

JudgeFinding finding_of(FindingKind kind, const Tracks& tracks, const std::vector<int>& samples, const Run& run, const glm::dvec2& move) {
  JudgeFinding finding;
  finding.kind = kind;
  finding.length_px = length_of(tracks, samples, run);
  finding.points = points_of_run(tracks, samples, run, move);
  finding.px = tracks.samples[static_cast<size_t>(samples[(run.from + run.to) / 2])].at + move;
  return finding;
}

/// A closed chain starts at a sample that is there, so that no run goes over its seam.
void start_at_match(const std::vector<TrackMatch>& matches, ChainSamples& chain) {
  if (!chain.closed) return;
  const auto there = std::find_if(chain.samples.begin(), chain.samples.end(), [&](int i) { return matches[static_cast<size_t>(i)].found; });
  if (there != chain.samples.end()) std::rotate(chain.samples.begin(), there, chain.samples.end());
}

void find_missed(const ChainSamples& chain, const JudgedTracks& tracks, const JudgedMatches& matches, const JudgeSettings& settings,
                 const std::vector<JudgeRow*>& rows, std::vector<JudgeFinding>& findings) {
  const auto there = [&](size_t i) { return matches.lines[static_cast<size_t>(chain.samples[i])].found; };
  const size_t count = chain.samples.size();
  std::vector<Run> missed = runs_of(count, [&](size_t i) { return !there(i); });
  std::erase_if(missed, [&](const Run& run) { return length_of(tracks.visible, chain.samples, run) < settings.least_px; });
  const bool any =
      std::any_of(chain.samples.begin(), chain.samples.end(), [&](int i) { return matches.lines[static_cast<size_t>(i)].found; });
  int gaps = 0;
  for (const Run& run : missed) {
    JudgeFinding finding = finding_of(FindingKind::missed, tracks.visible, chain.samples, run, glm::dvec2(0.0));
    finding.line_class = chain.line_class;
    finding.gap = run.from > 0 && (run.to < count || chain.closed);
    gaps += finding.gap ? 1 : 0;
    findings.push_back(std::move(finding));
  }
  for (JudgeRow* row : rows) {
    ++row->chains;
    row->gaps += gaps;
    row->pieces += !any ? 0 : chain.closed ? std::max(1, gaps) : gaps + 1;
  }
}

void find_displaced(const ChainSamples& chain, const JudgedTracks& tracks, const JudgedMatches& matches, const JudgeSettings& settings,
                    std::vector<JudgeFinding>& findings) {
  const auto off = [&](size_t i) {
    const TrackMatch& match = matches.lines[static_cast<size_t>(chain.samples[i])];
    return match.found && !matches.crowded[static_cast<size_t>(chain.samples[i])] ? match.distance_px : 0.0;
  };
  for (const Run& run : runs_of(chain.samples.size(), [&](size_t i) { return off(i) > settings.displaced_px; })) {
    JudgeFinding finding = finding_of(FindingKind::displaced, tracks.visible, chain.samples, run, glm::dvec2(0.0));
    if (finding.length_px < settings.least_px) continue;
    finding.line_class = chain.line_class;
    for (size_t i = run.from; i < run.to; ++i) {
      if (off(i) <= finding.distance_px) continue;
      finding.distance_px = off(i);
      finding.px = tracks.visible.samples[static_cast<size_t>(chain.samples[i])].at;
    }
    findings.push_back(std::move(finding));
  }
}

}  // namespace

std::vector<ChainSamples> visible_chains(const ViewGraph& graph, const Tracks& visible) {
  std::vector<int> track_of_edge(graph.edges.size(), -1);
  for (size_t i = 0; i < visible.tracks.size(); ++i) track_of_edge[static_cast<size_t>(visible.tracks[i].source)] = static_cast<int>(i);
  std::vector<ChainSamples> chains;
  for (const LineChain& chain : graph.chains) {
    if (chain.invisibility != 0) continue;
    ChainSamples all{chain.line_class, chain.closed, {}};
    for (const ChainLink& link : chain.links) {
      const int index = track_of_edge[static_cast<size_t>(link.edge)];
      if (index < 0) continue;
      const Track& track = visible.tracks[static_cast<size_t>(index)];
      for (int i = 0; i < track.count; ++i) all.samples.push_back(track.first + (link.reversed ? track.count - 1 - i : i));
    }
    if (!all.samples.empty()) chains.push_back(std::move(all));
  }
  return chains;
}

void find_in_lines(const std::vector<ChainSamples>& chains, const JudgedTracks& tracks, const JudgedMatches& matches,
                   const JudgeSettings& settings, std::vector<JudgeRow>& rows, std::vector<JudgeFinding>& findings) {
  for (ChainSamples chain : chains) {
    start_at_match(matches.lines, chain);
    std::vector<JudgeRow*> counted;
    for (JudgeRow& row : rows)
      if (!row.line_class || *row.line_class == chain.line_class) counted.push_back(&row);
    find_missed(chain, tracks, matches, settings, counted, findings);
    find_displaced(chain, tracks, matches, settings, findings);
  }
}

void find_in_ink(const ViewGraph& graph, const JudgedTracks& tracks, const JudgedMatches& matches, const JudgeSettings& settings,
                 std::vector<JudgeFinding>& findings) {
  constexpr std::pair<InkVerdict, FindingKind> kKinds[] = {{InkVerdict::false_stroke, FindingKind::false_stroke},
                                                           {InkVerdict::hidden, FindingKind::hidden},
                                                           {InkVerdict::doubled, FindingKind::doubled}};
  for (const Track& track : tracks.drawn.tracks) {
    std::vector<int> samples(static_cast<size_t>(track.count));
    std::iota(samples.begin(), samples.end(), track.first);
    for (const auto& [verdict, kind] : kKinds) {
      const InkVerdict wanted = verdict;
      const auto is = [&](size_t i) { return matches.ink[static_cast<size_t>(samples[i])].verdict == wanted; };
      for (const Run& run : runs_of(samples.size(), is)) {
        // The drawing was moved onto the lines; its places are said as they are.
        JudgeFinding finding = finding_of(kind, tracks.drawn, samples, run, matches.shift);
        if (finding.length_px < settings.least_px) continue;
        std::map<LineClass, int> classes;
        for (size_t i = run.from; i < run.to && wanted != InkVerdict::false_stroke; ++i)
          ++classes[class_of(graph, wanted == InkVerdict::hidden ? tracks.hidden : tracks.visible,
                             matches.ink[static_cast<size_t>(samples[i])].sample)];
        const auto most =
            std::max_element(classes.begin(), classes.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
        if (most != classes.end()) finding.line_class = most->first;
        findings.push_back(std::move(finding));
      }
    }
  }
}

void sort_findings(std::vector<JudgeFinding>& findings) {
  std::stable_sort(findings.begin(), findings.end(), [](const JudgeFinding& a, const JudgeFinding& b) {
    return std::tuple(a.kind, -a.distance_px, -a.length_px) < std::tuple(b.kind, -b.distance_px, -b.length_px);
  });
}

}  // namespace limn
