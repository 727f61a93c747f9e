#pragma once

#include <filesystem>

#include "sdf/guard.h"
#include "subdiv/mesh.h"

namespace limn {

struct ImportSettings {
  GuardLimits limits;
  std::int64_t max_elements = 200'000'000;  ///< Vertices plus corners; more is refused.
};

/// Reads .obj (n-gons, `t crease / corner / interpolateboundary` tags, materials, groups, vertex colours; double precision), and
/// .ply, .stl, .off, .gltf, .glb through assimp (parts joined with their transforms; STL vertices welded by equal position, since the
/// format has no indices). assimp reads in a guarded child process, .obj is read by our own reader; the result is validated.
/// Throws InputError: no such file, a folder, empty, unknown extension, damaged, no faces, non-finite vertices, indices out of range.
Mesh load_mesh(const std::filesystem::path& file, const ImportSettings& settings = {});

/// True for the extensions above (case does not matter).
bool is_mesh_file(const std::filesystem::path& file);

/// Writes .obj (n-gons; normals where present; creases and corners as tags) or .ply (binary little-endian); whole or not at all.
void write_mesh(const Mesh& mesh, const std::filesystem::path& file);

}  // namespace limn
