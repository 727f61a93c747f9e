#include "raymarch/local/merge_flat.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "raymarch/local/edge_collapse.h"

namespace limn {
namespace {

/// How far a vertex may lie off a plane, or off the line through its neighbours, as a share of the distance to them.
constexpr double kOff = 1e-8;
/// The least height of a triangle over its longest side: rays and normals want no needles.
constexpr double kLeastHeight = 0.03;
/// Each pass halves the number of vertices within a flat part at most.
constexpr int kMostPasses = 16;

class Merger {
 public:
  explicit Merger(LocalTriangles& mesh) : mesh_(mesh) {
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) flat_.push_back(is_flat(mesh.triangles[t]));
  }

  void run() {
    std::vector<char> due(mesh_.vertex_count(), 1);
    for (int pass = 0; pass < kMostPasses; ++pass) {
      std::vector<char> again(due.size(), 0);
      bool any = false;
      for (std::uint32_t v = 0; v < due.size(); ++v) {
        if (!due[v]) continue;
        const VertexFan fan = mesh_.fan_of(v);
        const std::optional<std::uint32_t> target = target_of(v, fan);
        if (!target) continue;
        mesh_.collapse(v, *target, fan);
        for (const std::uint32_t u : fan.ring) again[u] = 1;
        any = true;
      }
      if (!any) break;
      due = std::move(again);
    }
    mesh_.compact();
  }

 private:
  const glm::dvec3& position(std::uint32_t v) const { return mesh_.position(v); }

  bool is_flat(const LocalTriangle& triangle) const {
    const glm::dvec3 area = mesh_.area_of(triangle.vertices);
    const double length = glm::length(area);
    if (!(length > 0.0)) return false;
    // A facet's own normal is as exact as its shape lets it be.
    for (const glm::dvec3& normal : triangle.normals)
      if (glm::distance(normal, triangle.normals[0]) > kSameVertexNormal || glm::dot(area, normal) < (1.0 - kSameVertexNormal) * length)
        return false;
    return true;
  }

  const glm::dvec3& normal_of(std::uint32_t t) const { return mesh_.triangle(t).normals[0]; }

  /// Whether all corners of the triangles around v lie in one another's planes, as far as normals say that these are one.
  bool in_planes(std::uint32_t v, const VertexFan& fan) const {
    for (const std::uint32_t t : fan.triangles) {
      const glm::dvec3 normal = glm::normalize(mesh_.area_of(mesh_.triangle(t).vertices));
      for (const std::uint32_t other : fan.triangles) {
        if (glm::distance(normal_of(t), normal_of(other)) > kSameVertexNormal) continue;
        for (const std::uint32_t u : mesh_.triangle(other).vertices) {
          const glm::dvec3 away = position(u) - position(v);
          if (std::abs(glm::dot(away, normal)) > kOff * glm::length(away)) return false;
        }
      }
    }
    return true;
  }

  /// The ends of the edges in the middle of a fan whose two triangles lie in different planes.
  std::vector<std::uint32_t> creases_of(const VertexFan& fan) const {
    std::vector<std::uint32_t> ends;
    for (const std::uint32_t u : fan.ring) {
      const glm::dvec3* first = nullptr;
      for (const std::uint32_t t : fan.triangles) {
        if (!mesh_.has_vertex(t, u)) continue;
        if (first == nullptr)
          first = &normal_of(t);
        else if (glm::distance(*first, normal_of(t)) > kSameVertexNormal)
          ends.push_back(u);
      }
    }
    return ends;
  }

  bool is_straight(std::uint32_t v, const std::vector<std::uint32_t>& ends) const {
    const glm::dvec3 a = position(ends[0]) - position(v), b = position(ends[1]) - position(v);
    return glm::dot(a, b) < 0.0 && glm::length(glm::cross(a, b)) <= kOff * glm::length(a) * glm::length(b) * 10.0;
  }

  /// The neighbours that lie on a straight line through v along which the normal stays the same, as on a cylinder; v has one normal.
  std::vector<std::uint32_t> ruling_of(std::uint32_t v, const VertexFan& fan) const {
    const glm::dvec3& normal = mesh_.triangle(fan.triangles[0]).normals[mesh_.corner_of(fan.triangles[0], v)];
    for (const std::uint32_t t : fan.triangles)
      if (glm::distance(mesh_.triangle(t).normals[mesh_.corner_of(t, v)], normal) > kSameVertexNormal) return {};
    std::vector<std::uint32_t> same;
    for (const std::uint32_t u : fan.ring) {
      const bool turns = std::any_of(fan.triangles.begin(), fan.triangles.end(), [&](std::uint32_t t) {
        return mesh_.has_vertex(t, u) && glm::distance(mesh_.triangle(t).normals[mesh_.corner_of(t, u)], normal) > kSameVertexNormal;
      });
      if (!turns) same.push_back(u);
    }
    for (size_t i = 1; i < same.size(); ++i)
      for (size_t k = 0; k < i; ++k)
        if (is_straight(v, {same[i], same[k]})) return {same[k], same[i]};
    return {};
  }

  bool is_plane(std::uint32_t v, const VertexFan& fan) const {
    return std::all_of(fan.triangles.begin(), fan.triangles.end(), [this](std::uint32_t t) { return flat_[t]; }) && in_planes(v, fan);
  }

  /// Where a vertex may go so that the surface stays the same; none where it has to stay.
  std::vector<std::uint32_t> places_for(std::uint32_t v, const VertexFan& fan) const {
    if (fan.triangles.size() < 3 || !fan.closed) return {};
    if (!is_plane(v, fan)) return ruling_of(v, fan);
    const std::vector<std::uint32_t> creases = creases_of(fan);
    if (creases.empty()) return fan.ring;
    return creases.size() == 2 && is_straight(v, creases) ? creases : std::vector<std::uint32_t>{};
  }

  /// Of those places the one that leaves the widest triangles.
  std::optional<std::uint32_t> target_of(std::uint32_t v, const VertexFan& fan) const {
    std::optional<std::uint32_t> best;
    double widest = kLeastHeight;
    for (const std::uint32_t u : places_for(v, fan)) {
      const double height = least_height(v, u, fan, widest);
      if (height > widest && mesh_.is_linked(v, u, fan)) best = u, widest = height;
    }
    return best;
  }

  /// Of the triangles that are left when v goes to u: the least height over the longest side; 0 where one fits its normals less well than
  /// some triangle does now.
  double least_height(std::uint32_t v, std::uint32_t u, const VertexFan& fan, double enough) const {
    double fit = 1.0;
    for (const std::uint32_t t : fan.triangles) fit = std::min(fit, mesh_.fit_of(mesh_.triangle(t).vertices, mesh_.triangle(t).normals));
    double least = std::numeric_limits<double>::infinity();
    for (const std::uint32_t t : fan.triangles) {
      if (mesh_.has_vertex(t, u)) continue;
      std::array<std::uint32_t, 3> corners = mesh_.triangle(t).vertices;
      corners[mesh_.corner_of(t, v)] = u;
      if (mesh_.fit_of(corners, mesh_.triangle(t).normals) < fit - kSameVertexNormal) return 0.0;
      least = std::min(least, mesh_.height_of(corners));
      if (!(least > enough)) return least;
    }
    return least;
  }

  CollapsingMesh mesh_;
  std::vector<char> flat_{};  ///< Of triangles.
};

}  // namespace

LocalTriangles merge_flat(LocalTriangles mesh) {
  if (mesh.colors.empty()) Merger(mesh).run();
  return mesh;
}

}  // namespace limn
