#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <future>
#include <memory>
#include <numbers>

#include "raymarch/files/animated_png.h"
#include "raymarch/files/picture_module.h"
#include "raymarch/image_output.h"
#include "raymarch/look.h"
#include "raymarch/mesh/polygons.h"
#include "raymarch/surface/view_level.h"
#include "samples/commands/command.h"
#include "samples/commands/common.h"
#include "samples/commands/render_outputs.h"
#include "samples/compare/flicker_watch.h"
#include "samples/experiment/camera_json.h"
#include "samples/experiment/empty_picture.h"
#include "samples/experiment/flat_input.h"
#include "samples/experiment/local_request.h"
#include "samples/experiment/no_effect.h"
#include "samples/experiment/thread_settings.h"
#include "samples/input/input_files.h"
#include "samples/input/scene_facts.h"
#include "samples/output/interrupt.h"
#include "samples/output/output.h"
#include "samples/plan/plan_job.h"
#include "sdf/error.h"
#include "sdf/output_file.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

struct Timings {
  double load_ms = 0.0, build_ms = 0.0, trace_ms = 0.0, border_ms = 0.0, write_ms = 0.0;
};

double since_ms(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
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
  Json files = Json::array(), cameras = Json::array();
  glm::vec3 ground{1.0f};                        ///< Behind pictures without alpha of their own.
  std::vector<std::vector<std::byte>> frames{};  ///< PNG files, where one picture plays them.
  Json plan{};                                   ///< What --tolerance chose; null without it.
  std::optional<FlickerWatch> flicker{};         ///< Of several frames.
  ObjectMeshCache meshes{};                      ///< Of the plan, if there was one.
  std::optional<LocalSettings> local{};          ///< Of a local model.
};

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

ResolvedModel resolved_model(const Render& render) {
  return {render.input.scene, render.surface, {render.surface.kind}, render.local ? render.local->tolerance_px : 0.0};
}

bool in_bytes(const Render& render) { return render.picture.colors == PictureColors::bytes; }

bool plays(const Render& render, const Options& options) {
  return std::any_of(render.outputs.begin(), render.outputs.end(), [&](const fs::path& file) { return is_animated(file, options); });
}

