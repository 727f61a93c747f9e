#include "raymarch/scene/covered_pixels.h"

#include <cmath>

namespace limn {

PixelTile covered_pixels(const Box& bounds, const ViewRequest& request) {
  const Camera& camera = request.camera;
  const PixelTile all{0, 0, camera.width_px, camera.height_px};
  if (bounds.empty()) return {};
  if (!bounds.finite()) return all;
  Box image;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p(corner & 1 ? bounds.upper.x : bounds.lower.x, corner & 2 ? bounds.upper.y : bounds.lower.y,
                       corner & 4 ? bounds.upper.z : bounds.lower.z);
    const glm::dvec3 at = project(camera, p);
    // So near that the projection has few digits left counts as behind.
    if (camera.projection == Projection::perspective && !(at.z > 1e-6 * bounds.radius())) return all;
    image = include(image, {at.x, at.y, 0.0});
  }
  const glm::dvec3 limit(camera.width_px, camera.height_px, 0.0);
  const glm::ivec3 first(glm::clamp(glm::floor(image.lower - 1.0), glm::dvec3(0.0), limit));
  const glm::ivec3 end(glm::clamp(glm::ceil(image.upper + 1.0), glm::dvec3(0.0), limit));
  return {first.x, first.y, end.x - first.x, end.y - first.y};
}

}  // namespace limn
