#pragma once
// One call of `limn render`, from its input to its report.

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "raymarch/local_model.h"
#include "raymarch/picture.h"
#include "samples/commands/options.h"
#include "samples/compare/flicker_watch.h"
#include "samples/experiment/job.h"
#include "samples/input/input.h"
#include "samples/output/output.h"

namespace limn {

/// Of all views together, ms.
struct RenderTimings {
  double load_ms = 0.0, build_ms = 0.0, trace_ms = 0.0, border_ms = 0.0, write_ms = 0.0;
};

/// What all views of one call share, and what they add up to.
struct Render {
  SceneInput input{};
  std::vector<std::filesystem::path> outputs{};
  SurfaceSettings surface{};
  PictureSettings picture{};
  Camera camera{};  ///< Of the last view.
  RenderTimings timings{};
  HitCounts counts{};
  std::vector<std::string> warnings{}, notes{};
  int empty_pictures = 0;
  Json files = Json::array(), cameras = Json::array();
  glm::vec3 ground{1.0f};                        ///< Behind pictures without alpha of their own.
  std::vector<std::vector<std::byte>> frames{};  ///< PNG files, where one picture plays them.
  Json plan{};                                   ///< What --tolerance chose; null without it.
  std::optional<FlickerWatch> flicker{};         ///< Of several frames.
  ObjectMeshCache meshes{};                      ///< Of the plan, if there was one.
  std::optional<LocalSettings> local{};          ///< Of a local model.
};

inline double elapsed_ms(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// What the call drew, as it is written into files.
inline ResolvedModel resolved_model(const Render& render) {
  return {render.input.scene, render.surface, {render.surface.kind}, render.local ? render.local->tolerance_px : 0.0};
}

/// The cameras of all pictures. Throws InputError.
std::vector<Camera> render_cameras(const Options& options, const SceneInput& input);

/// Files, what was seen and how long it took; on stdout, with notes on stderr.
void report_render(const Options& options, const Render& render, const SurfaceInfo& info);

}  // namespace limn
