#pragma once
// Internal: the triangles of placed meshes, gathered into one mesh.

#include "subdiv/gltf/gltf_scene.h"
#include "subdiv/gltf/materials.h"
#include "subdiv/mesh.h"

namespace limn::gltf {

/// A mesh as it grows, and what was left out or repaired on the way.
struct Gathered {
  Mesh mesh{};
  Materials materials{};
  std::int64_t elements = 0;  ///< Vertices and corners so far.
  std::int64_t points_and_lines = 0, without_positions = 0, out_of_range = 0, left_over = 0, unused_attributes = 0;
  bool textures = false, skins = false, morphs = false, missing_material = false;
};

/// Adds one mesh where it stands.
void gather(Document& document, const PlacedMesh& placed, Gathered& all);

}  // namespace limn::gltf
