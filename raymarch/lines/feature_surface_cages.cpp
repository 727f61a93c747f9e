// Limit surfaces of cages as feature surfaces: triangles of each patch's lattice, curvature from the patch's own derivatives.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "raymarch/lines/feature_mesh.h"
#include "raymarch/lines/feature_surface.h"
#include "raymarch/lines/line_memory.h"
#include "raymarch/lines/placed_cage.h"
#include "raymarch/truth/limit_grid.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr double kStep = 1e-3;     // of a patch's side, for differences of second derivatives
constexpr double kInwards = 1e-4;  // of a patch, where it degenerates
constexpr auto kNone = std::numeric_limits<std::uint32_t>::max();

struct CageTriangle {
  std::uint32_t patch = 0;
  std::array<glm::dvec2, 3> uv{};
};

/// du, dv with the dual basis of the tangent plane: a vector's parts along du and dv are its products with it.
struct PatchFrame {
  LimitPoint point{};
  glm::dvec3 normal{0.0}, dual_u{0.0}, dual_v{0.0};
  bool valid = false;
};

class CagePatches {
 public:
  /// With `of_mesh`, whose triangles are the cage's faces, curvature is that mesh's and not the patches' own.
  CagePatches(PlacedCage cage, std::shared_ptr<const SmoothCurvature> of_mesh)
      : cage_(std::move(cage)), placed_(place(*cage_.surface, cage_.solver_from_cage)), of_mesh_(std::move(of_mesh)) {}
  CagePatches(const CagePatches&) = delete;
  CagePatches& operator=(const CagePatches&) = delete;

  const PlacedLimitSurface& placed() const { return placed_; }
  void take(std::vector<CageTriangle> triangles) { triangles_ = std::move(triangles); }

  FeaturePoint point_at(std::uint32_t patch, const glm::dvec2& place) const {
    FeaturePoint result;
    result.sheet = patch;
    result.uv = within(patch, place);
    PatchFrame frame = frame_at(patch, result.uv);
    result.p = frame.point.position;
    if (!frame.valid) {
      const bool triangle = placed_.patches[patch].triangle;
      frame = frame_at(patch, glm::mix(result.uv, glm::dvec2(triangle ? 1.0 / 3.0 : 0.5), kInwards));
    }
    if (!frame.valid) return result;
    result.normal = frame.normal;
    if (of_mesh_) {
      result.shape = tangential(of_mesh(result).shape, result.normal);
      result.valid = true;
      return result;
    }
    const auto bend = [&](const glm::dvec3& second) { return -glm::dot(frame.normal, second); };
    const glm::dvec3 &u = frame.dual_u, &v = frame.dual_v;
    result.shape = bend(frame.point.duu) * glm::outerProduct(u, u) + bend(frame.point.dvv) * glm::outerProduct(v, v) +
                   bend(frame.point.duv) * (glm::outerProduct(u, v) + glm::outerProduct(v, u));
    const double trace = result.shape[0][0] + result.shape[1][1] + result.shape[2][2];
    result.valid = std::isfinite(trace) && std::isfinite(result.p.x + result.p.y + result.p.z);
    return result;
  }

  FeaturePoint at(const FeaturePlace& place) const {
    const CageTriangle& triangle = triangles_[place.triangle];
    glm::dvec2 uv(0.0);
    for (size_t i = 0; i < 3; ++i) uv += place.weights[static_cast<int>(i)] * triangle.uv[i];
    return point_at(triangle.patch, uv);
  }

  /// Along the straight line of the patch's domain: II(c', c') = -n.c'' derived once more, less what is due to the line's own turning.
  double change(const FeaturePoint& point, const glm::dvec3& tangent) const {
    if (of_mesh_) return change_along(of_mesh(point), tangent);
    const PatchFrame frame = frame_at(point.sheet, point.uv);
    if (!frame.valid) return 0.0;
    const double a = glm::dot(tangent, frame.dual_u), b = glm::dot(tangent, frame.dual_v);
    const LimitPoint along_u = third(point, glm::dvec2(1.0, 0.0)), along_v = third(point, glm::dvec2(0.0, 1.0));
    const glm::dvec3 second = a * a * frame.point.duu + 2.0 * a * b * frame.point.duv + b * b * frame.point.dvv;
    const glm::dvec3 third_along =
        a * a * a * along_u.duu + 3.0 * a * a * b * along_u.duv + 3.0 * a * b * b * along_u.dvv + b * b * b * along_v.dvv;
    return -glm::dot(point.normal, third_along) - 3.0 * glm::dot(point.shape * tangent, second);
  }

