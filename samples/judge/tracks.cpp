#include "samples/judge/tracks.h"

#include <algorithm>
#include <cmath>

namespace limn {
namespace {

/// The part of the segment within the frame, as parameters; false where there is none (Liang and Barsky 1984, "A new concept and method for
/// line clipping").
bool clip(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& size, double& from, double& to) {
  from = 0.0;
  to = 1.0;
  const glm::dvec2 d = b - a;
  for (int axis = 0; axis < 2; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      const double slope = side * d[axis], room = side < 0.0 ? a[axis] : size[axis] - a[axis];
      if (slope == 0.0 && room < 0.0) return false;
      if (slope < 0.0) from = std::max(from, room / slope);
      if (slope > 0.0) to = std::min(to, room / slope);
    }
  }
  return from < to;
}

}  // namespace

void add_track(Tracks& tracks, const std::vector<glm::dvec2>& points, int source) {
  Track track;
  track.source = source;
  for (const glm::dvec2& p : points) {
    const double step = track.points.empty() ? 0.0 : glm::distance(track.points.back(), p);
    if (!track.points.empty() && !(step > 0.0)) continue;
    track.along.push_back(track.points.empty() ? 0.0 : track.along.back() + step);
    track.points.push_back(p);
  }
  if (track.points.size() < 2) return;
  track.first = static_cast<int>(tracks.samples.size());
  track.count = std::max(1, static_cast<int>(std::ceil(track.length() / kTrackStep_px)));
  const int index = static_cast<int>(tracks.tracks.size());
  size_t segment = 0;
  for (int i = 0; i < track.count; ++i) {
    const double s = (i + 0.5) * track.step();
    while (segment + 2 < track.points.size() && track.along[segment + 1] < s) ++segment;
    const glm::dvec2 a = track.points[segment], d = track.points[segment + 1] - a;
    const double length = track.along[segment + 1] - track.along[segment];
    tracks.samples.push_back({a + d * ((s - track.along[segment]) / length), d / length, track.step(), index});
  }
  for (size_t i = 0; i + 1 < track.points.size(); ++i) {
    tracks.ends.push_back({track.points[i], track.points[i + 1]});
    tracks.segments.push_back({index, static_cast<int>(i)});
  }
  tracks.tracks.push_back(std::move(track));
}

void finish_tracks(Tracks& tracks) { tracks.grid = segment_grid(tracks.ends); }

void segments_near(const Tracks& tracks, const glm::dvec2& p, double radius, std::vector<std::uint32_t>& found) {
  found.clear();
  const SegmentGrid& grid = tracks.grid;
  if (grid.columns == 0) return;
  const int left = grid.column_of(p.x - radius), right = grid.column_of(p.x + radius);
  const int top = grid.row_of(p.y - radius), bottom = grid.row_of(p.y + radius);
  for (int row = top; row <= bottom; ++row)
    for (int column = left; column <= right; ++column)
      for (const std::uint32_t segment : grid.in_cell(column, row)) found.push_back(segment);
  if (left == right && top == bottom) return;
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
}

std::vector<std::vector<glm::dvec2>> clipped_to_frame(const std::vector<glm::dvec2>& points, const glm::dvec2& size) {
  std::vector<std::vector<glm::dvec2>> pieces;
  std::vector<glm::dvec2> piece;
  for (size_t i = 0; i + 1 < points.size(); ++i) {
    const glm::dvec2 a = points[i], b = points[i + 1];
    double from = 0.0, to = 1.0;
    if (!clip(a, b, size, from, to)) continue;
    if (from > 0.0 || piece.empty()) {
      if (piece.size() > 1) pieces.push_back(std::move(piece));
      piece = {a + (b - a) * from};
    }
    piece.push_back(to < 1.0 ? a + (b - a) * to : b);
    if (to < 1.0) {
      pieces.push_back(std::move(piece));
      piece.clear();
    }
  }
  if (piece.size() > 1) pieces.push_back(std::move(piece));
  return pieces;
}

}  // namespace limn
