#include "subdiv/polygon.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace limn {
namespace {

double cross2(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }
double turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) { return cross2(b - a, c - a); }

/// Corners in two dimensions; those of small polygons, which are most, need no memory of their own.
class FlatCorners {
 public:
  explicit FlatCorners(size_t count) : count_(count) {
    if (count > kFew) many_.resize(count);
  }
  glm::dvec2& operator[](size_t i) { return count_ > kFew ? many_[i] : few_[i]; }
  operator std::span<const glm::dvec2>() const { return {count_ > kFew ? many_.data() : few_.data(), count_}; }  // NOLINT

 private:
  static constexpr size_t kFew = 8;
  size_t count_;
  std::array<glm::dvec2, kFew> few_;
  std::vector<glm::dvec2> many_;
};

FlatCorners in_best_fit_plane(std::span<const glm::dvec3> corners) {
  const glm::dvec3 area = vector_area(corners);
  const double length = glm::length(area);
  const glm::dvec3 n = length > 0.0 ? area / length : glm::dvec3(0.0, 0.0, 1.0);
  const glm::dvec3 away = std::abs(n.x) < 0.6 ? glm::dvec3(1.0, 0.0, 0.0) : glm::dvec3(0.0, 1.0, 0.0);
  const glm::dvec3 u = glm::normalize(glm::cross(away, n));
  const glm::dvec3 v = glm::cross(n, u);
  FlatCorners flat(corners.size());
  for (size_t i = 0; i < corners.size(); ++i) flat[i] = {glm::dot(corners[i] - corners[0], u), glm::dot(corners[i] - corners[0], v)};
  return flat;
}

double extent_squared(std::span<const glm::dvec2> points) {
  glm::dvec2 lower = points[0], upper = points[0];
  for (const glm::dvec2& p : points) lower = glm::min(lower, p), upper = glm::max(upper, p);
  return glm::dot(upper - lower, upper - lower);
}

/// Every corner turns left, and once round in all (a pentagram turns left twice round).
bool strictly_convex(std::span<const glm::dvec2> p, double tolerance) {
  double total = 0.0;
  for (size_t i = 0; i < p.size(); ++i) {
    const glm::dvec2 a = p[(i + 1) % p.size()] - p[i], b = p[(i + 2) % p.size()] - p[(i + 1) % p.size()];
    if (cross2(a, b) <= tolerance) return false;
    // Four turns of less than half a circle each make one circle, never two.
    if (p.size() > 4) total += std::atan2(cross2(a, b), glm::dot(a, b));
  }
  return total < 3.0 * std::numbers::pi;
}

/// Points by square cells, about one in each, so that those near a triangle are found without a look at all.
class PointGrid {
 public:
  explicit PointGrid(std::span<const glm::dvec2> points) : lower_(points[0]) {
    glm::dvec2 upper = points[0];
    for (const glm::dvec2& p : points) lower_ = glm::min(lower_, p), upper = glm::max(upper, p);
    side_ = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(points.size()))));
    const glm::dvec2 size = upper - lower_;
    cells_per_unit_ = {size.x > 0.0 ? side_ / size.x : 0.0, size.y > 0.0 ? side_ / size.y : 0.0};
    start_.assign(static_cast<size_t>(side_) * static_cast<size_t>(side_) + 1, 0);
    for (const glm::dvec2& p : points) ++start_[index(cell(p)) + 1];
    for (size_t k = 1; k < start_.size(); ++k) start_[k] += start_[k - 1];
    std::vector<std::uint32_t> next(start_.begin(), start_.end() - 1);
    points_.resize(points.size());
    for (size_t i = 0; i < points.size(); ++i) points_[next[index(cell(points[i]))]++] = static_cast<std::uint32_t>(i);
  }

  /// Whether `test(i)` holds for any point in the cells that the box touches.
  template <class Test>
  bool any(const glm::dvec2& lower, const glm::dvec2& upper, const Test& test) const {
    const glm::ivec2 first = cell(lower), last = cell(upper);
    for (int y = first.y; y <= last.y; ++y)
      for (int x = first.x; x <= last.x; ++x)
        for (std::uint32_t k = start_[index({x, y})]; k < start_[index({x, y}) + 1]; ++k)
          if (test(size_t{points_[k]})) return true;
    return false;
  }

 private:
  glm::ivec2 cell(const glm::dvec2& p) const {
    const glm::dvec2 at = (p - lower_) * cells_per_unit_;
    return {std::clamp(static_cast<int>(at.x), 0, side_ - 1), std::clamp(static_cast<int>(at.y), 0, side_ - 1)};
  }
  size_t index(const glm::ivec2& c) const { return static_cast<size_t>(c.y) * static_cast<size_t>(side_) + static_cast<size_t>(c.x); }

  glm::dvec2 lower_, cells_per_unit_{0.0};
  int side_ = 1;
  std::vector<std::uint32_t> start_, points_;
};

