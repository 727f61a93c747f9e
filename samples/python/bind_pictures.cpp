// Pictures: drawn, looked at layer by layer without copies, written.

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "raymarch/image_output.h"
#include "raymarch/look.h"
#include "samples/experiment/empty_picture.h"
#include "samples/experiment/flat_input.h"
#include "samples/experiment/job.h"
#include "samples/experiment/thread_settings.h"
#include "samples/output/output.h"
#include "samples/python/arrays.h"
#include "samples/python/bindings.h"
#include "sdf/error.h"

namespace limn::python {
namespace {

namespace py = pybind11;

/// A picture and how it came about.
struct DrawnPicture {
  Picture picture{};
  Camera camera{};
  std::string call{};  ///< With nothing left open, as files carry it.
  SurfaceInfo info{};
  HitCounts counts{};
  std::vector<std::string> warnings{};
  std::optional<glm::vec3> ground{};  ///< Behind pictures to be looked at, linear; the layers keep their alpha.
};

/// As the command line has it: a picture of which nobody says more is one to be looked at, and what is mostly flat is drawn by its lines.
void set_defaults(const ModelOfPython& model, CallSettings& settings) {
  constexpr int kSamples = 8;
  BorderSpec& border = settings.spec.border;
  if (!settings.samples_given) border.samples = kSamples;
  const bool named = !border.methods.empty() || border.look || !border.parameters.empty() || !model.scene.input.borders.empty();
  if (!named && model.mostly_flat) border.methods = {kMethodOfFlat};
}

std::optional<glm::vec3> ground_of(const CallSettings& settings) {
  if (settings.transparent || settings.ink_only || settings.spec.border.background) return {};
  return settings.spec.border.look ? looks().find(*settings.spec.border.look).ground : glm::vec3(1.0f);
}

Image<glm::vec4> over_ground(const DrawnPicture& drawn) {
  Image<glm::vec4> picture = drawn.picture.composite;
  for (glm::vec4& pixel : picture.pixels) pixel += (1.0f - pixel.a) * glm::vec4(*drawn.ground, 1.0f);
  return picture;
}

std::shared_ptr<DrawnPicture> draw(const Source& source, CallSettings& settings, const Stopped& stopped) {
  const ThreadLimit threads(settings.spec.threads);
  const std::shared_ptr<const ModelOfPython> model = model_for(source, settings, stopped);
  const SceneInput& input = model->scene.input;
  auto drawn = std::make_shared<DrawnPicture>();
  drawn->warnings = model->warnings;
  set_defaults(*model, settings);
  PictureSettings picture = picture_settings(settings.spec.border, input);
  picture.mattes = settings.mattes;
  drawn->ground = ground_of(settings);
  const CameraSpec& camera = settings.spec.camera;
  // A built-in scene's own camera frames other points than one that the call turns.
  const FramedSurface framed = input.kind == InputKind::built_in ? framed_input(camera, input) : model->framed;
  drawn->camera = camera_of_view(camera_settings(camera, input), framed, framing_settings(camera), settings.view, settings.spec.views);
  drawn->picture = draw_picture(input.scene, model->model, drawn->camera, picture, execution_of(settings.spec.threads, stopped));
  drawn->picture.notes.insert(drawn->picture.notes.begin(), model->notes.begin(), model->notes.end());
  drawn->info = total(model->model);
  drawn->counts = count_hits(drawn->picture.gbuffer);
  for (std::string& reason : why_empty(input.scene, model->model, drawn->camera, drawn->counts))
    drawn->warnings.push_back(std::move(reason));
  drawn->call = resolved_call("render", settings.spec, {input.scene, model->settings, {model->settings.kind}, model->local_px},
                              drawn->camera, picture);
  return drawn;
}

std::shared_ptr<DrawnPicture> render(const py::object& scene, const CallFields& fields) {
  const Source source = source_of(scene);
  CallSettings settings;
  read_fields(fields, settings);
  return call_unlocked([&](const Stopped& stopped) { return draw(source, settings, stopped); });
}

void write(const DrawnPicture& drawn, const std::filesystem::path& file) {
  check_output_file(file, false, {".exr", ".png", ".tif", ".tiff", ".jpg", ".jpeg"});
  run_unlocked([&](const Stopped&) {
    if (ending_of(file) == ".exr")
      write_exr(drawn.picture, drawn.camera, drawn.call, file);
    else
      write_image(drawn.ground ? over_ground(drawn) : drawn.picture.composite, file);
  });
}

py::bytes png_of(const DrawnPicture& drawn) {
  const std::vector<std::byte> png =
      call_unlocked([&](const Stopped&) { return encode_png(drawn.ground ? over_ground(drawn) : drawn.picture.composite); });
  return {reinterpret_cast<const char*>(png.data()), png.size()};
}

/// A layer of the picture or of its G-buffer, as an attribute.
template <class Get>
void add_layer(py::class_<DrawnPicture, std::shared_ptr<DrawnPicture>>& type, const char* name, const Get& get, const char* help) {
  type.def_property_readonly(
      name, [get](const py::object& self) { return view_of(get(self.cast<const DrawnPicture&>().picture), self); }, help);
}

void add_layers(py::class_<DrawnPicture, std::shared_ptr<DrawnPicture>>& type) {
  add_layer(
      type, "depth", [](const Picture& p) -> auto& { return p.gbuffer.depth; },
      "Z along the view axis, world units, infinity where nothing is hit: (height, width) float32.");
  add_layer(
      type, "position", [](const Picture& p) -> auto& { return p.gbuffer.position; },
      "World position, infinity where nothing is hit: (height, width, 3) float32.");
  add_layer(
      type, "normal", [](const Picture& p) -> auto& { return p.gbuffer.normal; },
      "World normal, unit, 0 where nothing is hit: (height, width, 3) float32.");
  add_layer(
      type, "n_dot_v", [](const Picture& p) -> auto& { return p.gbuffer.n_dot_v; }, "N.V, 0 to 1: (height, width) float32.");
  add_layer(
      type, "id", [](const Picture& p) -> auto& { return p.gbuffer.id; },
      "Number of the object from 1, 0 where nothing is hit: (height, width) int32.");
  add_layer(
      type, "material", [](const Picture& p) -> auto& { return p.gbuffer.material; }, "Material id: (height, width) int32.");
  add_layer(
      type, "face", [](const Picture& p) -> auto& { return p.gbuffer.face; }, "Polygon of a mesh, -1 elsewhere: (height, width) int32.");
  add_layer(
      type, "status", [](const Picture& p) -> auto& { return p.gbuffer.status; }, "0 miss, 1 hit, 2 out of steps: (height, width) uint8.");
  add_layer(
      type, "border", [](const Picture& p) -> auto& { return p.border; }, "Coverage of the ink, 0 to 1: (height, width) float32.");
  add_layer(
      type, "border_status", [](const Picture& p) -> auto& { return p.border_status; },
      "Not 0 where a method is undefined: (height, width) uint8, or None.");
  add_layer(
      type, "composite", [](const Picture& p) -> auto& { return p.composite; },
      "Ink over shading, linear, premultiplied RGBA: (height, width, 4) float32.");
}

py::array_t<double> axes_of(const Camera& camera) {
  py::array_t<double> axes({3, 3});
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) axes.mutable_at(row, column) = camera.world_from_camera[column][row];
  return axes;
}

py::array_t<double> projected(const Camera& camera, const py::object& points) {
  const std::vector<glm::dvec3> at = points_of_array(points, "points");
  py::array_t<double> out({static_cast<py::ssize_t>(at.size()), py::ssize_t{3}});
  for (size_t i = 0; i < at.size(); ++i) {
    const glm::dvec3 place = project(camera, at[i]);
    for (int axis = 0; axis < 3; ++axis) out.mutable_at(static_cast<py::ssize_t>(i), axis) = place[axis];
  }
  return out;
}

void bind_camera(py::module_& module) {
  py::class_<Camera>(module, "ResolvedCamera", "A camera with nothing left open. Pixels: origin top left, centres at +0.5.")
      .def_property_readonly(
          "eye", [](const Camera& c) { return py::make_tuple(c.eye.x, c.eye.y, c.eye.z); }, "World units.")
      .def_property_readonly("axes", axes_of, "Columns right, up, backward, in world axes: (3, 3).")
      .def_property_readonly(
          "orthographic", [](const Camera& c) { return c.projection == Projection::orthographic; }, "Rays are parallel.")
      .def_property_readonly(
          "focal_px", [](const Camera& c) { return c.focal_px; }, "Perspective: distance of the image plane, pixels.")
      .def_property_readonly(
          "pixels_per_unit", [](const Camera& c) { return c.pixels_per_unit; }, "Orthographic: pixels per world unit.")
      .def_property_readonly(
          "size", [](const Camera& c) { return py::make_tuple(c.width_px, c.height_px); }, "Width and height, pixels.")
      .def("project", projected, py::arg("points"), "Image points of world points (n, 3): (n, 3), x and y in pixels and the depth Z.")
      .def_property_readonly("_call", [](const Camera& c) {
        CallText call("", "");
        add_camera(c, call);
        return settings_of_call(call.text());
      });
}

}  // namespace

