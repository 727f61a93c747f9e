#pragma once
// Internal: whether pictures ask for smaller voxels in a brick.

#include "raymarch/local/brick_settings.h"
#include "sdf/field.h"

namespace limn {

/// Where a brick holds creases or several sheets, its voxels are no larger in the picture: what they lose is smaller than a pixel.
inline constexpr double kFolded_px = 1.0;
/// Nodes that a gradient's stencil reads lie no farther from a brick, in voxels.
inline constexpr double kStencilReach_voxels = 3.0;
/// Of a predicted error, what is allowed for its being a prediction.
inline constexpr double kDemandSafety = 2.0;

/// True where voxels of `voxel_size` do not do in a brick or a part of one: where one of the pictures shows a border in it that they would
/// move by more than the tolerance, or where the surface would stand off by more than kLocalCoarse_px.
/// `smaller`: those that would take their place.
bool needs_smaller_voxels(FieldEvaluator& evaluator, const Box& box, double voxel_size, double smaller, const LocalBrickSettings& settings);

/// Where the camera's picture shows a box: the pixels that a world unit takes at its nearest point; negative where it does not.
double pixels_per_unit_of(const Camera& camera, const Box& box);

/// How far the surface may stand off in cells of that size, along its normal: a function whose slope lies in bounds of width w lies within
/// h w / 4 of its chords. Infinite where the gradient may vanish, so that the brick may hold several sheets.
double most_stand_off(const GradientBounds& bounds, double voxel_size);

/// False where no vector of the gradients' bounds has an N.V of 0 or of a threshold.
bool may_hold_border(const GradientBounds& bounds, const Box& box, const Camera& camera, const std::vector<double>& thresholds);

/// needs_smaller_voxels for any surface: `bounds` are those of its gradient in the box and in reach of stencils beside it.
/// `border_needs(camera, pixels_per_unit)`: whether a border that these bounds cannot exclude asks for them.
template <class BorderNeeds>
bool pictures_need_smaller(const GradientBounds& bounds, const Box& box, double voxel_size, const LocalBrickSettings& settings,
                           const BorderNeeds& border_needs) {
  const Box reach = dilate(box, kStencilReach_voxels * voxel_size);
  const double off = most_stand_off(bounds, voxel_size);
  for (size_t k = 0; k < settings.local.cameras.size(); ++k) {
    const Camera& camera = settings.local.cameras[k];
    const double pixels_per_unit = pixels_per_unit_of(camera, box);
    if (pixels_per_unit < 0.0) continue;
    if (voxel_size * pixels_per_unit > kFolded_px && !(off * pixels_per_unit <= kLocalCoarse_px)) return true;
    if (settings.border && may_hold_border(bounds, reach, camera, settings.local.thresholds) &&
        !(k < settings.hidden.size() && is_hidden(settings.hidden[k], box, 2.0 * kLocalCoarse_px, pixels_per_unit)) &&
        border_needs(camera, pixels_per_unit))
      return true;
  }
  return false;
}

}  // namespace limn
