#pragma once

#include "raymarch/scene.h"

namespace limn {

/// An object of a scene from a Catmull-Clark cage.
inline SceneObject cage_object(const std::string& name, Mesh mesh, const glm::vec3& color) {
  return {.name = name, .source = MeshSource{std::move(mesh), Scheme::catmark, name}, .color = color};
}

}  // namespace limn
