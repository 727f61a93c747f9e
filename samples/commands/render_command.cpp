#include <fmt/format.h>

#include <algorithm>
#include <future>

#include "raymarch/files/picture_module.h"
#include "raymarch/look.h"
#include "raymarch/mesh/polygons.h"
#include "raymarch/surface/view_level.h"
#include "samples/commands/command.h"
#include "samples/commands/common.h"
#include "samples/commands/render_outputs.h"
#include "samples/commands/render_writer.h"
#include "samples/experiment/camera_json.h"
#include "samples/experiment/empty_picture.h"
#include "samples/experiment/flat_input.h"
#include "samples/experiment/local_request.h"
#include "samples/experiment/no_effect.h"
#include "samples/experiment/thread_settings.h"
#include "samples/input/input_files.h"
#include "samples/input/scene_facts.h"
#include "samples/plan/plan_job.h"
#include "sdf/error.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

void add_options(CLI::App& app, Options& options) {
  add_input(app, options);
  add_camera(app, options, true);
  add_frames(app, options, "N pictures while the camera wanders within a pixel, 1..10000, and how often ink flips meanwhile");
  add_turntable(app, options);
  add_surface(app, options, {.surface = true, .repeatable = false, .views = true});
  add_local(app, options, false);
  add_plan(app, options);
  add_border(app, options);
  add_look(app, options);
  add_output(app, options, ".exr (all layers) or .png .tif .jpg (the composite), repeatable; default limn-out/render/<name>.exr and .png",
             true);
  add_json(app, options);
  add_execution(app, options);
}

/// What has no meaning without something else in the call.
void refuse_alone(const Options& options) {
  if (options.metric_given && !options.local.asked && !options.plan.tolerance_px)
    throw InputError({"", "--metric", "", "has no effect", "--tolerance PX or --local PX beside it"});
  if (options.local.asked && options.local.tolerance_px && options.plan.tolerance_px)
    throw InputError({"", "local", "", "beside tolerance the plan chooses how fine the model is", "--local without a number"});
  if (options.local.asked && !options.local.tolerance_px && !options.plan.tolerance_px)
    throw InputError({"", "local", "", "needs a tolerance", "a number of pixels, such as --local 0.25"});
}

/// --local asks for a mesh where nobody says otherwise.
void prepare_local(const Options& options, Render& render) {
  if (!options.local.tolerance_px) return;
  if (render.surface.kind.empty()) render.surface.kind = "mesh";
  refuse_local_without_effect(options.spec, render.input.scene, render.surface, {render.surface.kind});
}

// Of many pictures the first few stand for the rest.
void warn_of_empty(const std::vector<std::string>& reasons, int index, const Options& options, Render& render) {
  constexpr int kMost = 5;
  if (reasons.empty() || ++render.empty_pictures > kMost) return;
  std::vector<std::string> warnings;
  warnings.reserve(reasons.size());
  for (const std::string& reason : reasons) {
    warnings.push_back(pictures_of(options) == 1 ? reason : fmt::format("{} {}: {}", name_of_one(options), index, reason));
  }
  if (render.empty_pictures == kMost) warnings.emplace_back("further pictures that show nothing are not told one by one");
  print_warnings(options, warnings);
  render.warnings.insert(render.warnings.end(), warnings.begin(), warnings.end());
}

void draw_one(const SceneModel& model, int index, const Options& options, ProgressBar& bar, FrameHistory& history, PictureWriter& writer,
              Render& render) {
  ExecutionSettings how = execution_settings(options.spec.threads);
  const int pictures = pictures_of(options);
  how.progress = bar.stage(pictures == 1 ? "tracing" : fmt::format("tracing {} {} of {}", name_of_one(options), index + 1, pictures));
  Picture picture = draw_picture(render.input.scene, model, render.camera, render.picture, how, render.flicker ? &history : nullptr);
  if (render.flicker) watch_frame(picture, history, render.camera, how, *render.flicker);
  const HitCounts seen = picture.counts;
  render.timings.trace_ms += picture.trace_ms;
  render.timings.border_ms += picture.border_ms;
  render.counts.hits += seen.hits;
  render.counts.misses += seen.misses;
  render.counts.out_of_steps += seen.out_of_steps;
  render.notes.insert(render.notes.end(), picture.notes.begin(), picture.notes.end());
  warn_of_empty(why_empty(render.input.scene, model, render.camera, seen), index, options, render);
  writer.write(std::move(picture), index);
}

