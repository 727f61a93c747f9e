#include "raymarch/lines/exact_hits.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>

#include "raymarch/lines/mesh_tree.h"
#include "raymarch/mesh/embree_device.h"
#include "sdf/apart_from_loops.h"
#include "subdiv/embree_module.h"

namespace limn {
namespace {

constexpr double kPad = 1e-5;  // of the extent, about each triangle's box: far more than single precision puts a ray beside its place

/// Six times the signed volume over b and c as seen along the way, the same but for its sign in whatever order they come.
double volume(const glm::dvec3& from, const glm::dvec3& way, const glm::dvec3& b, const glm::dvec3& c) {
  const bool swapped = std::tie(c.x, c.y, c.z) < std::tie(b.x, b.y, b.z);
  const double result = glm::dot(way, swapped ? glm::cross(c - from, b - from) : glm::cross(b - from, c - from));
  return swapped ? -result : result;
}

std::optional<double> share_through(const glm::dvec3& from, const glm::dvec3& to, const std::array<glm::dvec3, 3>& corners) {
  const glm::dvec3 way = to - from;
  const double ab = volume(from, way, corners[0], corners[1]), bc = volume(from, way, corners[1], corners[2]),
               ca = volume(from, way, corners[2], corners[0]);
  if (!((ab > 0.0 && bc > 0.0 && ca > 0.0) || (ab < 0.0 && bc < 0.0 && ca < 0.0))) return {};
  const glm::dvec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
  const double before = glm::dot(normal, from - corners[0]), after = glm::dot(normal, to - corners[0]);
  if ((before < 0.0) == (after < 0.0)) return {};
  return before / (before - after);
}

/// A segment on its way through the tree.
struct Query {
  RTCIntersectContext context{};  ///< First, so that its address is this one's.
  Segment segment{};
  std::vector<ExactHit> hits{};
};

}  // namespace

struct ExactHits::Tree {
  std::span<const glm::dvec3> positions{};
  std::span<const LayerTriangle> triangles{};
  double pad = 0.0;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;

  ~Tree() {
    if (scene != nullptr) embree().rtcReleaseScene(scene);
    if (device != nullptr) embree().rtcReleaseDevice(device);
  }

  std::array<glm::dvec3, 3> corners_of(std::uint32_t triangle) const {
    const auto& c = triangles[triangle].corners;
    return {positions[c[0]], positions[c[1]], positions[c[2]]};
  }
  static void bound(const RTCBoundsFunctionArguments* arguments) {
    const auto& tree = *static_cast<const Tree*>(arguments->geometryUserPtr);
    const std::array<glm::dvec3, 3> p = tree.corners_of(arguments->primID);
    const glm::vec3 low(glm::min(glm::min(p[0], p[1]), p[2]) - tree.pad), high(glm::max(glm::max(p[0], p[1]), p[2]) + tree.pad);
    RTCBounds& box = *arguments->bounds_o;
    box.lower_x = low.x, box.lower_y = low.y, box.lower_z = low.z;
    box.upper_x = high.x, box.upper_y = high.y, box.upper_z = high.z;
  }
  static void meet(const RTCIntersectFunctionNArguments* arguments) {
    const auto& tree = *static_cast<const Tree*>(arguments->geometryUserPtr);
    auto& query = *reinterpret_cast<Query*>(arguments->context);
    const Segment& segment = query.segment;
    const auto has = [&corners = tree.triangles[arguments->primID].corners](std::uint32_t vertex) {
      return std::find(corners.begin(), corners.end(), vertex) != corners.end();
    };
    if (arguments->primID == segment.faces[0] || arguments->primID == segment.faces[1]) return;
    if ((has(segment.edge[0]) && has(segment.edge[1])) || has(segment.vertices[0]) || has(segment.vertices[1])) return;
    if (const auto share = share_through(segment.from, segment.to, tree.corners_of(arguments->primID)))
      query.hits.push_back({*share, arguments->primID});
  }
};

ExactHits::ExactHits(std::span<const glm::dvec3> positions, std::span<const LayerTriangle> triangles, double extent)
    : tree_(std::make_unique<Tree>()) {
  tree_->positions = positions;
  tree_->triangles = triangles;
  tree_->pad = kPad * extent;
  tree_->device = shared_embree_device();
  tree_->scene = embree().rtcNewScene(tree_->device);
  embree().rtcSetSceneFlags(tree_->scene, RTC_SCENE_FLAG_ROBUST);
  embree().rtcSetSceneBuildQuality(tree_->scene, RTC_BUILD_QUALITY_LOW);
  RTCGeometry geometry = embree().rtcNewGeometry(tree_->device, RTC_GEOMETRY_TYPE_USER);
  embree().rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_LOW);
  embree().rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(triangles.size()));
  embree().rtcSetGeometryUserData(geometry, tree_.get());
  embree().rtcSetGeometryBoundsFunction(geometry, Tree::bound, nullptr);
  embree().rtcSetGeometryIntersectFunction(geometry, Tree::meet);
  embree().rtcCommitGeometry(geometry);
  embree().rtcAttachGeometry(tree_->scene, geometry);
  embree().rtcReleaseGeometry(geometry);
  apart_from_loops([this] { embree().rtcCommitScene(tree_->scene); });
  check_tree(tree_->device);
}

ExactHits::~ExactHits() = default;

std::vector<ExactHit> ExactHits::through(const Segment& segment) const {
  Query query;
  rtcInitIntersectContext(&query.context);
  query.segment = segment;
  const glm::vec3 start(segment.from), way(segment.to - segment.from);
  RTCRayHit ray{};
  ray.ray.org_x = start.x, ray.ray.org_y = start.y, ray.ray.org_z = start.z;
  ray.ray.dir_x = way.x, ray.ray.dir_y = way.y, ray.ray.dir_z = way.z;
  ray.ray.tnear = 0.0f, ray.ray.tfar = 1.0f;
  ray.ray.mask = 0xffffffffu;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  embree().rtcIntersect1(tree_->scene, &query.context, &ray);
  std::sort(query.hits.begin(), query.hits.end(),
            [](const ExactHit& a, const ExactHit& b) { return std::tie(a.share, a.triangle) < std::tie(b.share, b.triangle); });
  return std::move(query.hits);
}

}  // namespace limn
