// Triangles through Embree 3. One ray at a time, although Embree knows packets: a packet may settle a hit on a shared edge by what
// its other rays did, and a pixel must not depend on its neighbours. Single rays use SIMD across the tree's children instead.

#include <embree3/rtcore.h>

#include <chrono>

#include "raymarch/surface/object_mesh.h"
#include "raymarch/surface/registry.h"
#include "sdf/error.h"

namespace limn {
namespace {

// How far outside its triangle a polished hit may come to lie, in barycentrics, before Embree's own is kept.
constexpr double kBarycentricSlack = 1e-3;

struct EmbreeDevice {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct EmbreeScene {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
template <class Handle, class Release>
using Owned = std::unique_ptr<std::remove_pointer_t<Handle>, Release>;

struct MeshState {
  TriangleMesh mesh;  ///< Render space.
  Owned<RTCDevice, EmbreeDevice> device;
  Owned<RTCScene, EmbreeScene> scene;
};

/// The nearest hit so far, for ties: where two triangles are hit at the same t the one of lower index counts, whatever the tree.
struct TieContext {
  RTCIntersectContext context;  // first, so that Embree's pointer is ours
  float t;
  unsigned triangle;
};

void settle_tie(const RTCFilterFunctionNArguments* arguments) {
  auto* tie = reinterpret_cast<TieContext*>(arguments->context);
  const float t = RTCRayN_tfar(arguments->ray, arguments->N, 0);
  const unsigned triangle = RTCHitN_primID(arguments->hit, arguments->N, 0);
  if (t == tie->t && triangle > tie->triangle) {
    arguments->valid[0] = 0;
    return;
  }
  tie->t = t;
  tie->triangle = triangle;
}

void attach_triangles(MeshState& state) {
  const TriangleMesh& mesh = state.mesh;
  const auto geometry = rtcNewGeometry(state.device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.positions.size()));
  auto* indices = static_cast<unsigned*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), mesh.triangles.size()));
  if (!vertices || !indices) throw MachineError("Embree could not take the memory for the mesh");
  for (const glm::dvec3& position : mesh.positions) {
    for (int axis = 0; axis < 3; ++axis) *vertices++ = static_cast<float>(position[axis]);
  }
  for (const glm::uvec3& triangle : mesh.triangles) {
    for (int corner = 0; corner < 3; ++corner) *indices++ = triangle[corner];
  }
  rtcSetGeometryIntersectFilterFunction(geometry, settle_tie);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(state.scene.get(), geometry);
  rtcReleaseGeometry(geometry);
}

void build_tree(MeshState& state) {
  state.device.reset(rtcNewDevice(nullptr));
  if (!state.device) throw MachineError("Embree could not start");
  state.scene.reset(rtcNewScene(state.device.get()));
  rtcSetSceneFlags(state.scene.get(), RTC_SCENE_FLAG_ROBUST);
  attach_triangles(state);
  rtcCommitScene(state.scene.get());
  if (rtcGetDeviceError(state.device.get()) != RTC_ERROR_NONE) throw MachineError("Embree could not build its tree over the mesh");
}

/// A hit on one triangle: where, and the weights of its second and third corner.
struct TriangleHit {
  unsigned triangle = 0;
  double t = 0.0, u = 0.0, v = 0.0;
};

/// t, u and v again in double, from the triangle's plane. A ray that grazes the plane keeps Embree's, which are safe at the edges.
void polish(const MeshState& state, const glm::dvec3& origin, const glm::dvec3& direction, TriangleHit& hit) {
  const glm::uvec3& corners = state.mesh.triangles[hit.triangle];
  const glm::dvec3 a = state.mesh.positions[corners.x];
  const glm::dvec3 ab = state.mesh.positions[corners.y] - a, ac = state.mesh.positions[corners.z] - a;
  const glm::dvec3 normal = glm::cross(ab, ac);
  const double area2 = glm::dot(normal, normal);
  const double t = glm::dot(normal, a - origin) / glm::dot(normal, direction);
  const glm::dvec3 ap = origin + t * direction - a;
  const double u = glm::dot(glm::cross(ap, ac), normal) / area2, v = glm::dot(glm::cross(ab, ap), normal) / area2;
  const bool inside = u >= -kBarycentricSlack && v >= -kBarycentricSlack && u + v <= 1.0 + kBarycentricSlack;
  if (inside && t >= 0.0 && std::isfinite(t)) hit = {hit.triangle, t, u, v};
}

