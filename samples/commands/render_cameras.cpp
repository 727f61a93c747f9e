#include <numbers>

#include "raymarch/frames.h"
#include "samples/commands/render_call.h"
#include "samples/commands/render_outputs.h"

namespace limn {
namespace {

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

}  // namespace

std::vector<Camera> render_cameras(const Options& options, const SceneInput& input) {
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

}  // namespace limn
