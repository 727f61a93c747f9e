#pragma once
// Rays against a narrow-band level set: the first root of the trilinear interpolant, exact to rounding. Shared by the surfaces
// `level_set` and `mesh_level_set`.

#include <array>

#include "raymarch/surface.h"
#include "sdf/level_set.h"

namespace limn {

/// The level that is traced instead of 0.
struct MarchedLevel {
  OffsetWidth width{};
  double largest_voxels = 0.0;  ///< Of the width, wherever the surface is.
};

/// A surface that traces `level_set`, placed in the world by `world_from_object` and seen from `render_origin` (world). Normals by
/// `gradient`. Fills bounds and info (kind is left to the caller). The hit is the first change of sign along the ray, in either
/// direction; f < 0 is inside, f >= 0 outside. With a `level`: of f minus its width, which the band must hold.
Surface level_set_marcher(const LevelSet& level_set, const Affine& world_from_object, const GradientDescriptor& gradient,
                          const glm::dvec3& render_origin, int max_steps, const MarchedLevel& level = {});

/// The band's half width for these settings, in voxels: what the gradient needs, or what the user asks for. Throws InputError
/// (field --half-width) where that is too little.
double half_width_for(const SurfaceSettings& settings, const GradientDescriptor& gradient);

/// The voxel size for these settings, in world units, by the longest side of the object's bounds (world). Throws InputError.
double voxel_size_for(const SurfaceSettings& settings, const Box& bounds);

/// First place in [0, 1] where the polynomial c[0] + c[1] s + c[2] s^2 + c[3] s^3 changes from `inside` (c < 0) to outside (c >= 0) or
/// back; negative where it does not.
double first_sign_change(const std::array<double, 4>& c, bool inside);

}  // namespace limn
