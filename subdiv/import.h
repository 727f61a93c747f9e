#pragma once
// Mesh files in and out.

#include <filesystem>

#include "sdf/guard.h"
#include "subdiv/mesh.h"

namespace limn {

/// What reading a mesh may take.
struct ImportSettings {
  GuardLimits limits;                       ///< Of the child process that reads .gltf and .glb.
  std::int64_t max_elements = 200'000'000;  ///< Vertices plus corners; more is refused.
};

/// Reads .obj, .ply, .stl and .off in this process (subdiv/read_obj.h and its neighbours), .gltf and .glb in a guarded
/// child process (parts joined with their transforms). Positions keep double precision; what a reader repaired, dropped or ignored is in
/// Mesh::warnings. The result is validated.
/// Throws InputError: no such file, a folder, empty, unknown extension, damaged, cut short, no faces, non-finite vertices.
Mesh load_mesh(const std::filesystem::path& file, const ImportSettings& settings = {});

/// True for the extensions above (case does not matter).
bool is_mesh_file(const std::filesystem::path& file);

/// Writes .obj (n-gons; normals where present; creases and corners as tags) or .ply (binary little-endian); whole or not at all.
void write_mesh(const Mesh& mesh, const std::filesystem::path& file);

}  // namespace limn
