#include "raymarch/picture/compose.h"

#include <algorithm>
#include <utility>

#include "raymarch/gbuffer/file_colors.h"
#include "raymarch/picture/pixel_lanes.h"
#include "raymarch/picture/shade.h"
#include "sdf/error.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr size_t kTogether = size_t{1} << 13;  // pixels that one thread takes at least

glm::vec4 lit(const glm::vec3& color, float n_dot_v) { return glm::vec4(color * (0.25f + 0.75f * n_dot_v), 1.0f); }

glm::vec4 headlight(const GBuffer& gbuffer, std::span<const glm::vec3> colors, size_t i) {
  const std::int32_t id = gbuffer.id.pixels[i];
  return id == 0 ? glm::vec4(0.0f) : lit(colors[static_cast<size_t>(id - 1)], gbuffer.n_dot_v.pixels[i]);
}

glm::vec4 under(const glm::vec4& below, const glm::vec3& ink, float share) { return (1.0f - share) * below + share * glm::vec4(ink, 1.0f); }

/// Objects go on beneath the ink along their edges. All is read before anything is written: the pixel beneath may have a neighbour of its
/// own.
void lay_beneath(const Border& border, Image<glm::vec4>& picture) {
  if (border.beneath.pixels.empty()) return;
  LIMN_CHECK(picture.size() == border.beneath.size());
  std::vector<std::pair<size_t, glm::vec4>> moved;
  for (size_t i = 0; i < picture.size(); ++i) {
    const std::int32_t from = border.beneath.pixels[i];
    if (from >= 0) moved.emplace_back(i, picture.pixels[static_cast<size_t>(from)]);
  }
  for (const auto& [i, color] : moved) picture.pixels[i] = color;
}

/// Of a pixel that is covered by `ink`, with another ink of that share on top.
float covered(float ink, float share) { return 1.0f - (1.0f - ink) * (1.0f - share); }

/// `color(i)` is pixel i of the finished picture, whose inks are these.
template <class Color>
void add_pixels(const Color& color, std::span<const Border> borders, bool first, const Finish* finish, Picture& picture) {
  parallel_parts(picture.composite.size(), kTogether, [&](const IndexRange<size_t>& part) {
    for (size_t i = part.first; i < part.last; ++i) {
      float ink = 0.0f;
      for (const Border& border : borders) ink = covered(ink, border.coverage.pixels[i]);
      glm::vec4 sum = color(i);
      if (!first) {
        sum = picture.composite.pixels[i] + sum;
        ink = picture.border.pixels[i] + ink;
      }
      if (finish != nullptr) finish_pixel(*finish, ink, sum);
      picture.composite.pixels[i] = sum;
      picture.border.pixels[i] = ink;
    }
  });
}

/// The same of the headlight's shading and inks of one colour each, several pixels at a time.
void compose_plain(const BorderInput& input, std::span<const Border> borders, bool first, const Finish* finish, Picture& picture) {
  const ColorsById colors = colors_by_id(input.model.colors);
  std::vector<glm::vec3> inks;
  inks.reserve(borders.size());
  for (const Border& border : borders) inks.push_back(border.color);
  const PixelStage stage{&colors, inks, first, finish};
  parallel_parts(picture.composite.size(), kTogether, [&](const IndexRange<size_t>& part) {
    std::vector<const float*> coverage;
    coverage.reserve(borders.size());
    for (const Border& border : borders) coverage.push_back(&border.coverage.pixels[part.first]);
    compose_pixels(stage, {part.last - part.first, &input.gbuffer.n_dot_v.pixels[part.first], &input.gbuffer.id.pixels[part.first],
                           coverage, &picture.border.pixels[part.first], &picture.composite.pixels[part.first]});
  });
}

glm::vec4 inked(glm::vec4 color, std::span<const Border> borders, size_t i) {
  for (const Border& border : borders)
    color = under(color, border.colors.pixels.empty() ? border.color : border.colors.pixels[i], border.coverage.pixels[i]);
  return color;
}

}  // namespace

