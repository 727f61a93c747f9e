#pragma once
// Internal: a batch of rays against all surfaces of a model.

#include <vector>

#include "raymarch/gbuffer.h"
#include "raymarch/surface.h"
#include "sdf/camera.h"

namespace limn {

/// Samples of a picture that are traced together, at most.
inline constexpr size_t kMostSamples = 8;

/// The sphere about the render origin that holds every bounded surface.
struct SceneExtent {
  double radius = 0.0;
  bool bounded = true;  ///< Every surface is.
};
SceneExtent scene_extent(const SceneModel& model);

/// The nearest hits over all objects. hits.status is set in every lane, the rest where something was hit or steps ran out.
struct SceneHits {
  HitBatch hits;
  std::int32_t object[kRayBatchSize];  ///< Index from 0; -1: nothing hit.
};

/// The surfaces, prepared for a picture: one view for each, without a trace of its own where there is nothing to prepare.
struct ModelView {
  std::vector<SurfaceView> surfaces{};
  std::vector<PixelTile> covered{};  ///< The pixels that each surface's bounds cover in the picture.
  std::vector<char> turned{};        ///< As turned_surfaces.
  /// Of many surfaces, those that reach into each cell of the picture, in order: a tile of thousands shows few. Empty: every tile asks all.
  int columns = 0;
  std::vector<std::vector<std::uint32_t>> cells{};
};
ModelView view_model(const SceneModel& model, const ViewRequest& request);
/// False where no surface can be seen in the tile.
bool touches(const ModelView& view, const PixelTile& tile);

/// Shortens rays.t_max to the hits. A ray that ran out of steps hides what lies behind that point: nobody knows what is there. Normals of
/// surfaces that are `turned` (empty: none) point towards the ray's origin.
void trace_scene(const SceneModel& model, std::span<const char> turned, PointRays how, RayBatch& rays, SceneHits& found);
/// Of a tile's pixels; `found` has one for each of `rays`, which are several samples only where all surfaces trace them together.
void trace_scene(const SceneModel& model, const ModelView& view, const PixelTile& tile, std::span<RayBatch> rays,
                 std::span<SceneHits> found);

}  // namespace limn
