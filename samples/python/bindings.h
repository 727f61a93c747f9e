#pragma once
// The parts of the module; each adds its classes and functions.

#include <pybind11/pybind11.h>

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "raymarch/framing.h"
#include "raymarch/scene.h"
#include "raymarch/surface.h"
#include "samples/input/input.h"
#include "samples/python/call_fields.h"
#include "samples/python/run_call.h"

namespace limn::python {

/// In this order: later ones name the types of earlier ones.
void bind_errors(pybind11::module_& module);
void bind_fields(pybind11::module_& module);
void bind_meshes(pybind11::module_& module);
void bind_level_sets(pybind11::module_& module);
void bind_scenes(pybind11::module_& module);
void bind_pictures(pybind11::module_& module);
void bind_borders(pybind11::module_& module);
void bind_lines(pybind11::module_& module);
void bind_comparisons(pybind11::module_& module);
void bind_studies(pybind11::module_& module);
void bind_judge(pybind11::module_& module);
void bind_lists(pybind11::module_& module);

/// A scene that was made or read before the call.
struct SceneObjectOfPython {
  SceneInput input{};
  std::string source{};  ///< As the call names it: a file, a built-in scene or a name.
};

/// A scene that is modelled already.
struct ModelOfPython {
  SceneObjectOfPython scene{};
  SurfaceSettings settings{};
  SceneModel model{};
  std::vector<std::string> warnings{}, notes{};
  FramedSurface framed{};    ///< What cameras frame where the call leaves that open.
  bool mostly_flat = false;  ///< A rim would ink whole faces.
  double local_px = 0.0;     ///< Of a local model its tolerance; else 0.
};

/// What a call draws or measures: exactly one is set.
struct Source {
  std::string name{};  ///< A file or a built-in scene, read by the call.
  std::shared_ptr<const SceneObjectOfPython> scene{};
  std::shared_ptr<const ModelOfPython> model{};
};
/// From a str, a Scene or a Model. Throws InputError.
Source source_of(const pybind11::object& given);

/// The call's scene; reads it where it is a name, which goes into `spec.input`. Grids that were left out go into `warnings`.
SceneInput load_source(const Source& source, ExperimentSpec& spec, std::vector<std::string>& warnings);

/// A model for the call: the source's own, which must not be given surface settings, or a new one.
std::shared_ptr<const ModelOfPython> model_for(const Source& source, CallSettings& settings, const Stopped& stopped);

}  // namespace limn::python
