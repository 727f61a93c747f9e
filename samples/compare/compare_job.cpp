#include "samples/compare/compare_job.h"

#include "raymarch/image_io.h"
#include "raymarch/surface/view_level.h"
#include "samples/experiment/local_request.h"
#include "samples/experiment/no_effect.h"
#include "sdf/output_file.h"
#include "sdf/parallel.h"

namespace limn {

Comparison comparison_for(const ExperimentSpec& spec, SceneInput& input, std::vector<std::string>& notes,
                          const std::optional<ComparedLocal>& local) {
  SurfaceSettings settings = surface_settings(spec, input);
  const Camera camera =
      camera_of_view(camera_settings(spec.camera, input), framed_input(spec.camera, input), framing_settings(spec.camera), 0, 1);
  ObjectMeshCache meshes;
  if (spec.surface.level_for_view) {
    settings.kind = "mesh";
    notes = refine_for_views(settings, {&camera, 1}, input.scene, &meshes);
  }
  settings.kind.clear();
  const bool gradient_chosen = spec.surface.gradient.has_value() || input.surface.gradient.has_value();
  Comparison comparison = plan_comparison(input, settings, spec.surfaces, gradient_chosen);
  comparison.meshes = std::move(meshes);
  comparison.picture = picture_settings(spec.border, input);
  if (!comparison.picture.background) comparison.picture.background = glm::vec3(1.0f);
  std::vector<std::vector<MethodCall>> columns;
  if (spec.border.columns.empty()) {
    columns.push_back(comparison.picture.methods);
  } else {
    for (const MethodCall& call : comparison.picture.methods) columns.push_back({call});
  }
  plan_methods(columns, comparison);
  comparison.camera = camera;
  if (local) plan_local(local_settings(local->tolerance_px, local->silhouette, comparison.picture.methods, {camera}), comparison);
  std::vector<std::string> kinds;
  for (const ComparedModel& model : comparison.models)
    if (model.skipped.empty()) kinds.push_back(model.surface.kind);
  comparison.truth_reference = spec.reference.value_or(TruthReference::given);
  comparison.call = resolved_call("compare", spec, {input.scene, settings, kinds, local ? local->tolerance_px : 0.0}, comparison.camera,
                                  comparison.picture);
  return comparison;
}

void refuse_uncompared(const ExperimentSpec& spec, const SceneInput& input, const Comparison& comparison) {
  SettingUse use;
  for (const ComparedModel& model : comparison.models) {
    if (model.skipped.empty()) use.kinds.push_back(model.surface.kind);
  }
  refuse_without_effect(spec.surface, input, use);
  refuse_reference_without_effect(spec, input);
}

std::vector<std::filesystem::path> layer_files(const Comparison& comparison) {
  std::vector<std::filesystem::path> names;
  for (const ComparedModel& model : comparison.models) {
    if (model.skipped.empty()) names.emplace_back(model.name + ".exr");
  }
  return names;
}

// Without a font the sheet has no words; the page has them all.
bool write_comparison(const Comparison& comparison, const std::filesystem::path& folder) {
  bool has_labels = false;
  parallel_invoke(
      [&] {
        const Sheet sheet = contact_sheet(comparison);
        write_image(sheet.picture, folder / "sheet.png");
        has_labels = sheet.has_labels;
      },
      [&] {
        write_whole(folder / "rows.json", rows_json(comparison).dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
        write_whole(folder / "report.html", report_page(comparison));
      });
  return has_labels;
}

}  // namespace limn
