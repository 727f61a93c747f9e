#include "samples/study/study.h"

#include <fmt/format.h>

#include <cmath>

#include "samples/experiment/job.h"

namespace limn {

double Study::measure_ms() const { return cell_ms(pixels(), border_faces); }
double Study::truth_ms() const { return limn::truth_ms(pixels(), border_faces); }

StudyRow row_of(const Study& study, const StudyCell& cell) {
  const StudyModel& model = study.models[cell.model];
  const StudyMethod& method = study.methods[cell.method];
  StudyRow row;
  row.key = cell.key;
  row.scene = study.scene.name;
  row.view = static_cast<int>(cell.view);
  row.width_px = study.cameras[cell.view].width_px;
  row.height_px = study.cameras[cell.view].height_px;
  row.surface = model.surface;
  row.surface_parameters = model.parameters;
  row.method = method.call.method->about.name;
  row.method_parameters = method.parameters;
  return row;
}

std::string cell_text(const Study& study, const StudyCell& cell) {
  const StudyRow row = row_of(study, cell);
  const std::string resolution = resolution_text(row);
  return fmt::format("{}{}, view {}, {}", series_of(row), resolution.empty() ? "" : ", " + resolution, cell.view,
                     methods_text({study.methods[cell.method].call}));
}

std::string duration_text(double milliseconds) {
  const auto seconds = static_cast<std::int64_t>(std::llround(milliseconds / 1e3));
  if (seconds < 60) return fmt::format("{} s", seconds);
  if (seconds < 3600) return fmt::format("{} min {} s", seconds / 60, seconds % 60);
  return fmt::format("{} h {} min", seconds / 3600, seconds % 3600 / 60);
}

}  // namespace limn
