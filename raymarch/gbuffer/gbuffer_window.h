#pragma once
// Internal: a part of a G-buffer, drawn over what is there; and pixels that are used as soon as they are traced.

#include "raymarch/gbuffer.h"

namespace limn {

/// As render_gbuffer with all layers; pixels outside the window stay as they are. `out` has the picture's size.
void render_window(const SceneModel& model, const Camera& camera, const ExecutionSettings& how, glm::dvec2 offset, const PixelTile& window,
                   GBuffer& out);

/// Tasks are so many tiles wide and one tile high.
inline constexpr int kTilesInARow = 8;

/// Pixels that one thread has just traced: a few tiles side by side.
struct TracedPixels {
  const GBuffer& layers;  ///< Their layers, in the cache.
  glm::ivec2 first{0};    ///< Of the picture: where `layers` begins.
  const PixelTile& task;  ///< Of the picture: what they are some of.
  Image<float>& sums;     ///< Of the task, for what adds up its rays, of any size: empty at first, and gone with the task.
  PixelTile pixels{};     ///< Of the picture.
  bool seen = false;      ///< False where no surface can be seen in any of them; then `layers` must not be read.
};
using PixelWork = std::function<void(const TracedPixels&)>;

/// One ray of each pixel, and what is done with what it hits.
struct PixelRays {
  glm::dvec2 offset{0.5, 0.5};  ///< Where in its pixel it goes.
  GBufferLayers layers{};
  bool kept = false;       ///< Else `out` has no layers in the end: those of a task last as long as its work.
  PixelWork work{};        ///< Called once for each pixel, from many threads at a time; not empty.
  GBuffer* out = nullptr;  ///< Of the whole picture; not null. Several whose layers are not kept may share one.
};

/// As render_gbuffer for each of `rays`, which one thread traces one after the other in each task: what adds them up needs memory for tasks
/// alone.
void render_pixels(const SceneModel& model, const Camera& camera, const ExecutionSettings& how, std::span<const PixelRays> rays);

}  // namespace limn
