#pragma once
// Internal: surfaces in colour, before any ink.

#include "raymarch/border.h"
#include "raymarch/shading.h"

namespace limn {

/// Premultiplied; alpha 1 where something is hit, 0 everywhere with Shading::none. Reads the layers that layers_read(shading) names.
Image<glm::vec4> shade(const BorderInput& input, const ShadingSettings& shading);

/// Beside those of colours.
GBufferLayers layers_read(const ShadingSettings& shading);

/// As shade_headlight does, of one colour.
inline glm::vec4 headlight(const glm::vec3& color, float n_dot_v) { return glm::vec4(color * (0.25f + 0.75f * n_dot_v), 1.0f); }

/// Each pixel's colour: the object's, or the one that its file gives it.
Image<glm::vec3> base_colors(const BorderInput& input);

}  // namespace limn
