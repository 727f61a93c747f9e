// Walls and gaps against the voxels that are asked for, and how many would be needed.

#include <fmt/format.h>

#include <cmath>

#include "raymarch/audit.h"
#include "raymarch/audit/facts.h"
#include "subdiv/first_hits.h"

namespace limn {
namespace {

constexpr double kWallVoxels = 2.0, kGapVoxels = 1.0;
constexpr double kMostThin = kThinShare;
constexpr double kRounding = 1e-3;  // of what is found by steps
// A grid of more voxels along a side is advice for nobody: its surface alone has over 16 million of them, tens of gigabytes.
constexpr std::int64_t kMostVoxels = 4096;

double voxel_size_of(const AuditFacts& facts, double longest_side) {
  if (const LevelSetSource* source = facts.level_set())
    return source->level_set.info().voxel_size * std::cbrt(std::abs(glm::determinant(facts.object.world_from_object.linear)));
  const SurfaceSettings& settings = facts.settings.surface;
  return settings.voxel_size > 0.0 ? settings.voxel_size : longest_side / settings.voxels;
}

struct Thing {
  const char* check;
  const char* good;
  const char* bad;   ///< "... % of the surface lies …"
  const char* fate;  ///< "…, which may …"
  double voxels;
};

std::string remedy_of(std::int64_t voxels, const AuditFacts& facts) {
  const char* const exact = facts.field() != nullptr ? "analytic" : "mesh";
  if (facts.level_set() != nullptr)
    return voxels > kMostVoxels
               ? "none by voxels of one size"
               : fmt::format("a grid with {} voxels along the longest side would hold all but {:g} %", voxels, 100.0 * kMostThin);
  if (voxels > kMostVoxels) return fmt::format("surface = {}: no grid that fits into memory holds them", exact);
  return fmt::format("voxels = {} would hold all but {:g} %; surface = {} needs none", voxels, 100.0 * kMostThin, exact);
}

void look_at(const Thing& thing, const std::vector<double>& widths, double voxel, AuditFacts& facts, std::vector<Finding>& findings) {
  const SurfaceSamples& samples = facts.samples();
  const double share = share_below(widths, thing.voxels * voxel), thinnest = known_quantile(widths, kMostThin);
  const std::string where = samples.of.empty() ? "" : " (of " + samples.of + ")";
  Finding finding{.check = thing.check, .value = share, .message = thing.good};
  if (std::isfinite(thinnest)) {
    finding.message +=
        fmt::format(" at a voxel of {:.3g}: the thinnest is {:.3g}, {:.2f} voxels{}", voxel, thinnest, thinnest / voxel, where);
  }
  if (share > kMostThin) {
    const auto needed =
        static_cast<std::int64_t>(std::ceil(std::min(1e15, (1.0 - kRounding) * thing.voxels * samples.longest_side / thinnest)));
    finding.severity = Severity::warning;
    finding.message = fmt::format("{:.3g} % of the surface{} lies {} ({:.3g}), which may {}; the thinnest is {:.2g}, {:.2f} voxels",
                                  100.0 * share, where, thing.bad, thing.voxels * voxel, thing.fate, thinnest, thinnest / voxel);
    finding.remedy = remedy_of(needed, facts);
    finding.surfaces =
        facts.mesh() != nullptr ? std::vector<std::string>{"mesh_level_set"} : std::vector<std::string>{"level_set", "mesh_level_set"};
  }
  findings.push_back(std::move(finding));
}

void look(AuditFacts& facts, std::vector<Finding>& findings) {
  const SurfaceSamples& samples = facts.samples();
  if (samples.points.empty()) return;
  const double voxel = voxel_size_of(facts, samples.longest_side);
  look_at({"thin walls", "no wall is thinner than two voxels", "on walls thinner than two voxels", "break up", kWallVoxels}, samples.walls,
          voxel, facts, findings);
  look_at({"narrow gaps", "no gap is narrower than one voxel", "at gaps narrower than one voxel", "close", kGapVoxels}, samples.gaps, voxel,
          facts, findings);
}

}  // namespace

AuditCheck thin_check() {
  return {{"thin", "walls below two voxels, gaps below one", ""}, false, look, true, {"level_set", "mesh_level_set"}};
}

}  // namespace limn
