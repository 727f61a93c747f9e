#include "raymarch/mesh/open_sheet.h"

#include <algorithm>

#include "raymarch/mesh/polygons.h"

namespace limn {
namespace {

bool same(const Camera& a, const Camera& b) {
  return a.projection == b.projection && a.eye == b.eye && a.world_from_camera == b.world_from_camera && a.focal_px == b.focal_px &&
         a.pixels_per_unit == b.pixels_per_unit && a.width_px == b.width_px && a.height_px == b.height_px;
}

/// The part of the picture that a box covers, px; all of it where the box reaches behind the eye.
Box covered_px(const Box& bounds, const Camera& camera) {
  const Box all{glm::dvec3(0.0), glm::dvec3(camera.width_px, camera.height_px, 0.0)};
  Box covered;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p(corner & 1 ? bounds.upper.x : bounds.lower.x, corner & 2 ? bounds.upper.y : bounds.lower.y,
                       corner & 4 ? bounds.upper.z : bounds.lower.z);
    const glm::dvec3 at = project(camera, p);
    if (camera.projection == Projection::perspective && !(at.z > 1e-6 * bounds.radius())) return all;
    covered = include(covered, glm::clamp(glm::dvec3(at.x, at.y, 0.0), all.lower, all.upper));
  }
  return covered;
}

struct Seen {
  int hits = 0, backs = 0;
};

void count_batch(const Surface& surface, RayBatch& rays, Seen& seen) {
  HitBatch hits;
  std::fill_n(hits.status, rays.count, HitStatus::miss);
  surface.trace(surface.state.get(), rays, hits);
  for (int i = 0; i < rays.count; ++i) {
    if (hits.status[i] != HitStatus::hit) continue;
    ++seen.hits;
    const glm::vec3 normal(hits.normal_x[i], hits.normal_y[i], hits.normal_z[i]);
    seen.backs += glm::dot(normal, rays.direction(i)) > 0.0f;
  }
  rays.count = 0;
}

/// Rays through the middles of side x side even cells of the part of the picture that the surface covers.
Seen look(const Surface& surface, const Camera& camera, int side) {
  const Box covered = covered_px(surface.bounds, camera);
  const glm::dvec3 corner = glm::max(glm::abs(surface.bounds.lower), glm::abs(surface.bounds.upper));
  const double radius = 1.01 * glm::length(corner);
  Seen seen;
  RayBatch rays;
  rays.count = 0;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const glm::dvec3 at = covered.lower + covered.size() * glm::dvec3(x + 0.5, y + 0.5, 0.0) / double(side);
      const CameraRay ray = camera_ray(camera, at.x, at.y);
      const double nearest = -glm::dot(ray.origin, ray.direction), shift = std::max(0.0, nearest - radius);
      rays.set(rays.count++, ray.origin + shift * ray.direction, ray.direction, 0.0, std::max(0.0, nearest + radius - shift));
      if (rays.count == kRayBatchSize) count_batch(surface, rays, seen);
    }
  }
  if (rays.count > 0) count_batch(surface, rays, seen);
  return seen;
}

bool is_open(const Polygons& polygons) {
  const PassingVector<TopologyEdge>& edges = polygons.edges().edges;
  return std::any_of(edges.begin(), edges.end(), [](const TopologyEdge& edge) { return edge.face_b < 0; });
}

/// Most meshes show their front, which few rays tell; whether a mesh is open is asked last, since it takes longest.
bool find_out(const Surface& surface, const Camera& camera) {
  if (!surface.polygons || surface.bounds.empty() || !surface.bounds.finite()) return false;
  const Seen first = look(surface, camera, 16);
  if (4 * first.backs <= first.hits && first.hits >= 16) return false;
  const Seen seen = look(surface, camera, 64);
  return 2 * seen.backs > seen.hits && is_open(*surface.polygons);
}

}  // namespace

bool OpenSheet::shows_back(const Surface& surface, const Camera& camera) const {
  {
    const std::lock_guard lock(mutex_);
    if (camera_ && same(*camera_, camera)) return shows_back_;
  }
  // Not while the lock is held: a thread that waits for others within may be handed work that asks here.
  const bool answer = find_out(surface, camera);
  const std::lock_guard lock(mutex_);
  camera_ = camera;
  shows_back_ = answer;
  return answer;
}

std::vector<char> turned_surfaces(std::span<const Surface> surfaces, const Camera& camera) {
  std::vector<char> turned(surfaces.size(), 0);
  for (size_t i = 0; i < surfaces.size(); ++i)
    turned[i] = surfaces[i].open_sheet && surfaces[i].open_sheet->shows_back(surfaces[i], camera);
  if (std::find(turned.begin(), turned.end(), 1) == turned.end()) turned.clear();
  return turned;
}

}  // namespace limn
