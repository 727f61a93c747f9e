// The true border, the border that a model shows, and what metrics say of the two.

#include <pybind11/stl.h>

#include <algorithm>

#include "raymarch/measured_border.h"
#include "raymarch/metric.h"
#include "samples/compare/comparison.h"
#include "samples/experiment/job.h"
#include "samples/experiment/local_request.h"
#include "samples/experiment/no_effect.h"
#include "samples/experiment/thread_settings.h"
#include "samples/python/arrays.h"
#include "samples/python/bindings.h"
#include "sdf/error.h"

namespace limn::python {
namespace {

namespace py = pybind11;

/// A true border, or a measured one: that has curves alone.
struct SolvedBorder {
  BorderTruth truth{};
  Camera camera{};
  bool measured = false;
};
using BorderClass = py::class_<SolvedBorder, std::shared_ptr<SolvedBorder>>;

/// A curve within a border that it keeps.
struct CurveOfPython {
  std::shared_ptr<SolvedBorder> border{};
  size_t index = 0;
  const BorderCurve& curve() const { return border->truth.curves.curves[index]; }
};
using CurveClass = py::class_<CurveOfPython>;

Camera camera_of(const CallSettings& settings, const SceneInput& input) {
  return camera_of_view(camera_settings(settings.spec.camera, input), framed_input(settings.spec.camera, input),
                        framing_settings(settings.spec.camera), settings.view, settings.spec.views);
}

std::shared_ptr<SolvedBorder> truth(const py::object& scene, const CallFields& fields) {
  const Source source = source_of(scene);
  CallSettings settings;
  read_fields(fields, settings);
  return call_unlocked([&](const Stopped& stopped) {
    const ThreadLimit threads(settings.spec.threads);
    std::vector<std::string> warnings;
    const SceneInput input = load_source(source, settings.spec, warnings);
    refuse_reference_without_effect(settings.spec, input);
    settings.truth.reference = settings.spec.reference.value_or(TruthReference::given);
    auto solved = std::make_shared<SolvedBorder>();
    solved->camera = camera_of(settings, input);
    solved->truth = solve_truth(input.scene, solved->camera, settings.truth, execution_of(settings.spec.threads, stopped));
    return solved;
  });
}

std::shared_ptr<SolvedBorder> border(const py::object& scene, const CallFields& fields) {
  const Source source = source_of(scene);
  CallSettings settings;
  read_fields(fields, settings);
  return call_unlocked([&](const Stopped& stopped) {
    const ThreadLimit threads(settings.spec.threads);
    const std::shared_ptr<const ModelOfPython> model = model_for(source, settings, stopped);
    const ExecutionSettings execution = execution_of(settings.spec.threads, stopped);
    auto solved = std::make_shared<SolvedBorder>();
    solved->measured = true;
    solved->camera = camera_of(settings, model->scene.input);
    const GBuffer gbuffer = render_gbuffer(model->model, solved->camera, execution);
    solved->truth.curves = measure_border(model->model, solved->camera, gbuffer, {.threshold = settings.truth.threshold}, execution);
    return solved;
  });
}

/// Name, value, unit and what the reference itself scores.
using Row = std::tuple<std::string, double, std::string, double>;

Experiment experiment_of(const CallSettings& settings, const Comparison& comparison, const SceneInput& input) {
  Experiment experiment;
  experiment.scene = comparison.reference().scene;
  experiment.cameras = {camera_of(settings, input)};
  for (const ComparedModel& model : comparison.models)
    experiment.models.push_back({model.title, model.scene, model.surface, model.skipped, model.local});
  const std::vector<MethodCall> calls = method_calls(settings.spec.border, input);
  experiment.methods.push_back({methods_text(calls), calls, truth_threshold(calls)});
  for (const Metric& metric : metrics())
    if (metric.subject != MetricSubject::motion) experiment.metrics.push_back(&metric);
  PictureSettings picture = picture_settings(settings.spec.border, input);
  experiment.picture = picture;
  experiment.silhouette_of_all = true;
  experiment.reference = settings.spec.reference.value_or(TruthReference::given);
  return experiment;
}

std::vector<Row> measured_rows(const Experiment& experiment, const ExecutionSettings& execution) {
  std::vector<Row> rows;
  std::string refused;
  ExperimentObserver observer;
  observer.measured = [&rows, &refused](MeasuredCell& cell) {
    refused = cell.drawing.refused;
    for (const Measurement& one : cell.measurements) {
      double floor = std::numeric_limits<double>::quiet_NaN();
      for (const Measurement& of_reference : cell.floor)
        if (of_reference.value.name == one.value.name) floor = of_reference.value.value;
      rows.emplace_back(one.value.name, one.value.value, one.value.unit, floor);
    }
  };
  observer.refused = [&refused](std::span<const ExperimentCell>, const std::string& reason) { refused = reason; };
  ExperimentRun run(experiment, execution, observer);
  const ExperimentCell cell{.model = experiment.models.size() - 1};
  run.run({&cell, 1});
  if (!refused.empty()) throw InputError({"", "surface", "", refused, ""});
  return rows;
}

std::vector<Row> measure(const py::object& scene, const CallFields& fields) {
  const Source source = source_of(scene);
  CallSettings settings;
  read_fields(fields, settings);
  return call_unlocked([&](const Stopped& stopped) {
    const ThreadLimit threads(settings.spec.threads);
    std::vector<std::string> warnings;
    SceneInput input = load_source(source, settings.spec, warnings);
    SurfaceSettings surface = surface_settings(settings.spec, input);
    if (settings.local_px && surface.kind.empty()) surface.kind = "mesh";
    refuse_without_effect(settings.spec.surface, input, {.kinds = {surface.kind}});
    if (settings.local_px) refuse_local_without_effect(settings.spec, input.scene, surface, {surface.kind});
    refuse_reference_without_effect(settings.spec, input);
    const std::string kind = surface.kind;
    surface.kind.clear();
    const bool gradient_chosen = settings.spec.surface.gradient.has_value() || input.surface.gradient.has_value();
    const std::vector<std::string> only =
        kind.empty() ? std::vector<std::string>{natural_surface(input.scene.objects.front())} : std::vector{kind};
    Comparison comparison = plan_comparison(input, surface, only, gradient_chosen);
    comparison.models.resize(std::min<size_t>(comparison.models.size(), 2));
    if (settings.local_px)
      plan_local(local_settings(*settings.local_px, false, method_calls(settings.spec.border, input), {camera_of(settings, input)}),
                 comparison);
    if (!comparison.models.back().skipped.empty()) throw InputError({"", "surface", kind, comparison.models.back().skipped, ""});
    return measured_rows(experiment_of(settings, comparison, input), execution_of(settings.spec.threads, stopped));
  });
}

/// A member of a curve's points, as an attribute.
template <class T>
void add_member(CurveClass& type, const char* name, T BorderPoint::*member, const char* help) {
  type.def_property_readonly(
      name, [member](const py::object& self) { return view_of(self.cast<const CurveOfPython&>().curve().points, member, self); }, help);
}

void bind_curve(py::module_& module) {
  CurveClass type(module, "Curve", "A polyline of a border, at sub-pixel precision. Its arrays look at the border's own memory.");
  add_member(type, "px", &BorderPoint::px, "Image points, pixels: (n, 2) float64. What is bounded lies to the left.");
  add_member(type, "depth", &BorderPoint::depth, "Z of the nearer sheet, world units: (n,).");
  add_member(type, "position", &BorderPoint::position, "World units: (n, 3); NaN in measured borders.");
  add_member(type, "normal", &BorderPoint::normal, "World, unit: (n, 3); NaN in measured borders.");
  add_member(type, "radial_curvature", &BorderPoint::radial_curvature, "1 / world unit: (n,); NaN at creases and in measured borders.");
  type.def_property_readonly(
          "kind", [](const CurveOfPython& self) { return self.curve().kind == CurveKind::silhouette ? "silhouette" : "inner"; },
          "\"silhouette\" or \"inner\".")
      .def_property_readonly(
          "object", [](const CurveOfPython& self) { return self.curve().object; }, "Of the nearer sheet, from 1.")
      .def_property_readonly(
          "closed", [](const CurveOfPython& self) { return self.curve().closed; }, "The last point joins the first.")
      .def_property_readonly(
          "length_px", [](const CurveOfPython& self) { return length_px(self.curve()); }, "Pixels.");
}

}  // namespace

void bind_borders(py::module_& module) {
  bind_curve(module);
  BorderClass(module, "Border", "The visible border of a view as curves: the true one, or that which a model shows.")
      .def_property_readonly(
          "curves",
          [](const std::shared_ptr<SolvedBorder>& self) {
            std::vector<CurveOfPython> curves;
            for (size_t i = 0; i < self->truth.curves.curves.size(); ++i) curves.push_back({self, i});
            return curves;
          },
          "In the same order for equal calls.")
      .def_property_readonly(
          "coverage", [](const py::object& self) { return view_of(self.cast<const SolvedBorder&>().truth.coverage, self); },
          "Share of each pixel that is ink of the rim: (height, width) float32; None of a measured border.")
      .def_property_readonly(
          "camera", [](const SolvedBorder& self) { return self.camera; }, "Where it was seen from.")
      .def_property_readonly(
          "measured", [](const SolvedBorder& self) { return self.measured; }, "True of a model's, false of the true one.")
      .def_property_readonly(
          "exact", [](const SolvedBorder& self) { return self.truth.exact && !self.measured; },
          "False where a finer model stands in for the surface itself.")
      .def_property_readonly(
          "bound_px", [](const SolvedBorder& self) { return self.truth.bound_px; },
          "No point of the true border's curves lies farther from it, pixels.")
      .def_property_readonly(
          "source", [](const SolvedBorder& self) { return self.truth.from; }, "What it was solved on, in words.")
      .def_property_readonly(
          "notes", [](const SolvedBorder& self) { return self.truth.notes; }, "What the bound does not cover.");
  module.def("truth", truth);
  module.def("border", border);
  module.def("measure", measure);
}

}  // namespace limn::python
