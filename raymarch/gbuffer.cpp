#include "raymarch/gbuffer.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <mutex>

#include "raymarch/threads.h"
#include "sdf/error.h"

namespace limn {
namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();
// Beyond this many scene radii an unbounded surface (a plane) ends.
constexpr double kHorizon = 1e5;

/// What all rays of a picture share: the camera in render space and the sphere about its origin that holds every bounded surface.
struct Setup {
  const SceneModel& model;
  Camera camera;
  double radius = 0.0;
  bool bounded = true;
};

Setup make_setup(const SceneModel& model, const Camera& camera) {
  Setup setup{model, moved(camera, model.render_origin), 0.0, true};
  for (const Surface& surface : model.surfaces) {
    if (surface.bounds.empty()) continue;
    if (!surface.bounds.finite()) {
      setup.bounded = false;
      continue;
    }
    const glm::dvec3 corner = glm::max(glm::abs(surface.bounds.lower), glm::abs(surface.bounds.upper));
    setup.radius = std::max(setup.radius, 1.01 * glm::length(corner));
  }
  return setup;
}

/// The rays of one batch: in double as the camera gives them, in float from where they enter the scene's sphere, so that float keeps
/// its digits at any distance of the eye.
struct TracedBatch {
  RayBatch rays;
  HitBatch hits;
  std::array<CameraRay, kRayBatchSize> camera_rays;  ///< Render space.
  std::array<double, kRayBatchSize> shift;           ///< From the camera ray's origin to the float ray's.
  std::array<std::int32_t, kRayBatchSize> object;    ///< Index from 0; -1: nothing hit.
};

void add_ray(const Setup& setup, double x_px, double y_px, TracedBatch& batch) {
  const int i = batch.rays.count++;
  const auto k = static_cast<size_t>(i);
  const CameraRay ray = camera_ray(setup.camera, x_px, y_px);
  const double nearest = -glm::dot(ray.origin, ray.direction);
  const double shift = setup.radius > 0.0 ? std::max(0.0, nearest - setup.radius) : 0.0;
  const glm::dvec3 origin = ray.origin + shift * ray.direction;
  double t_min = 0.0, t_max = std::max(0.0, nearest + setup.radius - shift);
  if (!setup.bounded) {
    t_min = -shift;
    t_max = kHorizon * std::max(setup.radius, glm::length(ray.origin));
  } else if (glm::length(ray.origin + nearest * ray.direction) > setup.radius) {
    t_max = 0.0;
  }
  batch.camera_rays[k] = ray;
  batch.shift[k] = shift;
  batch.object[k] = -1;
  batch.rays.origin_x[i] = static_cast<float>(origin.x);
  batch.rays.origin_y[i] = static_cast<float>(origin.y);
  batch.rays.origin_z[i] = static_cast<float>(origin.z);
  batch.rays.direction_x[i] = static_cast<float>(ray.direction.x);
  batch.rays.direction_y[i] = static_cast<float>(ray.direction.y);
  batch.rays.direction_z[i] = static_cast<float>(ray.direction.z);
  batch.rays.t_min[i] = static_cast<float>(t_min);
  batch.rays.t_max[i] = static_cast<float>(t_max);
}

void take_hit(int i, int object, const HitBatch& from, TracedBatch& batch) {
  batch.hits.t[i] = from.t[i];
  batch.hits.normal_x[i] = from.normal_x[i];
  batch.hits.normal_y[i] = from.normal_y[i];
  batch.hits.normal_z[i] = from.normal_z[i];
  batch.hits.face[i] = from.face[i];
  batch.hits.material[i] = from.material[i];
  batch.hits.status[i] = from.status[i];
  batch.object[static_cast<size_t>(i)] = from.status[i] == HitStatus::hit ? object : -1;
  batch.rays.t_max[i] = from.t[i];
}

/// The nearest hit over all objects. A ray that ran out of steps hides what lies behind that point: nobody knows what is there.
void trace_batch(const Setup& setup, TracedBatch& batch) {
  std::fill_n(batch.hits.status, batch.rays.count, HitStatus::miss);
  HitBatch own;
  for (size_t object = 0; object < setup.model.surfaces.size(); ++object) {
    const Surface& surface = setup.model.surfaces[object];
    std::fill_n(own.status, batch.rays.count, HitStatus::miss);
    std::copy_n(batch.rays.t_max, batch.rays.count, own.t);
    surface.trace(surface.state.get(), batch.rays, own);
    for (int i = 0; i < batch.rays.count; ++i) {
      if (own.status[i] != HitStatus::miss && own.t[i] <= batch.rays.t_max[i]) take_hit(i, static_cast<int>(object), own, batch);
    }
  }
}

PointSample sample_of(const Setup& setup, const TracedBatch& batch, int i) {
  const auto k = static_cast<size_t>(i);
  PointSample sample;
  sample.status = batch.hits.status[i];
  sample.n_dot_v = std::numeric_limits<float>::quiet_NaN();
  sample.position = glm::dvec3(std::numeric_limits<double>::quiet_NaN());
  if (sample.status != HitStatus::hit) return sample;
  const CameraRay& ray = batch.camera_rays[k];
  const glm::dvec3 position = ray.origin + (batch.shift[k] + static_cast<double>(batch.hits.t[i])) * ray.direction;
  sample.id = batch.object[k] + 1;
  sample.face = batch.hits.face[i];
  sample.position = position + setup.model.render_origin;
  sample.normal = {batch.hits.normal_x[i], batch.hits.normal_y[i], batch.hits.normal_z[i]};
  sample.n_dot_v = static_cast<float>(glm::dot(glm::dvec3(sample.normal), view_vector(setup.camera, position)));
  return sample;
}

void write_pixel(const Setup& setup, const TracedBatch& batch, int i, size_t pixel, GBuffer& out) {
  out.status.pixels[pixel] = static_cast<std::uint8_t>(batch.hits.status[i]);
  const PointSample sample = sample_of(setup, batch, i);
  if (sample.status != HitStatus::hit) return;
  const glm::dvec3 backward = setup.camera.world_from_camera[2];
  const glm::dvec3 from_eye = (sample.position - setup.model.render_origin) - setup.camera.eye;
  out.depth.pixels[pixel] = static_cast<float>(-glm::dot(from_eye, backward));
  out.position.pixels[pixel] = glm::vec3(sample.position);
  out.normal.pixels[pixel] = sample.normal;
  out.n_dot_v.pixels[pixel] = std::clamp(sample.n_dot_v, 0.0f, 1.0f);
  out.id.pixels[pixel] = sample.id;
  const auto object = static_cast<size_t>(sample.id - 1);
  out.material.pixels[pixel] = setup.model.materials[object] + batch.hits.material[i];
  out.face.pixels[pixel] = sample.face;
}

void render_tile(const Setup& setup, int tile_x, int tile_y, int tile_px, glm::dvec2 offset, GBuffer& out) {
  const int x0 = tile_x * tile_px, y0 = tile_y * tile_px;
  const int x1 = std::min(x0 + tile_px, out.width), y1 = std::min(y0 + tile_px, out.height);
  TracedBatch batch;
  batch.rays.count = 0;
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) add_ray(setup, x + offset.x, y + offset.y, batch);
  }
  trace_batch(setup, batch);
  int i = 0;
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) write_pixel(setup, batch, i++, out.depth.index(x, y), out);
  }
}

