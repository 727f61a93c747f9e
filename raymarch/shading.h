#pragma once
// How surfaces are coloured beneath the ink.

#include <glm/glm.hpp>
#include <optional>

#include "sdf/descriptor.h"
#include "sdf/registry.h"

namespace limn {

/// See shadings() for what each does.
enum class Shading { headlight, flat, cel, soft, normal, none };

/// A shading by name.
struct ShadingDescriptor {
  Description about{};                   ///< Name, help and source.
  Shading shading = Shading::headlight;  ///< Which.
};
/// All of them, in the order of help.
const Registry<ShadingDescriptor>& shadings();

/// How surfaces are coloured.
struct ShadingSettings {
  Shading shading = Shading::headlight;  ///< By what.
  int steps = 3;                         ///< Of `cel`, 2..16: tones from shadow to light.
  double rim_light = 0.0;                ///< Of `cel`: N.V below which a lit edge is light; 0: none.
  double occlusion = 0.0;                ///< Of `soft`, 0..1: how much darker hollows are, as far as the picture shows what encloses them.
  std::optional<glm::vec3> color{};      ///< Linear, of all objects; unset: their own, and those of files.
};

}  // namespace limn
