#include "samples/judge/matching.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace limn {
namespace {

/// Nearer than this, directions do not count: at corners and ends they say nothing.
constexpr double kTouching_px = 0.3;
/// Of two places equally near, the one with the same direction: pixels that a right angle weighs.
constexpr double kDirectionWeight_px = 0.5;
/// A place of one side belongs to the nearest line of the other, and to those that are at most so many times farther away.
constexpr double kOwnership = 2.0;

struct Search {
  double radius_px = 2.0;
  double least_cosine = 0.8;
  double ends_px = 0.3;
};

Search search_of(const DrawnLines& drawing, const JudgeSettings& settings) {
  return {settings.search_px, std::cos(settings.angle_deg * std::numbers::pi / 180.0), drawing.ends_px};
}

int sample_at(const Tracks& tracks, std::uint32_t segment, double t) {
  const TrackSegment& one = tracks.segments[segment];
  const Track& track = tracks.tracks[static_cast<size_t>(one.track)];
  const auto i = static_cast<size_t>(one.index);
  const double s = track.along[i] + t * (track.along[i + 1] - track.along[i]);
  return track.first + std::clamp(static_cast<int>(s / track.step()), 0, track.count - 1);
}

/// The place of `to` that matches the sample best, of those that `accept(sample of to, distance)` lets pass.
template <class Accept>
TrackMatch best_match(const TrackSample& from, const Tracks& to, const Search& search, std::vector<std::uint32_t>& near,
                      const Accept& accept) {
  TrackMatch best;
  double least = std::numeric_limits<double>::infinity();
  segments_near(to, from.at, search.radius_px, near);
  for (const std::uint32_t segment : near) {
    const SegmentEnds& ends = to.ends[segment];
    const glm::dvec2 d = ends.b - ends.a;
    const double t = std::clamp(glm::dot(from.at - ends.a, d) / glm::dot(d, d), 0.0, 1.0);
    const glm::dvec2 offset = ends.a + t * d - from.at;
    const double distance = glm::length(offset);
    if (distance > search.radius_px) continue;
    const double cosine = std::min(1.0, std::fabs(glm::dot(d, from.tangent)) / glm::length(d));
    if (cosine < search.least_cosine && distance > kTouching_px) continue;
    const double cost = std::hypot(distance, kDirectionWeight_px * std::sqrt(1.0 - cosine * cosine));
    if (cost >= least) continue;
    TrackMatch match{true, glm::dot(offset, from.tangent), glm::dot(offset, glm::dvec2(-from.tangent.y, from.tangent.x)), distance, -1};
    // Beyond the end of the other line there is nothing, however near its end.
    if (std::fabs(match.along_px) > std::max(search.ends_px, std::fabs(match.across_px))) continue;
    match.sample = sample_at(to, segment, t);
    if (!accept(match.sample, distance)) continue;
    least = cost;
    best = match;
  }
  return best;
}

std::vector<TrackMatch> plain_matches(const Tracks& from, const Tracks& to, const Search& search) {
  std::vector<TrackMatch> matches(from.samples.size());
  std::vector<std::uint32_t> near;
  for (size_t i = 0; i < matches.size(); ++i) matches[i] = best_match(from.samples[i], to, search, near, [](int, double) { return true; });
  return matches;
}

/// Where two lines touch, either may be nearer: a short run that ownership alone leaves out counts where the line has its match before and
/// behind it; at an end of the line, a run of half that length.
void heal_short_runs(const Tracks& from, const std::vector<TrackMatch>& plain, std::vector<TrackMatch>& owned) {
  constexpr double kShort_px = 1.5;
  for (const Track& track : from.tracks) {
    const int end = track.first + track.count;
    for (int i = track.first; i < end;) {
      const auto at = static_cast<size_t>(i);
      if (owned[at].found || !plain[at].found) {
        ++i;
        continue;
      }
      int last = i;
      while (last < end && !owned[static_cast<size_t>(last)].found && plain[static_cast<size_t>(last)].found) ++last;
      const bool before = i > track.first && owned[at - 1].found, behind = last < end && owned[static_cast<size_t>(last)].found;
      const double length = (last - i) * track.step();
      const bool healed = (before && behind && length <= kShort_px) || ((before || behind) && length <= 0.5 * kShort_px);
      for (int k = i; healed && k < last; ++k) owned[static_cast<size_t>(k)] = plain[static_cast<size_t>(k)];
      i = last;
    }
  }
}

/// Matches of `from` at places of `to` that belong to it: no other line of `from` is much nearer to them.
std::vector<TrackMatch> owned_matches(const Tracks& from, const Tracks& to, const Search& search, double slack_px) {
  const std::vector<TrackMatch> plain = plain_matches(from, to, search), back = plain_matches(to, from, search);
  std::vector<TrackMatch> owned(from.samples.size());
  std::vector<std::uint32_t> near;
  for (size_t i = 0; i < owned.size(); ++i) {
    if (!plain[i].found) continue;
    owned[i] = best_match(from.samples[i], to, search, near, [&](int sample, double distance) {
      return distance <= kOwnership * back[static_cast<size_t>(sample)].distance_px + slack_px;
    });
  }
  heal_short_runs(from, plain, owned);
  return owned;
}

/// Where a line crosses a sample's normal.
struct Abreast {
  int track = 0;
  double along_px = 0.0;  ///< On that track.
};

/// The lines that cross the sample's normal within `reach_px` of it, running in its direction, in their order. Each counts once, however
/// finely its points zigzag, and again where it comes back after `once_px`. With `overlap_px` those that end so near, or turn back, count,
/// too.
std::vector<Abreast> lines_abreast(const TrackSample& from, const Tracks& to, const Search& search, double reach_px, double overlap_px,
                                   double once_px) {
  const glm::dvec2 normal(-from.tangent.y, from.tangent.x);
  std::vector<std::uint32_t> near;
  std::vector<Abreast> found;
  segments_near(to, from.at, reach_px + overlap_px, near);
  for (const std::uint32_t segment : near) {
    const SegmentEnds& ends = to.ends[segment];
    const TrackSegment& one = to.segments[segment];
    const Track& track = to.tracks[static_cast<size_t>(one.track)];
    const glm::dvec2 d = ends.b - ends.a;
    const double run = glm::dot(d, from.tangent);
    if (std::fabs(run) < search.least_cosine * glm::length(d)) continue;
    // The same number at the end of one segment and at the start of the next: else a corner on the normal may be on neither.
    const double a = glm::dot(ends.a - from.at, from.tangent), b = glm::dot(ends.b - from.at, from.tangent);
    // Half-open, so that strokes end to end count once.
    bool crosses = (a <= 0.0) != (b <= 0.0);
    crosses = crosses || std::min(std::fabs(a), std::fabs(b)) < overlap_px;
    const double t = std::clamp(-a / run, 0.0, 1.0);
    if (!crosses || std::fabs(glm::dot(ends.a + t * d - from.at, normal)) > reach_px) continue;
    const auto i = static_cast<size_t>(one.index);
    found.push_back({one.track, track.along[i] + t * (track.along[i + 1] - track.along[i])});
  }
  std::sort(found.begin(), found.end(),
            [](const Abreast& p, const Abreast& q) { return p.track != q.track ? p.track < q.track : p.along_px < q.along_px; });
  found.erase(
      std::unique(found.begin(), found.end(),
                  [once_px](const Abreast& p, const Abreast& q) { return p.track == q.track && q.along_px - p.along_px < once_px; }),
      found.end());
  return found;
}

/// Two strokes on one line: more of them run side by side than lines do. The first ones drawn are the lines, the others too many.
bool is_surplus(const JudgedTracks& tracks, const DrawnLines& drawing, const Search& search, size_t sample, double distance_px) {
  constexpr double kAbreast_px = 0.3, kOverlap_px = 0.05, kZigzag_px = 2.0 * kOverlap_px, kMoreAngle_deg = 10.0;
  const TrackSample& at = tracks.drawn.samples[sample];
  const std::vector<Abreast> strokes = lines_abreast(at, tracks.drawn, search, kAbreast_px, 0.0, kZigzag_px + 2.0 * drawing.resolution_px);
  if (strokes.size() < 2) return false;
  // A stroke that just counts must not lack its line because the line just does not: lines count farther off, beyond their ends, at larger
  // angles, and nearer to where they turn back.
  const double reach = kAbreast_px + drawing.resolution_px + 2.0 * distance_px;
  Search wider = search;
  wider.least_cosine = std::cos(std::acos(search.least_cosine) + glm::radians(kMoreAngle_deg));
  const size_t lines = std::max<size_t>(1, lines_abreast(at, tracks.visible, wider, reach, kOverlap_px, kZigzag_px).size());
  const Track& own = tracks.drawn.tracks[static_cast<size_t>(at.track)];
  const double along = (static_cast<double>(sample) - own.first + 0.5) * own.step();
  constexpr double kSame_px = 0.1;
  const auto before = std::count_if(strokes.begin(), strokes.end(), [&](const Abreast& one) {
    return one.track < at.track || (one.track == at.track && one.along_px < along - kSame_px);
  });
  return static_cast<size_t>(before) >= lines;
}

}  // namespace

