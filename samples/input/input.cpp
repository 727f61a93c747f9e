#include "samples/input/input.h"

#include <algorithm>
#include <chrono>

#include "raymarch/scene/scene_extent.h"
#include "samples/input/scene_file.h"
#include "samples/scenes/scenes.h"
#include "samples/spec/utf8.h"
#include "sdf/error.h"
#include "sdf/guard.h"
#include "sdf/level_set_grids.h"
#include "sdf/vm_field.h"
#include "subdiv/import.h"

namespace limn {
namespace {

constexpr const char* kExpected = "a scene .toml, a mesh .obj .ply .stl .off .gltf .glb, a volume .vdb .nvdb or a formula .vm";

std::string extension_of(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

SceneInput from_mesh(const ExperimentSpec& spec) {
  std::optional<Scheme> scheme = spec.surface.scheme;
  Mesh mesh = load_mesh(spec.input);
  if (!scheme && spec.surface.level && *spec.surface.level > 0) scheme = default_scheme(mesh);
  SceneInput input;
  input.scene.objects.push_back(
      {.name = std::filesystem::path(spec.input).stem().string(), .source = mesh_source(std::move(mesh), scheme, spec.input)});
  return input;
}

/// Every grid an object of its own.
SceneInput from_volume(const ExperimentSpec& spec) {
  const std::string stem = std::filesystem::path(spec.input).stem().string();
  SceneInput input;
  ReadLevelSets read = read_level_sets(spec.input, spec.grids);
  for (NamedLevelSet& grid : read.grids)
    input.scene.objects.push_back(
        {.name = grid.level_set.info().name.empty() ? stem : grid.name, .source = LevelSetSource{std::move(grid.level_set), spec.input}});
  input.left_out = std::move(read.left_out);
  return input;
}

SceneInput from_vm(const ExperimentSpec& spec) {
  VmField vm = load_vm(spec.input);
  if (!vm.unbounded.empty())
    throw InputError({spec.input, "", "", vm.unbounded,
                      "a bounded surface; a scene file can cut it: [[object]] with csg = \"intersection\" of { vm = \"" +
                          std::filesystem::path(spec.input).filename().string() + "\" } and { shape = \"box\" }"});
  SceneInput input;
  input.scene.objects.push_back({.name = std::filesystem::path(spec.input).stem().string(), .source = std::move(vm.field)});
  return input;
}

}  // namespace

InputKind input_kind(const std::string& input) {
  if (find_scene(input) != nullptr) return InputKind::built_in;
  const std::filesystem::path path(input);
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) throw InputError({input, "", "", "is a folder", kExpected});
  const std::string extension = extension_of(path);
  const bool exists = std::filesystem::exists(path, ignored);
  if (!exists && extension.empty()) {
    throw InputError({input, "", "", "no such file and no built-in scene of that name", known_names(input, scenes().names())});
  }
  if (extension == ".toml") return InputKind::scene_file;
  if (extension == ".vdb" || extension == ".nvdb") return InputKind::level_set;
  if (extension == ".vm") return InputKind::field;
  if (is_mesh_file(path)) return InputKind::mesh;
  throw InputError({input, "", extension, exists ? "unknown kind of file" : "no such file", kExpected});
}

SceneInput load_input(const ExperimentSpec& spec) {
  const auto start = std::chrono::steady_clock::now();
  const InputKind kind = input_kind(spec.input);
  if (!spec.grids.empty() && kind != InputKind::level_set) {
    throw InputError({"", "grids", spec.grids.front(), "the input has no grids", "a volume .vdb or .nvdb as INPUT"});
  }
  SceneInput input;
  switch (kind) {
    case InputKind::scene_file:
      input = load_scene_file(spec.input);
      break;
    case InputKind::mesh:
      input = from_mesh(spec);
      break;
    case InputKind::level_set:
      input = from_volume(spec);
      break;
    case InputKind::field:
      input = from_vm(spec);
      break;
    case InputKind::built_in:
      input.scene = find_scene(spec.input)->make();
      break;
  }
  input.kind = kind;
  input.name = kind == InputKind::built_in ? spec.input : std::filesystem::path(spec.input).stem().string();
  input.file = kind == InputKind::built_in ? "" : spec.input;
  input.scene.name = valid_utf8(input.name);
  for (SceneObject& object : input.scene.objects) object.name = valid_utf8(object.name);
  check_extent(input.scene);
  input.load_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return input;
}

}  // namespace limn