  FeaturePoint beside(const FeaturePoint& point, const glm::dvec3& step) const {
    const PatchFrame frame = frame_at(point.sheet, point.uv);
    return point_at(point.sheet, point.uv + glm::dvec2(glm::dot(step, frame.dual_u), glm::dot(step, frame.dual_v)));
  }

 private:
  VertexCurvature of_mesh(const FeaturePoint& point) const {
    return curvature_between(*of_mesh_, static_cast<size_t>(placed_.patches[point.sheet].face),
                             {1.0 - point.uv.x - point.uv.y, point.uv.x, point.uv.y});
  }
  glm::dvec2 within(std::uint32_t patch, const glm::dvec2& uv) const {
    const glm::dvec2 p = glm::clamp(uv, glm::dvec2(0.0), glm::dvec2(1.0));
    const double excess = p.x + p.y - 1.0;
    return placed_.patches[patch].triangle && excess > 0.0 ? glm::max(p - 0.5 * excess, glm::dvec2(0.0)) : p;
  }
  bool inside(std::uint32_t patch, const glm::dvec2& uv) const {
    return uv.x >= 0.0 && uv.y >= 0.0 && (placed_.patches[patch].triangle ? uv.x + uv.y <= 1.0 : uv.x <= 1.0 && uv.y <= 1.0);
  }

  PatchFrame frame_at(std::uint32_t index, const glm::dvec2& uv) const {
    const LimitPatch& patch = placed_.patches[index];
    PatchFrame frame;
    LimitPoint p;
    if (!placed_.surface.evaluate(patch.face, patch.sub_face, uv.x, uv.y, p)) return frame;
    const Affine& map = placed_.world_from_cage;
    frame.point = {map.point(p.position), map.vector(p.du), map.vector(p.dv), map.vector(p.duu), map.vector(p.duv), map.vector(p.dvv)};
    const glm::dvec3 cross = glm::cross(frame.point.du, frame.point.dv);
    const double squared = glm::dot(cross, cross),
                 sizes = glm::dot(frame.point.du, frame.point.du) + glm::dot(frame.point.dv, frame.point.dv);
    if (!(std::sqrt(squared) > 1e-9 * sizes)) return frame;
    frame.dual_u = glm::cross(frame.point.dv, cross) / squared;
    frame.dual_v = glm::cross(cross, frame.point.du) / squared;
    frame.normal = (glm::determinant(map.linear) < 0.0 ? -1.0 : 1.0) / std::sqrt(squared) * cross;
    frame.valid = true;
    return frame;
  }

  /// The second derivatives' own derivatives by u or v: a central difference, or three places on the side that is in the patch.
  LimitPoint third(const FeaturePoint& point, const glm::dvec2& axis) const {
    const auto at = [&](double step) { return frame_at(point.sheet, point.uv + step * axis).point; };
    const auto sum = [](double x, const LimitPoint& a, double y, const LimitPoint& b, double z, const LimitPoint& c) {
      LimitPoint out;
      out.duu = x * a.duu + y * b.duu + z * c.duu;
      out.duv = x * a.duv + y * b.duv + z * c.duv;
      out.dvv = x * a.dvv + y * b.dvv + z * c.dvv;
      return out;
    };
    const bool after = inside(point.sheet, point.uv + kStep * axis), before = inside(point.sheet, point.uv - kStep * axis);
    if (after && before) return sum(0.5 / kStep, at(kStep), -0.5 / kStep, at(-kStep), 0.0, {});
    const double h = after ? kStep : -kStep;
    return sum(-1.5 / h, at(0.0), 2.0 / h, at(h), -0.5 / h, at(2.0 * h));
  }

  PlacedCage cage_;
  PlacedLimitSurface placed_;
  std::vector<CageTriangle> triangles_{};
  std::shared_ptr<const SmoothCurvature> of_mesh_;
};

