// Points of a limit surface in the world, with normals and curvature.

#include <cmath>
#include <limits>

#include "raymarch/truth/limit_grid.h"

namespace limn {
namespace {

bool has_normal(const glm::dvec3& n) { return std::isfinite(n.x) && glm::dot(n, n) > 0.5; }

/// Where a patch degenerates (a collapsed side, a corner without derivatives) the normal of a point a little inside serves.
glm::dvec2 inwards(const LimitPatch& patch, const glm::dvec2& uv) {
  const glm::dvec2 middle(patch.triangle ? 1.0 / 3.0 : 0.5);
  return glm::mix(uv, middle, 1e-4);
}

LimitSample sample_of(const PlacedLimitSurface& placed, size_t k, const glm::dvec2& uv, const LimitPoint& point) {
  LimitSample out;
  out.position = placed.world_from_cage.point(point.position);
  const bool mirrored = glm::determinant(placed.world_from_cage.linear) < 0.0;
  const auto normal_of = [&](const LimitPoint& at) {
    const glm::dvec3 cross = glm::cross(placed.world_from_cage.vector(at.du), placed.world_from_cage.vector(at.dv));
    return mirrored ? -cross : cross;
  };
  glm::dvec3 cross = normal_of(point);
  double length = glm::length(cross);
  if (!(length > 1e-12 * (glm::dot(point.du, point.du) + glm::dot(point.dv, point.dv)))) {
    const LimitPatch& patch = placed.patches[k];
    const glm::dvec2 in = inwards(patch, uv);
    LimitPoint inner = point;
    placed.surface.evaluate(patch.face, patch.sub_face, in.x, in.y, inner, LimitOrder::first);
    cross = normal_of(inner);
    length = glm::length(cross);
  }
  out.normal = cross / length;
  out.valid = has_normal(out.normal) && std::isfinite(out.position.x + out.position.y + out.position.z);
  return out;
}

SurfaceCurvature no_curvature() {
  SurfaceCurvature none;
  none.k1 = none.k2 = std::numeric_limits<double>::quiet_NaN();
  return none;
}

SurfaceCurvature placed_curvature(const PlacedLimitSurface& placed, const LimitPoint& p) {
  const Affine& map = placed.world_from_cage;
  LimitPoint moved{map.point(p.position), map.vector(p.du), map.vector(p.dv), map.vector(p.duu), map.vector(p.duv), map.vector(p.dvv)};
  if (glm::determinant(map.linear) < 0.0) {
    std::swap(moved.du, moved.dv);
    std::swap(moved.duu, moved.dvv);
  }
  return curvature(moved);
}

}  // namespace

PlacedLimitSurface place(const LimitSurface& surface, const Affine& world_from_cage) {
  PlacedLimitSurface placed{surface, world_from_cage, {}};
  for (int face = 0; face < surface.face_count(); ++face) {
    if (surface.is_hole(face)) continue;
    const bool sub_faces = surface.has_sub_faces(face);
    const int size = surface.face_size(face), parts = sub_faces ? size : 1;
    for (int part = 0; part < parts; ++part) placed.patches.push_back({face, part, sub_faces, size == 3 && !sub_faces});
  }
  return placed;
}

LimitSample sample(const PlacedLimitSurface& placed, size_t k, const glm::dvec2& uv) {
  const LimitPatch& patch = placed.patches[k];
  LimitPoint point;
  if (!placed.surface.evaluate(patch.face, patch.sub_face, uv.x, uv.y, point, LimitOrder::first)) return {};
  return sample_of(placed, k, uv, point);
}

CurvedLimitSample curved_sample(const PlacedLimitSurface& placed, size_t k, const glm::dvec2& uv) {
  const LimitPatch& patch = placed.patches[k];
  LimitPoint point;
  if (!placed.surface.evaluate(patch.face, patch.sub_face, uv.x, uv.y, point)) return {{}, no_curvature()};
  return {sample_of(placed, k, uv, point), placed_curvature(placed, point)};
}

SurfaceCurvature curvature_at(const PlacedLimitSurface& placed, size_t k, const glm::dvec2& uv) {
  const LimitPatch& patch = placed.patches[k];
  LimitPoint p;
  if (!placed.surface.evaluate(patch.face, patch.sub_face, uv.x, uv.y, p)) return no_curvature();
  return placed_curvature(placed, p);
}

}  // namespace limn
