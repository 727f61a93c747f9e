#pragma once
// What a call asks for, resolved: the command line over the scene file over the defaults.

#include "raymarch/picture.h"
#include "samples/input.h"
#include "samples/progress.h"

namespace limn {

/// Surface settings; `kind` is empty where nobody named one (each object in its natural representation).
/// Objects' own levels give way to the command line's.
SurfaceSettings surface_settings(const Options& options, SceneInput& input);

/// Camera of the scene with the command line over it.
CameraSettings camera_settings(const Options& options, const SceneInput& input);
/// View `index` of `count`: the camera's own where count is 1, else framed from view_direction().
Camera camera_of_view(const CameraSettings& settings, const Box& bounds, int index, int count);

/// The methods with their parameters. `--set key=value` goes to every method that has the key, `--set method.key=value` to that one.
std::vector<MethodCall> method_calls(const Options& options, const SceneInput& input);

PictureSettings picture_settings(const Options& options, const SceneInput& input);
ExecutionSettings execution_settings(const Options& options);

/// The whole call with nothing left open, for file headers; the same for any number of threads.
/// Settings are in it as far as they have an effect on what is built of the scene: `kinds` as OptionUse has them.
struct ResolvedModel {
  const Scene& scene;
  const SurfaceSettings& surface;
  std::vector<std::string> kinds{};
};
std::string resolved_call(const std::string& command, const Options& options, const ResolvedModel& model, const Camera& camera,
                          const PictureSettings& picture);
/// "rim threshold=0.4" for captions.
std::string methods_text(const std::vector<MethodCall>& methods);

}  // namespace limn
