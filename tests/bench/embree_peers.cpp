// Embree: triangles, a tree of high quality, packets of 4 x 4 pixels, smooth normals; on the zero surface of the grid as polygons and on
// the mesh that the grid was made from.

#include <embree3/rtcore.h>
#if defined(__SSE__)
#include <pmmintrin.h>
#include <xmmintrin.h>
#endif

#include <cmath>

#include "sdf/error.h"
#include "tests/bench/contestant.h"
#include "tests/bench/vdb_grid.h"

namespace limn::bench {
namespace {

struct EmbreeMesh {
  std::vector<glm::vec3> positions, normals;
  std::vector<glm::uvec3> triangles;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  ~EmbreeMesh() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
};

/// Embree asks for this mode; other contestants on the same threads do not.
struct DenormalsAreZero {
#if defined(__SSE__)
  unsigned before = _mm_getcsr();
  DenormalsAreZero() { _mm_setcsr(before | _MM_FLUSH_ZERO_ON | _MM_DENORMALS_ZERO_ON); }
  ~DenormalsAreZero() { _mm_setcsr(before); }
  DenormalsAreZero(const DenormalsAreZero&) = delete;
  DenormalsAreZero& operator=(const DenormalsAreZero&) = delete;
#endif
};

void take_smooth_normals(EmbreeMesh& mesh) {
  std::vector<glm::dvec3> sums(mesh.positions.size(), glm::dvec3(0.0));
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
    for (int k = 0; k < 3; ++k) sums[t[k]] += glm::cross(b - a, c - a);
  }
  for (const glm::dvec3& sum : sums) mesh.normals.emplace_back(glm::dot(sum, sum) > 0.0 ? glm::normalize(sum) : glm::dvec3(0.0, 0.0, 1.0));
}

void build_tree(EmbreeMesh& mesh) {
  take_smooth_normals(mesh);
  mesh.positions.reserve(mesh.positions.size() + 1);  // Embree reads 16 bytes at each position
  mesh.device = rtcNewDevice(nullptr);
  mesh.scene = rtcNewScene(mesh.device);
  rtcSetSceneBuildQuality(mesh.scene, RTC_BUILD_QUALITY_HIGH);
  RTCGeometry geometry = rtcNewGeometry(mesh.device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh.positions.data(), 0, sizeof(glm::vec3),
                             mesh.positions.size());
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles.data(), 0, sizeof(glm::uvec3),
                             mesh.triangles.size());
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(mesh.scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(mesh.scene);
  if (rtcGetDeviceError(mesh.device) != RTC_ERROR_NONE) throw MachineError("Embree could not build its tree");
}

std::shared_ptr<EmbreeMesh> from_soup(const PolygonSoup& soup) {
  auto mesh = std::make_shared<EmbreeMesh>();
  for (const glm::dvec3& p : soup.positions) mesh->positions.emplace_back(p);
  size_t first = 0;
  for (const std::int32_t size : soup.face_sizes) {
    const auto at = [&](int k) { return static_cast<unsigned>(soup.corner_vertices[first + static_cast<size_t>(k)]); };
    for (int k = 2; k < size; ++k) mesh->triangles.emplace_back(at(0), at(k - 1), at(k));
    first += static_cast<size_t>(size);
  }
  build_tree(*mesh);
  return mesh;
}

std::shared_ptr<EmbreeMesh> from_triangles(const TriangleMesh& triangles) {
  auto mesh = std::make_shared<EmbreeMesh>();
  for (const glm::dvec3& p : triangles.positions) mesh->positions.emplace_back(p);
  mesh->triangles = triangles.triangles;
  build_tree(*mesh);
  return mesh;
}

void trace_packet(const EmbreeMesh& mesh, const RayForms<float>& forms, int x, int y, Frame& frame) {
  alignas(64) int valid[16];
  alignas(64) RTCRayHit16 packet;
  for (int k = 0; k < 16; ++k) {
    const int column = x + (k & 3), row = y + (k >> 2);
    valid[k] = column < frame.width && row < frame.height ? -1 : 0;
    const glm::vec3 d = forms.direction(column, row);
    packet.ray.org_x[k] = forms.eye.x, packet.ray.org_y[k] = forms.eye.y, packet.ray.org_z[k] = forms.eye.z;
    packet.ray.dir_x[k] = d.x, packet.ray.dir_y[k] = d.y, packet.ray.dir_z[k] = d.z;
    packet.ray.tnear[k] = 0.0f, packet.ray.tfar[k] = std::numeric_limits<float>::infinity();
    packet.ray.time[k] = 0.0f, packet.ray.mask[k] = ~0u, packet.ray.flags[k] = 0;
    packet.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID, packet.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
  }
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect16(valid, mesh.scene, &context, &packet);
  for (int k = 0; k < 16; ++k) {
    if (!valid[k]) continue;
    const size_t i = static_cast<size_t>(y + (k >> 2)) * static_cast<size_t>(frame.width) + static_cast<size_t>(x + (k & 3));
    if (packet.hit.geomID[k] == RTC_INVALID_GEOMETRY_ID) {
      frame.miss(i);
      continue;
    }
    const glm::uvec3& t = mesh.triangles[packet.hit.primID[k]];
    const float u = packet.hit.u[k], v = packet.hit.v[k];
    const glm::vec3 n = (1.0f - u - v) * mesh.normals[t.x] + u * mesh.normals[t.y] + v * mesh.normals[t.z];
    frame.hit(i, packet.ray.tfar[k], n * (1.0f / std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z)));
  }
}

Contestant embree_contestant(const BenchCase& bench_case, const std::shared_ptr<EmbreeMesh>& mesh, const std::string& key,
                             const std::string& name, Drawn drawn) {
  auto frame = std::make_shared<Frame>(bench_case.camera.width_px, bench_case.camera.height_px);
  const RayForms<float> forms = single(ray_forms(bench_case.camera));
  return {.key = key,
          .name = name,
          .drawn = drawn,
          .draw =
              [mesh, frame, forms] {
                for_each_tile(frame->width, frame->height, [&](int x0, int y0, int x1, int y1) {
                  const DenormalsAreZero mode;
                  for (int y = y0; y < y1; y += 4)
                    for (int x = x0; x < x1; x += 4) trace_packet(*mesh, forms, x, y, *frame);
                });
              },
          .take = [frame](Frame& out) { copy(*frame, out); }};
}

}  // namespace

std::vector<Contestant> embree_peers(const BenchCase& bench_case) {
  return {embree_contestant(bench_case, from_soup(mesh_from_level_set(bench_case.level_set)), "embree.grid",
                            "Embree rtcIntersect16, the grid's mesh", Drawn::grid),
          embree_contestant(bench_case, from_triangles(bench_case.original), "embree.original", "Embree rtcIntersect16, the original mesh",
                            Drawn::original)};
}

}  // namespace limn::bench
