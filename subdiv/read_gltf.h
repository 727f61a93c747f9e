#pragma once
// glTF 2.0 (Khronos, ISO/IEC 12113): .gltf and .glb.

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>

#include "subdiv/mesh.h"

namespace limn {

/// The scene's triangles as one mesh in the scene's axes; its warnings tell what was repaired or left out. Colours: those of the materials
/// (baseColorFactor) and of the vertices (COLOR_0), no textures. Nothing where the file is glTF 1.0. Throws InputError, in which
/// the file's own name is missing. Buffers are read from the file's folder.
std::optional<Mesh> read_gltf(const std::filesystem::path& file, std::int64_t max_elements);
std::optional<Mesh> parse_gltf(std::span<const std::byte> bytes, const std::filesystem::path& folder, std::int64_t max_elements);

}  // namespace limn
