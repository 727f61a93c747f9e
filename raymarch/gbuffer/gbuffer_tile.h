#pragma once
// Internal: a tile's hits into the layers of a G-buffer that are there, each pixel written once.

#include "raymarch/gbuffer.h"
#include "raymarch/gbuffer/picture_rays.h"
#include "raymarch/gbuffer/trace_scene.h"

namespace limn {

struct TileWriter {
  GBuffer* out = nullptr;
  const SceneModel* model = nullptr;
  double shift = 0.0;       ///< From the eye (or its plane) to the rays' origins.
  glm::vec3 forward{0.0f};  ///< Unit.
};

inline TileWriter tile_writer(const SceneModel& model, const PictureRays& rays, GBuffer& out) {
  return {&out, &model, rays.shift, glm::vec3(rays.forward)};
}

/// Layers without pixels are left alone.
void write_tile(const TileWriter& writer, const PixelTile& tile, const RayBatch& rays, const SceneHits& found);
/// Pixels in which nothing is seen: a tile, or several in a row. Large pictures are written past the caches.
void write_nothing(const TileWriter& writer, const PixelTile& pixels);

}  // namespace limn
