#include "raymarch/gbuffer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "raymarch/gbuffer/picture_rays.h"
#include "raymarch/gbuffer/trace_scene.h"
#include "raymarch/mesh/open_sheet.h"
#include "sdf/error.h"

namespace limn {
namespace {

struct Setup {
  const SceneModel& model;
  Camera camera;  ///< In render space.
  SceneExtent extent;
  std::vector<char> turned;  ///< As turned_surfaces.
};

/// The rays of one batch: in double as the camera gives them, in float from where they enter the scene's sphere, so that float keeps
/// its digits at any distance of the eye.
struct TracedBatch {
  RayBatch rays;
  SceneHits found;
  std::array<CameraRay, kRayBatchSize> camera_rays;  ///< Render space.
  std::array<double, kRayBatchSize> shift;           ///< From the camera ray's origin to the float ray's.
};

void add_ray(const Setup& setup, double x_px, double y_px, TracedBatch& batch) {
  const int i = batch.rays.count++;
  const auto k = static_cast<size_t>(i);
  const CameraRay ray = camera_ray(setup.camera, x_px, y_px);
  const double nearest = -glm::dot(ray.origin, ray.direction);
  const double shift = setup.extent.radius > 0.0 ? std::max(0.0, nearest - setup.extent.radius) : 0.0;
  const glm::dvec3 origin = ray.origin + shift * ray.direction;
  double t_min = 0.0, t_max = std::max(0.0, nearest + setup.extent.radius - shift);
  if (!setup.extent.bounded) {
    t_min = -shift;
    t_max = kHorizonRadii * std::max(setup.extent.radius, glm::length(ray.origin));
  } else if (glm::length(ray.origin + nearest * ray.direction) > setup.extent.radius) {
    t_max = 0.0;
  }
  batch.camera_rays[k] = ray;
  batch.shift[k] = shift;
  batch.rays.set(i, origin, ray.direction, t_min, t_max);
}

PointSample sample_of(const Setup& setup, const TracedBatch& batch, int i) {
  const auto k = static_cast<size_t>(i);
  PointSample sample;
  sample.status = batch.found.hits.status[i];
  sample.n_dot_v = std::numeric_limits<float>::quiet_NaN();
  sample.position = glm::dvec3(std::numeric_limits<double>::quiet_NaN());
  if (sample.status != HitStatus::hit) return sample;
  const CameraRay& ray = batch.camera_rays[k];
  const glm::dvec3 position = ray.origin + (batch.shift[k] + static_cast<double>(batch.found.hits.t[i])) * ray.direction;
  sample.id = batch.found.object[i] + 1;
  sample.face = batch.found.hits.face[i];
  sample.position = position + setup.model.render_origin;
  sample.normal = {batch.found.hits.normal_x[i], batch.found.hits.normal_y[i], batch.found.hits.normal_z[i]};
  sample.n_dot_v = static_cast<float>(glm::dot(glm::dvec3(sample.normal), view_vector(setup.camera, position)));
  return sample;
}

/// What a packet's rays meet then is near to each other.
void sort_by_tiles(std::span<const glm::dvec2> points_px, std::vector<size_t>& order) {
  constexpr double kTile_px = 8.0;
  // By rows, then by columns, as one number; far beside all pictures they are all the same.
  const auto tile_of = [](double px) {
    constexpr double kFar = 1 << 30;
    const double tile = std::floor(px / kTile_px);
    return tile > -kFar ? static_cast<std::uint64_t>(std::min(tile, kFar) + kFar) : 0u;
  };
  std::vector<std::pair<std::uint64_t, size_t>> places;
  places.reserve(points_px.size());
  for (size_t k = 0; k < points_px.size(); ++k) places.emplace_back(tile_of(points_px[k].y) << 32 | tile_of(points_px[k].x), k);
  std::sort(places.begin(), places.end());
  for (size_t k = 0; k < places.size(); ++k) order[k] = places[k].second;
}

}  // namespace

void prepare_points(const SceneModel& model) {
  for (const Surface& surface : model.surfaces)
    if (surface.prepare != nullptr) surface.prepare(surface.state.get());
}

void sample_points(const SceneModel& model, const Camera& camera, std::span<const glm::dvec2> points_px, std::span<PointSample> samples,
                   PointRays rays) {
  LIMN_CHECK(points_px.size() == samples.size());
  const Camera render_camera = moved(camera, model.render_origin);
  const Setup setup{model, render_camera, scene_extent(model), turned_surfaces(model.surfaces, render_camera)};
  std::vector<size_t> order(points_px.size());
  std::iota(order.begin(), order.end(), size_t{0});
  if (rays == PointRays::in_packets) sort_by_tiles(points_px, order);
  TracedBatch batch;
  for (size_t first = 0; first < order.size(); first += kRayBatchSize) {
    const std::span<const size_t> part = std::span(order).subspan(first, std::min<size_t>(kRayBatchSize, order.size() - first));
    batch.rays.count = 0;
    for (const size_t k : part) add_ray(setup, points_px[k].x, points_px[k].y, batch);
    trace_scene(model, setup.turned, rays, batch.rays, batch.found);
    for (size_t i = 0; i < part.size(); ++i) samples[part[i]] = sample_of(setup, batch, static_cast<int>(i));
  }
}

}  // namespace limn
