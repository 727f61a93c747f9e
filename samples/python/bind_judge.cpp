// Drawings, as files or as arrays of ink, measured against the lines of a surface.

#include <pybind11/stl.h>

#include <algorithm>

#include "samples/experiment/job.h"
#include "samples/experiment/line_scene.h"
#include "samples/experiment/thread_settings.h"
#include "samples/judge/drawing_file.h"
#include "samples/judge/ink_picture.h"
#include "samples/judge/judge_report.h"
#include "samples/python/arrays.h"
#include "samples/python/bindings.h"
#include "sdf/error.h"

namespace limn::python {
namespace {

namespace py = pybind11;

/// A judgement with all that its reports are made of.
struct JudgedDrawing {
  JudgeSubject subject{};
  ViewGraph graph{};
  DrawnLines drawing{};
  Judgement judgement{};
  std::vector<LimitResult> limits{};
  JudgeReport report() const { return {subject, graph, drawing, judgement, limits}; }
};

/// Ink from 0 to 1, one number a pixel.
Image<float> ink_of(const py::object& array) {
  const py::array_t<double> numbers = numbers_of(array, "drawing", {-1, -1});
  constexpr py::ssize_t kMost = 16384;
  if (numbers.size() == 0 || numbers.shape(0) > kMost || numbers.shape(1) > kMost)
    throw InputError({"", "drawing", std::to_string(numbers.shape(0)) + " x " + std::to_string(numbers.shape(1)),
                      "has no size of a picture", "1 to 16384 pixels either way"});
  Image<float> ink(static_cast<int>(numbers.shape(1)), static_cast<int>(numbers.shape(0)));
  for (size_t i = 0; i < ink.size(); ++i) {
    const double value = numbers.data()[i];
    if (value < 0.0 || value > 1.0) throw InputError({"", "drawing", std::to_string(value), "is no coverage", "ink from 0 to 1"});
    ink.pixels[i] = static_cast<float>(value);
  }
  return ink;
}

std::shared_ptr<JudgedDrawing> judge(const py::object& given, const py::object& against, const CallFields& fields) {
  const Source source = source_of(against);
  CallSettings settings;
  read_fields(fields, settings);
  const bool is_file = py::isinstance<py::str>(given);
  const std::string file = is_file ? given.cast<std::string>() : "";
  const Image<float> ink = is_file ? Image<float>() : ink_of(given);
  return call_unlocked([&](const Stopped& stopped) {
    const ThreadLimit threads(settings.spec.threads);
    std::vector<std::string> warnings;
    const SceneInput input = load_source(source, settings.spec, warnings);
    check_smooth(settings.lines, input.scene);
    CameraSpec camera_spec = settings.spec.camera;
    if (!is_file) camera_spec.size_px = glm::ivec2(ink.width, ink.height);
    if (!camera_spec.size_px) camera_spec.size_px = size_of_drawing(file);
    const Camera camera = camera_of_view(camera_settings(camera_spec, input), framed_input(camera_spec, input),
                                         framing_settings(camera_spec), settings.view, settings.spec.views);
    auto judged = std::make_shared<JudgedDrawing>();
    judged->drawing = is_file ? read_drawing(file, settings.ink, {camera.width_px, camera.height_px}) : lines_of_ink(ink);
    judged->graph = solve_lines(input.scene, camera, settings.lines, execution_of(settings.spec.threads, stopped));
    judged->judgement = judge_lines(judged->graph, judged->drawing, settings.judge);
    judged->limits = check_judge_limits(judged->judgement, settings.limits);
    judged->subject = {is_file ? file : "the array", input.name, camera.width_px, camera.height_px, settings.judge};
    return judged;
  });
}

}  // namespace

void bind_judge(py::module_& module) {
  py::class_<JudgedDrawing, std::shared_ptr<JudgedDrawing>>(module, "Judged", "A drawing measured against true lines.")
      .def_property_readonly(
          "passed",
          [](const JudgedDrawing& self) {
            return std::all_of(self.limits.begin(), self.limits.end(), [](const LimitResult& one) { return one.passed; });
          },
          "No limit is exceeded.")
      .def_property_readonly(
          "text", [](const JudgedDrawing& self) { return judge_text(self.report()); }, "For people.")
      .def("_json", [](const JudgedDrawing& self) { return judge_json(self.report()).dump(); })
      .def("_junit", [](const JudgedDrawing& self) { return judge_junit(self.report()); })
      .def("_page", [](const JudgedDrawing& self) { return judge_page(self.report()); });
  module.def("judge", judge);
}

}  // namespace limn::python
