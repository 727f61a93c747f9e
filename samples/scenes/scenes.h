#pragma once
// Built-in scenes: one file a scene and one line in scenes/all_scenes.cpp.

#include <span>

#include "raymarch/scene.h"
#include "sdf/registry.h"

namespace limn {

struct SceneDescriptor {
  Description about;
  Scene (*make)();
};

/// A camera that looks at `target` from `direction` (any length) at `distance` (world): tighter than framing by bounds, in pictures at
/// least 4:3 wide.
CameraSettings look_at(const glm::dvec3& target, const glm::dvec3& direction, double distance);

const Registry<SceneDescriptor>& scenes();
/// Null where no scene has that name.
inline const SceneDescriptor* find_scene(const std::string& name) { return scenes().look_up(name); }

}  // namespace limn
