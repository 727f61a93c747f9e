#pragma once
// What a call reads is not what it writes over.

#include <filesystem>
#include <string>
#include <vector>

#include "samples/input/input.h"

namespace limn {

/// The files that an input was read from: the scene file, and the meshes and volumes that it names. Nothing for a built-in scene.
std::vector<std::filesystem::path> files_of(const SceneInput& input);

/// Throws InputError where `file` is one of the `inputs`, by whatever name or link.
void check_not_input(const std::filesystem::path& file, const std::vector<std::filesystem::path>& inputs);
/// Throws InputError where one of the `inputs` lies in `folder`, which `who` empties.
void check_not_holding_input(const std::filesystem::path& folder, const std::vector<std::filesystem::path>& inputs, const std::string& who);

}  // namespace limn
