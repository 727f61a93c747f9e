#pragma once
// Internal: which nodes of a glTF document are drawn, and where they stand.

#include <vector>

#include "subdiv/gltf/document.h"

namespace limn::gltf {

/// A node that has a mesh. Meshes that no node places are given by themselves (`node` is then nullopt).
struct PlacedMesh {
  std::optional<size_t> node{};
  std::uint64_t mesh = 0;
  glm::dmat4 world_from_mesh{1.0};
};

/// Those of the file's scene, without one those of its first, without scenes those of all nodes, in the file's order. Refuses nodes that
/// hold each other.
std::vector<PlacedMesh> placed_meshes(Document& document);

}  // namespace limn::gltf