void bind_pictures(py::module_& module) {
  bind_camera(module);
  py::class_<DrawnPicture, std::shared_ptr<DrawnPicture>> type(
      module, "Picture", "A picture. Its layers are arrays that look at the picture's own memory, and can only be read.");
  add_layers(type);
  type.def_property_readonly(
          "camera", [](const DrawnPicture& self) { return self.camera; }, "Where it was seen from.")
      .def_property_readonly(
          "call", [](const DrawnPicture& self) { return self.call; }, "The command line that draws the same picture.")
      .def_property_readonly(
          "hits", [](const DrawnPicture& self) { return self.counts.hits; }, "Pixels whose ray hit something.")
      .def_property_readonly(
          "misses", [](const DrawnPicture& self) { return self.counts.misses; }, "Pixels whose ray hit nothing.")
      .def_property_readonly(
          "out_of_steps", [](const DrawnPicture& self) { return self.counts.out_of_steps; }, "Pixels whose ray ended undecided.")
      .def_property_readonly(
          "notes", [](const DrawnPicture& self) { return self.picture.notes; }, "What failed, in the methods' words.")
      .def_property_readonly(
          "warnings", [](const DrawnPicture& self) { return self.warnings; }, "What a person should know before trusting it.")
      .def_property_readonly(
          "trace_ms", [](const DrawnPicture& self) { return self.picture.trace_ms; }, "Time of tracing, milliseconds.")
      .def_property_readonly(
          "border_ms", [](const DrawnPicture& self) { return self.picture.border_ms; }, "Time of the methods, milliseconds.")
      .def("write", write, py::arg("file"), "All layers as .exr, or the composite as .png, .tif or .jpg.")
      .def("__repr__",
           [](const DrawnPicture& self) {
             return fmt::format("<limn.Picture: {} x {}, {}, {} hits>", self.camera.width_px, self.camera.height_px, self.info.kind,
                                self.counts.hits);
           })
      .def("_repr_png_", [](const DrawnPicture& self) { return png_of(self); });
  module.def("render", render);
  module.def("read_channel", [](const std::string& file, const std::string& channel) {
    auto image = std::make_unique<Image<float>>(call_unlocked([&](const Stopped&) { return read_channel(file, channel); }));
    const Image<float>& pixels = *image;
    const py::capsule owner(image.release(), [](void* held) { delete static_cast<Image<float>*>(held); });
    return view_of(pixels, owner);
  });
  module.def("channel_names", [](const std::string& file) { return call_unlocked([&](const Stopped&) { return channel_names(file); }); });
}

}  // namespace limn::python
