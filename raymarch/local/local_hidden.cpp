#include "raymarch/local/local_hidden.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "sdf/parallel.h"

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

/// Of two pictures, one of which may not be begun.
HiddenParts nearer(HiddenParts a, const HiddenParts& b) {
  if (a.depth.empty()) return b;
  for (size_t i = 0; i < b.depth.size(); ++i) a.depth[i] = std::min(a.depth[i], b.depth[i]);
  return a;
}

/// Triangles whose vertices are at `pixels`: `vertices_of(i, k)` is the k-th vertex of the i-th. Parts of them are drawn side by side: the
/// nearest depth of all is the same in any order.
template <class VerticesOf>
HiddenParts draw(std::span<const glm::dvec3> pixels, size_t count, const VerticesOf& vertices_of, const Camera& camera) {
  const size_t size = static_cast<size_t>(camera.width_px) * static_cast<size_t>(camera.height_px);
  const auto draw_part = [&](const IndexRange<size_t>& part, HiddenParts parts) {
    if (parts.depth.empty()) parts = {camera.width_px, camera.height_px, std::vector(size, std::numeric_limits<float>::infinity())};
    Raster raster{parts, camera.projection == Projection::perspective};
    for (size_t i = part.first; i < part.last; ++i) {
      const std::array points{pixels[vertices_of(i, 0)], pixels[vertices_of(i, 1)], pixels[vertices_of(i, 2)]};
      if (!raster.pinhole || (points[0].z > 0.0 && points[1].z > 0.0 && points[2].z > 0.0)) raster.draw(points);
    }
    return parts;
  };
  // To clear another picture takes as long as to draw as many triangles as it has pixels.
  return parallel_reduce(count, std::max(size, size_t{1}), HiddenParts{}, draw_part, nearer);
}

std::vector<glm::dvec3> projected(std::span<const glm::dvec3> positions, const Camera& camera) {
  std::vector<glm::dvec3> pixels(positions.size());
  parallel_parts(positions.size(), size_t{1} << 14, [&](const IndexRange<size_t>& part) {
    for (size_t i = part.begin(); i < part.end(); ++i) pixels[i] = project(camera, positions[i]);
  });
  return pixels;
}

}  // namespace

HiddenParts hidden_parts(const LocalTriangles& mesh, const Camera& camera) {
  const auto vertices_of = [&](size_t i, size_t k) { return mesh.triangles[i].vertices[k]; };
  return draw(projected(mesh.positions, camera), mesh.triangles.size(), vertices_of, camera);
}

HiddenParts hidden_parts(const TriangleMesh& mesh, const Camera& camera) {
  const auto vertices_of = [&](size_t i, size_t k) { return mesh.triangles[i][static_cast<glm::length_t>(k)]; };
  return draw(projected(mesh.positions, camera), mesh.triangles.size(), vertices_of, camera);
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
