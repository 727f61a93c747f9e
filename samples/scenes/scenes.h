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

std::span<const SceneDescriptor> scenes();
std::vector<std::string> scene_names();
/// Null where no scene has that name.
const SceneDescriptor* find_scene(const std::string& name);

}  // namespace limn