Image<glm::vec4> shade_headlight(const GBuffer& gbuffer, const SceneModel& model) {
  auto picture = Image<glm::vec4>::unset(gbuffer.width, gbuffer.height);
  parallel_parts(picture.size(), kTogether, [&](const IndexRange<size_t>& part) {
    for (size_t i = part.first; i < part.last; ++i) picture.pixels[i] = headlight(gbuffer, model.colors, i);
  });
  return picture;
}

Image<glm::vec4> shade_headlight(const BorderInput& input) {
  const GBuffer& gbuffer = input.gbuffer;
  const FileColors found = file_colors(input.model);
  if (!found.any) return shade_headlight(gbuffer, input.model);
  Image<glm::vec3> colors(gbuffer.width, gbuffer.height, glm::vec3(0.0f));
  for (size_t i = 0; i < colors.size(); ++i) {
    if (const std::int32_t id = gbuffer.id.pixels[i]; id != 0) colors.pixels[i] = input.model.colors[static_cast<size_t>(id - 1)];
  }
  find_file_colors(found, gbuffer, input.camera, input.model.render_origin, colors);
  Image<glm::vec4> picture(gbuffer.width, gbuffer.height, glm::vec4(0.0f));
  for (size_t i = 0; i < picture.size(); ++i) {
    if (gbuffer.id.pixels[i] != 0) picture.pixels[i] = lit(colors.pixels[i], gbuffer.n_dot_v.pixels[i]);
  }
  return picture;
}

void lay_ink(Image<glm::vec4>& picture, const Image<float>& coverage, const glm::vec3& color) {
  LIMN_CHECK(picture.size() == coverage.size());
  for (size_t i = 0; i < picture.size(); ++i) picture.pixels[i] = under(picture.pixels[i], color, coverage.pixels[i]);
}

void lay_ink(Image<glm::vec4>& picture, const Border& border) {
  lay_beneath(border, picture);
  LIMN_CHECK(picture.size() == border.coverage.size());
  LIMN_CHECK(border.colors.pixels.empty() || picture.size() == border.colors.size());
  parallel_parts(picture.size(), kTogether, [&](const IndexRange<size_t>& part) {
    for (size_t i = part.first; i < part.last; ++i) picture.pixels[i] = inked(picture.pixels[i], {&border, 1}, i);
  });
}

Finish finish_of(const PictureSettings& settings) { return {1.0f / static_cast<float>(settings.samples), settings.background}; }

void compose(const BorderInput& input, std::span<const Border> borders, bool first, const ShadingSettings& shading, const Finish* finish,
             Picture& picture) {
  const GBuffer& gbuffer = input.gbuffer;
  if (first) {
    picture.composite = Image<glm::vec4>::unset(gbuffer.width, gbuffer.height);
    picture.border = Image<float>::unset(gbuffer.width, gbuffer.height);
  }
  for (const Border& border : borders) {
    LIMN_CHECK(border.coverage.size() == picture.border.size());
    LIMN_CHECK(border.colors.pixels.empty() || border.colors.size() == picture.border.size());
  }
  const bool moving = std::any_of(borders.begin(), borders.end(), [](const Border& border) { return !border.beneath.pixels.empty(); });
  const bool plain = shading.shading == Shading::headlight && !shading.color;
  const bool many = std::any_of(borders.begin(), borders.end(), [](const Border& border) { return !border.colors.pixels.empty(); });
  if (!moving && plain && !file_colors(input.model).any) {
    if (!many) return compose_plain(input, borders, first, finish, picture);
    add_pixels([&](size_t i) { return inked(headlight(gbuffer, input.model.colors, i), borders, i); }, borders, first, finish, picture);
    return;
  }
  // What moves is a neighbour under the inks before it: each ink is laid over the whole picture before the next.
  Image<glm::vec4> composite = plain ? shade_headlight(input) : shade(input, shading);
  for (const Border& border : borders) lay_ink(composite, border);
  add_pixels([&](size_t i) { return composite.pixels[i]; }, borders, first, finish, picture);
}

}  // namespace limn
