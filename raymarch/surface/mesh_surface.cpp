// Triangles through Embree 3, which finds the candidates; each is then tested in double precision. Embree's own triangles let rays
// slip through between the corners that meet at a vertex (two of a thousand rays aimed at the vertices of a globe, in its robust
// mode). One ray at a time, although Embree knows packets: a pixel must not depend on its neighbours.

#include <atomic>
#include <chrono>
#include <cmath>
#include <mutex>

#include "raymarch/mesh/embree_device.h"
#include "raymarch/mesh/mesh_hit.h"
#include "raymarch/mesh/mesh_view.h"
#include "raymarch/mesh/open_sheet.h"
#include "raymarch/mesh/polygons.h"
#include "raymarch/surface.h"
#include "raymarch/surface/mesh_curvature.h"
#include "raymarch/surface/object_mesh.h"
#include "sdf/apart_from_loops.h"
#include "sdf/once_alone.h"
#include "sdf/parallel.h"
#include "subdiv/embree_module.h"
#include "subdiv/first_hits.h"

namespace limn {
namespace {

struct EmbreeDevice {
  void operator()(RTCDevice device) const { embree().rtcReleaseDevice(device); }
};
struct EmbreeScene {
  void operator()(RTCScene scene) const { embree().rtcReleaseScene(scene); }
};
template <class Handle, class Release>
using Owned = std::unique_ptr<std::remove_pointer_t<Handle>, Release>;

struct MeshState {
  std::shared_ptr<const TriangleMesh> mesh;  ///< Render space.
  /// Embree's tree, made when the first single ray asks for it: most pictures are drawn from lists of triangles and need none.
  mutable std::once_flag tree_made;
  mutable Owned<RTCDevice, EmbreeDevice> device;
  mutable Owned<RTCScene, EmbreeScene> scene;
  mutable std::atomic<bool> has_tree{false};
  mutable std::atomic<int> few_batches{0};  ///< Traced without it.
  Box bounds;
  mutable MeshViewMemory view_memory;
  std::shared_ptr<const Polygons> polygons;
  std::optional<MeshCurvature> curvature;  ///< Refers to the mesh and the polygons.
};

/// A ray in the axes of the watertight test (Woop, Benthin, Wald 2013): z along the largest component of its direction, x and y
/// sheared onto it. A vertex comes out the same for every triangle that holds it.
struct ShearedRay {
  glm::dvec3 origin{0.0};
  glm::ivec3 axes{0};
  glm::dvec3 shear{0.0};

