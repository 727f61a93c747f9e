#include "raymarch/picture/shade.h"

#include <algorithm>
#include <cmath>

#include "raymarch/gbuffer/file_colors.h"
#include "raymarch/picture/occlusion.h"
#include "sdf/color.h"
#include "sdf/error.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr size_t kTogether = size_t{1} << 13;  // pixels that one thread takes at least

// The light stands behind the camera, to the left of it and above; camera axes.
const glm::vec3 kLight = glm::normalize(glm::vec3(-0.45f, 0.65f, 0.6f));
const glm::vec3 kShadow(0.30f, 0.29f, 0.40f);  // share of a colour that the darkest step keeps: slightly blue, as the sky would light it

/// Calls `color(i)` for the pixels that show something.
template <class Color>
Image<glm::vec4> colored(const GBuffer& gbuffer, const Color& color) {
  Image<glm::vec4> picture(gbuffer.width, gbuffer.height, glm::vec4(0.0f));
  parallel_parts(picture.size(), kTogether, [&](const IndexRange<size_t>& part) {
    for (size_t i = part.first; i < part.last; ++i)
      if (gbuffer.id.pixels[i] != 0) picture.pixels[i] = glm::vec4(color(i), 1.0f);
  });
  return picture;
}

/// Steps from shadow to light, and a light edge where the lit side turns away.
glm::vec3 cel(const glm::vec3& base, float light, float n_dot_v, const ShadingSettings& shading) {
  const auto steps = static_cast<float>(shading.steps);
  // Half lit in the middle, so that the terminator lies off the outline.
  const float step = std::clamp(std::floor((0.5f + 0.5f * light) * steps), 0.0f, steps - 1.0f) / (steps - 1.0f);
  const glm::vec3 tone = base * glm::mix(kShadow, glm::vec3(1.0f), step);
  const bool edge = step > 0.99f && n_dot_v < static_cast<float>(shading.rim_light);
  return edge ? glm::mix(tone, glm::vec3(1.0f), 0.6f) : tone;
}

/// A wide light from above and the camera's light, which falls off gently.
glm::vec3 soft(const glm::vec3& base, const glm::vec3& normal, float open) {
  const float sky = 0.5f + 0.5f * normal.y, wrapped = std::max(0.0f, (glm::dot(normal, kLight) + 0.3f) / 1.3f);
  return base * open * (0.22f + 0.28f * sky + 0.55f * wrapped);
}

/// As normal maps have it, in camera axes.
glm::vec3 normal_color(const glm::vec3& normal) {
  const glm::vec3 code = 0.5f * normal + 0.5f;
  return {linear_from_srgb(code.x), linear_from_srgb(code.y), linear_from_srgb(code.z)};
}

}  // namespace

const Registry<ShadingDescriptor>& shadings() {
  static const Registry<ShadingDescriptor> all(
      "shading", {{{"headlight", "a light at the eye: colour x (0.25 + 0.75 N.V)", ""}, Shading::headlight},
                  {{"flat", "the colour itself, without light", ""}, Shading::flat},
                  {{"cel", "steps from shadow to light, as in cartoons; the light comes from the upper left", ""}, Shading::cel},
                  {{"soft", "a wide sky light and a gentle light from the upper left", ""}, Shading::soft},
                  {{"normal", "the normal in the camera's axes, as normal maps hold it", ""}, Shading::normal},
                  {{"none", "nothing: ink alone; surfaces still hide what is behind them", ""}, Shading::none}});
  return all;
}

Image<glm::vec3> base_colors(const BorderInput& input) {
  const GBuffer& gbuffer = input.gbuffer;
  Image<glm::vec3> colors(gbuffer.width, gbuffer.height, glm::vec3(0.0f));
  for (size_t i = 0; i < colors.size(); ++i) {
    if (const std::int32_t id = gbuffer.id.pixels[i]; id != 0) colors.pixels[i] = input.model.colors[static_cast<size_t>(id - 1)];
  }
  find_file_colors(file_colors(input.model), gbuffer, input.camera, input.model.render_origin, colors);
  return colors;
}

GBufferLayers layers_read(const ShadingSettings& shading) {
  const bool turned = shading.shading == Shading::cel || shading.shading == Shading::soft || shading.shading == Shading::normal;
  return {.depth = shading.shading == Shading::soft && shading.occlusion > 0.0,
          .position = false,
          .normal = turned,
          .n_dot_v = true,
          .id = true,
          .material = false,
          .face = false,
          .status = false};
}

Image<glm::vec4> shade(const BorderInput& input, const ShadingSettings& shading) {
  const GBuffer& gbuffer = input.gbuffer;
  if (shading.shading == Shading::none) return Image<glm::vec4>(gbuffer.width, gbuffer.height, glm::vec4(0.0f));
  const glm::mat3 camera_from_world(glm::transpose(input.camera.world_from_camera));
  const auto normal = [&](size_t i) { return camera_from_world * gbuffer.normal.pixels[i]; };
  if (shading.shading == Shading::normal) return colored(gbuffer, [&](size_t i) { return normal_color(normal(i)); });

  const Image<glm::vec3> colors = shading.color ? Image<glm::vec3>(gbuffer.width, gbuffer.height, *shading.color) : base_colors(input);
  const auto base = [&](size_t i) { return colors.pixels[i]; };
  switch (shading.shading) {
    case Shading::flat:
      return colored(gbuffer, base);
    case Shading::cel:
      return colored(gbuffer, [&](size_t i) { return cel(base(i), glm::dot(normal(i), kLight), gbuffer.n_dot_v.pixels[i], shading); });
    case Shading::soft: {
      const auto strength = static_cast<float>(shading.occlusion);
      const Image<float> hidden = strength > 0.0f ? screen_occlusion(gbuffer, input.camera) : Image<float>();
      return colored(gbuffer,
                     [&](size_t i) { return soft(base(i), normal(i), strength > 0.0f ? 1.0f - strength * hidden.pixels[i] : 1.0f); });
    }
    default:
      return colored(gbuffer, [&](size_t i) { return glm::vec3(headlight(base(i), gbuffer.n_dot_v.pixels[i])); });
  }
}

}  // namespace limn
