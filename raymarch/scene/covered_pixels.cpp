#include "raymarch/scene/covered_pixels.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace limn {

std::optional<BoxImage> image_of(const Box& box, const Camera& camera) {
  if (!box.finite()) return std::nullopt;
  BoxImage image{.pixels = {}, .nearest = std::numeric_limits<double>::infinity()};
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p(corner & 1 ? box.upper.x : box.lower.x, corner & 2 ? box.upper.y : box.lower.y,
                       corner & 4 ? box.upper.z : box.lower.z);
    const glm::dvec3 at = project(camera, p);
    // So near that the projection has few digits left counts as behind.
    if (camera.projection == Projection::perspective && !(at.z > 1e-6 * box.radius())) return std::nullopt;
    image.pixels = include(image.pixels, {at.x, at.y, 0.0});
    image.nearest = std::min(image.nearest, at.z);
  }
  return image;
}

PixelTile covered_pixels(const Box& bounds, const ViewRequest& request) {
  const Camera& camera = request.camera;
  if (bounds.empty()) return {};
  const std::optional<BoxImage> image = image_of(bounds, camera);
  if (!image) return {0, 0, camera.width_px, camera.height_px};
  const glm::dvec3 limit(camera.width_px, camera.height_px, 0.0);
  const glm::ivec3 first(glm::clamp(glm::floor(image->pixels.lower - 1.0), glm::dvec3(0.0), limit));
  const glm::ivec3 end(glm::clamp(glm::ceil(image->pixels.upper + 1.0), glm::dvec3(0.0), limit));
  return {first.x, first.y, end.x - first.x, end.y - first.y};
}

}  // namespace limn
