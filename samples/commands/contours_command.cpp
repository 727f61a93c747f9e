#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <map>
#include <tuple>

#include "samples/commands/command.h"
#include "samples/commands/common.h"
#include "samples/commands/contours_frames.h"
#include "samples/experiment/camera_json.h"
#include "samples/experiment/line_scene.h"
#include "samples/experiment/thread_settings.h"
#include "samples/input/input_files.h"
#include "samples/lines/graph_json.h"
#include "samples/lines/write_drawing.h"
#include "samples/output/output.h"
#include "sdf/error.h"
#include "sdf/output_file.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kEndings = {".svg", ".pdf", ".json", ".dxf"};

void add_options(CLI::App& app, Options& options) {
  add_input(app, options);
  add_lines(app, options);
  add_line_surface(app, options);
  add_camera(app, options, true);
  add_line_frames(app, options);
  add_output(app, options, ".svg .pdf .json or .dxf, repeatable; default limn-out/contours/<name>.svg", true);
  add_json(app, options);
  add_execution(app, options);
}

std::string plural(size_t count, const char* what) { return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s"); }

DrawingSettings drawing_settings(const LineOptions& lines) {
  DrawingSettings settings = lines.drawing;
  if (lines.layers) std::tie(settings.lowest_invisibility, settings.highest_invisibility) = *lines.layers;
  if (lines.hidden) settings.highest_invisibility = std::numeric_limits<int>::max();
  return settings;
}

int pictures_of(const Options& options) { return std::max(options.spec.views, options.frames.frames); }

// name.svg, or name_v03.svg for one of several views, name_f03.svg for one of several frames.
fs::path picture_file(const fs::path& file, int index, const Options& options) {
  if (pictures_of(options) == 1) return file;
  fs::path out = file;
  out.replace_filename(fmt::format("{}_{}{:0{}}{}", file.stem().string(), options.frames.frames > 1 ? 'f' : 'v', index,
                                   std::to_string(pictures_of(options) - 1).size(), file.extension().string()));
  return out;
}

std::vector<fs::path> outputs_of(const Options& options, const SceneInput& input) {
  std::vector<fs::path> outputs = options.outputs;
  if (outputs.empty()) outputs.push_back(default_output("contours", input.name).string() + ".svg");
  const auto check = [&](const fs::path& file, const std::vector<std::string>& endings) {
    check_output_file(file, options.no_clobber, endings);
    check_not_input(file, files_of(input));
  };
  for (const fs::path& file : outputs) {
    if (options.lines.animate) {
      check(file, {".svg"});
      continue;
    }
    for (int index = 0; index < pictures_of(options); ++index) check(picture_file(file, index, options), kEndings);
  }
  return outputs;
}

/// With --surface the lines of that model: a level set's spline, or a mesh's facets.
Scene modelled(const Options& options, SceneInput& input, ProgressBar& bar) {
  std::vector<std::string> warnings;
  Scene scene = scene_of_lines(options.spec, input, bar.stage("building the surface"), warnings);
  print_warnings(options, warnings);
  return scene;
}

/// One view or frame, solved.
struct Shot {
  Camera camera{};
  ViewGraph graph{};
  std::vector<int> ids{};  ///< Of chains, where there are frames.
  double solve_ms = 0.0;
};

LineDrawing drawing_of(const Shot& shot, const Options& options) {
  return make_drawing(shot.graph, shot.camera.width_px, shot.camera.height_px, drawing_settings(options.lines), shot.ids);
}

void write(const fs::path& file, const Shot& shot, const Options& options, const std::string& title) {
  if (ending_of(file) == ".json") {
    write_whole(file, graph_json(shot.graph, shot.camera.width_px, shot.camera.height_px, shot.ids).dump() + "\n");
    return;
  }
  const LineDrawing drawing = drawing_of(shot, options);
  if (ending_of(file) == ".svg") {
    write_whole(file, svg_text(drawing, title));
  } else if (ending_of(file) == ".dxf") {
    write_whole(file, dxf_text(drawing));
  } else {
    write_whole(file, [&](const fs::path& temporary) { write_pdf(drawing, title, temporary); });
  }
}

void print_certificate(const Options& options, const ViewGraph& graph, int index) {
  if (options.quiet) return;
  const std::string which = pictures_of(options) == 1 ? "" : fmt::format("{} {}: ", options.frames.frames > 1 ? "frame" : "view", index);
  print_note(fmt::format("{}{}, {}, {} {:.3g} px", which, plural(graph.chains.size(), "chain"), plural(graph.conflicts.size(), "conflict"),
                         graph.exact ? "bound" : "not exact, estimated bound", graph.bound_px));
  for (const LineConflict& conflict : graph.conflicts)
    print_note(fmt::format("{}conflict at {:.1f}, {:.1f}: {}", which, conflict.px.x, conflict.px.y, conflict.what));
}

/// "birth: tangency (16)", a line each kind, and what nothing explains.
void print_tracks(const Options& options, const LineTracks& tracks) {
  if (options.quiet) return;
  std::map<std::pair<ChainChange, ChainCause>, size_t> counts;
  for (const ChainEvent& event : tracks.events) ++counts[{event.change, event.cause}];
  print_note(fmt::format("{}, {} of visible chains, {} unexplained", plural(static_cast<size_t>(tracks.ids), "id"),
                         plural(tracks.events.size(), "change"), unexplained(tracks)));
  for (const auto& [what, count] : counts) print_note(fmt::format("{}: {} ({})", name_of(what.first), name_of(what.second), count));
  for (const ChainEvent& event : tracks.events) {
    if (event.cause == ChainCause::unexplained)
      print_note(fmt::format("unexplained {} of chain {} between frames {:.4f} and {:.4f} at {:.1f}, {:.1f}: {:.1f} px{}",
                             name_of(event.change), event.id, event.from, event.to, event.px.x, event.px.y, event.length_px,
                             event.beside_conflict ? ", beside a conflict" : ""));
  }
}

/// Solves views or frames one after the other.
class Film {
 public:
  Film(const Options& options, const SceneInput& input, const Scene& scene, ProgressBar& bar)
      : options_(options),
        scene_(scene),
        bar_(bar),
        framed_(framed_input(options.spec.camera, input)),
        settings_(camera_settings(options.spec.camera, input)) {
    execution_.threads = options.spec.threads;
    if (options.frames.frames > 1) camera_at_ = cameras_of_frames(options, settings_, framed_);
  }

  Shot shot(int index) {
    Shot next;
    next.camera = camera_at_ ? camera_at_(index)
                             : camera_of_view(settings_, framed_, framing_settings(options_.spec.camera), index, options_.spec.views);
    const auto start = std::chrono::steady_clock::now();
    next.graph = solve(next.camera);
    next.solve_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    if (camera_at_) {
      const auto graph_at = [this](double time) { return solve(camera_at_(time)); };
      next.ids = index == 0 ? first_ids(next.graph, tracks)
                            : follow_chains(before_.graph, before_.ids, index - 1, next.graph, index, graph_at, {}, tracks);
      before_ = next;
    }
    bar_.clear();
    return next;
  }
  LineTracks tracks{};

 private:
  ViewGraph solve(const Camera& camera) {
    execution_.progress = bar_.stage("solving the lines");
    return solve_lines(scene_, camera, options_.lines.lines, execution_, &memory_);
  }

  const Options& options_;
  const Scene& scene_;
  ProgressBar& bar_;
  FramedSurface framed_;
  CameraSettings settings_;
  ExecutionSettings execution_{};
  LineMemory memory_{};
  CameraAt camera_at_{};
  Shot before_{};
};

int run(const Options& options) {
  const ThreadLimit threads(options.spec.threads);
  ProgressBar bar(wants_progress(options.quiet, options.no_progress));
  SceneInput input = load(options);
  const std::vector<fs::path> outputs = outputs_of(options, input);
  const Scene scene = modelled(options, input, bar);
  check_smooth(options.lines.lines, scene, "--smooth");
  Film film(options, input, scene, bar);
  Json documents = Json::array(), files = Json::array();
  std::vector<LineDrawing> drawings;
  size_t conflicts = 0;
  for (int index = 0; index < pictures_of(options); ++index) {
    const Shot shot = film.shot(index);
    if (options.lines.animate) drawings.push_back(drawing_of(shot, options));
    for (const fs::path& file : outputs) {
      if (options.lines.animate) break;
      const fs::path out = picture_file(file, index, options);
      write(out, shot, options, input.name);
      files.push_back(out.string());
    }
    conflicts += shot.graph.conflicts.size();
    print_certificate(options, shot.graph, index);
    Json document = certificate_json(shot.graph);
    document["solve_ms"] = shot.solve_ms;
    document["camera"] = camera_json(shot.camera, camera_settings(options.spec.camera, input).up, bounds(input.scene));
    if (!shot.ids.empty()) document["ids"] = shot.ids;
    documents.push_back(std::move(document));
  }
  if (options.lines.animate) {
    for (const fs::path& file : outputs) {
      write_whole(file, animated_svg_text(drawings, input.name, options.lines.frames_per_second));
      files.push_back(file.string());
    }
  }
  const bool frames = options.frames.frames > 1;
  if (frames) print_tracks(options, film.tracks);
  if (options.json) {
    Json all = {{"files", files}, {frames ? "frames" : "views", documents}};
    if (frames) all["tracks"] = tracks_json(film.tracks);
    print_json(all);
  } else if (!options.quiet) {
    for (const auto& file : files) print_text(file.get<std::string>() + "\n");
  }
  return options.lines.strict && conflicts + static_cast<size_t>(unexplained(film.tracks)) > 0 ? 1 : 0;
}

}  // namespace

Command contours_command() {
  return {"contours", "draws the lines of the true surface as vectors: contours, creases, boundaries, visible and hidden",
          "  limn contours teacup -o teacup.svg\n"
          "  limn contours machined_part --hidden --style technical --curves arc -o part.svg -o part.dxf\n"
          "  limn contours gyroid --surface level_set --voxels 256 -o gyroid.pdf\n"
          "  limn contours rook --frames 120 --turn 360 --animate -o rook.svg",
          add_options, run};
}

}  // namespace limn
