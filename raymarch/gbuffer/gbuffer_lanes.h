#pragma once
// Internal: what a batch's hits show, lane by lane, as the layers of a G-buffer hold it.

#include "raymarch/gbuffer.h"
#include "raymarch/gbuffer/trace_scene.h"

namespace limn {

/// Lanes in which nothing is seen have infinite depth, no normal and no N.V. Four lanes in a row are four pixels in a row.
struct LaneLayers {
  alignas(64) float depth[kRayBatchSize];
  alignas(64) float n_dot_v[kRayBatchSize];
  alignas(64) glm::vec3 normal[kRayBatchSize];
};

/// What depth is measured along, and from where.
struct DepthAxis {
  glm::vec3 forward{0.0f};  ///< Unit.
  double shift = 0.0;       ///< From the eye (or its plane) to the rays' origins.
};

/// Of the layers named in `wanted`; the others stay as they are. rays.count is a multiple of 16.
void lane_layers(const RayBatch& rays, const SceneHits& found, const DepthAxis& axis, const GBufferLayers& wanted, LaneLayers& out);

}  // namespace limn
