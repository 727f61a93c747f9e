#include "raymarch/lines/mesh_layers.h"

#include <algorithm>
#include <cmath>

namespace limn {
namespace {

constexpr double kLift_px = 0.1;
constexpr int kMostLayers = 10'000;

}  // namespace

MeshLayers::MeshLayers(const LineTask& task, const std::vector<size_t>& objects, double edge_px) : camera_(task.camera), lift_px_(kLift_px) {
  Scene part{task.scene.name, task.scene.camera, {}};
  for (const size_t i : objects) {
    part.objects.push_back(task.scene.objects[i]);
    part.objects.back().world_from_object.translation -= task.origin;
  }
  model_ = make_proxy(part, task.camera, task.settings.max_bytes, edge_px).model;
}

int MeshLayers::before(const CurveSample& sample) const {
  const double unit_px = pixels_per_unit_at(camera_, std::max(sample.depth, 1e-9));
  const glm::dvec3 start = sample.p + (lift_px_ / unit_px) * sample.lift, direction = view_vector(camera_, start);
  const double reach = camera_.projection == Projection::perspective ? glm::distance(start, camera_.eye)
                                                                     : std::max(0.0, project(camera_, start).z) + 4.0 * model_.bounds.radius();
  const glm::dvec3 origin = start - model_.render_origin;
  // Two hits closer together than this, in units of rounding, count as one: on an edge both triangles may be hit.
  const double apart = 4e-7 * (reach + model_.bounds.radius());
  int layers = 0;
  RayBatch rays;
  HitBatch hits;
  rays.count = 1;
  for (const Surface& surface : model_.surfaces) {
    double from = 0.0;
    for (int k = 0; k < kMostLayers; ++k) {
      rays.set(0, origin, direction, from, reach);
      hits.status[0] = HitStatus::miss;
      hits.t[0] = rays.t_max[0];
      surface.trace(surface.state.get(), rays, hits);
      if (hits.status[0] != HitStatus::hit) break;
      ++layers;
      from = static_cast<double>(hits.t[0]) + apart;
    }
  }
  return layers;
}

}  // namespace limn
