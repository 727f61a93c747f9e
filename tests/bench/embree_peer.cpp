#include <embree3/rtcore.h>

#include <cmath>
#include <limits>

#include "sdf/error.h"
#include "tests/bench/contestant.h"

namespace limn::bench {
namespace {

struct EmbreeScene {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  ~EmbreeScene() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
};

std::shared_ptr<EmbreeScene> build_scene(const PolygonSoup& soup) {
  auto built = std::make_shared<EmbreeScene>();
  built->device = rtcNewDevice(nullptr);
  built->scene = rtcNewScene(built->device);
  rtcSetSceneFlags(built->scene, RTC_SCENE_FLAG_ROBUST);
  RTCGeometry geometry = rtcNewGeometry(built->device, RTC_GEOMETRY_TYPE_QUAD);
  auto* vertices = static_cast<glm::vec3*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3), soup.positions.size()));
  for (size_t i = 0; i < soup.positions.size(); ++i) vertices[i] = glm::vec3(soup.positions[i]);
  auto* quads = static_cast<glm::uvec4*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4, sizeof(glm::uvec4), soup.face_sizes.size()));
  size_t corner = 0;
  for (size_t face = 0; face < soup.face_sizes.size(); ++face) {
    const auto at = [&](int k) { return static_cast<unsigned>(soup.corner_vertices[corner + static_cast<size_t>(k)]); };
    quads[face] = glm::uvec4(at(0), at(1), at(2), soup.face_sizes[face] == 4 ? at(3) : at(2));
    corner += static_cast<size_t>(soup.face_sizes[face]);
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(built->scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(built->scene);
  return built;
}

}  // namespace

Contestant embree_on_grid_mesh(const BenchCase& bench_case) {
  const auto built = build_scene(mesh_from_level_set(bench_case.level_set));
  const Camera camera = bench_case.camera;
  return {.name = "Embree rtcIntersect16 on the grid's mesh", .draw = [built, camera](Frame& frame) {
            for_each_row(camera.height_px, [&](int y) {
              for (int x0 = 0; x0 < camera.width_px; x0 += 16) {
                alignas(64) int valid[16];
                RTCRayHit16 packet{};
                for (int lane = 0; lane < 16; ++lane) {
                  valid[lane] = x0 + lane < camera.width_px ? -1 : 0;
                  const CameraRay ray = camera_ray(camera, x0 + lane + 0.5, y + 0.5);
                  packet.ray.org_x[lane] = float(ray.origin.x), packet.ray.org_y[lane] = float(ray.origin.y);
                  packet.ray.org_z[lane] = float(ray.origin.z);
                  packet.ray.dir_x[lane] = float(ray.direction.x), packet.ray.dir_y[lane] = float(ray.direction.y);
                  packet.ray.dir_z[lane] = float(ray.direction.z);
                  packet.ray.tnear[lane] = 0.0f;
                  packet.ray.tfar[lane] = std::numeric_limits<float>::infinity();
                  packet.ray.mask[lane] = ~0u;
                  packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
                }
                RTCIntersectContext context;
                rtcInitIntersectContext(&context);
                context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
                rtcIntersect16(valid, built->scene, &context, &packet);
                for (int lane = 0; lane < 16 && valid[lane]; ++lane) {
                  const size_t i = static_cast<size_t>(y) * static_cast<size_t>(camera.width_px) + static_cast<size_t>(x0 + lane);
                  const bool hit = packet.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID;
                  frame.distance[i] = packet.ray.tfar[lane];
                  frame.normal[i] = hit ? glm::normalize(glm::vec3(packet.hit.Ng_x[lane], packet.hit.Ng_y[lane], packet.hit.Ng_z[lane]))
                                        : glm::vec3(0.0f);
                }
              }
            });
          }};
}

}  // namespace limn::bench