// With --tolerance the plan says how to model; nothing is drawn where nothing meets it.
bool choose_model(const Options& options, ProgressBar& bar, Render& render) {
  PlanJob job = plan_for(options.spec, options.plan, render.input, bar, options.local.asked);
  const std::vector<std::string> sentences = plan_sentences(job.answer, job.settings);
  render.plan = plan_json(job);
  if (!options.quiet) print_note(sentences.front());
  if (!job.answer.chosen) return false;
  const PlanTrial& chosen = job.answer.trials[*job.answer.chosen];
  render.surface = job.answer.all_series[chosen.series].at(chosen.candidate);
  if (const auto local = job.answer.all_series[chosen.series].local_at(chosen.candidate)) render.local = *local;
  for (SceneObject& object : render.input.scene.objects) object.level.reset();
  render.meshes = std::move(job.answer.meshes);
  return true;
}

// A picture of which nobody says more is one to be looked at; frames are there to be measured.
Options with_defaults(Options options) {
  constexpr int kSamples = 8;
  if (!options.samples_given && options.frames.frames <= 1) options.spec.border.samples = kSamples;
  if (options.ink_only) options.spec.border.shading = "none";
  return options;
}

// Where nobody names a method, and the surface is flat for the most part, its lines are drawn: a rim inks whole faces.
void choose_method(Render& render, Options& options) {
  const BorderSpec& border = options.spec.border;
  const bool named = !border.methods.empty() || border.look || !border.parameters.empty() || !render.input.borders.empty();
  const bool measured = options.frames.frames > 1 || options.plan.tolerance_px;
  if (named || measured || render.input.kind == InputKind::built_in) return;
  const double share = flat_share(render.input.scene, render.surface, &render.meshes);
  if (share <= kMostlyFlat) return;
  options.spec.border.methods = {kMethodOfFlat};
  render.notes.push_back(fmt::format("{:.0f} % of the surface is flat: drawn by its lines (--method {}); --method {} inks whole faces",
                                     100.0 * share, kMethodOfFlat, kDefaultMethod));
}

/// Of which the memory is estimated: colours of files are found in whole images.
PictureSettings planned_picture(const Render& render) {
  PictureSettings planned = render.picture;
  for (const SceneObject& object : render.input.scene.objects) {
    const auto* const source = std::get_if<MeshSource>(&object.source);
    if (source != nullptr && has_colors(*source->mesh)) planned.colors = PictureColors::linear;
  }
  return planned;
}

bool has_layers(const fs::path& file) { return ending_of(file) == ".exr"; }
bool is_png(const fs::path& file) { return ending_of(file) == ".png" || ending_of(file) == ".apng"; }
/// Written by the module for all other kinds of pictures.
bool by_module(const fs::path& file) { return !is_png(file) && !has_layers(file); }

/// What the pictures hold: no more than the files and the methods read.
void choose_picture(const Options& options, Render& render) {
  render.picture = picture_settings(options.spec.border, render.input);
  if (options.spec.border.look) render.ground = looks().find(*options.spec.border.look).ground;
  const bool layered = std::any_of(render.outputs.begin(), render.outputs.end(), has_layers);
  render.picture.mattes = layered;
  if (!layered && !options.transparent && !options.ink_only && !render.picture.background) render.picture.background = render.ground;
  constexpr GBufferLayers none{false, false, false, false, false, false, false, false};
  if (!layered) render.picture.layers = none;
  if (std::all_of(render.outputs.begin(), render.outputs.end(), is_png)) render.picture.colors = PictureColors::bytes;
  render.picture.hands_over_gbuffer = layered;
}

/// Throws InputError where the call needs more than it may have. A local level set says so itself: what it takes is not known before.
void check_render_cost(const Options& options, const Camera& camera, Render& render) {
  if (render.local && has_local_bricks(render.surface.kind)) return;
  const bool layered = render.picture.hands_over_gbuffer;
  PictureLoad load = picture_load(camera, planned_picture(render), {pictures_of(options), layered, options.frames.frames > 1});
  if (std::any_of(render.outputs.begin(), render.outputs.end(), by_module)) load.library_bytes = kPictureLibraryBytes;
  check_cost(options, render.input.scene, render.surface, load, {.meshes = &render.meshes});
}

