#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "raymarch/files/picture_module.h"
#include "raymarch/image_output.h"
#include "raymarch/surface/view_level.h"
#include "samples/commands/command.h"
#include "samples/commands/common.h"
#include "samples/compare/flicker_watch.h"
#include "samples/experiment/empty_picture.h"
#include "samples/experiment/local_request.h"
#include "samples/experiment/no_effect.h"
#include "samples/experiment/thread_settings.h"
#include "samples/input/input_files.h"
#include "samples/input/scene_facts.h"
#include "samples/output/interrupt.h"
#include "samples/output/output.h"
#include "samples/plan/plan_job.h"
#include "sdf/error.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kEndings = {".exr", ".png", ".tif", ".tiff", ".jpg", ".jpeg"};

struct Timings {
  double load_ms = 0.0, build_ms = 0.0, trace_ms = 0.0, border_ms = 0.0, write_ms = 0.0;
};

double since_ms(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

int pictures_of(const Options& options) { return std::max(options.spec.views, options.frames.frames); }

// name.png, or name_v03.png for one of several views, name_f03.png for one of several frames.
fs::path picture_file(const fs::path& file, int index, const Options& options) {
  if (pictures_of(options) == 1) return file;
  const auto digits = std::to_string(pictures_of(options) - 1).size();
  fs::path out = file;
  out.replace_filename(
      fmt::format("{}_{}{:0{}}{}", file.stem().string(), options.frames.frames > 1 ? 'f' : 'v', index, digits, file.extension().string()));
  return out;
}

std::vector<fs::path> outputs_of(const Options& options, const SceneInput& input) {
  if (!options.outputs.empty()) return options.outputs;
  const std::string name = default_output("render", input.name).string();
  return {name + ".exr", name + ".png"};
}

void check_outputs(const std::vector<fs::path>& outputs, const std::vector<fs::path>& inputs, const Options& options) {
  for (size_t i = 0; i < outputs.size(); ++i) {
    const auto same = [&](const fs::path& other) { return fs::weakly_canonical(other) == fs::weakly_canonical(outputs[i]); };
    if (std::any_of(outputs.begin(), outputs.begin() + static_cast<std::ptrdiff_t>(i), same))
      throw InputError({outputs[i].string(), "--output", "", "is given twice", "a file of its own for each --output"});
  }
  for (const fs::path& file : outputs) {
    for (int k = 0; k < pictures_of(options); ++k) {
      check_output_file(picture_file(file, k, options), options.no_clobber, kEndings);
      check_not_input(picture_file(file, k, options), inputs);
    }
  }
}

Json surface_json(const SurfaceInfo& info) {
  return {{"kind", info.kind},   {"voxels", info.voxels},     {"voxel_size", info.voxel_size}, {"triangles", info.triangles},
          {"bytes", info.bytes}, {"build_ms", info.build_ms}, {"warnings", info.warnings}};
}

std::string summary(const SurfaceInfo& info, const Camera& camera, const HitCounts& counts, const Timings& timings) {
  std::string text = fmt::format("{}x{}, {}, {} hits, {} misses", camera.width_px, camera.height_px, info.kind, counts.hits, counts.misses);
  if (counts.out_of_steps > 0) text += fmt::format(", {} out of steps", counts.out_of_steps);
  text += fmt::format("; load {}, build {}, trace {}, border {}, write {}", time_text(timings.load_ms), time_text(timings.build_ms),
                      time_text(timings.trace_ms), time_text(timings.border_ms), time_text(timings.write_ms));
  if (info.bytes > 0) text += "; " + bytes_text(static_cast<double>(info.bytes));
  return text + "\n";
}

void add_options(CLI::App& app, Options& options) {
  add_input(app, options);
  add_camera(app, options, true);
  add_frames(app, options, "N pictures while the camera wanders within a pixel, 1..10000, and how often ink flips meanwhile");
  add_surface(app, options, {.surface = true, .repeatable = false, .views = true});
  add_local(app, options, false);
  add_plan(app, options);
  add_border(app, options);
  add_output(app, options, ".exr (all layers) or .png .tif .jpg (the composite), repeatable; default limn-out/render/<name>.exr and .png",
             true);
  add_json(app, options);
  add_execution(app, options);
}

// What all views of one call share, and what they add up to.
struct Render {
  SceneInput input;
  std::vector<fs::path> outputs;
  SurfaceSettings surface;
  PictureSettings picture;
  Camera camera;  ///< Of the last view.
  Timings timings;
  HitCounts counts;
  std::vector<std::string> warnings, notes;
  int empty_pictures = 0;
  Json files = Json::array();
  Json plan{};                            ///< What --tolerance chose; null without it.
  std::optional<FlickerWatch> flicker{};  ///< Of several frames.
  std::optional<LocalSettings> local{};   ///< Of a local model.
};

/// What has no meaning without something else in the call.
void refuse_alone(const Options& options) {
  if (options.plan.silhouette && !options.local.asked && !options.plan.tolerance_px)
    throw InputError({"", "metric", "", "has no effect without tolerance or local; leave it out", ""});
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

ResolvedModel resolved_model(const Render& render) {
  return {render.input.scene, render.surface, {render.surface.kind}, render.local ? render.local->tolerance_px : 0.0};
}

void write_picture(const Picture& picture, int index, const Options& options, Render& render) {
  const auto start = std::chrono::steady_clock::now();
  const std::string call = resolved_call("render", options.spec, resolved_model(render), render.camera, render.picture);
  std::vector<OutputFile> files;
  for (const fs::path& name : render.outputs) {
    const fs::path file = picture_file(name, index, options);
    OutputFile output = ending_of(file) == ".exr" ? exr_output(picture, render.camera, call, file) : image_output(picture.composite, file);
    files.push_back({file, [write = std::move(output.write)](const fs::path& temporary) {
                       if (interrupted()) throw Cancelled{};
                       write(temporary);
                     }});
    render.files.push_back(file.string());
  }
  // A layer file and the picture beside it show the same, or are both those of an earlier call.
  write_together(files);
  render.timings.write_ms += since_ms(start);
}

// Of many pictures the first few stand for the rest.
void warn_of_empty(const std::vector<std::string>& reasons, int index, const Options& options, Render& render) {
  constexpr int kMost = 5;
  if (reasons.empty() || ++render.empty_pictures > kMost) return;
  std::vector<std::string> warnings;
  warnings.reserve(reasons.size());
  for (const std::string& reason : reasons) {
    warnings.push_back(pictures_of(options) == 1 ? reason
                                                 : fmt::format("{} {}: {}", options.frames.frames > 1 ? "frame" : "view", index, reason));
  }
  if (render.empty_pictures == kMost) warnings.emplace_back("further pictures that show nothing are not told one by one");
  print_warnings(options, warnings);
  render.warnings.insert(render.warnings.end(), warnings.begin(), warnings.end());
}

void draw_one(const SceneModel& model, int index, const Options& options, ProgressBar& bar, FrameHistory& history, Render& render) {
  ExecutionSettings how = execution_settings(options.spec.threads);
  const int pictures = pictures_of(options);
  how.progress = bar.stage(
      pictures == 1 ? "tracing" : fmt::format("tracing {} {} of {}", options.frames.frames > 1 ? "frame" : "view", index + 1, pictures));
  const Picture picture = draw_picture(render.input.scene, model, render.camera, render.picture, how, render.flicker ? &history : nullptr);
  if (render.flicker) watch_frame(picture, history, render.camera, how, *render.flicker);
  const HitCounts seen = count_hits(picture.gbuffer);
  render.timings.trace_ms += picture.trace_ms;
  render.timings.border_ms += picture.border_ms;
  render.counts.hits += seen.hits;
  render.counts.misses += seen.misses;
  render.counts.out_of_steps += seen.out_of_steps;
  render.notes.insert(render.notes.end(), picture.notes.begin(), picture.notes.end());
  warn_of_empty(why_empty(render.input.scene, model, render.camera, seen), index, options, render);
  write_picture(picture, index, options, render);
}

std::vector<Camera> cameras_of(const Options& options, const SceneInput& input) {
  const CameraSettings settings = camera_settings(options.spec.camera, input);
  const Box box = bounds(input.scene);
  if (options.frames.frames > 1) return path_cameras(camera_of_view(settings, box, 0, 1), box, options.frames);
  std::vector<Camera> cameras;
  cameras.reserve(static_cast<size_t>(options.spec.views));
  for (int view = 0; view < options.spec.views; ++view) cameras.push_back(camera_of_view(settings, box, view, options.spec.views));
  return cameras;
}

/// By which rules cages were subdivided: nobody need have said.
std::vector<std::string> scheme_lines(const Scene& scene, const SurfaceSettings& settings) {
  std::vector<std::string> lines;
  for (const SceneObject& object : scene.objects) {
    const auto scheme = cage_scheme(object, settings);
    if (scheme)
      lines.push_back(
          fmt::format("'{}' is subdivided by {}, level {}", object.name, name_of(*scheme), object.level.value_or(settings.level)));
  }
  return lines;
}

void report(const Options& options, const Render& render, const SurfaceInfo& info) {
  const Timings& timings = render.timings;
  if (!options.quiet) {
    for (const std::string& note : render.notes) print_note(note);
  }
  if (options.verbose) {
    for (const std::string& line : scheme_lines(render.input.scene, render.surface)) print_note(line);
    print_note(resolved_call("render", options.spec, resolved_model(render), render.camera, render.picture));
  }
  if (options.json) {
    print_json({{"hits", render.counts.hits},
                {"misses", render.counts.misses},
                {"out_of_steps", render.counts.out_of_steps},
                {"timings_ms",
                 {{"load", timings.load_ms},
                  {"build", timings.build_ms},
                  {"trace", timings.trace_ms},
                  {"border", timings.border_ms},
                  {"write", timings.write_ms}}},
                {"surface", surface_json(info)},
                {"files", render.files},
                {"warnings", render.warnings},
                {"notes", render.notes},
                {"plan", render.plan},
                {"flicker", render.flicker ? flicker_json(*render.flicker) : Json()}});
  } else if (!options.quiet) {
    std::string text;
    for (const Json& file : render.files) text += file.get<std::string>() + "\n";
    print_text(text + summary(info, render.camera, render.counts, timings));
  }
}

// With --tolerance the plan says how to model; nothing is drawn where nothing meets it.
bool choose_model(const Options& options, ProgressBar& bar, Render& render) {
  const PlanJob job = plan_for(options.spec, options.plan, render.input, bar, options.local.asked);
  const std::vector<std::string> sentences = plan_sentences(job.answer, job.settings);
  render.plan = plan_json(job);
  if (!options.quiet) print_note(sentences.front());
  if (!job.answer.chosen) return false;
  const PlanTrial& chosen = job.answer.trials[*job.answer.chosen];
  render.surface = job.answer.ladders[chosen.ladder].at(chosen.rung);
  if (const auto local = job.answer.ladders[chosen.ladder].local_at(chosen.rung)) render.local = *local;
  for (SceneObject& object : render.input.scene.objects) object.level.reset();
  return true;
}

int run(const Options& options) {
  const ThreadLimit threads(options.spec.threads);
  ProgressBar bar(wants_progress(options.quiet, options.no_progress));
  input_kind(options.spec.input);
  refuse_alone(options);
  // A wrong output name must not cost the wait for a large model.
  if (!options.outputs.empty()) check_outputs(options.outputs, {options.spec.input}, options);

  Render render;
  render.input = load(options);
  render.outputs = outputs_of(options, render.input);
  check_outputs(render.outputs, files_of(render.input), options);
  render.timings.load_ms = render.input.load_ms;
  render.surface = surface_settings(options.spec, render.input);
  refuse_eye_of_views(options.spec.camera, options.spec.views);
  prepare_local(options, render);
  if (!options.plan.tolerance_px) refuse_without_effect(options.spec.surface, render.input, {.kinds = {render.surface.kind}});
  if (options.plan.tolerance_px && !choose_model(options, bar, render)) {
    if (options.json) print_json({{"files", Json::array()}, {"warnings", render.warnings}, {"plan", render.plan}});
    return 1;
  }
  render.surface.progress = bar.stage("building the surface");
  render.picture = picture_settings(options.spec.border, render.input);
  const auto has_layers = [](const fs::path& file) { return ending_of(file) == ".exr"; };
  if (std::none_of(render.outputs.begin(), render.outputs.end(), has_layers)) render.picture.layers = layers_read(render.picture.methods);
  // Made first: a camera that is wrong is told before the surface is built.
  const std::vector<Camera> cameras = cameras_of(options, render.input);

  if (options.local.tolerance_px)
    render.local = local_settings(*options.local.tolerance_px, options.plan.silhouette, render.picture.methods, cameras);

  check_cost(options, render.input.scene, render.surface,
             picture_load(cameras.front(), render.picture, pictures_of(options),
                          std::any_of(render.outputs.begin(), render.outputs.end(), has_layers)));
  render.warnings = warn_of_input(options, render.input.scene, render.surface, {.methods = names_of(render.picture.methods)});

  // While the surface is built.
  const auto is_png = [](const fs::path& file) { return ending_of(file) == ".png"; };
  std::future<void> pictures;
  if (!std::all_of(render.outputs.begin(), render.outputs.end(), is_png)) pictures = load_picture_module_early();
  const auto build_start = std::chrono::steady_clock::now();
  std::vector<std::string> levels;
  if (options.spec.surface.level_for_view && !options.plan.tolerance_px)
    levels = refine_for_views(render.surface, cameras, render.input.scene);
  const SceneModel model =
      render.local ? build_local_model(render.input.scene, render.surface, *render.local) : build_model(render.input.scene, render.surface);
  render.timings.build_ms = since_ms(build_start);
  const SurfaceInfo info = total(model);
  print_warnings(options, info.warnings);
  render.warnings.insert(render.warnings.end(), info.warnings.begin(), info.warnings.end());
  render.notes = levels;
  render.notes.insert(render.notes.end(), info.notes.begin(), info.notes.end());
  if (options.frames.frames > 1) render.flicker = watch_flicker(options.spec, options.frames, render.input, render.surface);
  FrameHistory history;
  for (int k = 0; k < pictures_of(options); ++k) {
    render.camera = cameras[static_cast<size_t>(k)];
    draw_one(model, k, options, bar, history, render);
  }
  bar.clear();
  if (render.flicker && !options.quiet) print_note(flicker_sentence(*render.flicker));
  report(options, render, info);
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
