#pragma once
// Internal: which bricks of which voxel sizes a local level set has: small ones where the border of given pictures runs, larger ones, each
// twice as large, farther away.

#include <vector>

#include "raymarch/local/local_depth.h"
#include "raymarch/local_model.h"
#include "sdf/field.h"

namespace limn {

/// Eight voxels to a side.
struct LocalBrick {
  glm::ivec3 place{0};  ///< In bricks.
  Field field;          ///< Equals the whole one where the brick's nodes and stencils ask it.
};

/// Every point of the surface lies in one brick or on the faces between several. Two bricks that touch, be it at a corner, are of the same
/// size or one is twice as large as the other.
struct LocalChoice {
  glm::dvec3 origin{0.0};                         ///< Of the lattices of all sizes, render space.
  double voxel_size = 0.0;                        ///< The smallest.
  std::vector<std::vector<LocalBrick>> levels{};  ///< [k]: those of voxels 2^k times as large, in the order of their x, y and z.

  double voxel_of(size_t level) const { return voxel_size * static_cast<double>(std::int64_t{1} << level); }
  Box box_of(size_t level, const glm::ivec3& place) const {
    const double side = 8.0 * voxel_of(level);
    const glm::dvec3 lower = origin + side * glm::dvec3(place);
    return {lower, lower + side};
  }
};

/// How a local level set is made.
struct LocalBrickSettings {
  LocalSettings local{};    ///< Cameras in render space.
  double voxel_size = 0.0;  ///< No voxels are smaller.
  const GradientDescriptor* gradient = nullptr;
  std::int64_t max_bytes = std::int64_t{8} << 30;
  bool border = true;                  ///< False: only as fine as any part has to be.
  std::vector<SmallPicture> hidden{};  ///< One for each camera, or none: what is hidden in it may be coarse.
};

/// `field` has bounds and is in render space. Interval bounds decide: a brick where they show no border is never taken for one, and one
/// where they cannot tell is. Throws SizeError (InputError) before it needs more than max_bytes.
LocalChoice choose_bricks(const Field& field, const LocalBrickSettings& settings);

}  // namespace limn
