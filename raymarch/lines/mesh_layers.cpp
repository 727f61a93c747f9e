#include "raymarch/lines/mesh_layers.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

#include "raymarch/mesh/embree_device.h"
#include "raymarch/mesh/polygons.h"
#include "raymarch/truth/proxy.h"
#include "sdf/error.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr double kLift_px = 0.1;
constexpr double kAcross = 0.1, kSameSheet = 0.85;  // cosines

using Triangle = LayerTriangle;

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

}  // namespace

struct MeshLayers::State {
  Camera camera{};
  double extent = 1.0;
  std::vector<glm::dvec3> positions{};
  std::vector<Triangle> triangles{};
  std::uint32_t parts = 0;
  RTCDevice device = nullptr;
  RTCScene tree = nullptr;

  ~State() {
    if (tree != nullptr) rtcReleaseScene(tree);
    if (device != nullptr) rtcReleaseDevice(device);
  }

  void add(const Polygons& polygons, const glm::dvec3& offset, int object) {
    const Mesh& mesh = polygons.mesh();
    const auto first = static_cast<std::uint32_t>(positions.size());
    for (const glm::dvec3& p : mesh.positions) positions.push_back(p + offset);
    const std::vector<std::int32_t> face_of = mesh.face_materials.empty() ? std::vector<std::int32_t>{} : faces_of_corners(mesh);
    for (const glm::uvec3& corner : polygons.corner_triangles()) {
      Triangle triangle;
      if (!face_of.empty()) triangle.material = mesh.face_materials[static_cast<size_t>(face_of[corner[0]])];
      for (int k = 0; k < 3; ++k)
        triangle.corners[static_cast<size_t>(k)] = first + static_cast<std::uint32_t>(mesh.corner_vertices[corner[k]]);
      triangle.object = object;
      triangles.push_back(triangle);
    }
  }

  /// Vertices at one place are one vertex.
  void weld() {
    std::vector<std::uint32_t> order(positions.size()), same(positions.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto key = [&](std::uint32_t i) { return std::tie(positions[i].x, positions[i].y, positions[i].z); };
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
    for (size_t i = 0; i < order.size(); ++i) same[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? same[order[i - 1]] : order[i];
    Parts joined(positions.size());
    for (Triangle& triangle : triangles) {
      for (std::uint32_t& corner : triangle.corners) corner = same[corner];
      joined.join(triangle.corners[0], triangle.corners[1]);
      joined.join(triangle.corners[0], triangle.corners[2]);
    }
    std::map<std::uint32_t, std::uint32_t> numbers;
    for (Triangle& triangle : triangles)
      triangle.part = numbers.try_emplace(joined.find(triangle.corners[0]), static_cast<std::uint32_t>(numbers.size())).first->second;
    parts = static_cast<std::uint32_t>(numbers.size());
  }

  void build() {
    device = shared_embree_device();
    tree = rtcNewScene(device);
    rtcSetSceneFlags(tree, static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                                                 std::max<size_t>(positions.size(), 1)));
    auto* corners = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                   3 * sizeof(unsigned), std::max<size_t>(triangles.size(), 1)));
    if (vertices == nullptr || corners == nullptr) throw MachineError("Embree could not build its tree over the mesh");
    for (size_t i = 0; i < positions.size(); ++i) {
      for (int k = 0; k < 3; ++k) vertices[3 * i + static_cast<size_t>(k)] = static_cast<float>(positions[i][k]);
    }
    for (size_t i = 0; i < triangles.size(); ++i) std::copy(triangles[i].corners.begin(), triangles[i].corners.end(), corners + 3 * i);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(tree, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(tree);
    if (rtcGetDeviceError(device) != RTC_ERROR_NONE) throw MachineError("Embree could not build its tree over the mesh");
  }

