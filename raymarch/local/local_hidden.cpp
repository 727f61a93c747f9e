#include "raymarch/local/local_hidden.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace limn {
namespace {

/// Of a pinhole 1 / depth is linear in the picture, of an orthographic camera the depth itself.
struct Raster {
  HiddenParts& parts;
  bool pinhole;

  void draw(const std::array<glm::dvec3, 3>& p) {
    const double area = (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x);
    if (area == 0.0 || !std::isfinite(area)) return;
    const auto range = [](double low, double high, int size) {
      const int first = static_cast<int>(std::ceil(std::clamp(low - 0.5, 0.0, 1e6)));
      const int last = static_cast<int>(std::floor(std::clamp(high - 0.5, -1.0, 1e6)));
      return std::pair(first, std::min(last, size - 1));
    };
    const auto [left, right] = range(std::min({p[0].x, p[1].x, p[2].x}), std::max({p[0].x, p[1].x, p[2].x}), parts.width);
    const auto [top, bottom] = range(std::min({p[0].y, p[1].y, p[2].y}), std::max({p[0].y, p[1].y, p[2].y}), parts.height);
    for (int y = top; y <= bottom; ++y)
      for (int x = left; x <= right; ++x) set(p, area, x, y);
  }

  void set(const std::array<glm::dvec3, 3>& p, double area, int x, int y) {
    const glm::dvec2 at(x + 0.5, y + 0.5);
    std::array<double, 3> weights{};
    double sum = 0.0;
    for (size_t k = 0; k < 3; ++k) {
      const glm::dvec3 &a = p[(k + 1) % 3], &b = p[(k + 2) % 3];
      weights[k] = ((b.x - a.x) * (at.y - a.y) - (b.y - a.y) * (at.x - a.x)) / area;
      if (weights[k] < 0.0) return;
      sum += weights[k] * (pinhole ? 1.0 / p[k].z : p[k].z);
    }
    const auto depth = static_cast<float>(pinhole ? 1.0 / sum : sum);
    float& nearest = parts.depth[static_cast<size_t>(y) * static_cast<size_t>(parts.width) + static_cast<size_t>(x)];
    nearest = std::min(nearest, depth);
  }
};

}  // namespace

HiddenParts hidden_parts(const LocalTriangles& mesh, const Camera& camera) {
  HiddenParts parts{camera.width_px, camera.height_px, {}};
  parts.depth.assign(static_cast<size_t>(parts.width) * static_cast<size_t>(parts.height), std::numeric_limits<float>::infinity());
  Raster raster{parts, camera.projection == Projection::perspective};
  for (const LocalTriangle& triangle : mesh.triangles) {
    std::array<glm::dvec3, 3> points{};
    bool in_front = true;
    for (size_t k = 0; k < 3; ++k) {
      points[k] = project(camera, mesh.positions[triangle.vertices[k]]);
      in_front = in_front && (!raster.pinhole || points[k].z > 0.0);
    }
    if (in_front) raster.draw(points);
  }
  return parts;
}

bool is_hidden(const HiddenParts& parts, std::span<const glm::dvec3> points, double margin_px, double margin) {
  if (parts.depth.empty()) return false;
  glm::dvec2 low(points[0]), high(points[0]);
  double nearest = points[0].z;
  for (const glm::dvec3& p : points) {
    low = glm::min(low, glm::dvec2(p)), high = glm::max(high, glm::dvec2(p));
    nearest = std::min(nearest, p.z);
  }
  const auto pixel = [](double at, int size) { return static_cast<int>(std::floor(std::clamp(at, -1.0, static_cast<double>(size)))); };
  const int left = pixel(low.x - margin_px, parts.width), right = pixel(high.x + margin_px, parts.width);
  const int top = pixel(low.y - margin_px, parts.height), bottom = pixel(high.y + margin_px, parts.height);
  // What lies at the picture's edge may be seen beside it.
  if (left < 0 || top < 0 || right >= parts.width || bottom >= parts.height) return false;
  const auto before = static_cast<float>(nearest - margin);
  for (int y = top; y <= bottom; ++y)
    for (int x = left; x <= right; ++x)
      if (!(parts.depth[static_cast<size_t>(y) * static_cast<size_t>(parts.width) + static_cast<size_t>(x)] < before)) return false;
  return true;
}

}  // namespace limn