/// A ring of corners that shrinks as ears are clipped.
class EarClipper {
 public:
  EarClipper(std::span<const glm::dvec2> points, double tolerance) : points_(points), tolerance_(tolerance) {
    const size_t n = points.size();
    next_.resize(n), previous_.resize(n), is_ear_.resize(n);
    constexpr size_t kMany = 64;
    if (n > kMany) grid_.emplace(points);
    for (size_t i = 0; i < n; ++i) next_[i] = (i + 1) % n, previous_[i] = (i + n - 1) % n;
  }

  void run(std::vector<std::array<std::int32_t, 3>>& triangles) {
    size_t left = points_.size(), at = 0;
    refresh_all(at, left);
    while (left > 3) {
      size_t ear = find(at, left);
      if (ear == kNone) {
        // Clipping may have freed a corner that is no neighbour; failing that the outline crosses itself and any corner will do.
        refresh_all(at, left);
        ear = find(at, left);
        if (ear == kNone) ear = at;
      }
      emit(ear, triangles);
      next_[previous_[ear]] = next_[ear];
      previous_[next_[ear]] = previous_[ear];
      at = next_[ear];
      next_[ear] = kNone;
      --left;
      is_ear_[previous_[ear]] = ear_at(previous_[ear]);
      is_ear_[at] = ear_at(at);
    }
    emit(at, triangles);
  }

 private:
  static constexpr size_t kNone = static_cast<size_t>(-1);

  void emit(size_t i, std::vector<std::array<std::int32_t, 3>>& triangles) const {
    triangles.push_back({static_cast<std::int32_t>(previous_[i]), static_cast<std::int32_t>(i), static_cast<std::int32_t>(next_[i])});
  }
  void refresh_all(size_t at, size_t left) {
    for (size_t k = 0; k < left; ++k, at = next_[at]) is_ear_[at] = ear_at(at);
  }
  size_t find(size_t at, size_t left) const {
    for (size_t k = 0; k < left; ++k, at = next_[at])
      if (is_ear_[at]) return at;
    return kNone;
  }
  bool ear_at(size_t i) const {
    const glm::dvec2 &a = points_[previous_[i]], &b = points_[i], &c = points_[next_[i]];
    if (turn(a, b, c) <= tolerance_) return false;
    const auto within = [&](size_t k) {
      const glm::dvec2& p = points_[k];
      if (next_[k] == kNone || p == a || p == b || p == c) return false;
      return turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
    };
    if (grid_) return !grid_->any(glm::min(a, glm::min(b, c)), glm::max(a, glm::max(b, c)), within);
    for (size_t k = next_[next_[i]]; k != previous_[i]; k = next_[k])
      if (within(k)) return false;
    return true;
  }

  std::span<const glm::dvec2> points_;
  double tolerance_;
  std::vector<size_t> next_, previous_;  ///< kNone after a corner that was clipped.
  std::vector<char> is_ear_;
  std::optional<PointGrid> grid_{};  ///< Of many corners.
};

}  // namespace

