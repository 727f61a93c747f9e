#include "raymarch/border/broken_lines.h"

#include <fmt/core.h>

#include <algorithm>

#include "raymarch/border/specks.h"

namespace limn {

std::string broken_lines_note(const std::string& name, const BorderInput& input, const Image<float>& coverage) {
  const std::vector<Surface>& surfaces = input.model.surfaces;
  if (std::none_of(surfaces.begin(), surfaces.end(), [](const Surface& surface) { return surface.info.voxel_size > 0.0; })) return {};
  const GBuffer& seen = input.gbuffer;
  const auto voxel_px = [&](size_t i) {
    const std::int32_t id = seen.id.pixels[i];
    if (id == 0) return 0.0;
    return surfaces[static_cast<size_t>(id - 1)].info.voxel_size * pixels_per_unit_at(input.camera, double{seen.depth.pixels[i]});
  };
  const std::int64_t specks = count_specks(coverage, kSpeckPx, [&](size_t i) { return voxel_px(i) > 1.0; });
  if (specks == 0) return {};
  return fmt::format(
      "{}: {} piece{} of line on level sets {} shorter than {} px: the grid turns its creases over a voxel or two, which cover several "
      "pixels here; a finer grid draws the lines whole",
      name, specks, specks == 1 ? "" : "s", specks == 1 ? "is" : "are", kSpeckPx);
}

}  // namespace limn
