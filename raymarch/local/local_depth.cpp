#include "raymarch/local/local_depth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "raymarch/gbuffer/picture_rays.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr int kMostSmall_px = 320;
constexpr int kTile_px = 16;
/// Of the small picture: what its pixels do not show.
constexpr double kBetween_px = 1.5;

Camera smaller(const Camera& camera) {
  const double scale = std::min(1.0, static_cast<double>(kMostSmall_px) / std::max(camera.width_px, camera.height_px));
  Camera small = camera;
  small.width_px = std::max(1, static_cast<int>(std::ceil(camera.width_px * scale)));
  small.height_px = std::max(1, static_cast<int>(std::ceil(camera.height_px * scale)));
  small.focal_px *= scale;
  small.pixels_per_unit *= scale;
  return small;
}

void trace_tile(const Surface& surface, const SurfaceView& view, const PictureRays& of_picture, const glm::dvec3& eye,
                const PixelTile& tile, HiddenParts& parts) {
  RayBatch rays;
  HitBatch hits;
  fill_rays(of_picture, tile, {0.5, 0.5}, rays);
  std::fill_n(hits.status, kRayBatchSize, HitStatus::miss);
  if (view.trace)
    view.trace(view.state.get(), tile, rays, hits);
  else
    surface.trace(surface.state.get(), rays, hits);
  for (int y = 0; y < tile.height; ++y)
    for (int x = 0; x < tile.width; ++x) {
      const int lane = lane_of(tile, x, y);
      if (hits.status[lane] != HitStatus::hit) continue;
      const glm::dvec3 at = glm::dvec3(rays.origin(lane)) + static_cast<double>(hits.t[lane]) * glm::dvec3(rays.direction(lane));
      parts.depth[static_cast<size_t>(tile.y + y) * static_cast<size_t>(parts.width) + static_cast<size_t>(tile.x + x)] =
          static_cast<float>(glm::dot(at - eye, of_picture.forward));
    }
}

}  // namespace

SmallPicture small_picture(const Surface& surface, const Camera& camera) {
  SmallPicture picture{smaller(camera), {}};
  HiddenParts& parts = picture.hidden;
  parts.width = picture.camera.width_px, parts.height = picture.camera.height_px;
  parts.depth.assign(static_cast<size_t>(parts.width) * static_cast<size_t>(parts.height), std::numeric_limits<float>::infinity());
  const double radius = glm::length(glm::max(glm::abs(surface.bounds.lower), glm::abs(surface.bounds.upper)));
  const PictureRays rays = picture_rays(picture.camera, radius, true);
  const SurfaceView view = surface.view(surface.state, {.camera = picture.camera});
  const int columns = (parts.width + kTile_px - 1) / kTile_px, rows = (parts.height + kTile_px - 1) / kTile_px;
  parallel_for(0, columns * rows, [&](int k) {
    PixelTile tile{k % columns * kTile_px, k / columns * kTile_px, 0, 0};
    tile.width = std::min(kTile_px, parts.width - tile.x), tile.height = std::min(kTile_px, parts.height - tile.y);
    trace_tile(surface, view, rays, picture.camera.eye, tile, parts);
  });
  return picture;
}

SmallPicture small_picture(const TriangleMesh& mesh, const Camera& camera) {
  const Camera small = smaller(camera);
  return {small, hidden_parts(mesh, small)};
}

bool is_hidden(const SmallPicture& picture, const Box& box, double margin_px, double whole_pixels_per_unit) {
  std::array<glm::dvec3, 8> points;
  for (size_t corner = 0; corner < 8; ++corner) {
    points[corner] = project(picture.camera, {corner & 1 ? box.upper.x : box.lower.x, corner & 2 ? box.upper.y : box.lower.y,
                                              corner & 4 ? box.upper.z : box.lower.z});
    if (picture.camera.projection == Projection::perspective && !(points[corner].z > 0.0)) return false;
  }
  return is_hidden(picture.hidden, points, kBetween_px + margin_px, margin_px / whole_pixels_per_unit);
}

}  // namespace limn