GBuffer empty_gbuffer(int width, int height) {
  GBuffer out;
  out.width = width;
  out.height = height;
  out.depth = {width, height, kFar};
  out.position = {width, height, glm::vec3(kFar)};
  out.normal = {width, height, glm::vec3(0.0f)};
  out.n_dot_v = {width, height, 0.0f};
  out.id = {width, height, 0};
  out.material = {width, height, 0};
  out.face = {width, height, -1};
  out.status = {width, height, static_cast<std::uint8_t>(HitStatus::miss)};
  return out;
}

}  // namespace

GBuffer render_gbuffer(const SceneModel& model, const Camera& camera, const ExecutionSettings& how, glm::dvec2 offset) {
  LIMN_CHECK(how.tile_px >= 1 && how.tile_px <= 16 && how.threads >= 0);
  const Setup setup = make_setup(model, camera);
  GBuffer out = empty_gbuffer(camera.width_px, camera.height_px);
  out.sample = offset;
  const int columns = (out.width + how.tile_px - 1) / how.tile_px, rows = (out.height + how.tile_px - 1) / how.tile_px;
  const std::int64_t tiles = std::int64_t{columns} * rows;
  std::mutex progress_mutex;
  std::int64_t done = 0;
  ThreadArena arena(how.threads);
  arena.execute([&] {
    tbb::parallel_for(std::int64_t{0}, tiles, [&](std::int64_t tile) {
      if (how.cancelled && how.cancelled()) throw Cancelled{};
      render_tile(setup, static_cast<int>(tile % columns), static_cast<int>(tile / columns), how.tile_px, offset, out);
      if (!how.progress) return;
      const std::lock_guard lock(progress_mutex);
      how.progress(static_cast<double>(++done) / static_cast<double>(tiles));
    });
  });
  return out;
}

void sample_points(const SceneModel& model, const Camera& camera, std::span<const glm::dvec2> points_px, std::span<PointSample> samples) {
  LIMN_CHECK(points_px.size() == samples.size());
  const Setup setup = make_setup(model, camera);
  TracedBatch batch;
  for (size_t first = 0; first < points_px.size(); first += kRayBatchSize) {
    const size_t count = std::min<size_t>(kRayBatchSize, points_px.size() - first);
    batch.rays.count = 0;
    for (size_t k = 0; k < count; ++k) add_ray(setup, points_px[first + k].x, points_px[first + k].y, batch);
    trace_batch(setup, batch);
    for (size_t k = 0; k < count; ++k) samples[first + k] = sample_of(setup, batch, static_cast<int>(k));
  }
}

HitCounts count_hits(const GBuffer& gbuffer) {
  HitCounts counts;
  for (const std::uint8_t status : gbuffer.status.pixels) {
    counts.hits += status == static_cast<std::uint8_t>(HitStatus::hit);
    counts.misses += status == static_cast<std::uint8_t>(HitStatus::miss);
    counts.out_of_steps += status == static_cast<std::uint8_t>(HitStatus::out_of_steps);
  }
  return counts;
}

}  // namespace limn
