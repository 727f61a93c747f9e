#include "raymarch/lines/mesh_tree.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <new>
#include <numeric>

#include "raymarch/mesh/embree_device.h"
#include "raymarch/mesh/polygons.h"
#include "sdf/apart_from_loops.h"
#include "sdf/once_alone.h"
#include "sdf/parallel.h"
#include "subdiv/embree_module.h"

namespace limn {
namespace {

using Triangle = LayerTriangle;

constexpr size_t kPart = 16384;  // of a loop

/// The face of each corner.
std::vector<std::int32_t> faces_of_corners(const Mesh& mesh) {
  std::vector<std::int32_t> faces;
  faces.reserve(mesh.corner_vertices.size());
  for (size_t f = 0; f < mesh.face_sizes.size(); ++f)
    faces.insert(faces.end(), static_cast<size_t>(mesh.face_sizes[f]), static_cast<std::int32_t>(f));
  return faces;
}

/// Vertices joined where faces join them.
class Parts {
 public:
  explicit Parts(size_t vertices) : parent_(vertices) { std::iota(parent_.begin(), parent_.end(), 0u); }
  std::uint32_t find(std::uint32_t v) {
    while (parent_[v] != v) v = parent_[v] = parent_[parent_[v]];
    return v;
  }
  void join(std::uint32_t a, std::uint32_t b) { parent_[find(a)] = find(b); }

 private:
  std::vector<std::uint32_t> parent_;
};

bool touch(const Triangle& a, const Triangle& b) {
  return std::any_of(a.corners.begin(), a.corners.end(),
                     [&](std::uint32_t corner) { return std::find(b.corners.begin(), b.corners.end(), corner) != b.corners.end(); });
}

}  // namespace

struct MeshTree::Embree {
  RTCDevice device = nullptr;
  RTCScene tree = nullptr;
  ~Embree() {
    if (tree != nullptr) embree().rtcReleaseScene(tree);
    if (device != nullptr) embree().rtcReleaseDevice(device);
  }
};

MeshTree::MeshTree(const std::vector<std::shared_ptr<const Polygons>>& polygons, const glm::dvec3& offset, const std::vector<int>& objects,
                   double extent, bool exact)
    : extent_(extent), exact_(exact), embree_(std::make_unique<Embree>()) {
  for (size_t i = 0; i < polygons.size(); ++i) {
    if (polygons[i]) add(*polygons[i], offset, objects[i]);
  }
  weld();
}

MeshTree::~MeshTree() = default;

void MeshTree::add(const Polygons& polygons, const glm::dvec3& offset, int object) {
  const Mesh& mesh = polygons.mesh();
  const auto first = static_cast<std::uint32_t>(positions_.size());
  for (const glm::dvec3& p : mesh.positions) positions_.push_back(p + offset);
  const std::vector<std::int32_t> face_of = mesh.face_materials.empty() ? std::vector<std::int32_t>{} : faces_of_corners(mesh);
  for (const glm::uvec3& corner : polygons.corner_triangles()) {
    Triangle triangle;
    if (!face_of.empty()) triangle.material = mesh.face_materials[static_cast<size_t>(face_of[corner[0]])];
    for (int k = 0; k < 3; ++k)
      triangle.corners[static_cast<size_t>(k)] = first + static_cast<std::uint32_t>(mesh.corner_vertices[corner[k]]);
    triangle.object = object;
    triangles_.push_back(triangle);
  }
}

/// Vertices at one place are one vertex.
void MeshTree::weld() {
  std::vector<std::uint32_t> order(positions_.size()), same(positions_.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&](std::uint32_t i) { return std::tie(positions_[i].x, positions_[i].y, positions_[i].z); };
  // Of one place the first comes first, however many threads sort.
  parallel_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::tie(positions_[a].x, positions_[a].y, positions_[a].z, a) < std::tie(positions_[b].x, positions_[b].y, positions_[b].z, b);
  });
  for (size_t i = 0; i < order.size(); ++i) same[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? same[order[i - 1]] : order[i];
  Parts joined(positions_.size());
  for (Triangle& triangle : triangles_) {
    for (std::uint32_t& corner : triangle.corners) corner = same[corner];
    joined.join(triangle.corners[0], triangle.corners[1]);
    joined.join(triangle.corners[0], triangle.corners[2]);
  }
  std::map<std::uint32_t, std::uint32_t> numbers;
  for (Triangle& triangle : triangles_)
    triangle.part = numbers.try_emplace(joined.find(triangle.corners[0]), static_cast<std::uint32_t>(numbers.size())).first->second;
  parts_ = static_cast<std::uint32_t>(numbers.size());
}

