#pragma once
// Internal: how a local level set is made.

#include <vector>

#include "raymarch/local/local_depth.h"
#include "raymarch/local_model.h"

namespace limn {

/// How a local level set is made. Places are those of the surface that it is made of (see SurfacePart).
struct LocalBrickSettings {
  LocalSettings local{};
  double voxel_size = 0.0;         ///< No voxels are smaller.
  double half_width_voxels = 0.0;  ///< Of each size's band.
  const GradientDescriptor* gradient = nullptr;
  std::int64_t max_bytes = std::int64_t{8} << 30;
  bool border = true;                  ///< False: only as fine as any part has to be.
  std::vector<SmallPicture> hidden{};  ///< One for each camera, or none: what is hidden in it may be coarse.
};

}  // namespace limn
