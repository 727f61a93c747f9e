// Comparisons: one scene in every representation, by one method or by several.

#include <pybind11/stl.h>

#include "raymarch/image_io.h"
#include "samples/compare/compare_job.h"
#include "samples/experiment/job.h"
#include "samples/experiment/limits.h"
#include "samples/experiment/thread_settings.h"
#include "samples/experiment/warnings.h"
#include "samples/output/progress.h"
#include "samples/python/arrays.h"
#include "samples/python/bindings.h"

namespace limn::python {
namespace {

namespace py = pybind11;

std::shared_ptr<Comparison> compare(const py::object& scene, const CallFields& fields, const std::string& folder) {
  const Source source = source_of(scene);
  CallSettings settings;
  read_fields(fields, settings);
  return call_unlocked([&](const Stopped& stopped) {
    const ThreadLimit threads(settings.spec.threads);
    std::vector<std::string> warnings;
    SceneInput input = load_source(source, settings.spec, warnings);
    std::optional<ComparedLocal> local;
    if (settings.local_px) local = ComparedLocal{*settings.local_px, false};
    auto comparison = std::make_shared<Comparison>(comparison_for(settings.spec, input, warnings, local));
    refuse_uncompared(settings.spec, input, *comparison);
    const ComparedModel& last = comparison->models.back();
    check_limits(settings.spec.limits, last.scene, last.surface,
                 picture_load(comparison->camera, comparison->picture, {.writes_layers = true}), {.meshes = &comparison->meshes});
    ProgressBar none(false);
    draw_comparison(*comparison, folder, execution_of(settings.spec.threads, stopped), none);
    return comparison;
  });
}

const Cell& cell_of(const Comparison& comparison, size_t model, size_t method) {
  if (model >= comparison.models.size() || method >= comparison.methods.size()) throw py::index_error("no such cell");
  return comparison.at(model, method);
}

py::bytes sheet_of(const Comparison& comparison) {
  const std::vector<std::byte> png = call_unlocked([&](const Stopped&) { return encode_png(contact_sheet(comparison).picture); });
  return {reinterpret_cast<const char*>(png.data()), png.size()};
}

}  // namespace

void bind_comparisons(py::module_& module) {
  py::class_<Comparison, std::shared_ptr<Comparison>>(module, "Comparison", "A scene's models beside a reference, drawn and measured.")
      .def_property_readonly(
          "models",
          [](const Comparison& self) {
            std::vector<std::string> names;
            for (const ComparedModel& model : self.models) names.push_back(model.name);
            return names;
          },
          "By name; the first is the reference.")
      .def_property_readonly(
          "methods",
          [](const Comparison& self) {
            std::vector<std::string> names;
            for (const ComparedMethod& method : self.methods) names.push_back(method.name);
            return names;
          },
          "By name.")
      .def_property_readonly(
          "call", [](const Comparison& self) { return self.call; }, "The command line that makes the same comparison.")
      .def_property_readonly(
          "summary", [](const Comparison& self) { return summary_sentences(self); }, "The result in sentences.")
      .def_property_readonly(
          "skipped", [](const Comparison& self) { return skipped_sentences(self); }, "What is not there, and why.")
      .def("_border", [](const py::object& self, size_t model,
                         size_t method) { return view_of(cell_of(self.cast<const Comparison&>(), model, method).border, self); })
      .def("_composite", [](const py::object& self, size_t model,
                            size_t method) { return view_of(cell_of(self.cast<const Comparison&>(), model, method).composite, self); })
      .def("_rows", [](const Comparison& self) { return rows_json(self).dump(); })
      .def("_json", [](const Comparison& self) { return comparison_json(self, {}).dump(); })
      .def("_report", [](const Comparison& self) { return call_unlocked([&](const Stopped&) { return report_page(self); }); })
      .def("_write",
           [](const Comparison& self, const std::string& folder) { run_unlocked([&](const Stopped&) { write_comparison(self, folder); }); })
      .def("_repr_png_", sheet_of);
  module.def("compare", compare);
}

}  // namespace limn::python
