#pragma once
// Internal: a part of a G-buffer, drawn over what is there; and pixels that are used as soon as they are traced.

#include "raymarch/gbuffer.h"

namespace limn {

/// As render_gbuffer with all layers; pixels outside the window stay as they are. `out` has the picture's size.
void render_window(const SceneModel& model, const Camera& camera, const ExecutionSettings& how, glm::dvec2 offset, const PixelTile& window,
                   GBuffer& out);

/// Pixels that one thread has just traced: a few tiles side by side.
struct TracedPixels {
  const GBuffer& layers;  ///< Their layers, in the cache.
  glm::ivec2 first{0};    ///< Of the picture: where `layers` begins.
  PixelTile pixels{};     ///< Of the picture.
  bool seen = false;      ///< False where no surface can be seen in any of them; then `layers` must not be read.
};
using PixelWork = std::function<void(const TracedPixels&)>;

/// Tasks are so many tiles wide and one tile high.
inline constexpr int kTilesInARow = 8;

/// As render_gbuffer, and calls `work` once for each pixel, from many threads at a time. Unless the layers are kept, `out` has no layers
/// in the end: those of a task last as long as its work.
void render_pixels(const SceneModel& model, const Camera& camera, const ExecutionSettings& how, glm::dvec2 offset,
                   const GBufferLayers& layers, bool kept, const PixelWork& work, GBuffer& out);

}  // namespace limn
