#include "raymarch/picture/occlusion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "raymarch/gbuffer/picture_rows.h"

namespace limn {
namespace {

constexpr int kTaps = 16;
constexpr float kReach = 0.09f;     // of the picture's shorter side
constexpr float kLeastSine = 0.1f;  // of a neighbour above the tangent plane: below it curvature alone would darken
constexpr double kGoldenAngle = 2.399963229728653;

/// Camera axes from pixel and depth: z grows away from the eye.
struct Unprojection {
  float x0, y0, per_pixel;  // half the picture; slope of a pixel, or its length for parallel rays
  bool parallel;

  glm::vec3 operator()(float x, float y, float z) const {
    const float scale = parallel ? per_pixel : per_pixel * z;
    return {(x - x0) * scale, (y0 - y) * scale, z};
  }
};

/// Interleaved gradient noise (Jimenez 2014), turned with the sample so that samples average it.
float angle_at(int x, int y, const glm::dvec2& sample) {
  const float value =
      0.06711056f * static_cast<float>(x) + 0.00583715f * static_cast<float>(y) + static_cast<float>(sample.x + 3.0 * sample.y);
  const float noise = 52.9829189f * (value - std::floor(value));
  return 2.0f * std::numbers::pi_v<float> * (noise - std::floor(noise));
}

std::array<glm::vec2, kTaps> spiral(float reach_px) {
  std::array<glm::vec2, kTaps> taps;
  for (int i = 0; i < kTaps; ++i) {
    const float radius = reach_px * std::sqrt((static_cast<float>(i) + 0.5f) / kTaps);
    const auto angle = static_cast<float>(kGoldenAngle * i);
    taps[static_cast<size_t>(i)] = radius * glm::vec2(std::cos(angle), std::sin(angle));
  }
  return taps;
}

}  // namespace

Image<float> screen_occlusion(const GBuffer& gbuffer, const Camera& camera) {
  Image<float> result(gbuffer.width, gbuffer.height, 0.0f);
  const float reach_px = kReach * static_cast<float>(std::min(gbuffer.width, gbuffer.height));
  const std::array<glm::vec2, kTaps> taps = spiral(reach_px);
  const bool parallel = camera.projection == Projection::orthographic;
  const Unprojection point{0.5f * static_cast<float>(gbuffer.width), 0.5f * static_cast<float>(gbuffer.height),
                           static_cast<float>(1.0 / (parallel ? camera.pixels_per_unit : camera.focal_px)), parallel};
  const glm::mat3 camera_from_world(glm::transpose(camera.world_from_camera));
  const auto at = [&](int x, int y) { return point(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, gbuffer.depth.at(x, y)); };
  const auto occlusion_at = [&](int x, int y) {
    const glm::vec3 here = at(x, y);
    glm::vec3 normal = camera_from_world * gbuffer.normal.at(x, y);
    normal.z = -normal.z;
    const float reach = reach_px * (parallel ? point.per_pixel : point.per_pixel * here.z);
    const float angle = angle_at(x, y, gbuffer.sample), c = std::cos(angle), s = std::sin(angle);
    float sum = 0.0f;
    for (const glm::vec2& tap : taps) {
      const int u = x + static_cast<int>(std::lround(c * tap.x - s * tap.y)), v = y + static_cast<int>(std::lround(s * tap.x + c * tap.y));
      if (u < 0 || v < 0 || u >= gbuffer.width || v >= gbuffer.height || gbuffer.id.at(u, v) == 0) continue;
      const glm::vec3 way = at(u, v) - here;
      const float distance = glm::length(way);
      if (!(distance > 0.0f)) continue;
      const float sine = (glm::dot(way, normal) / distance - kLeastSine) / (1.0f - kLeastSine);
      // What stands far in front encloses nothing.
      sum += std::max(sine, 0.0f) * std::clamp(2.0f - distance / reach, 0.0f, 1.0f);
    }
    return std::min(1.0f, 2.5f * sum / kTaps);
  };
  for_each_band(gbuffer.height, [&](int y0, int y1) {
    for (int y = y0; y < y1; ++y)
      for (int x = 0; x < gbuffer.width; ++x)
        if (gbuffer.id.at(x, y) != 0) result.at(x, y) = occlusion_at(x, y);
  });
  return result;
}

}  // namespace limn
