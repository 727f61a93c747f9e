#pragma once
// Internal: where on measured curves the partner of a true sample may lie.

#include <cstdint>

#include "raymarch/curves/curve_geometry.h"
#include "raymarch/curves/segment_grid.h"

namespace limn {

/// A stretch of a measured curve beside a sample.
struct MatchCandidate {
  size_t curve = 0;            ///< Index into the measured BorderCurves::curves.
  double along_px = 0.0;       ///< Arc length from its first point.
  double distance_px = 0.0;    ///< Of the stretch from the sample.
  double displacement_px = 0;  ///< Along the sample's outward normal, positive outwards.
};

/// The segments of measured curves, with their arc lengths, in a uniform grid.
class MatchCandidates {
 public:
  explicit MatchCandidates(const BorderCurves& measured);

  /// One for each place within `reach_px` where the distance of a curve of the same kind and object that faces the same way is least, the
  /// nearest first, kMost at most. The normal's meeting with such a stretch says the displacement, unless it lies four times as far as the
  /// stretch does; beside corners the nearest point does.
  std::vector<MatchCandidate> of(const BorderSample& sample, double reach_px) const;

  double length_px(size_t curve) const { return lengths_[curve]; }

  static constexpr size_t kMost = 8;

 private:
  struct Segment {
    glm::dvec2 a{0.0}, along{0.0};
    double start_px = 0.0, length_px = 0.0;  ///< Arc length at `a`; its own.
    size_t curve = 0;
    CurveKind kind = CurveKind::silhouette;
    int object = 0;
    size_t before = 0, after = 0;  ///< Neighbours along the curve; itself at an open end.
  };
  void add_curve(const BorderCurve& curve, size_t index);
  /// Segments within reach, and some beyond; those in several cells several times.
  template <class Visit>
  void visit_near(const glm::dvec2& px, double reach_px, const Visit& visit) const;
  std::optional<MatchCandidate> nearest_on(const BorderSample& sample, std::uint32_t index, double reach_px) const;
  std::optional<MatchCandidate> meeting_on(const BorderSample& sample, std::uint32_t index, double reach_px) const;

  std::vector<Segment> segments_{};
  std::vector<double> lengths_{};
  std::vector<char> closed_{};
  SegmentGrid grid_{};
};

}  // namespace limn
