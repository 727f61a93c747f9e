#include "cover.h"

#include <algorithm>
#include <cmath>

namespace limn::foreign {
namespace {

/// Winding number of the polygon about a point, by signed crossings of the ray towards +x.
int winding(const std::vector<glm::dvec2>& polygon, const glm::dvec2& point) {
  int sum = 0;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec2 a = polygon[i], b = polygon[(i + 1) % polygon.size()];
    const double side = (b.x - a.x) * (point.y - a.y) - (point.x - a.x) * (b.y - a.y);
    if (a.y <= point.y && b.y > point.y && side > 0.0) ++sum;
    if (a.y > point.y && b.y <= point.y && side < 0.0) --sum;
  }
  return sum;
}

void fill(const std::vector<glm::dvec2>& polygon, Image<std::uint8_t>& covered) {
  glm::dvec2 low = polygon.front(), high = polygon.front();
  for (const glm::dvec2& p : polygon) low = glm::min(low, p), high = glm::max(high, p);
  const int x0 = std::max(0, static_cast<int>(std::ceil(low.x - 0.5))), x1 = std::min(covered.width - 1, static_cast<int>(high.x - 0.5));
  const int y0 = std::max(0, static_cast<int>(std::ceil(low.y - 0.5))), y1 = std::min(covered.height - 1, static_cast<int>(high.y - 0.5));
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x)
      if (covered.at(x, y) == 0 && winding(polygon, {x + 0.5, y + 0.5}) != 0) covered.at(x, y) = 1;
}

}  // namespace

Image<std::uint8_t> covered_pixels(const Soup& soup, const Camera& camera) {
  Image<std::uint8_t> covered(camera.width_px, camera.height_px, 0);
  std::vector<glm::dvec2> polygon;
  for (const std::vector<size_t>& face : soup.faces) {
    polygon.clear();
    for (const size_t vertex : face) {
      const glm::dvec3 p = project(camera, soup.positions[vertex]);
      if (p.z > 0.0 && std::isfinite(p.x) && std::isfinite(p.y))
        polygon.emplace_back(std::clamp(p.x, -1e6, 1e6), std::clamp(p.y, -1e6, 1e6));
    }
    if (polygon.size() == face.size() && polygon.size() >= 3) fill(polygon, covered);
  }
  return covered;
}

std::int64_t pixels_apart(const Image<std::uint8_t>& covered, const GBuffer& gbuffer, int reach_px) {
  const auto same_around = [&](int x, int y) {
    for (int dy = -reach_px; dy <= reach_px; ++dy)
      for (int dx = -reach_px; dx <= reach_px; ++dx) {
        const int nx = std::clamp(x + dx, 0, covered.width - 1), ny = std::clamp(y + dy, 0, covered.height - 1);
        if (covered.at(nx, ny) != covered.at(x, y)) return false;
      }
    return true;
  };
  std::int64_t apart = 0;
  for (int y = 0; y < covered.height; ++y)
    for (int x = 0; x < covered.width; ++x) {
      const bool hit = gbuffer.status.at(x, y) == static_cast<std::uint8_t>(HitStatus::hit);
      if (hit != (covered.at(x, y) != 0) && same_around(x, y)) ++apart;
    }
  return apart;
}

}  // namespace limn::foreign
