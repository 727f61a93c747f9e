#include "raymarch/local/merge_flat.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace limn {
namespace {

/// Normals are known to about a single-precision unit in the last place.
constexpr double kSameNormal = 1e-6;
/// How far a vertex may lie off a plane, or off the line through its neighbours, as a share of the distance to them.
constexpr double kOff = 1e-8;
/// The least height of a triangle over its longest side: rays and normals want no needles.
constexpr double kLeastHeight = 0.03;
/// Each pass halves the number of vertices within a flat part at most.
constexpr int kMostPasses = 16;

size_t next(size_t k) { return (k + 1) % 3; }

/// The triangles around a vertex, and what is known of them.
struct Fan {
  std::vector<std::uint32_t> triangles{};
  std::vector<std::uint32_t> ring{};  ///< Neighbours, in no order.
  bool closed = true;
};

class Merger {
 public:
  explicit Merger(LocalTriangles& mesh) : mesh_(mesh), at_(mesh.positions.size()), alive_(mesh.triangles.size(), 1) {
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
      for (const std::uint32_t v : mesh.triangles[t].vertices) at_[v].push_back(static_cast<std::uint32_t>(t));
      flat_.push_back(is_flat(mesh.triangles[t]));
    }
  }

  void run() {
    std::vector<char> due(mesh_.positions.size(), 1);
    for (int pass = 0; pass < kMostPasses; ++pass) {
      std::vector<char> again(due.size(), 0);
      bool any = false;
      for (std::uint32_t v = 0; v < due.size(); ++v) {
        if (!due[v]) continue;
        const Fan fan = fan_of(v);
        const std::optional<std::uint32_t> target = target_of(v, fan);
        if (!target) continue;
        collapse(v, *target, fan);
        for (const std::uint32_t u : fan.ring) again[u] = 1;
        any = true;
      }
      if (!any) break;
      due = std::move(again);
    }
    compact();
  }

 private:
  const glm::dvec3& position(std::uint32_t v) const { return mesh_.positions[v]; }

  glm::dvec3 area_of(const std::array<std::uint32_t, 3>& v) const {
    return glm::cross(position(v[1]) - position(v[0]), position(v[2]) - position(v[0]));
  }

  bool is_flat(const LocalTriangle& triangle) const {
    const glm::dvec3 area = area_of(triangle.vertices);
    const double length = glm::length(area);
    if (!(length > 0.0)) return false;
    // A facet's own normal is as exact as its shape lets it be.
    for (const glm::dvec3& normal : triangle.normals)
      if (glm::distance(normal, triangle.normals[0]) > kSameNormal || glm::dot(area, normal) < (1.0 - kSameNormal) * length) return false;
    return true;
  }

  Fan fan_of(std::uint32_t v) const {
    Fan fan;
    fan.triangles = at_[v];
    std::vector<std::uint32_t> ahead, behind;
    for (const std::uint32_t t : fan.triangles) {
      const auto& corners = mesh_.triangles[t].vertices;
      const size_t k = corner_of(t, v);
      ahead.push_back(corners[next(k)]), behind.push_back(corners[next(next(k))]);
    }
    std::sort(ahead.begin(), ahead.end()), std::sort(behind.begin(), behind.end());
    // An edge that has one triangle, or three, or two on the same side.
    fan.closed = ahead == behind && std::adjacent_find(ahead.begin(), ahead.end()) == ahead.end();
    fan.ring = std::move(ahead);
    return fan;
  }

  size_t corner_of(std::uint32_t t, std::uint32_t v) const {
    const auto& corners = mesh_.triangles[t].vertices;
    return corners[0] == v ? 0 : corners[1] == v ? 1 : 2;
  }

  const glm::dvec3& normal_of(std::uint32_t t) const { return mesh_.triangles[t].normals[0]; }

