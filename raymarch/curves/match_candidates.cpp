#include "raymarch/curves/match_candidates.h"

#include <algorithm>
#include <cmath>

#include "sdf/segment.h"

namespace limn {
namespace {

/// A meeting this many times as far as the nearest point of its stretch is one beside the tip of a sharp turn.
constexpr double kSlanted = 4.0;
/// A nearest point that lies sidewards counts no farther off than this, nor does the end of a curve for what lies beyond.
constexpr double kBeside_px = 0.25;
/// Of two places of a curve nearer to each other than this only the nearer to the sample counts: a kink has one on either side.
constexpr double kSamePlace_px = 1.0;

glm::dvec2 turned(const glm::dvec2& along) { return {-along.y, along.x}; }

/// What was found on one segment; on a segment in several cells, once in each.
struct OfSegment {
  std::uint32_t segment = 0;
  MatchCandidate found{};
};

/// In the order of the segments. Of the hundreds in reach few have anything: these are sorted, not the segments.
std::vector<MatchCandidate> along_curves(std::vector<OfSegment>& all) {
  std::sort(all.begin(), all.end(), [](const OfSegment& a, const OfSegment& b) { return a.segment < b.segment; });
  std::vector<MatchCandidate> once;
  for (size_t i = 0; i < all.size(); ++i)
    if (i == 0 || all[i].segment != all[i - 1].segment) once.push_back(all[i].found);
  return once;
}

}  // namespace

MatchCandidates::MatchCandidates(const BorderCurves& measured) {
  for (size_t c = 0; c < measured.curves.size(); ++c) add_curve(measured.curves[c], c);
  std::vector<SegmentEnds> ends;
  ends.reserve(segments_.size());
  for (const Segment& s : segments_) ends.push_back({s.a, s.a + s.along});
  grid_ = segment_grid(ends);
}

void MatchCandidates::add_curve(const BorderCurve& curve, size_t index) {
  const size_t first = segments_.size();
  double start = 0.0;
  const auto add = [&](const glm::dvec2& a, const glm::dvec2& b, double from) {
    const double length = glm::length(b - a);
    if (!(length > 0.0)) return;
    segments_.push_back({a, b - a, from, length, index, curve.kind, curve.object, segments_.size() - 1, segments_.size() + 1});
  };
  const size_t n = curve.points.size();
  for (size_t i = 0; i + (curve.closed ? 0 : 1) < n; ++i) {
    const glm::dvec2 a = curve.points[i].px, b = curve.points[(i + 1) % n].px;
    add(a, b, start);
    start += glm::length(b - a);
  }
  lengths_.push_back(start);
  closed_.push_back(curve.closed);
  if (segments_.size() == first) return;
  segments_[first].before = curve.closed ? segments_.size() - 1 : first;
  segments_.back().after = curve.closed ? first : segments_.size() - 1;
}

template <class Visit>
void MatchCandidates::visit_near(const glm::dvec2& px, double reach_px, const Visit& visit) const {
  const glm::dvec2 low = (px - reach_px - grid_.origin) / grid_.cell_px, high = (px + reach_px - grid_.origin) / grid_.cell_px;
  const auto inside = [](double cell, int count) {
    return static_cast<int>(std::clamp(std::floor(cell), -1.0, static_cast<double>(count)));
  };
  for (int row = std::max(0, inside(low.y, grid_.rows)); row <= std::min(grid_.rows - 1, inside(high.y, grid_.rows)); ++row) {
    for (int column = std::max(0, inside(low.x, grid_.columns)); column <= std::min(grid_.columns - 1, inside(high.x, grid_.columns));
         ++column) {
      for (const std::uint32_t index : grid_.in_cell(column, row)) visit(index);
    }
  }
}

/// Where the distance along the curve is least, if that is on this segment; a vertex belongs to the segment that it begins, or to the last.
std::optional<MatchCandidate> MatchCandidates::nearest_on(const BorderSample& sample, std::uint32_t index, double reach_px) const {
  const Segment& s = segments_[index];
  const double share = closest_share(sample.px - s.a, s.along);
  const bool starts = s.before == index, ends = s.after == index;
  bool facing = glm::dot(sample.outward, turned(s.along)) > 0.0;
  if (share <= 0.0 && !starts) {
    const Segment& before = segments_[s.before];
    if (closest_share(sample.px - before.a, before.along) < 1.0) return std::nullopt;
    facing = facing || glm::dot(sample.outward, turned(before.along)) > 0.0;
  } else if (share >= 1.0 && !ends) {
    return std::nullopt;
  }
  const glm::dvec2 to = s.a + share * s.along - sample.px;
  const double distance = glm::length(to), across = glm::dot(to, sample.outward);
  if (!facing || distance > reach_px) return std::nullopt;
  const MatchCandidate found{s.curve, s.start_px + share * s.length_px, distance, across};
  const bool before_it = std::abs(across) >= 0.5 * distance, open_end = (share <= 0.0 && starts) || (share >= 1.0 && ends);
  if (open_end) {
    const double beside = std::sqrt(std::max(0.0, distance * distance - across * across));
    return beside <= kBeside_px ? std::optional(found) : std::nullopt;
  }
  if (before_it) return found;
  if (distance > kBeside_px) return std::nullopt;
  return MatchCandidate{found.curve, found.along_px, distance, std::copysign(distance, across)};
}

std::optional<MatchCandidate> MatchCandidates::meeting_on(const BorderSample& sample, std::uint32_t index, double reach_px) const {
  const Segment& s = segments_[index];
  const double facing = glm::dot(sample.outward, turned(s.along));
  if (!(facing > 0.0)) return std::nullopt;
  const double t = glm::dot(s.a - sample.px, turned(s.along)) / facing;
  const double share = glm::dot(sample.px + t * sample.outward - s.a, s.along) / (s.length_px * s.length_px);
  // A little beyond both ends, so that no line slips through between two segments.
  if (!(share >= -1e-9 && share <= 1.0 + 1e-9) || std::abs(t) > reach_px) return std::nullopt;
  return MatchCandidate{s.curve, s.start_px + share * s.length_px, std::abs(t), t};
}

std::vector<MatchCandidate> MatchCandidates::of(const BorderSample& sample, double reach_px) const {
  if (segments_.empty()) return {};
  std::vector<OfSegment> nearest_of, meetings_of;
  visit_near(sample.px, reach_px, [&](std::uint32_t index) {
    if (segments_[index].kind != sample.kind || segments_[index].object != sample.object) return;
    if (const auto found = nearest_on(sample, index, reach_px)) nearest_of.push_back({index, *found});
    if (const auto found = meeting_on(sample, index, reach_px)) meetings_of.push_back({index, *found});
  });
  std::vector<MatchCandidate> nearest = along_curves(nearest_of), meetings = along_curves(meetings_of);
  const auto arc = [&](const MatchCandidate& a, const MatchCandidate& b) {
    const double between = std::abs(a.along_px - b.along_px);
    return closed_[a.curve] ? std::min(between, lengths_[a.curve] - between) : between;
  };
  for (MatchCandidate& one : nearest) {
    const MatchCandidate* best = nullptr;
    for (const MatchCandidate& meeting : meetings) {
      const bool own = meeting.curve == one.curve && arc(meeting, one) <= meeting.distance_px + 0.5;
      if (own && meeting.distance_px <= kSlanted * one.distance_px + 1e-6 && (best == nullptr || meeting.distance_px < best->distance_px))
        best = &meeting;
    }
    if (best != nullptr) one.along_px = best->along_px, one.displacement_px = best->displacement_px;
  }
  std::stable_sort(nearest.begin(), nearest.end(),
                   [](const MatchCandidate& a, const MatchCandidate& b) { return a.distance_px < b.distance_px; });
  std::vector<MatchCandidate> kept;
  for (const MatchCandidate& one : nearest) {
    const bool again = std::any_of(
        kept.begin(), kept.end(), [&](const MatchCandidate& other) { return other.curve == one.curve && arc(other, one) < kSamePlace_px; });
    if (!again && kept.size() < kMost) kept.push_back(one);
  }
  return kept;
}

}  // namespace limn
