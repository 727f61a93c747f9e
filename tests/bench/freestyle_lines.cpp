#include "tests/bench/freestyle_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "raymarch/lines.h"
#include "sdf/shape.h"

namespace limn::bench {
namespace {

constexpr double kWide = 2.4;  // of the picture, in radii

}  // namespace

std::optional<Silhouette> freestyle_silhouette(int faces, int size_px) {
  const std::string call = fmt::format("command -v blender >/dev/null && blender --background --python {} -- {} {} 2>/dev/null",
                                       LIMN_FREESTYLE_SCRIPT, faces, size_px);
  std::FILE* const out = popen(call.c_str(), "r");
  if (out == nullptr) return {};
  std::optional<Silhouette> found;
  std::array<char, 512> line{};
  while (std::fgets(line.data(), static_cast<int>(line.size()), out) != nullptr) {
    Silhouette silhouette;
    int made = 0;
    if (std::sscanf(line.data(), "freestyle %d %lf %lf %lf", &made, &silhouette.ms, &silhouette.worst_px, &silhouette.rms_px) == 4)
      found = silhouette;
  }
  pclose(out);
  return found;
}

Silhouette limn_silhouette(int size_px, int threads) {
  Scene scene;
  scene.objects.push_back({.name = "sphere", .source = make_shape("sphere", {{"radius", {1.0}}})});
  CameraSettings settings;
  settings.projection = Projection::orthographic;
  settings.eye = 4.0 * glm::normalize(glm::dvec3(0.45, 0.55, 0.7));
  settings.target = glm::dvec3(0.0);
  settings.ortho_height = kWide;
  settings.width_px = settings.height_px = size_px;
  const Camera camera = resolve_camera(settings, bounds(scene));
  ExecutionSettings execution;
  execution.threads = threads;
  const auto start = std::chrono::steady_clock::now();
  const ViewGraph graph = solve_lines(scene, camera, {}, execution);
  Silhouette silhouette;
  silhouette.ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  double squares = 0.0;
  int count = 0;
  for (const LineChain& chain : graph.chains) {
    std::vector<LinePoint> points = points_of(graph, chain);
    if (chain.closed) points.push_back(points.front());
    for (size_t i = 0; i + 1 < points.size(); ++i) {
      for (const double share : {0.0, 0.25, 0.5, 0.75, 1.0}) {
        const glm::dvec2 px = glm::mix(points[i].px, points[i + 1].px, share) - 0.5 * size_px;
        const double off = std::fabs(glm::length(px) - size_px / kWide);
        silhouette.worst_px = std::max(silhouette.worst_px, off);
        squares += off * off;
        ++count;
      }
    }
  }
  silhouette.rms_px = std::sqrt(squares / std::max(count, 1));
  return silhouette;
}

}  // namespace limn::bench
