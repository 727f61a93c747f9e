#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "raymarch/level_set/level_set_marcher.h"
#include "sdf/error.h"

namespace limn {

double half_width_for(const SurfaceSettings& settings, const GradientDescriptor& gradient) {
  // Every cell on the surface lies within the square root of 3 of it; the rest is for distances that are right to third order only.
  const double needed = std::max(gradient.half_width_voxels, 1.8);
  if (settings.half_width_voxels == 0.0) return needed;
  if (settings.half_width_voxels >= needed - 1e-2 && settings.half_width_voxels <= 1000.0)
    return std::max(needed, settings.half_width_voxels);
  throw InputError({.file = {},
                    .field = "half_width",
                    .value = fmt::format("{:.6g}", settings.half_width_voxels),
                    .problem = fmt::format("does not suit the gradient '{}'", gradient.about.name),
                    .expected = fmt::format("at least {:.2f} and at most 1000 voxels", needed)});
}

double voxel_size_for(const SurfaceSettings& settings, const Box& bounds) {
  if (settings.voxel_size != 0.0) {
    if (std::isfinite(settings.voxel_size) && settings.voxel_size > 0.0) return settings.voxel_size;
    throw InputError({.file = {},
                      .field = "voxel_size",
                      .value = fmt::format("{:.6g}", settings.voxel_size),
                      .problem = "not a length",
                      .expected = "above 0"});
  }
  if (settings.voxels < 2 || settings.voxels > 65536)
    throw InputError({.file = {},
                      .field = "voxels",
                      .value = std::to_string(settings.voxels),
                      .problem = "out of range",
                      .expected = "from 2 to 65536 voxels along the longest side"});
  if (!bounds.finite() || !(bounds.longest_side() > 0.0))
    throw InputError({.file = {},
                      .field = "voxels",
                      .value = {},
                      .problem = "the object has no bounds to be divided",
                      .expected = "an object with bounds, or its intersection with a box"});
  return bounds.longest_side() / settings.voxels;
}

}  // namespace limn
