#pragma once
// Internal: a part of a G-buffer, drawn over what is there.

#include "raymarch/gbuffer.h"

namespace limn {

/// As render_gbuffer with all layers; pixels outside the window stay as they are. `out` has the picture's size.
void render_window(const SceneModel& model, const Camera& camera, const ExecutionSettings& how, glm::dvec2 offset, const PixelTile& window,
                   GBuffer& out);

}  // namespace limn
