// Studies (sweeps with a journal) and plans (the cheapest model that is good enough).

#include <pybind11/stl.h>

#include <algorithm>
#include <filesystem>

#include "samples/experiment/job.h"
#include "samples/experiment/limits.h"
#include "samples/experiment/no_effect.h"
#include "samples/experiment/thread_settings.h"
#include "samples/output/folder_lock.h"
#include "samples/output/output.h"
#include "samples/output/progress.h"
#include "samples/plan/plan_job.h"
#include "samples/python/bindings.h"
#include "samples/study/folder.h"
#include "samples/study/run_cells.h"
#include "samples/study/study_summary.h"
#include "sdf/error.h"

namespace limn::python {
namespace {

namespace py = pybind11;

/// A study that was done, with all of its rows.
struct DoneStudy {
  StudyFolder held{};
  std::vector<std::string> rows{};  ///< As lines of rows.jsonl, in the study's order.
};

std::vector<std::string> surfaces_of(const Study& study) {
  std::vector<std::string> names;
  for (const StudyModel& model : study.models)
    if (std::find(names.begin(), names.end(), model.surface) == names.end()) names.push_back(model.surface);
  return names;
}

std::shared_ptr<DoneStudy> do_study(const Study& study, const CallSettings& settings, const std::filesystem::path& folder, bool with_report,
                                    const Stopped& stopped) {
  const FolderLock lock(folder);
  StudyRecord record = record_of(study);
  auto done = std::make_shared<DoneStudy>();
  done->held = open_folder(folder, record, settings.fresh);
  StudyWork work{study, {}, folder, execution_of(settings.spec.threads, stopped)};
  for (size_t cell = 0; cell < study.cells.size(); ++cell)
    if (!done->held.rows.contains(study.cells[cell].key)) work.cells.push_back(cell);
  CostLedger ledger = plan_costs(work);
  calibrate(work, ledger);
  ProgressBar none(false);
  run_cells(work, ledger, done->held.record, done->held.rows, none);
  finish_folder(folder, done->held, with_report);
  for (const StudyRow& row : rows_in_order(done->held)) done->rows.push_back(json_line(row));
  return done;
}

std::shared_ptr<DoneStudy> study(const py::object& scene, const CallFields& fields, const std::string& folder, bool with_report) {
  const Source source = source_of(scene);
  CallSettings settings;
  read_fields(fields, settings);
  return call_unlocked([&](const Stopped& stopped) {
    const ThreadLimit threads(settings.spec.threads);
    constexpr double kMost = 8e9, kShare = 0.75;  // as the command line has it
    settings.sweep.max_model_bytes =
        settings.spec.limits.max_memory.value_or(static_cast<std::int64_t>(std::min(kMost, kShare * machine_memory())));
    std::vector<std::string> warnings;
    SceneInput input = load_source(source, settings.spec, warnings);
    const SceneInput looked_at = input;
    const StudySpec spec{settings.spec, settings.sweep};
    Study planned = plan_study(spec, std::move(input));
    refuse_sweep_without_effect(spec, looked_at, surfaces_of(planned));
    planned.head.warnings = warnings;
    return do_study(planned, settings, folder, with_report, stopped);
  });
}

std::string plan(const py::object& scene, const CallFields& fields) {
  const Source source = source_of(scene);
  CallSettings settings;
  read_fields(fields, settings);
  if (!settings.plan.tolerance_px) throw InputError({"", "tolerance", "", "missing", "a number of pixels, such as 0.5"});
  return call_unlocked([&](const Stopped& stopped) {
    const ThreadLimit threads(settings.spec.threads);
    std::vector<std::string> warnings;
    const SceneInput input = load_source(source, settings.spec, warnings);
    refuse_eye_of_views(settings.spec.camera, settings.spec.views);
    ProgressBar none(false);
    Json json =
        plan_json(plan_for(settings.spec, settings.plan, input, none, execution_of(settings.spec.threads, stopped), settings.plan_local));
    json["warnings"] = warnings;
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
  });
}

}  // namespace

void bind_studies(py::module_& module) {
  py::class_<DoneStudy, std::shared_ptr<DoneStudy>>(module, "DoneStudy", "A study with its rows.")
      .def_property_readonly(
          "rows", [](const DoneStudy& self) { return self.rows; }, "As lines of rows.jsonl.")
      .def_property_readonly(
          "summary", [](const DoneStudy& self) { return summary_text(self.held); }, "The report's first sentences.")
      .def_property_readonly(
          "call", [](const DoneStudy& self) { return self.held.record.head.call; }, "The command line that makes the same study.")
      .def_property_readonly(
          "truth", [](const DoneStudy& self) { return self.held.record.head.truth; }, "What was measured against, in words.")
      .def_property_readonly(
          "failed_cells", [](const DoneStudy& self) { return failed_cells(self.held); }, "Cells with a reason instead of values.")
      .def_property_readonly(
          "warnings", [](const DoneStudy& self) { return self.held.record.head.warnings; }, "What a person should know.");
  module.def("study", study);
  module.def("plan", plan);
}

}  // namespace limn::python
