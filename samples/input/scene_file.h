#pragma once
// The scene file (TOML). Every key that nobody reads is an InputError with file:line:column and the nearest known key.

#include <filesystem>
#include <functional>

#include "samples/input/input.h"
#include "sdf/vm_field.h"
#include "subdiv/import.h"

namespace limn {

/// Reads a scene file and the meshes and volumes it names (relative to it). Throws InputError.
SceneInput load_scene_file(const std::filesystem::path& file);

/// How the files that a scene names are read.
struct SceneReaders {
  /// For mesh = "FILE".
  std::function<Mesh(const std::filesystem::path& file)> mesh = [](const auto& file) { return load_mesh(file); };
  /// For volume files; `grid` as for read_level_set().
  std::function<LevelSet(const std::filesystem::path& file, const std::string& grid)> volume = [](const auto& file, const auto& grid) {
    return read_level_set(file, grid);
  };
  /// For vm = "FILE".
  std::function<Field(const std::filesystem::path& file)> vm = [](const auto& file) { return load_vm(file).field; };
};

/// The same from text; `file` goes into messages and its folder is where relative paths start.
SceneInput parse_scene_file(const std::string& text, const std::filesystem::path& file, const SceneReaders& readers = {});

}  // namespace limn
