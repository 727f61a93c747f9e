// |grad f| near the surface: 1 where the value is a distance.

#include <fmt/format.h>

#include <cmath>

#include "raymarch/audit.h"
#include "raymarch/audit/facts.h"

namespace limn {
namespace {

/// Slopes of a volume that lie further from 1 are no distances any more: an offset would be wrong by as much.
constexpr double kMostOff = 0.1;
/// Below this share of the median slope a field's surface is about to become singular: normals turn round within a pixel.
constexpr double kSingularShare = 1e-3;

struct Slopes {
  double low, median, high;
};

void look_at_field(const Slopes& slope, std::vector<Finding>& findings) {
  Finding finding{.check = "slope",
                  .value = slope.median,
                  .message = fmt::format("|grad f| on the surface is {:.3g} to {:.3g}, median {:.3g}: rays are bounded by intervals and "
                                         "distances are computed, so nothing depends on it",
                                         slope.low, slope.high, slope.median)};
  if (slope.low < kSingularShare * slope.median) {
    const std::vector<std::string> inputs{"N", "NdotV"};
    finding.severity = Severity::warning;
    finding.value = slope.low;
    finding.message = fmt::format("|grad f| falls to {:.2g} on the surface (median {:.3g}): it has a point or a line without a normal",
                                  slope.low, slope.median);
    finding.remedy = "expect single wrong pixels there; round the shape off, or look from where the place is hidden";
    finding.methods = methods_reading(inputs);
  }
  findings.push_back(std::move(finding));
}

void look_at_volume(const Slopes& slope, std::vector<Finding>& findings) {
  const double off = std::max(std::abs(slope.low - 1.0), std::abs(slope.high - 1.0));
  Finding finding{
      .check = "slope",
      .value = slope.median,
      .message = fmt::format("|grad f| across the surface is {:.3g} to {:.3g}, median {:.3g} (5 % to 95 %): the values are distances",
                             slope.low, slope.high, slope.median)};
  if (off > kMostOff) {
    const std::vector<std::string> inputs{"mesh or distances"};
    finding.severity = Severity::warning;
    finding.message = fmt::format(
        "|grad f| across the surface is {:.3g} to {:.3g}, median {:.3g} (5 % to 95 %) instead of 1: the volume is no distance field. Rays "
        "and normals do not mind; an outline of constant width on the object comes out {:.2g} times as wide",
        slope.low, slope.high, slope.median, 1.0 / slope.median);
    finding.remedy = "make true distances of it (vdb_tool -iso2ls iso=0, or openvdb::tools::levelSetRebuild), or use surface = mesh";
    finding.methods = methods_reading(inputs);
    finding.surfaces = {"level_set"};
  }
  findings.push_back(std::move(finding));
}

void look(AuditFacts& facts, std::vector<Finding>& findings) {
  if (facts.mesh() != nullptr) return;
  const std::vector<double>& slopes = facts.samples().slopes;
  if (slopes.empty()) return;
  if (facts.field() != nullptr)
    look_at_field({known_quantile(slopes, 0.0), known_quantile(slopes, 0.5), known_quantile(slopes, 1.0)}, findings);
  else
    look_at_volume({known_quantile(slopes, 0.05), known_quantile(slopes, 0.5), known_quantile(slopes, 0.95)}, findings);
}

}  // namespace

AuditCheck slope_check() { return {{"slope", "|grad f| on and across the surface", ""}, false, look}; }

}  // namespace limn