void MeshTree::build() const {
  embree_->device = shared_embree_device();
  embree_->tree = embree().rtcNewScene(embree_->device);
  embree().rtcSetSceneFlags(embree_->tree, static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
  // Few rays are asked: a better tree takes longer to build than they save.
  embree().rtcSetSceneBuildQuality(embree_->tree, RTC_BUILD_QUALITY_LOW);
  RTCGeometry geometry = embree().rtcNewGeometry(embree_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  embree().rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_LOW);
  auto* vertices = static_cast<float*>(embree().rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                        3 * sizeof(float), std::max<size_t>(positions_.size(), 1)));
  auto* corners = static_cast<unsigned*>(embree().rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                          3 * sizeof(unsigned), std::max<size_t>(triangles_.size(), 1)));
  if (vertices == nullptr || corners == nullptr) throw std::bad_alloc();
  parallel_parts(positions_.size(), kPart, [&](const IndexRange<size_t>& range) {
    for (size_t i = range.begin(); i < range.end(); ++i) {
      for (int k = 0; k < 3; ++k) vertices[3 * i + static_cast<size_t>(k)] = static_cast<float>(positions_[i][k]);
    }
  });
  parallel_parts(triangles_.size(), kPart, [&](const IndexRange<size_t>& range) {
    for (size_t i = range.begin(); i < range.end(); ++i)
      std::copy(triangles_[i].corners.begin(), triangles_[i].corners.end(), corners + 3 * i);
  });
  embree().rtcCommitGeometry(geometry);
  embree().rtcAttachGeometry(embree_->tree, geometry);
  embree().rtcReleaseGeometry(geometry);
  apart_from_loops([this] { embree().rtcCommitScene(embree_->tree); });
  check_tree(embree_->device);
}

void MeshTree::prepare_for_smooth() const {
  parallel_invoke([this] { once_alone(built_, [this] { build(); }); }, [this] { std::call_once(around_made_, [this] { find_around(); }); });
}

std::vector<LayerHit> MeshTree::hits_along(const glm::dvec3& origin, const glm::dvec3& direction, double end) const {
  struct Collector {
    RTCIntersectContext context;
    std::vector<LayerHit> hits;
  } collector;
  rtcInitIntersectContext(&collector.context);
  collector.context.filter = [](const RTCFilterFunctionNArguments* arguments) {
    auto* const own = reinterpret_cast<Collector*>(arguments->context);
    const auto* const ray = reinterpret_cast<const RTCRay*>(arguments->ray);
    const auto* const hit = reinterpret_cast<const RTCHit*>(arguments->hit);
    own->hits.push_back({static_cast<double>(ray->tfar), hit->primID});
    arguments->valid[0] = 0;  // Go on.
  };
  RTCRayHit query{};
  query.ray.org_x = static_cast<float>(origin.x), query.ray.org_y = static_cast<float>(origin.y),
  query.ray.org_z = static_cast<float>(origin.z);
  query.ray.dir_x = static_cast<float>(direction.x), query.ray.dir_y = static_cast<float>(direction.y);
  query.ray.dir_z = static_cast<float>(direction.z);
  query.ray.tnear = 0.0f, query.ray.tfar = static_cast<float>(end);
  query.ray.mask = 0xffffffffu;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  once_alone(built_, [&] { build(); });
  embree().rtcIntersect1(embree_->tree, &collector.context, &query);
  std::vector<LayerHit>& hits = collector.hits;
  std::sort(hits.begin(), hits.end(),
            [](const LayerHit& a, const LayerHit& b) { return std::tie(a.t, a.triangle) < std::tie(b.t, b.triangle); });
  std::vector<LayerHit> kept;
  for (const LayerHit& hit : hits) {
    const bool again = std::any_of(kept.rbegin(), kept.rend(), [&](const LayerHit& k) {
      return hit.t - k.t <= 1e-5 * (extent_ + end) && touch(triangles_[hit.triangle], triangles_[k.triangle]) &&
             same_side(hit, k, direction);
    });
    if (!again) kept.push_back(hit);
  }
  return kept;
}

