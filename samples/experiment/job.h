#pragma once
// What an experiment asks for, resolved: the specification over the scene file over the defaults.

#include "raymarch/framing.h"
#include "raymarch/picture.h"
#include "samples/input/input.h"
#include "samples/output/progress.h"
#include "samples/spec/flags.h"

namespace limn {

/// Surface settings; `kind` is empty where nobody named one (each object in its natural representation).
/// Objects' own levels give way to the specification's.
SurfaceSettings surface_settings(const ExperimentSpec& spec, SceneInput& input);

/// Camera of the scene with the specification over it.
CameraSettings camera_settings(const CameraSpec& spec, const SceneInput& input);
/// What the camera frames: the input's surface; of built-in scenes the corners of their bounds, for which their cameras are made, unless
/// the call says from where to look.
FramedSurface framed_input(const CameraSpec& spec, const SceneInput& input);
/// Roll, zoom and margin.
FramingSettings framing_settings(const CameraSpec& spec);
/// View `index` of `count`: the camera's own where count is 1, else framed from view_direction().
Camera camera_of_view(const CameraSettings& settings, const FramedSurface& surface, const FramingSettings& framing, int index, int count);

/// The methods with their parameters. A parameter `key` goes to every method that has it, `method.key` to that one.
std::vector<MethodCall> method_calls(const BorderSpec& spec, const SceneInput& input);

/// Methods, samples and background of a picture. Throws InputError as method_calls does.
PictureSettings picture_settings(const BorderSpec& spec, const SceneInput& input);
/// For so many threads (0: all); cancelled where the program is interrupted.
ExecutionSettings execution_settings(int threads);

/// What a call is resolved for.
struct ResolvedModel {
  /// Must outlive this.
  const Scene& scene;
  /// Must outlive this.
  const SurfaceSettings& surface;
  std::vector<std::string> kinds{};  ///< Representations that are built; an empty name: each object's natural one.
  double local_px = 0.0;             ///< Tolerance of local meshes, which have no level; 0: none is built.
};
/// The whole call with nothing left open, for file headers; the same for any number of threads. Settings are in it as far as they have an
/// effect on what is built of the scene.
std::string resolved_call(const std::string& command, const ExperimentSpec& spec, const ResolvedModel& model, const Camera& camera,
                          const PictureSettings& picture);
/// The camera, wholly said.
void add_camera(const Camera& camera, CallText& call);
/// "rim threshold=0.4" for captions.
std::string methods_text(const std::vector<MethodCall>& methods);

}  // namespace limn
