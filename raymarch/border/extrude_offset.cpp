// The outline of a field or a level set: rays that pass through the shell between the surface and its offset.

#include <cmath>

#include "raymarch/border/extrude.h"
#include "raymarch/border/extrude_pixels.h"
#include "raymarch/gbuffer/picture_rows.h"
#include "raymarch/scene/covered_pixels.h"

namespace limn {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
// Passages of one ray that are followed; more folds than this do not come one behind the other within an outline's width.
constexpr int kMostPassages = 16;

OffsetWidth offset_width(const BorderInput& input, size_t object, const ExtrudeSettings& settings, const Camera& camera) {
  OffsetWidth width;
  if (settings.space == ExtrudeSpace::object) {
    width.world = settings.object_width;
    if (object < input.scene.objects.size())
      width.world *= std::cbrt(std::abs(glm::determinant(input.scene.objects[object].world_from_object.linear)));
  } else if (camera.projection == Projection::orthographic) {
    width.world = settings.width_px / camera.pixels_per_unit;
  } else {
    width.per_depth = settings.width_px / camera.focal_px;
    width.eye = camera.eye;
    width.backward = camera.world_from_camera[2];
  }
  return width;
}

/// In render space, with the picture's size.
Camera camera_of(const BorderInput& input) {
  Camera camera = moved(input.camera, input.model.render_origin);
  camera.width_px = input.gbuffer.width;
  camera.height_px = input.gbuffer.height;
  return camera;
}

struct Shell {
  const BorderInput& input;
  const Surface& surface;
  const OffsetWidth& width;
  Camera camera;    ///< Render space.
  double radius;    ///< Of the sphere about the render origin that holds the shell; infinite where nothing does.
  std::int32_t id;  ///< Of the object, from 1.
  ExtrudeMask mask;
};

struct ShellBatch {
  RayBatch rays;
  HitBatch hits;
  size_t pixel[kRayBatchSize];  ///< Of the window.
  bool open[kRayBatchSize];     ///< Still followed.
};

/// From where the ray through pixel (x, y) of the picture enters the sphere to what is seen; an empty range where neither meets.
void set_ray(const Shell& shell, int x, int y, size_t window_pixel, ShellBatch& batch) {
  const GBuffer& seen = shell.input.gbuffer;
  const int i = batch.rays.count++;
  const size_t pixel = seen.id.index(x, y);
  const CameraRay ray = camera_ray(shell.camera, x + seen.sample.x, y + seen.sample.y);
  const double nearest = -glm::dot(ray.origin, ray.direction);
  const bool bounded = std::isfinite(shell.radius);
  const double shift = bounded ? std::max(0.0, nearest - shell.radius) : 0.0;
  double t_max = bounded ? std::max(0.0, nearest + shell.radius - shift) : 1e5 * std::max(1.0, glm::length(ray.origin));
  const double to_seen = double{seen.depth.pixels[pixel]} / -glm::dot(ray.direction, shell.camera.world_from_camera[2]) - shift;
  t_max = std::min(t_max, to_seen);
  if (bounded && glm::length(ray.origin + nearest * ray.direction) > shell.radius) t_max = 0.0;
  if (shell.mask == ExtrudeMask::stencil && seen.id.pixels[pixel] == shell.id) t_max = 0.0;
  const glm::dvec3 origin = ray.origin + shift * ray.direction;
  batch.pixel[i] = window_pixel;
  batch.open[i] = t_max > 0.0;
  batch.rays.set(i, origin, ray.direction, 0.0, std::max(t_max, 0.0));
}

/// Inks the batch's pixels, and empties it. A stencil wants rays that enter the shell; the inverted hull those that leave it again before
/// anything is seen: its back faces.
void follow(const Shell& shell, ShellBatch& batch, WindowImage<float>& ink) {
  for (int passage = 0; passage < kMostPassages; ++passage) {
    std::fill_n(batch.hits.status, batch.rays.count, HitStatus::miss);
    std::copy_n(batch.rays.t_max, batch.rays.count, batch.hits.t);
    shell.surface.trace(shell.surface.state.get(), batch.rays, batch.hits);
    bool any = false;
    for (int i = 0; i < batch.rays.count; ++i) {
      const bool hit = batch.open[i] && batch.hits.status[i] == HitStatus::hit && batch.hits.t[i] < batch.rays.t_max[i];
      const glm::vec3 normal(batch.hits.normal_x[i], batch.hits.normal_y[i], batch.hits.normal_z[i]);
      if (hit && (shell.mask == ExtrudeMask::stencil || glm::dot(normal, batch.rays.direction(i)) >= 0.0f)) {
        ink.values.pixels[batch.pixel[i]] = 1.0f;
      } else if (hit) {
        // Beyond the place of entry by so little that a chord of less is no outline anybody sees.
        const glm::dvec3 at = glm::dvec3(batch.rays.origin(i)) + double{batch.hits.t[i]} * glm::dvec3(batch.rays.direction(i));
        batch.rays.t_min[i] = std::nextafter(static_cast<float>(batch.hits.t[i] + shell.width.at(at) / 32.0), kInfinity);
        any = any || batch.rays.t_min[i] < batch.rays.t_max[i];
        continue;
      }
      batch.open[i] = false;
      batch.rays.t_max[i] = 0.0f;
      batch.rays.t_min[i] = 0.0f;
    }
    if (!any) break;
  }
  batch.rays.count = 0;
}

}  // namespace

