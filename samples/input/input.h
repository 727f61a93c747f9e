#pragma once
// What an experiment is made on, whatever it is: a scene file, a mesh, a volume, a formula (.vm) or the name of a built-in scene.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "raymarch/scene.h"
#include "samples/spec/spec.h"
#include "sdf/descriptor.h"
#include "subdiv/refine.h"

namespace limn {

/// One [border] of a scene file: a method and the parameters it sets.
struct BorderDefaults {
  std::string method;                                ///< A name in border_methods().
  std::map<std::string, ParameterInput> parameters;  ///< By name, as the file has them.
};

/// What an INPUT is: by its extension, or a name that is no file.
enum class InputKind { scene_file, mesh, level_set, field, built_in };

/// An input, read: its scene and what its file says of how to draw it.
struct SceneInput {
  InputKind kind = InputKind::scene_file;  ///< See InputKind.
  std::string name;                     ///< Of the built-in scene, or the file's without folder and extension: names the default outputs.
  std::string file;                     ///< As given; empty for a built-in scene.
  Scene scene;                          ///< With all meshes and volumes loaded.
  SurfaceSpec surface;                  ///< [surface] of a scene file: what it says and nothing else.
  std::vector<BorderDefaults> borders;  ///< The [[border]] tables of a scene file, in order.
  std::vector<std::string> formulas;    ///< The .vm files that a scene file names, as found.
  double load_ms = 0.0;                 ///< Time of reading it.
  std::vector<std::string> left_out{};  ///< Grids of a volume that were not asked for by name and cannot be drawn, with the reasons.
};

/// What an INPUT is, before anything of it is read. Throws InputError: nothing of that name, a folder, an unknown extension.
InputKind input_kind(const std::string& input);

/// Reads `spec.input`. Its grids, and its surface's scheme and level, go into what they mean for a file of that kind:
/// a mesh is drawn as it is unless one of the latter two, or crease and corner tags in the file, make it a subdivision cage.
SceneInput load_input(const ExperimentSpec& spec);

}  // namespace limn