const ExactHits& MeshTree::exact_hits() const {
  once_alone(exact_made_, [&] { exact_hits_ = std::make_unique<const ExactHits>(positions_, triangles_, extent_); });
  return *exact_hits_;
}

void MeshTree::find_around() const {
  first_around_.assign(positions_.size() + 1, 0);
  for (const Triangle& triangle : triangles_) {
    for (const std::uint32_t corner : triangle.corners) ++first_around_[corner + 1];
  }
  std::partial_sum(first_around_.begin(), first_around_.end(), first_around_.begin());
  around_.resize(first_around_.back());
  std::vector<std::uint32_t> next(first_around_.begin(), first_around_.end() - 1);
  for (size_t t = 0; t < triangles_.size(); ++t) {
    for (const std::uint32_t corner : triangles_[t].corners) around_[next[corner]++] = static_cast<std::uint32_t>(t);
  }
}

glm::dvec3 MeshTree::smooth_normal(std::uint32_t triangle, const glm::dvec3& place) const {
  std::call_once(around_made_, [&] { find_around(); });
  const auto& corners = triangles_[triangle].corners;
  const glm::dvec3 across = normal_of(triangles_[triangle]);
  glm::dvec3 sum(0.0);
  for (size_t k = 0; k < 3; ++k) {
    glm::dvec3 at_corner(0.0);
    for (std::uint32_t i = first_around_[corners[k]]; i < first_around_[corners[k] + 1]; ++i)
      at_corner += normal_of(triangles_[around_[i]]);
    const glm::dvec3 &b = positions_[corners[(k + 1) % 3]], &c = positions_[corners[(k + 2) % 3]];
    sum += std::max(0.0, glm::dot(glm::cross(b - place, c - place), across)) * glm::normalize(at_corner);
  }
  return glm::normalize(sum);
}

bool MeshTree::joined_near(std::uint32_t one, std::uint32_t other, const glm::dvec3& place, double reach) const {
  std::call_once(around_made_, [&] { find_around(); });
  std::vector<std::uint32_t> found{one};
  for (size_t k = 0; k < found.size(); ++k) {
    if (found[k] == other) return true;
    for (const std::uint32_t corner : triangles_[found[k]].corners) {
      if (glm::distance(positions_[corner], place) > reach) continue;
      for (std::uint32_t i = first_around_[corner]; i < first_around_[corner + 1]; ++i) {
        if (std::find(found.begin(), found.end(), around_[i]) == found.end()) found.push_back(around_[i]);
      }
    }
  }
  return false;
}

glm::dvec3 MeshTree::normal_of(const LayerTriangle& triangle) const {
  const glm::dvec3 &a = positions_[triangle.corners[0]], &b = positions_[triangle.corners[1]], &c = positions_[triangle.corners[2]];
  return glm::cross(b - a, c - a);
}

/// Two triangles at a fold are both gone through: only those that face the same way are one layer.
bool MeshTree::same_side(const LayerHit& a, const LayerHit& b, const glm::dvec3& direction) const {
  return (glm::dot(normal_of(triangles_[a.triangle]), direction) > 0.0) == (glm::dot(normal_of(triangles_[b.triangle]), direction) > 0.0);
}

const PartMeetings& MeshTree::meetings() const {
  once_alone(meetings_made_, [&] {
    if (parts_ > 1) meetings_ = find_meetings();
  });
  return meetings_;
}

}  // namespace limn