  /// All hits on origin + t direction, 0 < t < end, in order; one where a shared edge or vertex is hit.
  std::vector<LayerHit> hits_along(const glm::dvec3& origin, const glm::dvec3& direction, double end) const {
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
    rtcIntersect1(tree, &collector.context, &query);
    std::vector<LayerHit>& hits = collector.hits;
    std::sort(hits.begin(), hits.end(),
              [](const LayerHit& a, const LayerHit& b) { return std::tie(a.t, a.triangle) < std::tie(b.t, b.triangle); });
    std::vector<LayerHit> kept;
    for (const LayerHit& hit : hits) {
      const bool again = std::any_of(kept.rbegin(), kept.rend(), [&](const LayerHit& k) {
        return hit.t - k.t <= 1e-5 * (extent + end) && touch(triangles[hit.triangle], triangles[k.triangle]) &&
               same_side(hit, k, direction);
      });
      if (!again) kept.push_back(hit);
    }
    return kept;
  }
  static bool touch(const Triangle& a, const Triangle& b) {
    return std::any_of(a.corners.begin(), a.corners.end(),
                       [&](std::uint32_t corner) { return std::find(b.corners.begin(), b.corners.end(), corner) != b.corners.end(); });
  }
  glm::dvec3 normal_of(const Triangle& triangle) const {
    const glm::dvec3 &a = positions[triangle.corners[0]], &b = positions[triangle.corners[1]], &c = positions[triangle.corners[2]];
    return glm::cross(b - a, c - a);
  }
  /// Two triangles at a fold are both gone through: only those that face the same way are one layer.
  bool same_side(const LayerHit& a, const LayerHit& b, const glm::dvec3& direction) const {
    return (glm::dot(normal_of(triangles[a.triangle]), direction) > 0.0) == (glm::dot(normal_of(triangles[b.triangle]), direction) > 0.0);
  }