std::vector<TrackMatch> match_lines(const JudgedTracks& tracks, const DrawnLines& drawing, const JudgeSettings& settings, bool owned) {
  const Search search = search_of(drawing, settings);
  return owned ? owned_matches(tracks.visible, tracks.drawn, search, drawing.resolution_px)
               : plain_matches(tracks.visible, tracks.drawn, search);
}

std::vector<bool> crowded_samples(const Tracks& lines, double apart_px) {
  std::vector<bool> crowded(lines.samples.size(), false);
  if (apart_px <= 0.0) return crowded;
  std::vector<std::uint32_t> near;
  for (size_t i = 0; i < crowded.size(); ++i) {
    const TrackSample& sample = lines.samples[i];
    const Track& own = lines.tracks[static_cast<size_t>(sample.track)];
    const double along = (static_cast<double>(i) - own.first + 0.5) * own.step();
    segments_near(lines, sample.at, apart_px, near);
    crowded[i] = std::any_of(near.begin(), near.end(), [&](std::uint32_t segment) {
      const SegmentEnds& ends = lines.ends[segment];
      const TrackSegment& one = lines.segments[segment];
      const glm::dvec2 d = ends.b - ends.a;
      const double t = std::clamp(glm::dot(sample.at - ends.a, d) / glm::dot(d, d), 0.0, 1.0);
      if (glm::distance(ends.a + t * d, sample.at) >= apart_px) return false;
      if (one.track != sample.track) return true;
      // Of its own line, what is far away along it and yet near.
      const double apart = std::fabs(own.along[static_cast<size_t>(one.index)] + t * glm::length(d) - along);
      const bool closed = own.points.front() == own.points.back();
      return std::min(apart, closed ? own.length() - apart : apart) > 3.0 * apart_px;
    });
  }
  return crowded;
}