  /// Whether all corners of the triangles around v lie in one another's planes, as far as normals say that these are one.
  bool in_planes(std::uint32_t v, const Fan& fan) const {
    for (const std::uint32_t t : fan.triangles) {
      const glm::dvec3 normal = glm::normalize(area_of(mesh_.triangles[t].vertices));
      for (const std::uint32_t other : fan.triangles) {
        if (glm::distance(normal_of(t), normal_of(other)) > kSameNormal) continue;
        for (const std::uint32_t u : mesh_.triangles[other].vertices) {
          const glm::dvec3 away = position(u) - position(v);
          if (std::abs(glm::dot(away, normal)) > kOff * glm::length(away)) return false;
        }
      }
    }
    return true;
  }

  /// The ends of the edges in the middle of a fan whose two triangles lie in different planes.
  std::vector<std::uint32_t> creases_of(const Fan& fan) const {
    std::vector<std::uint32_t> ends;
    for (const std::uint32_t u : fan.ring) {
      const glm::dvec3* first = nullptr;
      for (const std::uint32_t t : fan.triangles) {
        const auto& corners = mesh_.triangles[t].vertices;
        if (std::find(corners.begin(), corners.end(), u) == corners.end()) continue;
        if (first == nullptr)
          first = &normal_of(t);
        else if (glm::distance(*first, normal_of(t)) > kSameNormal)
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
  std::vector<std::uint32_t> ruling_of(std::uint32_t v, const Fan& fan) const {
    const glm::dvec3& normal = mesh_.triangles[fan.triangles[0]].normals[corner_of(fan.triangles[0], v)];
    for (const std::uint32_t t : fan.triangles)
      if (glm::distance(mesh_.triangles[t].normals[corner_of(t, v)], normal) > kSameNormal) return {};
    std::vector<std::uint32_t> same;
    for (const std::uint32_t u : fan.ring) {
      const bool turns = std::any_of(fan.triangles.begin(), fan.triangles.end(), [&](std::uint32_t t) {
        const auto& corners = mesh_.triangles[t].vertices;
        const bool has = std::find(corners.begin(), corners.end(), u) != corners.end();
        return has && glm::distance(mesh_.triangles[t].normals[corner_of(t, u)], normal) > kSameNormal;
      });
      if (!turns) same.push_back(u);
    }
    for (size_t i = 1; i < same.size(); ++i)
      for (size_t k = 0; k < i; ++k)
        if (is_straight(v, {same[i], same[k]})) return {same[k], same[i]};
    return {};
  }

  bool is_plane(std::uint32_t v, const Fan& fan) const {
    return std::all_of(fan.triangles.begin(), fan.triangles.end(), [this](std::uint32_t t) { return flat_[t]; }) && in_planes(v, fan);
  }

  /// Where a vertex may go so that the surface stays the same; none where it has to stay.
  std::vector<std::uint32_t> places_for(std::uint32_t v, const Fan& fan) const {
    if (fan.triangles.size() < 3 || !fan.closed) return {};
    if (!is_plane(v, fan)) return ruling_of(v, fan);
    const std::vector<std::uint32_t> creases = creases_of(fan);
    if (creases.empty()) return fan.ring;
    return creases.size() == 2 && is_straight(v, creases) ? creases : std::vector<std::uint32_t>{};
  }

  /// Of those places the one that leaves the widest triangles.
  std::optional<std::uint32_t> target_of(std::uint32_t v, const Fan& fan) const {
    std::optional<std::uint32_t> best;
    double widest = kLeastHeight;
    for (const std::uint32_t u : places_for(v, fan)) {
      const double height = least_height(v, u, fan, widest);
      if (height > widest && is_linked(v, u, fan)) best = u, widest = height;
    }
    return best;
  }

  /// How well a facet fits the normals at its corners: the least cosine between them; -1 where it has no area.
  double fit_of(const std::array<std::uint32_t, 3>& corners, const LocalTriangle& triangle) const {
    const glm::dvec3 area = area_of(corners);
    const double length = glm::length(area);
    if (!(length > 0.0)) return -1.0;
    double least = 1.0;
    for (const glm::dvec3& normal : triangle.normals) least = std::min(least, glm::dot(area, normal) / length);
    return least;
  }

  /// Of the triangles that are left when v goes to u: the least height over the longest side; 0 where one fits its normals less well than
  /// some triangle does now.
  double least_height(std::uint32_t v, std::uint32_t u, const Fan& fan, double enough) const {
    double fit = 1.0;
    for (const std::uint32_t t : fan.triangles) fit = std::min(fit, fit_of(mesh_.triangles[t].vertices, mesh_.triangles[t]));
    double least = std::numeric_limits<double>::infinity();
    for (const std::uint32_t t : fan.triangles) {
      std::array<std::uint32_t, 3> corners = mesh_.triangles[t].vertices;
      if (std::find(corners.begin(), corners.end(), u) != corners.end()) continue;
      corners[corner_of(t, v)] = u;
      if (fit_of(corners, mesh_.triangles[t]) < fit - kSameNormal) return 0.0;
      double longest = 0.0;
      for (size_t k = 0; k < 3; ++k) longest = std::max(longest, glm::distance(position(corners[k]), position(corners[next(k)])));
      least = std::min(least, glm::length(area_of(corners)) / (longest * longest));
      if (!(least > enough)) return least;
    }
    return least;
  }

  /// The two ends share no neighbours but those of the two triangles at their edge: else the surface would meet itself.
  bool is_linked(std::uint32_t v, std::uint32_t u, const Fan& fan) const {
    const Fan other = fan_of(u);
    std::vector<std::uint32_t> ring = other.ring;
    if (!other.closed) {
      for (const std::uint32_t t : other.triangles)
        for (const std::uint32_t w : mesh_.triangles[t].vertices) ring.push_back(w);
      std::sort(ring.begin(), ring.end());
      ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
    }
    const auto shared = std::count_if(fan.ring.begin(), fan.ring.end(),
                                      [&](std::uint32_t w) { return w != u && std::binary_search(ring.begin(), ring.end(), w); });
    return shared == 2 && std::binary_search(fan.ring.begin(), fan.ring.end(), u) && v != u;
  }

  void collapse(std::uint32_t v, std::uint32_t u, const Fan& fan) {
    for (const std::uint32_t t : fan.triangles) {
      auto& corners = mesh_.triangles[t].vertices;
      if (std::find(corners.begin(), corners.end(), u) != corners.end()) {
        alive_[t] = 0;
        for (const std::uint32_t w : corners) std::erase(at_[w], t);
        continue;
      }
      corners[corner_of(t, v)] = u;
      at_[u].push_back(t);
    }
    at_[v].clear();
  }

  void compact() {
    std::vector<std::uint32_t> number(mesh_.positions.size(), 0);
    std::vector<glm::dvec3> kept;
    for (size_t v = 0; v < number.size(); ++v) {
      number[v] = static_cast<std::uint32_t>(kept.size());
      if (!at_[v].empty()) kept.push_back(mesh_.positions[v]);
    }
    std::vector<LocalTriangle> triangles;
    for (size_t t = 0; t < alive_.size(); ++t) {
      if (!alive_[t]) continue;
      triangles.push_back(mesh_.triangles[t]);
      for (std::uint32_t& v : triangles.back().vertices) v = number[v];
    }
    mesh_.positions = std::move(kept);
    mesh_.triangles = std::move(triangles);
  }

  LocalTriangles& mesh_;
  std::vector<std::vector<std::uint32_t>> at_;  ///< The triangles of each vertex.
  std::vector<char> alive_, flat_{};            ///< Of triangles.
};

}  // namespace

LocalTriangles merge_flat(LocalTriangles mesh) {
  if (mesh.colors.empty()) Merger(mesh).run();
  return mesh;
}

}  // namespace limn
