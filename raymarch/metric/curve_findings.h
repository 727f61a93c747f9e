#pragma once
// What several metrics ask of the same two borders, found once.

#include <array>

#include "raymarch/curves/border_match.h"
#include "raymarch/metric.h"

namespace limn {

/// From the points of one border to the other, px.
struct CurveDistances {
  double largest = 0.0, sum = 0.0, length = 0.0;
};

/// The distances one way and the other.
struct BothWays {
  CurveDistances there{}, back{};
};

/// Of the curves and the truth of one MetricInput: empty at first, filled in by the metrics that ask. Used from one thread at a time.
struct CurveFindings {
  std::optional<BorderMatch> match{};                  ///< Both kinds, each with its own.
  std::array<std::optional<BothWays>, 3> distances{};  ///< Of both kinds together, of silhouettes, of inner borders.
};

/// `input.findings`, or `own` where there are none. `input` must have curves and a truth.
inline CurveFindings& findings_of(const MetricInput& input, CurveFindings& own) { return input.findings ? *input.findings : own; }

/// The match of input.curves with input.truth, of both kinds.
inline const BorderMatch& find_match(const MetricInput& input, CurveFindings& findings) {
  if (!findings.match) findings.match = match_borders(input.truth->curves, *input.curves, {}, input.camera);
  return *findings.match;
}

}  // namespace limn
