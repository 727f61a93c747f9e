// Hits of a tile from the triangles that cover it: distances, interpolated normals, faces.

#include <algorithm>

#include "raymarch/mesh/cover.h"
#include "raymarch/mesh/mesh_hit.h"
#include "sdf/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raymarch/mesh/shade.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef LIMN_MESH_HIT_BLOCK
#define LIMN_MESH_HIT_BLOCK
namespace limn {
/// The hits of sixteen lanes: distances along the rays, weights of the second and third corner, those corners' normals.
struct HitBlock {
  alignas(64) float t[16], u[16], v[16];
  alignas(64) float normals[9][16];
};
}  // namespace limn
#endif

HWY_BEFORE_NAMESPACE();
namespace limn::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, 8>;
using H = hn::Rebind<float, D>;
using F = hn::CappedTag<float, 16>;

/// Where in space the block's rays meet their triangles; lanes without one get numbers without meaning.
HWY_INLINE void find_places(const MeshView& view, const RayBatch& rays, const TileCover& cover, size_t i, HitBlock& block) {
  const D d;
  const H h;
  const auto axis = [&](const float* values, double origin, double forward) {
    return hn::Mul(hn::Sub(hn::PromoteTo(d, hn::Load(h, values)), hn::Set(d, origin)), hn::Set(d, forward));
  };
  const auto along = [&](const float* x, const float* y, const float* z, const glm::dvec3& origin) {
    return hn::Add(hn::Add(axis(x, origin.x, view.forward.x), axis(y, origin.y, view.forward.y)), axis(z, origin.z, view.forward.z));
  };
  for (size_t k = 0; k < 16; k += hn::Lanes(d)) {
    const size_t at = i + k;
    const auto nearness = hn::Load(d, cover.nearness + at), sum = hn::Load(d, cover.weight_sum + at);
    const auto depth = view.perspective ? hn::Div(hn::Set(d, 1.0), nearness) : hn::Neg(nearness);
    const auto start = along(rays.origin_x + at, rays.origin_y + at, rays.origin_z + at, view.eye);
    const auto per_t = along(rays.direction_x + at, rays.direction_y + at, rays.direction_z + at, glm::dvec3(0.0));
    const auto share = [&](const double* weight) {
      const auto one = hn::Set(d, 1.0);
      return hn::Min(hn::Max(hn::Div(hn::Load(d, weight + at), sum), hn::Zero(d)), one);
    };
    hn::Store(hn::DemoteTo(h, hn::Div(hn::Sub(depth, start), per_t)), h, block.t + k);
    hn::Store(hn::DemoteTo(h, share(cover.weight_b)), h, block.u + k);
    hn::Store(hn::DemoteTo(h, share(cover.weight_c)), h, block.v + k);
  }
}

/// Interpolated and scaled to unit length, into lanes i on of the hits that `hit` names; returns in which of them normals cancel.
HWY_INLINE unsigned write_normals(const HitBlock& block, unsigned hit, size_t i, HitBatch& hits) {
  const F d;
  unsigned cancelled = 0;
  for (size_t k = 0; k < 16; k += hn::Lanes(d)) {
    const auto u = hn::Load(d, block.u + k), v = hn::Load(d, block.v + k), w = hn::Sub(hn::Sub(hn::Set(d, 1.0f), u), v);
    const auto mean = [&](size_t axis) {
      return hn::Add(hn::Add(hn::Mul(w, hn::Load(d, block.normals[axis] + k)), hn::Mul(u, hn::Load(d, block.normals[axis + 3] + k))),
                     hn::Mul(v, hn::Load(d, block.normals[axis + 6] + k)));
    };
    const auto x = mean(0), y = mean(1), z = mean(2);
    const auto length2 = hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
    const auto per = hn::Div(hn::Set(d, 1.0f), hn::Sqrt(length2));
    alignas(64) float normal[3][16], length[16];
    hn::Store(hn::Mul(x, per), d, normal[0]);
    hn::Store(hn::Mul(y, per), d, normal[1]);
    hn::Store(hn::Mul(z, per), d, normal[2]);
    hn::Store(length2, d, length);
    for (size_t lane = 0; lane < hn::Lanes(d); ++lane) {
      const size_t to = i + k + lane;
      if (!(hit >> (k + lane) & 1u)) continue;
      hits.normal_x[to] = normal[0][lane];
      hits.normal_y[to] = normal[1][lane];
      hits.normal_z[to] = normal[2][lane];
      if (!(length[lane] > static_cast<float>(kShortestNormal2))) cancelled |= 1u << (k + lane);
    }
  }
  return cancelled;
}

