// The blurred silhouette, laid around the object.

#include "raymarch/border/blur_passes.h"
#include "raymarch/border/picture_rows.h"
#include "raymarch/border/registry.h"

namespace limn {
namespace {

struct BlurSettings {
  BlurKernel kernel;
  int radius_px, scale;
  bool hard, over;
  float level, strength;
};

BlurSettings read_settings(const Parameters& parameters) {
  return {parameters.choice("kernel") == "box" ? BlurKernel::box : BlurKernel::gaussian,
          parameters.integer("radius"),
          parameters.integer("scale"),
          parameters.choice("edge") == "hard",
          parameters.choice("place") == "over",
          static_cast<float>(parameters.number("level")),
          static_cast<float>(parameters.number("strength"))};
}

Image<float> blurred(const Image<float>& plane, const BlurSettings& settings) {
  if (settings.scale == 1) return blur_separable(plane, settings.kernel, settings.radius_px);
  const int radius = std::max(1, (settings.radius_px + settings.scale / 2) / settings.scale);
  return enlarged(blur_separable(reduced(plane, settings.scale), settings.kernel, radius), settings.scale, plane.width, plane.height);
}

/// Calls `value(id)` for every pixel's object.
template <class Value>
Image<float> plane_of(const GBuffer& seen, const Value& value) {
  Image<float> plane(seen.width, seen.height);
  for_each_band(seen.height, [&](int y0, int y1) {
    for (size_t i = plane.index(0, y0); i < plane.index(0, y1); ++i) plane.pixels[i] = value(seen.id.pixels[i]);
  });
  return plane;
}

/// Of the blurred silhouette: on a straight edge it is 1/2, so that a glow starts there at 1. Over the object it fades inwards alike.
float ink_of(const BlurSettings& settings, float blurred_silhouette, bool inside) {
  if (inside && !settings.over) return 0.0f;
  const float amount = settings.over ? std::min(blurred_silhouette, 1.0f - blurred_silhouette) : blurred_silhouette;
  if (settings.hard) return amount > settings.level ? 1.0f : 0.0f;
  return std::min(1.0f, std::max(0.0f, 2.0f * settings.strength * amount));
}

/// The silhouette buffer in the objects' colours, blurred and divided by its coverage.
Image<glm::vec3> object_colors(const BorderInput& input, const BlurSettings& settings, const Image<float>& silhouette) {
  const GBuffer& seen = input.gbuffer;
  Image<glm::vec3> colors(seen.width, seen.height, glm::vec3(0.0f));
  for (int channel = 0; channel < 3; ++channel) {
    const Image<float> plane =
        blurred(plane_of(seen, [&](std::int32_t id) { return id == 0 ? 0.0f : input.model.colors[static_cast<size_t>(id - 1)][channel]; }),
                settings);
    for_each_band(seen.height, [&](int y0, int y1) {
      for (size_t i = plane.index(0, y0); i < plane.index(0, y1); ++i) {
        if (silhouette.pixels[i] > 1e-6f) colors.pixels[i][channel] = std::min(1.0f, plane.pixels[i] / silhouette.pixels[i]);
      }
    });
  }
  return colors;
}

Border draw(const BorderInput& input, const Parameters& parameters) {
  const GBuffer& seen = input.gbuffer;
  const BlurSettings settings = read_settings(parameters);
  const Image<float> silhouette = blurred(plane_of(seen, [](std::int32_t id) { return id != 0 ? 1.0f : 0.0f; }), settings);
  Border border;
  border.color = glm::vec3(parameters.vector3("color"));
  border.coverage = {seen.width, seen.height, 0.0f};
  for_each_band(seen.height, [&](int y0, int y1) {
    for (size_t i = silhouette.index(0, y0); i < silhouette.index(0, y1); ++i) {
      border.coverage.pixels[i] = ink_of(settings, silhouette.pixels[i], seen.id.pixels[i] != 0);
    }
  });
  if (parameters.choice("colors") == "objects") border.colors = object_colors(input, settings, silhouette);
  return border;
}

}  // namespace

BorderMethod blur_method() {
  constexpr auto number = ParameterKind::number, integer = ParameterKind::integer, choice = ParameterKind::choice;
  return {{"blur", "the silhouette blurred in two passes and laid around the object, as a glow or a hard line",
           "separable filters: Szeliski 2010, section 3.2"},
          {"id"},
          {{"kernel", choice, "", {0.0}, 0.0, 1.0, "kind of blur", {"gaussian", "box"}},
           {"radius", integer, "px", {8.0}, 1.0, 256.0, "half the kernel's size; a Gaussian's standard deviation is a third of it", {}},
           {"scale", integer, "", {1.0}, 1.0, 8.0, "blurs a buffer this many times smaller: quicker, coarser", {}},
           {"edge", choice, "", {0.0}, 0.0, 1.0, "fading out, or cut at the level", {"glow", "hard"}},
           {"level", number, "", {0.05}, 0.0, 0.5, "hard: ink where the blurred silhouette exceeds this", {}},
           {"strength", number, "", {1.0}, 0.0, 16.0, "glow: factor of the ink, which ends at 1", {}},
           {"place", choice, "", {0.0}, 0.0, 1.0, "outside the object only, or on both sides of the silhouette", {"outside", "over"}},
           {"colors", choice, "", {0.0}, 0.0, 1.0, "one ink, or the objects' own colours", {"one", "objects"}},
           {"color", ParameterKind::color, "", {0.0, 0.0, 0.0}, 0.0, 1.0, "ink, linear RGB", {}}},
          [](const SceneModel&, const Scene&) { return std::string(); },
          draw};
}

}  // namespace limn
