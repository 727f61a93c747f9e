// Scenes: read, built in, or put together from fields, meshes and level sets; and their models.

#include <pybind11/stl.h>

#include <cmath>

#include "raymarch/scene/scene_extent.h"
#include "raymarch/surface/view_level.h"
#include "samples/experiment/flat_input.h"
#include "samples/experiment/job.h"
#include "samples/experiment/limits.h"
#include "samples/experiment/local_request.h"
#include "samples/experiment/no_effect.h"
#include "samples/experiment/thread_settings.h"
#include "samples/experiment/warnings.h"
#include "samples/python/arrays.h"
#include "samples/python/bindings.h"
#include "samples/spec/parse.h"
#include "samples/spec/utf8.h"
#include "sdf/error.h"

namespace limn::python {
namespace {

namespace py = pybind11;

using SceneClass = py::class_<SceneObjectOfPython, std::shared_ptr<SceneObjectOfPython>>;

std::string type_name(const py::handle& object) { return py::str(py::type::of(object).attr("__name__")).cast<std::string>(); }

/// One object, as limn.Object describes it.
SceneObject object_of(const py::dict& given) {
  SceneObject object{.name = valid_utf8(given["name"].cast<std::string>()), .source = MeshSource{}};
  const py::object source = given["source"];
  const std::string scheme = given["scheme"].cast<std::string>();
  if (py::isinstance<Field>(source)) {
    object.source = source.cast<Field>();
  } else if (py::isinstance<SharedMesh>(source)) {
    const auto mesh = source.cast<SharedMesh>();
    object.source = mesh_source(*mesh, scheme.empty() ? std::optional<Scheme>() : parse_scheme(scheme, "", "scheme"), "");
  } else if (py::isinstance<LevelSet>(source)) {
    object.source = LevelSetSource{source.cast<LevelSet>()};
  } else {
    throw InputError({"", "source", type_name(source), "cannot be an object", "a Field, a Mesh or a LevelSet"});
  }
  const glm::dvec3 color = vector_of(given["color"], "color");
  object.color = glm::vec3(color);
  object.material = given["material"].cast<int>();
  if (!given["level"].is_none()) object.level = parse_integer("level", py::str(given["level"]).cast<std::string>(), 0, 8);
  return object;
}

std::shared_ptr<SceneObjectOfPython> scene_of(const std::string& name, const std::vector<py::dict>& objects) {
  auto scene = std::make_shared<SceneObjectOfPython>();
  scene->source = valid_utf8(name);
  // Of a kind whose objects are all there is to know of it: no file stands behind them.
  scene->input.kind = InputKind::mesh;
  scene->input.name = scene->source;
  scene->input.scene.name = scene->source;
  for (const py::dict& object : objects) scene->input.scene.objects.push_back(object_of(object));
  if (objects.empty()) throw InputError({"", "objects", "", "a scene without objects", "at least one Field, Mesh or LevelSet"});
  run_unlocked([&](const Stopped&) { check_extent(scene->input.scene); });
  return scene;
}

std::shared_ptr<SceneObjectOfPython> read_scene(const std::string& file, const CallFields& fields) {
  CallSettings settings;
  read_fields(fields, settings);
  settings.spec.input = file;
  return call_unlocked([&](const Stopped&) {
    auto scene = std::make_shared<SceneObjectOfPython>();
    scene->source = file;
    scene->input = load_input(settings.spec);
    return scene;
  });
}

py::list objects_of(const SceneObjectOfPython& scene) {
  py::list objects;
  for (const SceneObject& object : scene.input.scene.objects) {
    py::object source;
    if (const auto* field = std::get_if<Field>(&object.source)) source = py::cast(*field);
    if (const auto* mesh = std::get_if<MeshSource>(&object.source)) source = py::cast(mesh->mesh);
    if (const auto* volume = std::get_if<LevelSetSource>(&object.source)) source = py::cast(volume->level_set);
    objects.append(py::make_tuple(object.name, source, py::make_tuple(object.color.r, object.color.g, object.color.b), object.material));
  }
  return objects;
}

py::dict info_of(const ModelOfPython& model) {
  const SurfaceInfo info = total(model.model);
  py::dict out;
  out["kind"] = info.kind;
  out["voxels"] = info.voxels;
  out["voxel_size"] = info.voxel_size;
  out["triangles"] = info.triangles;
  out["bytes"] = info.bytes;
  out["build_ms"] = info.build_ms;
  return out;
}

std::shared_ptr<const ModelOfPython> build(const py::object& given, const CallFields& fields) {
  const Source source = source_of(given);
  CallSettings settings;
  read_fields(fields, settings);
  return call_unlocked([&](const Stopped& stopped) {
    const ThreadLimit threads(settings.spec.threads);
    return model_for(source, settings, stopped);
  });
}

}  // namespace

Source source_of(const py::object& given) {
  Source source;
  if (py::isinstance<py::str>(given)) {
    source.name = given.cast<std::string>();
  } else if (py::isinstance<SceneObjectOfPython>(given)) {
    source.scene = given.cast<std::shared_ptr<SceneObjectOfPython>>();
  } else if (py::isinstance<ModelOfPython>(given)) {
    source.model = given.cast<std::shared_ptr<ModelOfPython>>();
  } else {
    throw InputError(
        {"", "scene", type_name(given), "cannot be drawn", "a file, a built-in scene's name, a Scene, a Field, a Mesh or a LevelSet"});
  }
  return source;
}

SceneInput load_source(const Source& source, ExperimentSpec& spec, std::vector<std::string>& warnings) {
  const SceneObjectOfPython* const there = source.model ? &source.model->scene : source.scene.get();
  if (there == nullptr) {
    spec.input = source.name;
    SceneInput input = load_input(spec);
    warnings.insert(warnings.end(), input.left_out.begin(), input.left_out.end());
    return input;
  }
  spec.input = there->source;
  if (!spec.grids.empty())
    throw InputError({"", "grids", spec.grids.front(), "has no effect: the scene is read already", "a file's name in place of the scene"});
  SceneInput input = there->input;
  // What load_input does with a mesh's file.
  for (SceneObject& object : input.scene.objects)
    if (auto* mesh = std::get_if<MeshSource>(&object.source); mesh != nullptr && spec.surface.scheme) mesh->scheme = spec.surface.scheme;
  return input;
}

std::shared_ptr<const ModelOfPython> model_for(const Source& source, CallSettings& settings, const Stopped& stopped) {
  ExperimentSpec& spec = settings.spec;
  if (source.model) {
    const SurfaceSpec& surface = spec.surface;
    const bool any = !spec.surfaces.empty() || surface.voxels || surface.voxel_size || surface.half_width_voxels || surface.gradient ||
                     surface.level || surface.level_for_view || surface.scheme || surface.normals || surface.smooth_angle_deg ||
                     settings.local_px;
    if (any) throw InputError({"", "surface", "", "has no effect: the model is built already", "settings of the surface in limn.model()"});
    spec.input = source.model->scene.source;
    return source.model;
  }
  auto model = std::make_shared<ModelOfPython>();
  model->scene.input = load_source(source, spec, model->warnings);
  SceneInput& input = model->scene.input;
  model->scene.source = spec.input;
  model->settings = surface_settings(spec, input);
  model->settings.progress = stop_at_progress(stopped);
  if (settings.local_px && model->settings.kind.empty()) model->settings.kind = "mesh";
  if (settings.local_px) refuse_local_without_effect(spec, input.scene, model->settings, {model->settings.kind});
  refuse_without_effect(spec.surface, input, {.kinds = {model->settings.kind}});
  // Before anything is built: a camera that is wrong, and what would not fit.
  model->framed = framed_input(spec.camera, input);
  const Camera camera =
      camera_of_view(camera_settings(spec.camera, input), model->framed, framing_settings(spec.camera), settings.view, spec.views);
  model->local_px = settings.local_px.value_or(0.0);
  ObjectMeshCache meshes;
  // A local level set says itself when it needs too much: what it takes is not known before.
  if (!settings.local_px || !has_local_bricks(model->settings.kind))
    check_limits(spec.limits, input.scene, model->settings, picture_load(camera, picture_settings(spec.border, input), {}),
                 {.meshes = &meshes});
  if (spec.surface.level_for_view) model->notes = refine_for_views(model->settings, {&camera, 1}, input.scene, &meshes);
  model->mostly_flat = input.kind != InputKind::built_in && flat_share(input.scene, model->settings) > kMostlyFlat;
  // Once, for however many pictures.
  const std::vector<std::string> found = warnings_of(input.scene, model->settings, {.methods = names_of(method_calls(spec.border, input))});
  model->warnings.insert(model->warnings.end(), found.begin(), found.end());
  model->model = settings.local_px
                     ? build_local_model(input.scene, model->settings,
                                         local_settings(*settings.local_px, false, method_calls(spec.border, input), {camera}), &meshes)
                     : build_model(input.scene, model->settings, &meshes);
  model->settings.progress = {};
  const SurfaceInfo info = total(model->model);
  model->warnings.insert(model->warnings.end(), info.warnings.begin(), info.warnings.end());
  model->notes.insert(model->notes.end(), info.notes.begin(), info.notes.end());
  return model;
}

void bind_scenes(py::module_& module) {
  SceneClass(module, "Scene", "Objects and a camera, before anybody has decided how to model them. Never changes.")
      .def_property_readonly(
          "name", [](const SceneObjectOfPython& scene) { return scene.input.name; }, "For captions.")
      .def_property_readonly(
          "bounds", [](const SceneObjectOfPython& scene) { return array_of(bounds(scene.input.scene)); },
          "Of all objects, world units: (2, 3).")
      .def("_objects", objects_of);
  py::class_<ModelOfPython, std::shared_ptr<ModelOfPython>>(module, "Model", "A scene as it is modelled, for several pictures of it.")
      .def_property_readonly("info", info_of, "Kind, voxels, voxel_size (world units), triangles, bytes, build_ms.")
      .def_property_readonly(
          "warnings", [](const ModelOfPython& model) { return model.warnings; }, "What a person should know before trusting it.")
      .def_property_readonly(
          "notes", [](const ModelOfPython& model) { return model.notes; }, "What is good to know.");
  module.def("scene_of", scene_of);
  module.def("read_scene", read_scene);
  module.def("build", [](const py::object& scene, const CallFields& fields) {
    return std::const_pointer_cast<ModelOfPython>(build(scene, fields));
  });
}

}  // namespace limn::python
