#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "sdf/error.h"
#include "tests/bench/contestant.h"

namespace limn::bench {

Frame::Frame(int width_px, int height_px)
    : width(width_px),
      height(height_px),
      distance(hwy::AllocateAligned<float>(pixels())),
      normal(hwy::AllocateAligned<float>(3 * pixels())) {
  if (!distance || !normal) throw MachineError("no memory for a picture");
  std::fill_n(distance.get(), pixels(), 0.0f);
  std::fill_n(normal.get(), 3 * pixels(), 0.0f);
}

std::string checksum(const Frame& frame) {
  std::uint64_t sum = 14695981039346656037ull;
  const auto add = [&sum](const float* values, size_t count) {
    for (size_t i = 0; i < count; ++i) {
      std::uint32_t bits = 0;
      std::memcpy(&bits, values + i, sizeof bits);
      sum = (sum ^ bits) * 1099511628211ull;
    }
  };
  add(frame.distance.get(), frame.pixels());
  add(frame.normal.get(), 3 * frame.pixels());
  return fmt::format("{:016x}", sum);
}

RayForms<double> ray_forms(const Camera& camera) {
  LIMN_CHECK(camera.projection == Projection::perspective);
  const glm::dvec3 backward = camera.world_from_camera[2];
  // On the plane at distance 1 before the eye the directions' ends are linear in x and y.
  const auto on_plane = [&](double x, double y) {
    const glm::dvec3 d = camera_ray(camera, x, y).direction;
    return d / -glm::dot(d, backward);
  };
  RayForms<double> forms;
  forms.eye = camera.eye;
  forms.corner = on_plane(0.5, 0.5);
  forms.right = (on_plane(camera.width_px + 0.5, 0.5) - forms.corner) / static_cast<double>(camera.width_px);
  forms.down = (on_plane(0.5, camera.height_px + 0.5) - forms.corner) / static_cast<double>(camera.height_px);
  return forms;
}

RayForms<float> single(const RayForms<double>& forms) {
  return {glm::vec3(forms.eye), glm::vec3(forms.corner), glm::vec3(forms.right), glm::vec3(forms.down)};
}

}  // namespace limn::bench
