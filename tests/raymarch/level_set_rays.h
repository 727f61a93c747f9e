#pragma once
// Single rays through a surface's batches, for the tests of level sets.

#include <cstdio>
#include <random>

#include "raymarch/level_set/level_set_marcher.h"
#include "raymarch/surface.h"
#include "tests/random_seed.h"
#include "tests/sdf/level_set_maker.h"

namespace limn::testing_tools {

struct Ray {
  glm::vec3 origin, direction;
  float t_min = 0.0f, t_max = std::numeric_limits<float>::infinity();
};
struct Hit {
  HitStatus status = HitStatus::miss;
  double t = 0.0;
  glm::dvec3 normal{0.0};
};

inline std::vector<Hit> trace(const Surface& surface, const std::vector<Ray>& rays) {
  std::vector<Hit> found(rays.size());
  RayBatch batch;
  HitBatch hits;
  for (size_t first = 0; first < rays.size(); first += kRayBatchSize) {
    batch.count = static_cast<int>(std::min<size_t>(kRayBatchSize, rays.size() - first));
    for (int i = 0; i < batch.count; ++i) {
      const Ray& ray = rays[first + static_cast<size_t>(i)];
      batch.set(i, ray.origin, ray.direction, ray.t_min, ray.t_max);
      hits.status[i] = HitStatus::miss;
    }
    surface.trace(surface.state.get(), batch, hits);
    for (int i = 0; i < batch.count; ++i) {
      Hit& hit = found[first + static_cast<size_t>(i)];
      hit.status = hits.status[i];
      if (hit.status == HitStatus::hit)
        hit = {hits.status[i], static_cast<double>(hits.t[i]), glm::dvec3(glm::vec3(hits.normal_x[i], hits.normal_y[i], hits.normal_z[i]))};
    }
  }
  return found;
}

inline Hit trace(const Surface& surface, const Ray& ray) { return trace(surface, std::vector<Ray>{ray}).front(); }

inline Surface marcher(const LevelSet& level_set, const std::string& gradient = "central", int max_steps = 10'000) {
  return level_set_marcher(level_set, Affine{}, find_gradient(gradient), glm::dvec3(0.0), max_steps);
}

inline Surface build(const Field& field, const SurfaceSettings& settings, const glm::dvec3& render_origin = glm::dvec3(0.0)) {
  SceneObject object{.name = "object", .source = field};
  return find_surface("level_set").build(object, settings, render_origin);
}

inline std::uint64_t fresh_seed() { return random_seed(); }

}  // namespace limn::testing_tools
