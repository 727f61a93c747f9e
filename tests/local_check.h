#pragma once
// Whether rays pass through a local model where a model as fine as can be has a surface, and how far its surface stands off.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "raymarch/gbuffer.h"
#include "raymarch/local_model.h"
#include "raymarch/mesh/polygons.h"
#include "subdiv/mesh_level_set.h"
#include "tests/plan_check.h"

namespace limn::test {

struct LocalRays {
  std::int64_t rays = 0;   ///< Cast at both models.
  std::int64_t hits = 0;   ///< Of the fine one.
  std::int64_t backs = 0;  ///< Of the local one: first hits of polygons that turn their backs. Closed surfaces show none.
  /// Where the two differ, at an edge of what is seen: some ray near by misses the fine one, grazes it, or sees it jump.
  std::int64_t edge = 0;
  /// Elsewhere: where the local one is missed, or what is hit of either is farther than the bound from any point of the other.
  std::int64_t through = 0;
};

/// How far apart two hits on one ray are, along the flatter of their normals.
inline double apart(const PointSample& a, const PointSample& b) {
  const glm::dvec3 between = b.position - a.position;
  return std::min(std::abs(glm::dot(glm::dvec3(a.normal), between)), std::abs(glm::dot(glm::dvec3(b.normal), between)));
}

/// How far a hit stands off a model along its normal, either way; infinite beyond `most`. Asked from far and from near: from far another
/// part of the surface may stand before the one meant.
inline double off_surface(const PointSample& sample, const SceneModel& model, double most) {
  double off = std::numeric_limits<double>::infinity();
  const glm::dvec3 normal = glm::normalize(glm::dvec3(sample.normal));
  for (const double away : {most, -most, most / 4.0, -most / 4.0, most / 16.0, -most / 16.0}) {
    CameraSettings settings;
    settings.width_px = settings.height_px = 1;
    settings.eye = sample.position + away * normal;
    settings.target = sample.position;
    settings.up = std::abs(normal.x) < 0.5 ? glm::dvec3(1.0, 0.0, 0.0) : glm::dvec3(0.0, 1.0, 0.0);
    settings.ortho_height = most;
    const PointSample met =
        seen_at(model, resolve_camera(settings, Box{sample.position - most, sample.position + most}), {{0.5, 0.5}}).front();
    if (met.status == HitStatus::hit) off = std::min(off, glm::distance(met.position, sample.position));
  }
  return off;
}

/// A model, to be asked how far it is from a point and, where it is made of polygons, which side of one was hit.
class ComparedModel {
 public:
  explicit ComparedModel(const SceneModel& model) : model_(model) {
    for (const Surface& surface : model.surfaces) {
      if (!surface.polygons) continue;
      const Mesh& mesh = surface.polygons->mesh();
      closest_.emplace_back(triangulate(mesh, NormalKind::flat));
      std::vector<size_t>& first = first_corners_.emplace_back(1, size_t{0});
      for (const std::int32_t size : mesh.face_sizes) first.push_back(first.back() + static_cast<size_t>(size));
    }
  }
  const SceneModel& model() const { return model_; }
  bool has_polygons() const { return closest_.size() == model_.surfaces.size(); }
  /// World units from a hit to the closest point of any polygon; of other surfaces along the hit's normal, infinite beyond `most`.
  double distance_from(const PointSample& hit, double most) const {
    if (!has_polygons()) return off_surface(hit, model_, most);
    double least = std::numeric_limits<double>::infinity();
    for (const ClosestPointQuery& query : closest_) least = std::min(least, query.closest(hit.position - model_.render_origin).distance);
    return least;
  }
  /// Whether the polygon that was hit turns its back on the camera; edge on is neither.
  bool shows_back(const PointSample& hit, const Camera& camera) const {
    if (!has_polygons()) return false;
    const auto object = static_cast<size_t>(hit.id - 1), face = static_cast<size_t>(hit.face);
    const Mesh& mesh = model_.surfaces[object].polygons->mesh();
    const size_t begin = first_corners_[object][face], end = first_corners_[object][face + 1];
    const auto corner = [&](size_t k) { return mesh.positions[static_cast<size_t>(mesh.corner_vertices[k])]; };
    glm::dvec3 area(0.0);
    for (size_t k = begin + 1; k + 1 < end; ++k) area += glm::cross(corner(k) - corner(begin), corner(k + 1) - corner(begin));
    return glm::dot(area, view_vector(camera, hit.position)) < -1e-6 * glm::length(area);
  }