glm::dvec3 vector_area(std::span<const glm::dvec3> corners) {
  glm::dvec3 sum(0.0);
  for (size_t i = 2; i < corners.size(); ++i) sum += glm::cross(corners[i - 1] - corners[0], corners[i] - corners[0]);
  return 0.5 * sum;
}

std::span<const std::int32_t> face_corners(const Mesh& mesh, std::int32_t first, size_t face) {
  return std::span(mesh.corner_vertices).subspan(static_cast<size_t>(first), static_cast<size_t>(mesh.face_sizes[face]));
}

void gather_corners(const Mesh& mesh, std::span<const std::int32_t> vertices, std::vector<glm::dvec3>& out) {
  out.clear();
  for (const std::int32_t v : vertices) out.push_back(mesh.positions[static_cast<size_t>(v)]);
}

Mesh without_holes(const Mesh& mesh) {
  Mesh solid = mesh;
  solid.holes.clear();
  if (mesh.holes.empty()) return solid;
  for (auto* array : {&solid.face_sizes, &solid.corner_vertices, &solid.face_materials, &solid.face_groups, &solid.face_smoothing})
    array->clear();
  solid.corner_normals.clear();
  size_t hole = 0;
  std::int32_t first = 0;
  for (size_t f = 0; f < mesh.face_count(); first += mesh.face_sizes[f++]) {
    if (hole < mesh.holes.size() && static_cast<size_t>(mesh.holes[hole]) == f) {
      ++hole;
      continue;
    }
    const auto from = static_cast<std::ptrdiff_t>(first), to = from + mesh.face_sizes[f];
    const auto append = [&](auto& target, const auto& source) {
      if (!source.empty()) target.insert(target.end(), source.begin() + from, source.begin() + to);
    };
    append(solid.corner_vertices, mesh.corner_vertices);
    append(solid.corner_normals, mesh.corner_normals);
    solid.face_sizes.push_back(mesh.face_sizes[f]);
    if (!mesh.face_materials.empty()) solid.face_materials.push_back(mesh.face_materials[f]);
    if (!mesh.face_groups.empty()) solid.face_groups.push_back(mesh.face_groups[f]);
    if (!mesh.face_smoothing.empty()) solid.face_smoothing.push_back(mesh.face_smoothing[f]);
  }
  return solid;
}

bool zero_area(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 corners[3] = {a, b, c};
  return zero_area(corners);
}

bool zero_area(std::span<const glm::dvec3> corners) {
  double longest = 0.0;
  for (size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec3 edge = corners[(i + 1) % corners.size()] - corners[i];
    longest = std::max(longest, glm::dot(edge, edge));
  }
  return !(glm::length(vector_area(corners)) > 1e-14 * longest);
}

double corner_angle(std::span<const glm::dvec3> corners, size_t i, const glm::dvec3& normal) {
  const size_t n = corners.size();
  const glm::dvec3 a = corners[(i + 1) % n] - corners[i], b = corners[(i + n - 1) % n] - corners[i];
  const glm::dvec3 across = glm::cross(a, b);
  const double angle = std::atan2(glm::length(across), glm::dot(a, b));
  return glm::dot(across, normal) < 0.0 ? 2.0 * std::numbers::pi - angle : angle;
}

void triangulate_polygon(std::span<const glm::dvec3> corners, std::vector<std::array<std::int32_t, 3>>& triangles) {
  triangles.clear();
  if (corners.size() == 3) {
    triangles.push_back({0, 1, 2});
    return;
  }
  const FlatCorners flat = in_best_fit_plane(corners);
  const double tolerance = 1e-14 * extent_squared(flat);
  if (strictly_convex(flat, tolerance)) {
    for (std::int32_t i = 2; i < static_cast<std::int32_t>(corners.size()); ++i) triangles.push_back({0, i - 1, i});
  } else {
    EarClipper(flat, tolerance).run(triangles);
  }
}

}  // namespace limn
