#include <fmt/format.h>

#include "samples/commands/common.h"
#include "samples/commands/render_call.h"
#include "samples/input/scene_facts.h"

namespace limn {
namespace {

Json surface_json(const SurfaceInfo& info) {
  return {{"kind", info.kind},   {"voxels", info.voxels},     {"voxel_size", info.voxel_size}, {"triangles", info.triangles},
          {"bytes", info.bytes}, {"build_ms", info.build_ms}, {"warnings", info.warnings}};
}

std::string summary(const SurfaceInfo& info, const Camera& camera, const HitCounts& counts, const RenderTimings& timings) {
  std::string text = fmt::format("{}x{}, {}, {} hits, {} misses", camera.width_px, camera.height_px, info.kind, counts.hits, counts.misses);
  if (counts.out_of_steps > 0) text += fmt::format(", {} out of steps", counts.out_of_steps);
  text += fmt::format("; load {}, build {}, trace {}, border {}, write {}", time_text(timings.load_ms), time_text(timings.build_ms),
                      time_text(timings.trace_ms), time_text(timings.border_ms), time_text(timings.write_ms));
  if (info.bytes > 0) text += "; " + bytes_text(static_cast<double>(info.bytes));
  return text + "\n";
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

}  // namespace

void report_render(const Options& options, const Render& render, const SurfaceInfo& info) {
  const RenderTimings& timings = render.timings;
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

}  // namespace limn