/// All frames as one picture.
void write_animation(const Options& options, Render& render) {
  if (!plays(render, options)) return;
  const auto start = std::chrono::steady_clock::now();
  const std::vector<std::byte> bytes = animated_png(render.frames, options.lines.frames_per_second);
  for (const fs::path& file : render.outputs) {
    if (!is_animated(file, options)) continue;
    write_whole(file, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
    render.files.push_back(file.string());
  }
  render.timings.write_ms += since_ms(start);
}

Image<glm::vec4> over_ground(const Image<glm::vec4>& picture, const glm::vec3& ground) {
  auto over = Image<glm::vec4>::unset(picture.width, picture.height);
  parallel_parts(picture.size(), size_t{1} << 14, [&](const IndexRange<size_t>& part) {
    for (size_t i = part.first; i < part.last; ++i) {
      const glm::vec4& pixel = picture.pixels[i];
      over.pixels[i] = pixel + (1.0f - pixel.a) * glm::vec4(ground, 1.0f);
    }
  });
  return over;
}

/// Writes it; the time that took, ms. Of `render` only the frames of an animation change.
double write_picture(const Picture& picture, const Camera& camera, int index, const Options& options, Render& render) {
  const auto start = std::chrono::steady_clock::now();
  const std::string call = resolved_call("render", options.spec, resolved_model(render), camera, render.picture);
  // Layers keep their alpha; a picture to be looked at has a ground.
  const bool grounded = !options.transparent && !options.ink_only && !render.picture.background;
  const Image<glm::vec4> over = grounded ? over_ground(picture.composite, render.ground) : Image<glm::vec4>();
  std::vector<OutputFile> files;
  for (const fs::path& name : render.outputs) {
    if (is_animated(name, options)) continue;
    const fs::path file = picture_file(name, index, options);
    OutputFile output = ending_of(file) == ".exr" ? exr_output(picture, camera, call, file)
                        : in_bytes(render)        ? image_output(picture.bytes, file)
                                                  : image_output(grounded ? over : picture.composite, file);
    files.push_back({file, [write = std::move(output.write)](const fs::path& temporary) {
                       if (interrupted()) throw Cancelled{};
                       write(temporary);
                     }});
  }
  if (plays(render, options))
    render.frames.push_back(in_bytes(render) ? encode_png(picture.bytes) : encode_png(grounded ? over : picture.composite));
  // A layer file and the picture beside it show the same, or are both those of an earlier call.
  write_together(files);
  return since_ms(start);
}

/// Pictures are written while the next one is traced, if there is a second thread.
class Writer {
 public:
  Writer(const Options& options, Render& render) : options_(options), render_(render) {}
  ~Writer() {
    for (const std::future<double>& one : under_way_) one.wait();
  }
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  void write(Picture picture, int index) {
    // Of bytes, which are small, a second one: tracing and writing take about as long, and neither should wait for the other's longest.
    // Films keep their frames in order.
    wait_for(in_bytes(render_) && !plays(render_, options_) ? 1 : 0);
    for (const fs::path& name : render_.outputs)
      if (!is_animated(name, options_)) render_.files.push_back(picture_file(name, index, options_).string());
    if (pictures_of(options_) == 1) {
      render_.timings.write_ms += write_picture(picture, render_.camera, index, options_, render_);
      return;
    }
    under_way_.push_back(run_beside([this, kept = std::make_shared<const Picture>(std::move(picture)), camera = render_.camera, index] {
      return write_picture(*kept, camera, index, options_, render_);
    }));
  }
  /// Throws what writing threw.
  void finish() { wait_for(0); }

 private:
  /// Until so many are under way, the oldest first.
  void wait_for(size_t most) {
    while (under_way_.size() > most) {
      std::future<double> oldest = std::move(under_way_.front());
      under_way_.pop_front();
      render_.timings.write_ms += oldest.get();
    }
  }

  const Options& options_;
  Render& render_;
  std::deque<std::future<double>> under_way_{};
};

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

void draw_one(const SceneModel& model, int index, const Options& options, ProgressBar& bar, FrameHistory& history, Writer& writer,
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

// All frames have one size: the first camera frames the object as it goes round.
std::vector<Camera> turntable_cameras(const CameraSettings& settings, const FramedSurface& framed, const FramingSettings& framing,
                                      int count) {
  const glm::dvec3 center = settings.target ? *settings.target : framed.bounds.finite() ? framed.bounds.center() : glm::dvec3(0.0);
  const Camera first = camera_of_view(settings, turned_surface(framed, center, settings.up, count), framing, 0, 1);
  std::vector<Camera> cameras;
  cameras.reserve(static_cast<size_t>(count));
  for (int i = 0; i < count; ++i) cameras.push_back(turned_camera(first, center, settings.up, 2.0 * std::numbers::pi * i / count));
  return cameras;
}

std::vector<Camera> cameras_of(const Options& options, const SceneInput& input) {
  const CameraSettings settings = camera_settings(options.spec.camera, input);
  const FramedSurface framed = framed_input(options.spec.camera, input);
  const FramingSettings framing = framing_settings(options.spec.camera);
  if (options.frames.frames > 1) return path_cameras(camera_of_view(settings, framed, framing, 0, 1), framed.bounds, options.frames);
  if (options.turntable > 0) return turntable_cameras(settings, framed, framing, options.turntable);
  std::vector<Camera> cameras;
  cameras.reserve(static_cast<size_t>(options.spec.views));
  for (int view = 0; view < options.spec.views; ++view)
    cameras.push_back(camera_of_view(settings, framed, framing, view, options.spec.views));
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
                {"cameras", render.cameras},
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

int run(const Options& given) {
  Options options = with_defaults(given);
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
  choose_method(render, options);
  render.surface.progress = bar.stage("building the surface");
  render.picture = picture_settings(options.spec.border, render.input);
  if (options.spec.border.look) render.ground = looks().find(*options.spec.border.look).ground;
  const auto has_layers = [](const fs::path& file) { return ending_of(file) == ".exr"; };
  const bool layered = std::any_of(render.outputs.begin(), render.outputs.end(), has_layers);
  render.picture.mattes = layered;
  if (!layered && !options.transparent && !options.ink_only && !render.picture.background) render.picture.background = render.ground;
  constexpr GBufferLayers none{false, false, false, false, false, false, false, false};
  if (!layered) render.picture.layers = none;
  const auto is_png = [](const fs::path& file) { return ending_of(file) == ".png" || ending_of(file) == ".apng"; };
  const bool all_png = std::all_of(render.outputs.begin(), render.outputs.end(), is_png);
  if (all_png) render.picture.colors = PictureColors::bytes;
  render.picture.hands_over_gbuffer = layered;
  // Made first: a camera that is wrong is told before the surface is built.
  const std::vector<Camera> cameras = cameras_of(options, render.input);

  if (options.local.tolerance_px) {
    render.local = local_settings(*options.local.tolerance_px, options.plan.silhouette, render.picture.methods, cameras);
    render.local->steady = options.frames.frames > 1;
  }

  // A local level set says itself when it needs too much: what it takes is not known before.
  const bool is_local_volume = render.local && has_local_bricks(render.surface.kind);
  const bool by_module =
      std::any_of(render.outputs.begin(), render.outputs.end(), [&](const auto& file) { return !is_png(file) && !has_layers(file); });
  if (!is_local_volume) {
    PictureLoad load = picture_load(cameras.front(), planned_picture(render), {pictures_of(options), layered, options.frames.frames > 1});
    if (by_module) load.library_bytes = kPictureLibraryBytes;
    check_cost(options, render.input.scene, render.surface, load);
  }
  render.warnings =
      warn_of_input(options, render.input.scene, render.surface, {.methods = names_of(render.picture.methods), .meshes = &render.meshes});

  // While the surface is built.
  std::future<void> pictures;
  if (by_module && !is_held_to_one_thread()) pictures = load_picture_module_early();
  const auto build_start = std::chrono::steady_clock::now();
  std::vector<std::string> levels;
  if (options.spec.surface.level_for_view && !options.plan.tolerance_px)
    levels = refine_for_views(render.surface, cameras, render.input.scene);
  const SceneModel model = render.local ? build_local_model(render.input.scene, render.surface, *render.local, &render.meshes)
                                        : build_model(render.input.scene, render.surface, &render.meshes);
  render.timings.build_ms = since_ms(build_start);
  const SurfaceInfo info = total(model);
  print_warnings(options, info.warnings);
  render.warnings.insert(render.warnings.end(), info.warnings.begin(), info.warnings.end());
  render.notes.insert(render.notes.end(), levels.begin(), levels.end());
  render.notes.insert(render.notes.end(), info.notes.begin(), info.notes.end());
  if (options.frames.frames > 1) render.flicker = watch_flicker(options.spec, options.frames, render.input, render.surface);
  const glm::dvec3 up = camera_settings(options.spec.camera, render.input).up;
  const Box box = bounds(render.input.scene);
  FrameHistory history;
  Writer writer(options, render);
  for (int k = 0; k < pictures_of(options); ++k) {
    render.camera = cameras[static_cast<size_t>(k)];
    render.cameras.push_back(camera_json(render.camera, up, box));
    draw_one(model, k, options, bar, history, writer, render);
  }
  writer.finish();
  write_animation(options, render);
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
