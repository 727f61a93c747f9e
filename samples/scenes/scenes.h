#pragma once
// Built-in scenes: one file a scene and one line in scenes/registry.cpp.

#include <span>

#include "raymarch/scene.h"
#include "sdf/descriptor.h"

namespace limn {

struct SceneDescriptor {
  Description about;
  Scene (*make)();
};

/// A camera that looks at `target` from `direction` (any length) at `distance` (world): tighter than framing by bounds, in pictures at
/// least 4:3 wide.
CameraSettings look_at(const glm::dvec3& target, const glm::dvec3& direction, double distance);

std::span<const SceneDescriptor> scenes();
std::vector<std::string> scene_names();
/// Null where no scene has that name.
const SceneDescriptor* find_scene(const std::string& name);

}  // namespace limn
