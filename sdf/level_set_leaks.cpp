#include "sdf/level_set_leaks.h"

#include <fmt/format.h>

namespace limn {
namespace {

// Closed meshes reach 2 % on coarse grids, at edges and tips thinner than a voxel.
constexpr double kLeastShare = 0.03;
constexpr double kMostlyShare = 0.5;
constexpr std::int64_t kLeastNodes = 20;

}  // namespace

std::string with_inside_remedy() {
  return "limn export with surface = mesh_level_set makes a level set with an inside of any mesh: it closes holes by winding "
         "number";
}

double leaked_share(const BandFacts& band) {
  if (band.near_nodes == 0 || band.unsigned_nodes < kLeastNodes) return 0.0;
  const double share = static_cast<double>(band.unsigned_nodes) / static_cast<double>(band.near_nodes);
  return share < kLeastShare ? 0.0 : share;
}

std::string unsigned_surface_warning(const BandFacts& band) {
  const double share = leaked_share(band);
  if (share == 0.0) return {};
  const std::string counts =
      fmt::format("{} of the {} nodes within half a voxel of it have no neighbour of the other sign", band.unsigned_nodes, band.near_nodes);
  if (share >= kMostlyShare)
    return fmt::format(
        "{:.0f} % of the surface in this volume has no inside and is not drawn: {}. Its inside leaked out, as of an open mesh "
        "whose holes were not closed; {}",
        100.0 * share, counts, with_inside_remedy());
  return fmt::format(
      "{:.1f} % of the surface in this volume has no inside and is not drawn: {}. There its inside leaked out, as of an open "
      "mesh ({}), or walls are thinner than a voxel (smaller voxels help)",
      100.0 * share, counts, with_inside_remedy());
}

std::string no_surface_problem(const std::string& grid, const BandFacts& band) {
  std::string problem = "the grid '" + grid + "' has no surface: its values never change sign";
  if (band.near_nodes >= kLeastNodes)
    problem += fmt::format(", though {} of its nodes are within half a voxel of 0: unsigned distances, or an inside that leaked out",
                           band.near_nodes);
  return problem;
}

}  // namespace limn