std::shared_ptr<const OffsetShell> offset_shell(const BorderInput& input, size_t object, const ExtrudeSettings& settings,
                                                const OffsetShell* alike) {
  const OffsetWidth width = offset_width(input, object, settings, camera_of(input));
  if (width.zero()) return nullptr;
  const SurfaceOffset& offset = input.model.surfaces[object].offset;
  auto shell = std::make_shared<OffsetShell>(OffsetShell{width, alike ? alike->surface : offset.make(offset.state.get(), width), {}});
  if (shell->surface.where_met == nullptr) return shell;
  const Camera camera = camera_of(input);
  const SeenDepths depths(input.gbuffer, camera);
  // What this sample sees in front of a box the others do, too, but for the pixels beside.
  const MeetingRequest request{.camera = camera,
                               .facing_away = settings.mask == ExtrudeMask::back_faces,
                               .is_divided = [&](const Box& box) { return !depths.pixels_before(box, 1.0).empty(); }};
  shell->places = shell->surface.where_met(shell->surface.state.get(), request);
  return shell;
}

WindowImage<float> ink_offset(const BorderInput& input, size_t object, const ExtrudeSettings& settings, const OffsetShell& offset) {
  const Camera camera = camera_of(input);
  const Surface& surface = offset.surface;
  const PixelTile covered = covered_pixels(surface.bounds, {camera, input.gbuffer.sample});
  WindowImage<float> ink = window_image({covered.x, covered.y, covered.x + covered.width, covered.y + covered.height}, 0.0f);
  double radius = std::numeric_limits<double>::infinity();
  if (surface.bounds.finite()) radius = 1.01 * glm::length(glm::max(glm::abs(surface.bounds.lower), glm::abs(surface.bounds.upper)));
  const Shell shell{input, surface, offset.width, camera, radius, static_cast<std::int32_t>(object) + 1, settings.mask};
  WindowImage<std::uint8_t> asked{};
  if (offset.places) asked = pixels_before(*offset.places, SeenDepths(input.gbuffer, camera), ink.window);
  for_each_band(ink.window.height(), [&](int y0, int y1) {
    ShellBatch batch;
    batch.rays.count = 0;
    for (int y = y0; y < y1; ++y) {
      for (int x = 0; x < ink.window.width(); ++x) {
        const size_t pixel = ink.values.index(x, y);
        if (offset.places && asked.values.pixels[pixel] == 0) continue;
        set_ray(shell, ink.window.x0 + x, ink.window.y0 + y, pixel, batch);
        if (batch.rays.count == kRayBatchSize) follow(shell, batch, ink);
      }
    }
    if (batch.rays.count > 0) follow(shell, batch, ink);
  });
  return ink;
}

}  // namespace limn