  ShearedRay(const glm::dvec3& from, const glm::dvec3& direction) : origin(from) {
    const glm::dvec3 size = glm::abs(direction);
    axes.z = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    axes.x = (axes.z + 1) % 3;
    axes.y = (axes.x + 1) % 3;
    shear = glm::dvec3(direction[axes.x], direction[axes.y], 1.0) / direction[axes.z];
  }
  glm::dvec3 sheared(const glm::dvec3& point) const {
    const glm::dvec3 p = point - origin;
    return {p[axes.x] - shear.x * p[axes.z], p[axes.y] - shear.y * p[axes.z], shear.z * p[axes.z]};
  }
};

/// A hit on one triangle: where, and the weights of its second and third corner.
struct TriangleHit {
  unsigned triangle = 0;
  double t = std::numeric_limits<double>::infinity(), u = 0.0, v = 0.0;
};

/// What a ray carries through Embree's tree. The nearest triangle counts, of equally near ones that of lower index, whatever the order
/// in which the tree is walked.
struct RayContext {
  RTCIntersectContext context;  // first, so that Embree's pointer to it is one to us
  ShearedRay ray;
  double t_min, t_max;
  TriangleHit nearest;
};

/// The sign of each edge function is right or 0, since rounding is monotone and nothing is fused; 0 counts as inside on both sides of an
/// edge, so that no ray slips between two triangles.
bool intersect(const TriangleMesh& mesh, unsigned triangle, const RayContext& ray, TriangleHit& hit) {
  const glm::uvec3& corners = mesh.triangles[triangle];
  const glm::dvec3 a = ray.ray.sheared(mesh.positions[corners.x]), b = ray.ray.sheared(mesh.positions[corners.y]),
                   c = ray.ray.sheared(mesh.positions[corners.z]);
  const double at_a = c.x * b.y - c.y * b.x, at_b = a.x * c.y - a.y * c.x, at_c = b.x * a.y - b.y * a.x;
  if ((at_a < 0.0 || at_b < 0.0 || at_c < 0.0) && (at_a > 0.0 || at_b > 0.0 || at_c > 0.0)) return false;
  const double sum = at_a + at_b + at_c;
  if (sum == 0.0) return false;  // seen edge on: its neighbours stop the ray
  hit = {triangle, (at_a * a.z + at_b * b.z + at_c * c.z) / sum, at_b / sum, at_c / sum};
  return hit.t >= ray.t_min && hit.t < ray.t_max;
}

void test_candidate(const RTCIntersectFunctionNArguments* arguments) {
  if (!arguments->valid[0]) return;
  const auto& mesh = *static_cast<const TriangleMesh*>(arguments->geometryUserPtr);
  auto* ray = reinterpret_cast<RayContext*>(arguments->context);
  TriangleHit hit;
  if (!intersect(mesh, arguments->primID, *ray, hit)) return;
  if (hit.t > ray->nearest.t || (hit.t == ray->nearest.t && hit.triangle > ray->nearest.triangle)) return;
  ray->nearest = hit;
  auto* embree_ray = reinterpret_cast<RTCRayHit*>(arguments->rayhit);
  // Rounded up: what is as near in double must still be visited.
  embree_ray->ray.tfar = std::nextafter(static_cast<float>(hit.t), std::numeric_limits<float>::infinity());
  embree_ray->hit.geomID = arguments->geomID;
  embree_ray->hit.primID = arguments->primID;
}

void bound_triangle(const RTCBoundsFunctionArguments* arguments) {
  const parallel_detail::Part part(nullptr);
  const auto& mesh = *static_cast<const TriangleMesh*>(arguments->geometryUserPtr);
  const glm::uvec3& corners = mesh.triangles[arguments->primID];
  Box box;
  for (int corner = 0; corner < 3; ++corner) box = include(box, mesh.positions[corners[corner]]);
  // A margin for Embree's float arithmetic, beyond the rounding of the corners themselves.
  const glm::dvec3 margin = 1e-6 * (glm::max(glm::abs(box.lower), glm::abs(box.upper)) + box.longest_side());
  const glm::vec3 lower(box.lower - margin), upper(box.upper + margin);
  *arguments->bounds_o = {lower.x, lower.y, lower.z, 0.0f, upper.x, upper.y, upper.z, 0.0f};
}

void attach_triangles(const MeshState& state) {
  const auto geometry = embree().rtcNewGeometry(state.device.get(), RTC_GEOMETRY_TYPE_USER);
  // The scene's quality does not hold for what is within it. A tree of better quality takes three times as long to build, and rays save
  // less.
  embree().rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_LOW);
  embree().rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(state.mesh->triangles.size()));
  // Embree takes no const; what it is handed back is read only.
  embree().rtcSetGeometryUserData(geometry, const_cast<TriangleMesh*>(state.mesh.get()));
  embree().rtcSetGeometryBoundsFunction(geometry, bound_triangle, nullptr);
  embree().rtcSetGeometryIntersectFunction(geometry, test_candidate);
  embree().rtcCommitGeometry(geometry);
  embree().rtcAttachGeometry(state.scene.get(), geometry);
  embree().rtcReleaseGeometry(geometry);
}

void build_tree(const MeshState& state) {
  state.device.reset(shared_embree_device());
  state.scene.reset(embree().rtcNewScene(state.device.get()));
  embree().rtcSetSceneFlags(state.scene.get(), RTC_SCENE_FLAG_ROBUST);
  embree().rtcSetSceneBuildQuality(state.scene.get(), RTC_BUILD_QUALITY_LOW);
  attach_triangles(state);
  {
    const parallel_detail::Loop loop("Embree's own, over bound_triangle");
    apart_from_loops([&state] { embree().rtcCommitScene(state.scene.get()); });
  }
  check_tree(state.device.get());
}

RTCScene tree_of(const MeshState& state) {
  once_alone(state.tree_made, [&state] {
    build_tree(state);
    state.has_tree = true;
  });
  return state.scene.get();
}