glm::vec3 normal_at(const TriangleMesh& mesh, const TriangleHit& hit) {
  const glm::uvec3& corners = mesh.triangles[hit.triangle];
  const glm::dvec3 a = mesh.positions[corners.x];
  const glm::dvec3 facet = glm::cross(mesh.positions[corners.y] - a, mesh.positions[corners.z] - a);
  glm::dvec3 normal = facet;
  if (!mesh.corner_normals.empty()) {
    const glm::vec3* corner = &mesh.corner_normals[size_t{3} * hit.triangle];
    const double u = std::clamp(hit.u, 0.0, 1.0), v = std::clamp(hit.v, 0.0, 1.0 - u);
    normal = (1.0 - u - v) * glm::dvec3(corner[0]) + u * glm::dvec3(corner[1]) + v * glm::dvec3(corner[2]);
    // Opposite corner normals can cancel; the facet's own cannot.
    if (!(glm::dot(normal, normal) > 1e-12)) normal = facet;
  }
  return glm::vec3(glm::normalize(normal));
}

void write_hit(const MeshState& state, const TriangleHit& hit, int i, HitBatch& hits) {
  const TriangleMesh& mesh = state.mesh;
  const glm::vec3 normal = normal_at(mesh, hit);
  hits.status[i] = HitStatus::hit;
  hits.t[i] = static_cast<float>(hit.t);
  hits.normal_x[i] = normal.x;
  hits.normal_y[i] = normal.y;
  hits.normal_z[i] = normal.z;
  hits.face[i] = mesh.triangle_faces.empty() ? static_cast<std::int32_t>(hit.triangle) : mesh.triangle_faces[hit.triangle];
  hits.material[i] = mesh.triangle_materials.empty() ? 0 : mesh.triangle_materials[hit.triangle];
}

RTCRayHit embree_ray(const RayBatch& rays, int i) {
  RTCRayHit ray{};
  ray.ray.org_x = rays.origin_x[i];
  ray.ray.org_y = rays.origin_y[i];
  ray.ray.org_z = rays.origin_z[i];
  ray.ray.dir_x = rays.direction_x[i];
  ray.ray.dir_y = rays.direction_y[i];
  ray.ray.dir_z = rays.direction_z[i];
  ray.ray.tnear = std::max(rays.t_min[i], 0.0f);  // Embree asks for it; a bounded surface never lies before the ray's start
  ray.ray.tfar = rays.t_max[i];
  ray.ray.mask = ~0u;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  return ray;
}

void trace(const void* opaque, const RayBatch& rays, HitBatch& hits) {
  const MeshState& state = *static_cast<const MeshState*>(opaque);
  for (int i = 0; i < rays.count; ++i) {
    if (!(rays.t_min[i] < rays.t_max[i])) continue;
    RTCRayHit ray = embree_ray(rays, i);
    TieContext tie{};
    rtcInitIntersectContext(&tie.context);
    tie.t = std::numeric_limits<float>::infinity();
    rtcIntersect1(state.scene.get(), &tie.context, &ray);
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) continue;
    TriangleHit hit{ray.hit.primID, ray.ray.tfar, ray.hit.u, ray.hit.v};
    polish(state, glm::dvec3(rays.origin(i)), glm::dvec3(rays.direction(i)), hit);
    if (static_cast<float>(hit.t) < rays.t_max[i]) write_hit(state, hit, i, hits);
  }
}

Surface build(const SceneObject& object, const SurfaceSettings& settings, const glm::dvec3& render_origin) {
  const auto start = std::chrono::steady_clock::now();
  auto state = std::make_shared<MeshState>();
  ObjectMesh source = object_mesh(object, settings, render_origin);
  state->mesh = std::move(source.triangles);
  Surface surface;
  for (const glm::dvec3& position : state->mesh.positions) surface.bounds = include(surface.bounds, position);
  build_tree(*state);
  surface.trace = trace;
  surface.info.kind = "mesh";
  surface.info.triangles = static_cast<std::int64_t>(state->mesh.triangles.size());
  surface.info.bytes = state->mesh.bytes();
  surface.info.warnings = std::move(source.warnings);
  surface.info.build_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  surface.state = std::move(state);
  return surface;
}

}  // namespace

SurfaceDescriptor mesh_surface() {
  return {{"mesh", "the refined, tessellated or loaded mesh, its triangles traced exactly",
           "Embree 3 (Wald et al. 2014), robust mode; subdivision: OpenSubdiv 3.5"},
          {"level", "scheme", "normals"},
          cannot_mesh,
          build};
}

}  // namespace limn