 private:
  const SceneModel& model_;
  std::vector<ClosestPointQuery> closest_{};
  std::vector<std::vector<size_t>> first_corners_{};  ///< Of each surface's polygons, and the end.
};

/// Of N.V: where the surface is seen flatter, a ray may pass beside a part of it that stands off by the bound.
inline constexpr float kGrazing = 0.2f;

/// Rays through `points` of the picture of `camera`. `bound`: how far the local model may stand off, world units; a ray is at an edge where
/// it or one of eight at `around_px` misses the fine model, grazes it, or sees it jump.
inline void cast_at_both(const ComparedModel& local, const ComparedModel& fine, const Camera& camera, const std::vector<glm::dvec2>& points,
                         double bound, double around_px, LocalRays& count) {
  const std::vector<PointSample> of_local = seen_at(local.model(), camera, points), of_fine = seen_at(fine.model(), camera, points);
  const auto hit = [](const PointSample& sample) { return sample.status == HitStatus::hit; };
  const auto same = [&](const PointSample& a, const PointSample& b) { return hit(a) == hit(b) && (!hit(a) || apart(a, b) <= bound); };
  std::vector<glm::dvec2> around;
  std::vector<size_t> differs;
  for (size_t i = 0; i < points.size(); ++i) {
    ++count.rays;
    count.hits += hit(of_fine[i]);
    count.backs += hit(of_local[i]) && local.shows_back(of_local[i], camera);
    if (same(of_local[i], of_fine[i])) continue;
    differs.push_back(i);
    for (int k = 0; k < 8; ++k)
      around.push_back(points[i] + around_px * glm::dvec2(std::cos(k * std::numbers::pi / 4.0), std::sin(k * std::numbers::pi / 4.0)));
  }
  const std::vector<PointSample> fine_around = seen_at(fine.model(), camera, around);
  for (size_t d = 0; d < differs.size(); ++d) {
    const PointSample &here = of_fine[differs[d]], &met = of_local[differs[d]];
    const auto faces_camera = [](const PointSample& sample) { return std::abs(sample.n_dot_v) > kGrazing; };
    bool surrounded = hit(here) && faces_camera(here);
    for (size_t k = 8 * d; surrounded && k < 8 * d + 8; ++k)
      surrounded = hit(fine_around[k]) && faces_camera(fine_around[k]) && apart(fine_around[k], here) <= 2.0 * bound;
    const auto strays = [&] {
      return !hit(met) || glm::distance(met.position, here.position) > 4.0 * bound / kGrazing ||
             fine.distance_from(met, 4.0 * bound) > bound || local.distance_from(here, 4.0 * bound) > bound;
    };
    const bool through = surrounded && strays();
    ++(through ? count.through : count.edge);
  }
}

/// World units that the local model made for `camera` may stand off anywhere in its picture.
inline double bound_of(const Scene& scene, const Camera& camera) {
  const Box box = bounds(scene);
  const double far = project(camera, box.center()).z + box.radius();
  return kLocalCoarse_px / pixels_per_unit_at(camera, far);
}

/// How far from a ray others are asked, px: farther than the local model may stand off, whatever the camera.
inline double around_of(const Scene& scene, const Camera& camera, double bound) {
  const double near = project(camera, bounds(scene).center()).z - bounds(scene).radius();
  return 1.0 + 1.2 * bound * pixels_per_unit_at(camera, std::max(near, 1e-3));
}

}  // namespace limn::test