void write_hit(const MeshState& state, const TriangleHit& hit, int i, HitBatch& hits) {
  const TriangleMesh& mesh = *state.mesh;
  const glm::vec3 normal = normal_at(mesh, {hit.triangle, hit.u, hit.v});
  hits.status[i] = HitStatus::hit;
  hits.t[i] = static_cast<float>(hit.t);
  hits.normal_x[i] = normal.x;
  hits.normal_y[i] = normal.y;
  hits.normal_z[i] = normal.z;
  hits.face[i] = face_of(mesh, hit.triangle);
  hits.material[i] = material_of(mesh, hit.triangle);
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

/// A few batches of rays are all that some pictures of a large mesh ask for: one pass over its triangles each is quicker than a tree.
bool takes_no_tree(const MeshState& state) {
  constexpr int kFewBatches = 3;
  return state.mesh->triangles.size() > kManyTriangles && !state.has_tree && state.few_batches.fetch_add(1) < kFewBatches;
}

/// The same hits, to the last bit: the triangles that the tree would have found as candidates are tested the same way.
void trace_few(const MeshState& state, const RayBatch& rays, HitBatch& hits) {
  std::vector<SegmentRay> segments;
  std::vector<int> lanes;
  for (int i = 0; i < rays.count; ++i) {
    if (!(rays.t_min[i] < rays.t_max[i])) continue;
    lanes.push_back(i);
    const double from = std::nextafter(static_cast<double>(rays.t_min[i]), -std::numeric_limits<double>::infinity());
    segments.push_back({glm::dvec3(rays.origin(i)), glm::dvec3(rays.direction(i)), from, rays.t_max[i]});
  }
  const std::vector<SegmentHit> found = first_hits(*state.mesh, segments);
  for (size_t k = 0; k < lanes.size(); ++k) {
    const int i = lanes[k];
    if (!found[k].found()) continue;
    const RayContext context{{}, {segments[k].origin, segments[k].direction}, rays.t_min[i], rays.t_max[i], {}};
    TriangleHit hit;
    if (intersect(*state.mesh, found[k].triangle, context, hit) && static_cast<float>(hit.t) < rays.t_max[i])
      write_hit(state, hit, i, hits);
  }
}

void trace(const void* opaque, const RayBatch& rays, HitBatch& hits) {
  const MeshState& state = *static_cast<const MeshState*>(opaque);
  if (takes_no_tree(state)) return trace_few(state, rays, hits);
  const RTCScene tree = tree_of(state);
  for (int i = 0; i < rays.count; ++i) {
    if (!(rays.t_min[i] < rays.t_max[i])) continue;
    RTCRayHit ray = embree_ray(rays, i);
    RayContext context{{}, {glm::dvec3(rays.origin(i)), glm::dvec3(rays.direction(i))}, rays.t_min[i], rays.t_max[i], {}};
    rtcInitIntersectContext(&context.context);
    embree().rtcIntersect1(tree, &context.context, &ray);
    const TriangleHit& hit = context.nearest;
    // Rounding to float may reach t_max, which a hit must not.
    if (static_cast<float>(hit.t) < rays.t_max[i]) write_hit(state, hit, i, hits);
  }
}

Surface build(const SceneObject& object, const SurfaceSettings& settings, const glm::dvec3& render_origin) {
  const auto start = std::chrono::steady_clock::now();
  auto state = std::make_shared<MeshState>();
  ObjectMesh source = object_mesh(object, settings, render_origin);
  state->mesh = std::move(source.triangles);
  Surface surface;
  surface.bounds = bounds_of_triangles(*state->mesh);
  state->bounds = surface.bounds;
  surface.trace = trace;
  surface.prepare = [](const void* opaque) { static_cast<void>(tree_of(*static_cast<const MeshState*>(opaque))); };
  surface.view = [](const std::shared_ptr<const void>& kept, const ViewRequest& request) {
    const MeshState& mesh_state = *static_cast<const MeshState*>(kept.get());
    SurfaceView made = view_mesh({kept, mesh_state.mesh.get(), mesh_state.bounds, &mesh_state.view_memory}, request);
    // The picture comes from single rays, then: the tree is made by all threads now rather than by one of them later.
    if (!made.trace) tree_of(mesh_state);
    return made;
  };
  surface.info.kind = "mesh";
  surface.info.triangles = static_cast<std::int64_t>(state->mesh->triangles.size());
  surface.info.bytes = state->mesh->bytes();
  surface.info.warnings = std::move(source.warnings);
  surface.info.notes = std::move(source.notes);
  state->polygons = std::move(source.polygons);
  surface.polygons = state->polygons;
  surface.open_sheet = std::make_shared<const OpenSheet>();
  state->curvature.emplace(*state->mesh, *state->polygons, source.normals, std::move(source.smooth));
  surface.curvature.from = state->curvature->from();
  if (state->curvature->available()) {
    surface.curvature.state = {state, &*state->curvature};
    surface.curvature.evaluate = [](const void* opaque, std::span<const SurfacePoint> points, std::span<SurfaceCurvature> curvatures) {
      static_cast<const MeshCurvature*>(opaque)->evaluate(points, curvatures);
    };
  }
  surface.info.build_ms = source.spared_ms + std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  surface.state = std::move(state);
  return surface;
}

}  // namespace

SurfaceDescriptor mesh_surface() {
  return {{"mesh", "the refined, tessellated or loaded mesh, its triangles traced exactly",
           "Embree 3 (Wald et al. 2014); Woop, Benthin, Wald 2013, watertight test; subdivision: OpenSubdiv 3.5"},
          {"level", "scheme", "normals"},
          cannot_mesh,
          build};
}

}  // namespace limn
