#include "raymarch/lines/flat_crossings.h"

#include <algorithm>
#include <atomic>

#include "raymarch/lines/curve_walk.h"
#include "raymarch/lines/nearer_crossings.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr int kRounds = 5;
constexpr int kParts = 4;  // of a step that is cut: its line leaves each of them by 1/16

/// Parts of the steps that the curve had.
struct Part {
  size_t step = 0;
  double from = 0.0, to = 1.0;
};

/// Returns the marks of the new steps: parts of unclear ones may still be unclear.
std::vector<char> cut_steps(const std::vector<char>& unclear, const Camera& camera, SurfaceCurve& curve) {
  const size_t count = steps_of(curve);
  std::vector<CurveSample> samples;
  std::vector<Part> parts;
  std::vector<char> marks;
  const auto cut = static_cast<size_t>(std::count(unclear.begin(), unclear.end(), 1)), all = count + cut * (kParts - 1);
  samples.reserve(all + 1);
  parts.reserve(all);
  marks.reserve(all);
  for (size_t i = 0; i < count; ++i) {
    const int n = unclear[i] != 0 ? kParts : 1;
    for (int k = 0; k < n; ++k) {
      const double from = static_cast<double>(k) / n, to = static_cast<double>(k + 1) / n;
      CurveSample sample = k == 0 ? curve.samples[i] : sample_at(curve, static_cast<double>(i) + from, camera);
      sample.pierced.clear();
      for (const Piercing& piercing : curve.samples[i].pierced) {
        if (piercing.t >= from && (piercing.t < to || k + 1 == n))
          sample.pierced.push_back({(piercing.t - from) / (to - from), piercing.layers, piercing.unclear_px});
      }
      samples.push_back(std::move(sample));
      parts.push_back({i, from, to});
      marks.push_back(unclear[i]);
    }
  }
  if (!curve.closed) samples.push_back(curve.samples.back());
  curve.samples = std::move(samples);
  if (curve.between) {
    curve.between = [parts = std::move(parts), whole = std::move(curve.between)](size_t step, double share) {
      return whole(parts[step].step, glm::mix(parts[step].from, parts[step].to, share));
    };
  }
  return marks;
}

}  // namespace

void refine_flat_crossings(std::vector<SurfaceCurve>& curves, const Camera& camera) {
  StepMarks asked(curves.size());
  for (size_t c = 0; c < curves.size(); ++c) asked[c].assign(steps_of(curves[c]), 1);
  for (int round = 0; round < kRounds; ++round) {
    const StepMarks unclear = unclear_steps(curves, camera, asked);
    std::atomic<bool> any = false;
    parallel_for(size_t{0}, curves.size(), [&](size_t c) {
      if (std::find(unclear[c].begin(), unclear[c].end(), 1) == unclear[c].end()) {
        asked[c].clear();
        return;
      }
      asked[c] = cut_steps(unclear[c], camera, curves[c]);
      any = true;
    });
    if (!any) break;
  }
}

}  // namespace limn
