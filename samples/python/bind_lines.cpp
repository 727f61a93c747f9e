// The lines of a view as polylines and drawings.

#include <pybind11/stl.h>

#include "samples/experiment/job.h"
#include "samples/experiment/line_scene.h"
#include "samples/experiment/thread_settings.h"
#include "samples/lines/graph_json.h"
#include "samples/lines/write_drawing.h"
#include "samples/python/arrays.h"
#include "samples/python/bindings.h"
#include "sdf/error.h"
#include "sdf/output_file.h"

namespace limn::python {
namespace {

namespace py = pybind11;

struct SolvedLines {
  ViewGraph graph{};
  std::vector<std::vector<LinePoint>> points{};  ///< Of each chain.
  Camera camera{};
  std::string title{};
  std::vector<std::string> warnings{};
};

/// A chain within lines that it keeps.
struct ChainOfPython {
  std::shared_ptr<const SolvedLines> lines{};
  size_t index = 0;
  const LineChain& chain() const { return lines->graph.chains[index]; }
  const std::vector<LinePoint>& points() const { return lines->points[index]; }
};
using ChainClass = py::class_<ChainOfPython>;

std::shared_ptr<SolvedLines> contours(const py::object& scene, const CallFields& fields) {
  const Source source = source_of(scene);
  CallSettings settings;
  read_fields(fields, settings);
  return call_unlocked([&](const Stopped& stopped) {
    const ThreadLimit threads(settings.spec.threads);
    auto solved = std::make_shared<SolvedLines>();
    SceneInput input = load_source(source, settings.spec, solved->warnings);
    const Scene drawn = scene_of_lines(settings.spec, input, stop_at_progress(stopped), solved->warnings);
    check_smooth(settings.lines, drawn);
    solved->title = input.name;
    solved->camera = camera_of_view(camera_settings(settings.spec.camera, input), framed_input(settings.spec.camera, input),
                                    framing_settings(settings.spec.camera), settings.view, settings.spec.views);
    solved->graph = solve_lines(drawn, solved->camera, settings.lines, execution_of(settings.spec.threads, stopped));
    for (const LineChain& chain : solved->graph.chains) solved->points.push_back(points_of(solved->graph, chain));
    return solved;
  });
}

LineDrawing drawing_of(const SolvedLines& lines, const CallFields& fields) {
  CallSettings settings;
  read_fields(fields, settings);
  return make_drawing(lines.graph, lines.camera.width_px, lines.camera.height_px, settings.drawing);
}

std::string json_of(const SolvedLines& lines) { return graph_json(lines.graph, lines.camera.width_px, lines.camera.height_px).dump(); }

std::string svg_of(const SolvedLines& lines, const CallFields& fields) { return svg_text(drawing_of(lines, fields), lines.title); }

void write(const SolvedLines& lines, const std::string& name, const CallFields& fields) {
  const std::filesystem::path file(name);
  check_output_file(file, false, {".svg", ".pdf", ".json", ".dxf"});
  const std::string ending = ending_of(file);
  const LineDrawing drawing = drawing_of(lines, fields);
  run_unlocked([&](const Stopped&) {
    if (ending == ".json") write_whole(file, json_of(lines) + "\n");
    if (ending == ".svg") write_whole(file, svg_text(drawing, lines.title));
    if (ending == ".dxf") write_whole(file, dxf_text(drawing));
    if (ending == ".pdf") write_whole(file, [&](const std::filesystem::path& temporary) { write_pdf(drawing, lines.title, temporary); });
  });
}

/// A member of a chain's points, as an attribute.
template <class T>
void add_member(ChainClass& type, const char* name, T LinePoint::*member, const char* help) {
  type.def_property_readonly(
      name, [member](const py::object& self) { return view_of(self.cast<const ChainOfPython&>().points(), member, self); }, help);
}

void bind_chain(py::module_& module) {
  ChainClass type(module, "Chain", "A stroke of one class and visibility. Its arrays look at the lines' own memory.");
  add_member(type, "px", &LinePoint::px, "Image points, pixels: (n, 2) float64.");
  add_member(type, "depth", &LinePoint::depth, "Z, world units: (n,).");
  add_member(type, "position", &LinePoint::position, "World units: (n, 3).");
  add_member(type, "normal", &LinePoint::normal, "World, unit: (n, 3).");
  add_member(type, "radial_curvature", &LinePoint::radial_curvature, "1 / world unit: (n,); NaN on creases and boundaries.");
  type.def_property_readonly(
          "line_class", [](const ChainOfPython& self) { return name_of(self.chain().line_class); },
          "\"contour\", \"boundary\", \"crease\", ...")
      .def_property_readonly(
          "object", [](const ChainOfPython& self) { return self.chain().object; }, "From 1.")
      .def_property_readonly(
          "qi", [](const ChainOfPython& self) { return self.chain().invisibility; },
          "Quantitative invisibility: layers of surface in front of it.")
      .def_property_readonly(
          "visible", [](const ChainOfPython& self) { return self.chain().invisibility == 0; }, "Nothing is in front of it.")
      .def_property_readonly(
          "closed", [](const ChainOfPython& self) { return self.chain().closed; }, "The last point joins the first.");
}

py::list conflicts_of(const SolvedLines& lines) {
  py::list conflicts;
  for (const LineConflict& one : lines.graph.conflicts) conflicts.append(py::make_tuple(one.what, py::make_tuple(one.px.x, one.px.y)));
  return conflicts;
}

}  // namespace

void bind_lines(py::module_& module) {
  bind_chain(module);
  py::class_<SolvedLines, std::shared_ptr<SolvedLines>>(module, "Lines", "The lines of a view, hidden ones included.")
      .def_property_readonly(
          "chains",
          [](const std::shared_ptr<SolvedLines>& self) {
            std::vector<ChainOfPython> chains;
            for (size_t i = 0; i < self->graph.chains.size(); ++i) chains.push_back({self, i});
            return chains;
          },
          "Strokes, in an order that does not depend on threads.")
      .def_property_readonly("conflicts", conflicts_of, "Where the certificate disagrees: (what, (x, y) in pixels) each.")
      .def_property_readonly(
          "camera", [](const SolvedLines& self) { return self.camera; }, "Where they were seen from.")
      .def_property_readonly(
          "exact", [](const SolvedLines& self) { return self.graph.exact; }, "False where a part is approximated.")
      .def_property_readonly(
          "bound_px", [](const SolvedLines& self) { return self.graph.bound_px; }, "No point lies farther from its line, pixels.")
      .def_property_readonly(
          "source", [](const SolvedLines& self) { return self.graph.from; }, "What they were solved on, in words.")
      .def_property_readonly(
          "notes", [](const SolvedLines& self) { return self.graph.notes; }, "What the bound does not cover.")
      .def_property_readonly(
          "warnings", [](const SolvedLines& self) { return self.warnings; }, "What a person should know.")
      .def("_svg", svg_of)
      .def("_json", json_of)
      .def("_write", write)
      .def("_repr_svg_", [](const SolvedLines& self) { return svg_of(self, {}); });
  module.def("contours", contours);
}

}  // namespace limn::python
