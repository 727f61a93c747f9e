#pragma once
// The border that a model shows, at sub-pixel precision: its own rays decide, between the pixels too, so that neither the pixel grid nor
// a binary mask blunts the measurement.

#include "raymarch/border_curves.h"
#include "raymarch/gbuffer.h"

namespace limn {

/// Which border is measured, and how precisely.
struct MeasuredBorderSettings {
  double threshold = 0.4;       ///< Of the rim; 0: the silhouette alone. In [0, 1).
  double precision_px = 0.002;  ///< Crossings are bracketed to this.
};

/// The border of `model`. `gbuffer` is its picture of the pixel centres, seen by `camera`: what shows at no pixel centre nor changes
/// between two is not found. What is found is followed round corners and into tips, to 0.01 px, and to its ends.
BorderCurves measure_border(const SceneModel& model, const Camera& camera, const GBuffer& gbuffer, const MeasuredBorderSettings& settings,
                            const ExecutionSettings& how);

}  // namespace limn
