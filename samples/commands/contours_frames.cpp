#include "samples/commands/contours_frames.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "samples/experiment/job.h"

namespace limn {

CameraAt cameras_of_frames(const Options& options, const CameraSettings& settings, const FramedSurface& framed) {
  const Box& bounds = framed.bounds;
  const Camera first = camera_of_view(settings, framed, framing_settings(options.spec.camera), 0, 1);
  if (const auto& turn = options.lines.turn_deg) {
    const glm::dvec3 target = settings.target ? *settings.target : bounds.finite() ? bounds.center() : glm::dvec3(0.0);
    const double angle = *turn * std::numbers::pi / 180.0 / options.frames.frames;
    return [first, target, up = settings.up, angle](double time) { return turned_camera(first, target, up, time * angle); };
  }
  return [path = path_cameras(first, bounds, options.frames)](double time) {
    const auto i = std::min(static_cast<size_t>(time), path.size() - 1), next = std::min(i + 1, path.size() - 1);
    Camera camera = path[i];
    camera.eye = glm::mix(path[i].eye, path[next].eye, time - static_cast<double>(i));
    return camera;
  };
}

}  // namespace limn