void excuse_crowded(const JudgedTracks& tracks, const DrawnLines& drawing, const std::vector<bool>& crowded, std::vector<TrackMatch>& lines,
                    std::vector<InkMatch>& ink) {
  if (drawing.apart_px <= 0.0) return;
  const Search anywhere{drawing.apart_px, 0.0, drawing.apart_px};
  const auto any = [](int, double) { return true; };
  std::vector<std::uint32_t> near;
  for (size_t i = 0; i < lines.size(); ++i)
    if (crowded[i] && !lines[i].found) lines[i].found = best_match(tracks.visible.samples[i], tracks.drawn, anywhere, near, any).found;
  for (size_t i = 0; i < ink.size(); ++i) {
    if (ink[i].verdict == InkVerdict::line) continue;
    const TrackMatch match = best_match(tracks.drawn.samples[i], tracks.visible, anywhere, near,
                                        [&](int sample, double) { return crowded[static_cast<size_t>(sample)]; });
    if (match.found) ink[i] = {InkVerdict::line, match.sample};
  }
}

std::vector<InkMatch> match_ink(const JudgedTracks& tracks, const DrawnLines& drawing, const JudgeSettings& settings) {
  const Search search = search_of(drawing, settings);
  const std::vector<TrackMatch> own = owned_matches(tracks.drawn, tracks.visible, search, drawing.resolution_px);
  const std::vector<TrackMatch> visible = plain_matches(tracks.drawn, tracks.visible, search);
  const std::vector<TrackMatch> hidden = plain_matches(tracks.drawn, tracks.hidden, search);
  std::vector<InkMatch> result(own.size());
  for (size_t i = 0; i < result.size(); ++i) {
    if (own[i].found) {
      const bool surplus = is_surplus(tracks, drawing, search, i, own[i].distance_px);
      result[i] = {surplus ? InkVerdict::doubled : InkVerdict::line, own[i].sample};
    } else if (hidden[i].distance_px < visible[i].distance_px) {
      result[i] = {InkVerdict::hidden, hidden[i].sample};
    } else if (visible[i].found) {
      result[i] = {InkVerdict::doubled, visible[i].sample};
    } else {
      result[i] = {InkVerdict::false_stroke, -1};
    }
  }
  return result;
}

}  // namespace limn
