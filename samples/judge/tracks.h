#pragma once
// Internal: polylines in pixels with samples along them, and what lies near a point.

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "raymarch/curves/segment_grid.h"

namespace limn {

inline constexpr double kTrackStep_px = 0.25;

/// A polyline; a closed one's first point is repeated.
struct Track {
  std::vector<glm::dvec2> points{};
  std::vector<double> along{};  ///< Arc length up to each point.
  int first = 0, count = 0;     ///< Its samples.
  int source = 0;               ///< What it is of, as the caller numbers it.
  double length() const { return along.back(); }
  double step() const { return length() / count; }
};

/// The middle of a step.
struct TrackSample {
  glm::dvec2 at{0.0}, tangent{1.0, 0.0};
  double length_px = 0.0;
  int track = 0;
};

struct TrackSegment {
  int track = 0, index = 0;  ///< From points[index] to the next.
};

struct Tracks {
  std::vector<Track> tracks{};
  std::vector<TrackSample> samples{};
  std::vector<SegmentEnds> ends{};
  std::vector<TrackSegment> segments{};
  SegmentGrid grid{};
};

/// Lines without length are left out.
void add_track(Tracks& tracks, const std::vector<glm::dvec2>& points, int source);
/// After the last track.
void finish_tracks(Tracks& tracks);

/// The segments that may lie within `radius` of `p`, each once.
void segments_near(const Tracks& tracks, const glm::dvec2& p, double radius, std::vector<std::uint32_t>& found);

/// The parts of a polyline within [0, width] x [0, height].
std::vector<std::vector<glm::dvec2>> clipped_to_frame(const std::vector<glm::dvec2>& points, const glm::dvec2& size);

}  // namespace limn
