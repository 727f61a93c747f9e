#pragma once
// Meshes that break methods, made by name: for cases that are too large to be written down.

#include <span>

#include "sdf/registry.h"
#include "subdiv/mesh.h"

namespace limn {

struct MeshMaker {
  Description about{};
  std::vector<Parameter> parameters{};
  Mesh (*make)(const Parameters& parameters);
};

const Registry<MeshMaker>& mesh_makers();
inline const MeshMaker& find_mesh_maker(const std::string& name, const std::string& file = {}, const std::string& field = {}) {
  return mesh_makers().find(name, file, field);
}

}  // namespace limn