  /// The part that the curve runs on: what most of a few short rays through it hit.
  std::uint32_t part_of(const SurfaceCurve& curve) const {
    std::map<std::uint32_t, int> votes;
    const size_t n = curve.samples.size(), step = std::max<size_t>(1, n / 9);
    for (size_t i = step / 2; i < n; i += step) {
      const CurveSample& sample = curve.samples[i];
      if (!(sample.depth > 0.0)) continue;
      const double reach = 2.0 * kLift_px / pixels_per_unit_at(camera, sample.depth);
      for (const glm::dvec3& way : {sample.high, sample.low}) {
        const std::vector<LayerHit> hits = hits_along(sample.p + reach * way, -way, 2.0 * reach);
        const auto nearest = std::min_element(hits.begin(), hits.end(), [&](const LayerHit& a, const LayerHit& b) {
          return std::fabs(a.t - reach) < std::fabs(b.t - reach);
        });
        if (nearest != hits.end()) ++votes[triangles[nearest->triangle].part];
      }
    }
    const auto most = std::max_element(votes.begin(), votes.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
    return most == votes.end() ? parts : most->first;
  }
};

MeshLayers::MeshLayers(const LineTask& task, const std::vector<size_t>& objects, double edge_px) : state_(std::make_unique<State>()) {
  state_->camera = task.camera;
  state_->extent = task.extent;
  Scene part{task.scene.name, task.scene.camera, {}};
  for (const size_t i : objects) {
    part.objects.push_back(task.scene.objects[i]);
    part.objects.back().world_from_object.translation -= task.origin;
  }
  const SceneModel model = make_proxy(part, task.camera, task.settings.max_bytes, edge_px).model;
  for (size_t i = 0; i < model.surfaces.size(); ++i) {
    if (model.surfaces[i].polygons) state_->add(*model.surfaces[i].polygons, model.render_origin, static_cast<int>(objects[i]) + 1);
  }
  state_->weld();
  state_->build();
}

MeshLayers::~MeshLayers() = default;

const std::vector<glm::dvec3>& MeshLayers::positions() const { return state_->positions; }
const std::vector<LayerTriangle>& MeshLayers::triangles() const { return state_->triangles; }

std::vector<LayerHit> MeshLayers::hits_to_eye(const CurveSample& sample) const {
  const Camera& camera = state_->camera;
  const double unit_px = pixels_per_unit_at(camera, std::max(sample.depth, 1e-9));
  const glm::dvec3 start = sample.p + (kLift_px / unit_px) * sample.lift, direction = view_vector(camera, start);
  const double reach = camera.projection == Projection::perspective ? glm::distance(start, camera.eye)
                                                                    : std::max(0.0, project(camera, start).z) + 4.0 * state_->extent;
  return state_->hits_along(start, direction, reach);
}

int MeshLayers::before(const CurveSample& sample) const { return static_cast<int>(hits_to_eye(sample).size()); }

bool MeshLayers::several_parts() const { return state_->parts > 1; }

void MeshLayers::pierce(SurfaceCurve& curve) const {
  const std::uint32_t own = state_->part_of(curve);
  const size_t n = curve.samples.size();
  for (size_t i = 0; i + (curve.closed ? 0 : 1) < n; ++i) {
    CurveSample& sample = curve.samples[i];
    const CurveSample& next = curve.samples[(i + 1) % n];
    const double length = glm::distance(sample.p, next.p);
    if (!(length > 0.0)) continue;
    const glm::dvec3 way = (next.p - sample.p) / length;
    for (const LayerHit& hit : state_->hits_along(sample.p, way, length)) {
      const Triangle& triangle = state_->triangles[hit.triangle];
      // Faces around a vertex that a mesh's own edge ends at are met there.
      const bool at_vertex = std::any_of(triangle.corners.begin(), triangle.corners.end(), [&](std::uint32_t corner) {
        return state_->positions[corner] == sample.p || state_->positions[corner] == next.p;
      });
      if (at_vertex && curve.straight) continue;
      const glm::dvec3 normal = glm::normalize(state_->normal_of(triangle));
      // Triangles of the curve's own sheet lie along it; another sheet of the same part goes across.
      const bool along_own = std::fabs(glm::dot(normal, way)) < kAcross || std::fabs(glm::dot(normal, sample.high)) > kSameSheet ||
                             std::fabs(glm::dot(normal, sample.low)) > kSameSheet;
      if (triangle.part == own && along_own) continue;
      const double along = glm::dot(normal, way), towards_eye = glm::dot(normal, view_vector(state_->camera, sample.p));
      sample.pierced.push_back({hit.t / length, (along > 0.0) == (towards_eye > 0.0) ? -1 : 1});
    }
  }
}

namespace {

/// Where an edge of one part goes through a triangle of another.
struct EdgeHit {
  glm::dvec3 p{0.0};
  glm::dvec3 lower_normal{0.0}, upper_normal{0.0};  ///< Unit, of the parts of lower and higher number.
  int object = 1;
};

}  // namespace

std::vector<SurfaceCurve> MeshLayers::intersections() const {
  const State& state = *state_;
  // Faces of each edge.
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::uint32_t>> faces_of;
  std::vector<Box> boxes(state.parts);
  for (const Triangle& triangle : state.triangles) {
    for (const std::uint32_t corner : triangle.corners) boxes[triangle.part] = include(boxes[triangle.part], state.positions[corner]);
  }
  const auto meets_others = [&](const Triangle& triangle) {
    Box own;
    for (const std::uint32_t corner : triangle.corners) own = include(own, state.positions[corner]);
    for (std::uint32_t part = 0; part < state.parts; ++part) {
      if (part != triangle.part && !intersect(own, boxes[part]).empty()) return true;
    }
    return false;
  };
  for (std::uint32_t f = 0; f < state.triangles.size(); ++f) {
    const Triangle& triangle = state.triangles[f];
    if (!meets_others(triangle)) continue;
    for (size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangle.corners[k], b = triangle.corners[(k + 1) % 3];
      faces_of[{std::min(a, b), std::max(a, b)}].push_back(f);
    }
  }
  // Each pair of faces that go through each other is left where an edge of the one meets the other.
  std::vector<EdgeHit> hits;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<size_t>> of_pair;
  for (const auto& [edge, faces] : faces_of) {
    const glm::dvec3 &a = state.positions[edge.first], &b = state.positions[edge.second];
    const double length = glm::distance(a, b);
    if (!(length > 0.0)) continue;
    for (const LayerHit& hit : state.hits_along(a, (b - a) / length, length)) {
      const Triangle& other = state.triangles[hit.triangle];
      if (other.part == state.triangles[faces[0]].part) continue;
      const Triangle& own = state.triangles[faces[0]];
      const glm::dvec3 own_normal = glm::normalize(state.normal_of(own)), other_normal = glm::normalize(state.normal_of(other));
      const bool lower = own.part < other.part;
      hits.push_back({glm::mix(a, b, hit.t / length), lower ? own_normal : other_normal, lower ? other_normal : own_normal, other.object});
      for (const std::uint32_t face : faces)
        of_pair[{std::min(face, hit.triangle), std::max(face, hit.triangle)}].push_back(hits.size() - 1);
    }
  }
  std::vector<std::vector<size_t>> next(hits.size());
  for (const auto& [pair, ends] : of_pair) {
    if (ends.size() != 2) continue;
    next[ends[0]].push_back(ends[1]);
    next[ends[1]].push_back(ends[0]);
  }
  std::vector<SurfaceCurve> curves;
  std::vector<bool> taken(hits.size(), false);
  const auto walk = [&](size_t start) {
    SurfaceCurve curve;
    size_t at = start, before = hits.size();
    std::pair<bool, bool> before_facing;
    for (;;) {
      taken[at] = true;
      CurveSample sample;
      sample.p = hits[at].p;
      const glm::dvec3 v = view_vector(state.camera, sample.p);
      const EdgeHit& hit = hits[at];
      const double lower = glm::dot(hit.lower_normal, v), upper = glm::dot(hit.upper_normal, v);
      sample.high = lower >= upper ? hit.lower_normal : hit.upper_normal;
      sample.low = lower >= upper ? hit.upper_normal : hit.lower_normal;
      // Past a contour of either part the line lies on its other sheet.
      const std::pair<bool, bool> facing(lower > 0.0, upper > 0.0);
      sample.joint = !curve.samples.empty() && facing != before_facing;
      before_facing = facing;
      sample.lift = v;
      sample.line_class = LineClass::intersection;
      sample.object = hits[at].object;
      project_sample(state.camera, sample);
      curve.samples.push_back(sample);
      const auto go = std::find_if(next[at].begin(), next[at].end(), [&](size_t k) { return k != before && !taken[k]; });
      if (go == next[at].end()) {
        curve.closed = at != start && std::find(next[at].begin(), next[at].end(), start) != next[at].end() && curve.samples.size() > 2;
        break;
      }
      before = at;
      at = *go;
    }
    if (curve.samples.size() > 1) curves.push_back(std::move(curve));
  };
  for (size_t i = 0; i < hits.size(); ++i) {
    if (!taken[i] && next[i].size() != 2) walk(i);
  }
  for (size_t i = 0; i < hits.size(); ++i) {
    if (!taken[i]) walk(i);
  }
  return curves;
}

void add_mesh_layers(const std::shared_ptr<const MeshLayers>& layers, LineContribution& out) {
  parallel_for(size_t{0}, out.curves.size(), [&](size_t i) { layers->pierce(out.curves[i]); });
  if (layers->several_parts()) {
    for (SurfaceCurve& curve : layers->intersections()) out.curves.push_back(std::move(curve));
  }
  out.layers_before = [layers](const CurveSample& sample) { return layers->before(sample); };
}

}  // namespace limn
