#include <cmath>
#include <limits>
#include <new>

#include "sdf/apart_from_loops.h"
#include "sdf/error.h"
#include "sdf/segment.h"
#include "subdiv/embree_module.h"
#include "subdiv/mesh_distance.h"

namespace limn {
namespace {

glm::dvec3 closest_on_edges(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  glm::dvec3 best = closest_on_segment(p, a, b);
  for (const glm::dvec3& q : {closest_on_segment(p, b, c), closest_on_segment(p, c, a)})
    if (glm::dot(q - p, q - p) < glm::dot(best - p, best - p)) best = q;
  return best;
}

struct Search {
  const ClosestPointData* data = nullptr;
  glm::dvec3 point{0.0};
  double best_squared = 0.0;
  std::uint32_t triangle = std::numeric_limits<std::uint32_t>::max();
  glm::dvec3 closest{0.0};
  double slack = 0.0;
};

/// Takes the triangle where it is closer; of equally close ones the lowest, so that the answer does not depend on the tree.
bool take_closer(std::uint32_t triangle, Search& search) {
  const glm::uvec3 t = search.data->triangles[triangle];
  const std::vector<glm::dvec3>& p = search.data->positions;
  const glm::dvec3 q = closest_on_triangle(search.point, p[t.x], p[t.y], p[t.z]);
  const double squared = glm::dot(q - search.point, q - search.point);
  if (squared > search.best_squared || (squared == search.best_squared && triangle >= search.triangle)) return false;
  search.best_squared = squared, search.triangle = triangle, search.closest = q;
  return true;
}

float query_radius(double distance, double slack) { return static_cast<float>(distance * (1.0 + 1e-6) + slack); }

bool visit(RTCPointQueryFunctionArguments* arguments) {
  auto& search = *static_cast<Search*>(arguments->userPtr);
  if (!take_closer(arguments->primID, search)) return false;
  const float radius = query_radius(std::sqrt(search.best_squared), search.slack);
  if (!(radius < arguments->query->radius)) return false;
  arguments->query->radius = radius;
  return true;
}

}  // namespace

glm::dvec3 closest_on_triangle(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 ab = b - a, ac = c - a, normal = glm::cross(ab, ac);
  const double squared = glm::dot(normal, normal);
  if (!(squared > 0.0)) return closest_on_edges(p, a, b, c);
  const glm::dvec3 ap = p - a;
  // Barycentric coordinates of the foot of the perpendicular.
  const double v = glm::dot(glm::cross(ap, ac), normal) / squared;
  const double w = glm::dot(glm::cross(ab, ap), normal) / squared;
  if (v < 0.0 || w < 0.0 || v + w > 1.0) return closest_on_edges(p, a, b, c);
  return a + v * ab + w * ac;
}

ClosestPointData::ClosestPointData(const TriangleMesh& mesh) : positions(mesh.positions), triangles(mesh.triangles) {
  Box box;
  for (const glm::uvec3& t : triangles)
    for (int i = 0; i < 3; ++i) box = include(box, positions[t[i]]);
  center = box.empty() ? glm::dvec3(0.0) : box.center();
  extent = box.radius();
  RTCDevice rtc_device = embree().rtcNewDevice(nullptr);
  if (rtc_device == nullptr) throw MachineError("Embree could not start: out of memory, most likely");
  RTCScene rtc_scene = embree().rtcNewScene(rtc_device);
  embree().rtcSetSceneFlags(rtc_scene, RTC_SCENE_FLAG_ROBUST);
  RTCGeometry geometry = embree().rtcNewGeometry(rtc_device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(
      embree().rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), positions.size()));
  auto* indices = static_cast<unsigned*>(
      embree().rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), triangles.size()));
  device = rtc_device, scene = rtc_scene;
  if (!triangles.empty() && (vertices == nullptr || indices == nullptr)) throw std::bad_alloc();
  for (size_t i = 0; i < positions.size(); ++i) {
    const glm::vec3 p(positions[i] - center);
    vertices[3 * i] = p.x, vertices[3 * i + 1] = p.y, vertices[3 * i + 2] = p.z;
  }
  for (size_t i = 0; i < triangles.size(); ++i)
    for (int k = 0; k < 3; ++k) indices[3 * i + static_cast<size_t>(k)] = triangles[i][k];
  embree().rtcSetGeometryPointQueryFunction(geometry, visit);
  embree().rtcCommitGeometry(geometry);
  embree().rtcAttachGeometry(rtc_scene, geometry);
  embree().rtcReleaseGeometry(geometry);
  apart_from_loops([&] { embree().rtcCommitScene(rtc_scene); });
  check_tree(rtc_device);
}

ClosestPointData::~ClosestPointData() {
  if (scene != nullptr) embree().rtcReleaseScene(static_cast<RTCScene>(scene));
  if (device != nullptr) embree().rtcReleaseDevice(static_cast<RTCDevice>(device));
}

std::optional<ClosestPoint> ClosestPointData::within(const glm::dvec3& point, double radius, std::span<const std::uint32_t> likely) const {
  if (triangles.empty()) return std::nullopt;
  Search search;
  search.data = this;
  search.point = point;
  const double finite_radius = std::min(radius, 1e30);
  search.best_squared = finite_radius * finite_radius;
  for (const std::uint32_t triangle : likely) take_closer(triangle, search);
  // The tree holds the triangles rounded to single precision about the centre, and so is the query.
  search.slack = 4e-7 * (extent + glm::length(point - center));
  const glm::vec3 local(point - center);
  RTCPointQuery query;
  query.x = local.x, query.y = local.y, query.z = local.z;
  query.time = 0.0f;
  query.radius = query_radius(std::sqrt(search.best_squared), search.slack);
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  embree().rtcPointQuery(static_cast<RTCScene>(scene), &query, &context, nullptr, &search);
  if (search.triangle >= triangles.size()) return std::nullopt;
  return ClosestPoint{std::sqrt(search.best_squared), search.closest, search.triangle};
}

ClosestPointQuery::ClosestPointQuery(const TriangleMesh& mesh) : data_(std::make_shared<const ClosestPointData>(mesh)) {}

ClosestPoint ClosestPointQuery::closest(const glm::dvec3& point) const {
  const std::optional<ClosestPoint> result = data_->within(point, std::numeric_limits<double>::infinity());
  LIMN_CHECK(result.has_value());  // of no triangles there is no closest one
  return *result;
}

}  // namespace limn