SceneModel build(const Options& options, const std::vector<Camera>& cameras, Render& render) {
  const auto start = std::chrono::steady_clock::now();
  std::vector<std::string> levels;
  if (options.spec.surface.level_for_view && !options.plan.tolerance_px)
    levels = refine_for_views(render.surface, cameras, render.input.scene, &render.meshes);
  SceneModel model = render.local ? build_local_model(render.input.scene, render.surface, *render.local, &render.meshes)
                                  : build_model(render.input.scene, render.surface, &render.meshes);
  render.timings.build_ms = elapsed_ms(start);
  const SurfaceInfo info = total(model);
  print_warnings(options, info.warnings);
  render.warnings.insert(render.warnings.end(), info.warnings.begin(), info.warnings.end());
  render.notes.insert(render.notes.end(), levels.begin(), levels.end());
  render.notes.insert(render.notes.end(), info.notes.begin(), info.notes.end());
  return model;
}

void draw_all(const SceneModel& model, const std::vector<Camera>& cameras, const Options& options, ProgressBar& bar, Render& render) {
  if (options.frames.frames > 1) render.flicker = watch_flicker(options.spec, options.frames, render.input, render.surface);
  const glm::dvec3 up = camera_settings(options.spec.camera, render.input).up;
  const Box box = bounds(render.input.scene);
  FrameHistory history;
  PictureWriter writer(options, render);
  for (int k = 0; k < pictures_of(options); ++k) {
    render.camera = cameras[static_cast<size_t>(k)];
    render.cameras.push_back(camera_json(render.camera, up, box));
    draw_one(model, k, options, bar, history, writer, render);
  }
  writer.finish();
  write_animation(options, render);
}

/// Input, outputs and surface. False where a plan finds no model that meets the tolerance; that is told then.
bool prepare(const Options& options, ProgressBar& bar, Render& render) {
  render.input = load(options);
  render.outputs = outputs_of(options, render.input);
  check_outputs(render.outputs, files_of(render.input), options);
  render.timings.load_ms = render.input.load_ms;
  render.surface = surface_settings(options.spec, render.input);
  refuse_eye_of_views(options.spec.camera, options.spec.views);
  prepare_local(options, render);
  if (!options.plan.tolerance_px) {
    refuse_without_effect(options.spec.surface, render.input, {.kinds = {render.surface.kind}});
    return true;
  }
  if (choose_model(options, bar, render)) return true;
  if (options.json) print_json({{"files", Json::array()}, {"warnings", render.warnings}, {"plan", render.plan}});
  return false;
}

int run(const Options& given) {
  Options options = with_defaults(given);
  const ThreadLimit threads(options.spec.threads);
  ProgressBar bar(wants_progress(options.quiet, options.no_progress));
  input_kind(options.spec.input);
  refuse_alone(options);
  // A wrong output name must not cost the wait for a large model.
  if (!options.outputs.empty()) check_outputs(options.outputs, {options.spec.input}, options);

  Render render;
  if (!prepare(options, bar, render)) return 1;
  choose_method(render, options);
  render.surface.progress = bar.stage("building the surface");
  choose_picture(options, render);
  // Made first: a camera that is wrong is told before the surface is built.
  const std::vector<Camera> cameras = render_cameras(options, render.input);
  if (options.local.tolerance_px) {
    render.local = local_settings(*options.local.tolerance_px, options.plan.silhouette, render.picture.methods, cameras);
    render.local->steady = options.frames.frames > 1;
  }
  check_render_cost(options, cameras.front(), render);
  render.warnings =
      warn_of_input(options, render.input.scene, render.surface, {.methods = names_of(render.picture.methods), .meshes = &render.meshes});

  // While the surface is built and pictures are drawn.
  std::future<void> module_loading;
  if (std::any_of(render.outputs.begin(), render.outputs.end(), by_module) && !is_held_to_one_thread())
    module_loading = load_picture_module_early();
  const SceneModel model = build(options, cameras, render);
  draw_all(model, cameras, options, bar, render);
  bar.clear();
  if (render.flicker && !options.quiet) print_note(flicker_sentence(*render.flicker));
  report_render(options, render, total(model));
  return 0;
}

}  // namespace

Command render_command() {
  return {"render", "draws one picture: G-buffer, border and composite",
          "  limn render gyroid --size 800x600 --set threshold=0.3 -o gyroid.png\n"
          "  limn render gyroid --surface level_set --frames 24 --set hysteresis=0.05 -o gyroid.png --json\n"
          "  limn render bunny.obj --surface mesh_level_set --voxels 400 -o bunny.exr --json",
          add_options, run};
}

}  // namespace limn
