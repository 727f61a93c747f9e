#include "raymarch/border/radial_curvature.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "raymarch/gbuffer/picture_rows.h"

namespace limn {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
// Nearer than this to face on, N.V has no slope to read a curvature from.
constexpr double kFaceOn = 0.02;

/// Pixels of one object in one band, and what is asked for them.
struct Batch {
  std::vector<size_t> pixels;
  std::vector<SurfacePoint> points;
  std::vector<glm::dvec3> views;  ///< World.
};

glm::dvec3 render_position(const Camera& render_camera, const GBuffer& seen, int x, int y) {
  const size_t i = seen.id.index(x, y);
  const CameraRay ray = camera_ray(render_camera, x + seen.sample.x, y + seen.sample.y);
  const double along = -glm::dot(ray.direction, render_camera.world_from_camera[2]);
  const double start = -glm::dot(ray.origin - render_camera.eye, render_camera.world_from_camera[2]);
  return ray.origin + (double{seen.depth.pixels[i]} - start) / along * ray.direction;
}

void gather(const BorderInput& input, const Camera& render_camera, int y0, int y1, std::vector<Batch>& batches) {
  const GBuffer& seen = input.gbuffer;
  for (int y = y0; y < y1; ++y) {
    for (int x = 0; x < seen.width; ++x) {
      const size_t i = seen.id.index(x, y);
      const std::int32_t id = seen.id.pixels[i];
      if (id == 0) continue;
      Batch& batch = batches[static_cast<size_t>(id - 1)];
      const glm::dvec3 position = render_position(render_camera, seen, x, y);
      batch.pixels.push_back(i);
      batch.points.push_back({position, glm::dvec3(seen.normal.pixels[i]), seen.face.pixels[i]});
      batch.views.push_back(view_vector(render_camera, position));
    }
  }
}

}  // namespace

SeenPoint seen_at(const BorderInput& input, int x, int y) {
  const GBuffer& seen = input.gbuffer;
  const size_t i = seen.id.index(x, y);
  return seen_point(input.camera, x + seen.sample.x, y + seen.sample.y, double{seen.depth.pixels[i]}, glm::dvec3(seen.normal.pixels[i]));
}

bool same_sheet(const BorderInput& input, size_t a, size_t b, int apart) {
  const GBuffer& seen = input.gbuffer;
  const double za = double{seen.depth.pixels[a]}, zb = double{seen.depth.pixels[b]};
  const double c = std::max({double{seen.n_dot_v.pixels[a]}, double{seen.n_dot_v.pixels[b]}, 1e-6});
  const double step_px = std::abs(za - zb) * pixels_per_unit_at(input.camera, std::min(za, zb));
  return step_px <= 2.5 * apart * (1.0 + std::sqrt((1.0 - c) * (1.0 + c)) / c);
}

Image<double> curvature_from_surfaces(const BorderInput& input, std::vector<std::int64_t>& missing) {
  const GBuffer& seen = input.gbuffer;
  Image<double> result(seen.width, seen.height, kNone);
  const std::int32_t objects = seen.id.pixels.empty() ? 0 : *std::max_element(seen.id.pixels.begin(), seen.id.pixels.end());
  missing.assign(static_cast<size_t>(objects), 0);
  const Camera render_camera = moved(input.camera, input.model.render_origin);
  std::mutex counting;
  for_each_band(seen.height, [&](int y0, int y1) {
    std::vector<Batch> batches(missing.size());
    gather(input, render_camera, y0, y1, batches);
    std::vector<SurfaceCurvature> curvatures;
    for (size_t object = 0; object < batches.size(); ++object) {
      const Batch& batch = batches[object];
      if (batch.pixels.empty()) continue;
      std::int64_t none = static_cast<std::int64_t>(batch.pixels.size());
      if (object < input.model.surfaces.size() && input.model.surfaces[object].curvature.evaluate) {
        const CurvatureSource& source = input.model.surfaces[object].curvature;
        curvatures.assign(batch.points.size(), {});
        source.evaluate(source.state.get(), batch.points, curvatures);
        for (size_t k = 0; k < curvatures.size(); ++k) {
          const double kr = curvature_along(curvatures[k], batch.views[k]);
          if (!std::isfinite(kr)) continue;
          result.pixels[batch.pixels[k]] = kr;
          --none;
        }
      }
      const std::lock_guard lock(counting);
      missing[object] += none;
    }
  });
  return result;
}

Image<double> curvature_from_screen(const BorderInput& input) {
  const GBuffer& seen = input.gbuffer;
  Image<double> result(seen.width, seen.height, kNone);
  // The square of N.V is nearly linear up to the contour, N.V itself has infinite slope there.
  const auto squared = [&](size_t i) { return double{seen.n_dot_v.pixels[i]} * double{seen.n_dot_v.pixels[i]}; };
  for_each_band(seen.height, [&](int y0, int y1) {
    for (int y = y0; y < y1; ++y) {
      for (int x = 0; x < seen.width; ++x) {
        const size_t i = seen.id.index(x, y);
        if (seen.id.pixels[i] == 0) continue;
        const SeenPoint at = seen_at(input, x, y);
        if (at.sine < kFaceOn || at.n_dot_v < 1e-6) continue;
        const ImageSlope slope = slope_at(input, x, y, 1, squared);
        if (!slope.any) continue;
        const glm::dvec2 motion = image_motion(input.camera, at);
        const double along = (slope.slope.x * motion.x - slope.slope.y * motion.y) / (2.0 * at.n_dot_v);
        result.pixels[i] = along / at.sine - at.n_dot_v / at.distance;
      }
    }
  });
  return result;
}

}  // namespace limn