/// Lanes that hit within their ray; what these need of the mesh is written or gathered.
HWY_INLINE unsigned take_faces(const TriangleMesh& mesh, const RayBatch& rays, const TileCover& cover, size_t i, HitBlock& block,
                               HitBatch& hits) {
  unsigned hit = 0;
  for (size_t k = 0; k < 16; ++k) {
    const size_t at = i + k;
    if (!(cover.nearness[at] > -std::numeric_limits<double>::infinity()) || !(block.t[k] >= rays.t_min[at] && block.t[k] < rays.t_max[at]))
      continue;
    hit |= 1u << k;
    const auto triangle = static_cast<size_t>(cover.triangle[at]);
    hits.status[at] = HitStatus::hit;
    hits.t[at] = block.t[k];
    hits.face[at] = face_of(mesh, triangle);
    hits.material[at] = material_of(mesh, triangle);
    if (mesh.corner_normals.empty()) continue;
    const float* normals = &mesh.corner_normals[3 * triangle].x;
    for (size_t n = 0; n < 9; ++n) block.normals[n][k] = normals[n];
  }
  return hit;
}

void ShadeBlock(const MeshView& view, const RayBatch& rays, const TileCover& cover, size_t i, HitBlock& block, HitBatch& hits) {
  const TriangleMesh& mesh = *view.mesh;
  find_places(view, rays, cover, i, block);
  const unsigned hit = take_faces(mesh, rays, cover, i, block, hits);
  if (hit == 0) return;
  unsigned by_facet = mesh.corner_normals.empty() ? hit : write_normals(block, hit, i, hits);
  for (size_t k = 0; by_facet != 0; ++k, by_facet >>= 1) {
    if (!(by_facet & 1u)) continue;
    const glm::vec3 normal = normal_at(mesh, {static_cast<unsigned>(cover.triangle[i + k]), block.u[k], block.v[k]});
    hits.normal_x[i + k] = normal.x;
    hits.normal_y[i + k] = normal.y;
    hits.normal_z[i + k] = normal.z;
  }
}

}  // namespace
}  // namespace limn::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace limn {
namespace {

/// What hits read of the mesh lies anywhere in memory: it is asked for a tile at a time.
void fetch_hits(const TriangleMesh& mesh, const TileCover& cover, int lanes) {
  for (int i = 0; i < lanes; ++i) {
    const auto triangle = static_cast<size_t>(cover.triangle[i]);
    if (!mesh.corner_normals.empty()) {
      __builtin_prefetch(&mesh.corner_normals[3 * triangle].x);
      __builtin_prefetch(&mesh.corner_normals[3 * triangle + 2].z);
    }
    if (!mesh.triangle_faces.empty()) __builtin_prefetch(&mesh.triangle_faces[triangle]);
  }
}

}  // namespace

HWY_EXPORT(ShadeBlock);
void trace_mesh_tile(const MeshView& view, const PixelTile& tile, const RayBatch& rays, HitBatch& hits) {
  TileCover cover;
  cover_tile(view, tile, rays.count, cover);
  fetch_hits(*view.mesh, cover, rays.count);
  HitBlock block{};
  const auto shade_block = HWY_DYNAMIC_DISPATCH(ShadeBlock);
  for (int i = 0; i < rays.count; i += 16) shade_block(view, rays, cover, static_cast<size_t>(i), block, hits);
}

}  // namespace limn
#endif