/// Of an object that stands for a mesh; nothing of others. The limit surface of a mesh's cage goes through its vertices, and between them
/// its curvature is the scheme's more than the mesh's: it ripples around extraordinary vertices.
std::shared_ptr<const SmoothCurvature> curvature_of_mesh(const LineTask& task, size_t object) {
  const std::vector<glm::dvec3>* const through = task.kept.smoothed ? &task.kept.smoothed->through[object] : nullptr;
  if (through == nullptr || through->empty()) return nullptr;
  std::shared_ptr<const SmoothCurvature>& kept = task.kept.curvatures[object];
  if (kept) return kept;
  const Affine& world_from_object = task.scene.objects[object].world_from_object;
  Mesh mesh = std::get<MeshSource>(task.scene.objects[object].source).mesh;
  mesh.positions = *through;
  for (glm::dvec3& p : mesh.positions) p = world_from_object.point(p) - task.origin;
  SmoothCurvature made = smooth_curvature(mesh);
  // What is mirrored has its faces the other way round.
  if (glm::determinant(world_from_object.linear) < 0.0) {
    for (VertexCurvature& vertex : made.vertices)
      vertex = {-vertex.normal, -vertex.shape, {-vertex.change[0], -vertex.change[1], -vertex.change[2]}};
  }
  return kept = std::make_shared<const SmoothCurvature>(std::move(made));
}

}  // namespace

std::vector<FeatureSurface> cage_features(const LineTask& task, const std::vector<size_t>& objects, std::vector<std::string>& notes) {
  std::vector<FeatureSurface> surfaces;
  for (const size_t object : objects) {
    const std::shared_ptr<const SmoothCurvature> of_mesh = curvature_of_mesh(task, object);
    const auto patches = std::make_shared<CagePatches>(place_cage(task, object), of_mesh);
    double cell_px = 0.0;
    const LimitGrid grid = sample_grid(patches->placed(), task.camera, kFeatureEdge_px, kMostFeatureTriangles, cell_px);
    FeatureSurface surface;
    Box box;
    for (const glm::dvec3& p : grid.positions) box = include(box, p);
    surface.radius = box.radius();
    if (of_mesh) surface.step = of_mesh->mean_edge;
    // A node is a side of the grid: what shares its place and its normal.
    std::vector<std::pair<std::uint32_t, glm::dvec2>> place_of(grid.normals.size(), {kNone, {}});
    std::vector<CageTriangle> triangles;
    for_triangles(grid, 0, triangle_count(grid), [&](std::uint32_t, const LimitTriangle& triangle) {
      const auto& c = triangle.corners;
      const bool tip = std::any_of(c.begin(), c.end(), [](const LimitCorner& corner) { return corner.side != corner.side_back; });
      if (tip || !may_be_seen(task.camera, {grid.positions[c[0].node], grid.positions[c[1].node], grid.positions[c[2].node]})) return;
      triangles.push_back({triangle.patch, {c[0].uv(), c[1].uv(), c[2].uv()}});
      surface.triangles.push_back({c[0].side, c[1].side, c[2].side});
      for (const LimitCorner& corner : c) {
        if (place_of[corner.side].first == kNone) place_of[corner.side] = {triangle.patch, corner.uv()};
      }
    });
    surface.nodes.resize(place_of.size());
    parallel_for(size_t{0}, place_of.size(), [&](size_t i) {
      if (place_of[i].first != kNone) surface.nodes[i] = patches->point_at(place_of[i].first, place_of[i].second);
    });
    patches->take(std::move(triangles));
    surface.at = [patches](const FeaturePlace& place) { return patches->at(place); };
    surface.change = [patches](const FeaturePoint& point, const glm::dvec3& tangent) { return patches->change(point, tangent); };
    surface.beside = [patches](const FeaturePoint& point, const glm::dvec3& step) { return patches->beside(point, step); };
    surface.object = [object](const FeaturePoint&) { return static_cast<int>(object) + 1; };
    if (cell_px > 1.5 * kFeatureEdge_px) {
      notes.push_back(
          fmt::format("{}: suggestive contours, ridges and valleys are searched in triangles of {:.2g} px: smaller ones may be missing",
                      task.scene.objects[object].name, cell_px));
    }
    surfaces.push_back(std::move(surface));
  }
  return surfaces;
}

}  // namespace limn
