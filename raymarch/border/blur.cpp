// The blurred silhouette, laid around the object.

#include "raymarch/border.h"
#include "raymarch/border/blur_groups.h"
#include "raymarch/border/blur_passes.h"
#include "raymarch/gbuffer/picture_rows.h"

namespace limn {
namespace {

BlurSettings read_settings(const Parameters& parameters) {
  return {parameters.choice("kernel") == "box" ? BlurKernel::box : BlurKernel::gaussian,
          parameters.integer("radius"),
          parameters.integer("scale"),
          parameters.choice("edge") == "hard",
          parameters.choice("place") == "over",
          parameters.choice("colors") == "objects",
          static_cast<float>(parameters.number("level")),
          static_cast<float>(parameters.number("strength"))};
}

/// Blurs what `value(id)` makes of the objects, and hands on `write(y, line)`. A smaller buffer needs whole pictures in between.
template <class Value>
void blur_objects(const GBuffer& seen, const BlurSettings& settings, const Value& value,
                  const std::function<void(int, const float*)>& write) {
  const auto read = [&](int y, float* line) {
    const std::int32_t* id = &seen.id.at(0, y);
    for (int x = 0; x < seen.width; ++x) line[x] = value(id[x]);
  };
  if (settings.scale == 1) {
    blur_lines(seen.width, seen.height, settings.kernel, settings.radius_px, read, write);
    return;
  }
  Image<float> plane(seen.width, seen.height);
  for_each_band(seen.height, [&](int y0, int y1) {
    for (int y = y0; y < y1; ++y) read(y, &plane.at(0, y));
  });
  const int radius = std::max(1, (settings.radius_px + settings.scale / 2) / settings.scale);
  const Image<float> small = blur_separable(reduced(plane, settings.scale), settings.kernel, radius);
  plane = enlarged(small, settings.scale, seen.width, seen.height);
  for_each_band(seen.height, [&](int y0, int y1) {
    for (int y = y0; y < y1; ++y) write(y, &plane.at(0, y));
  });
}

/// Ink of one line of the blurred silhouette. On a straight edge that is 1/2, so that a glow starts there at 1; over the object it fades
/// inwards alike.
void ink_line(const BlurSettings& settings, const float* __restrict blurred, const std::int32_t* __restrict id, int width,
              float* __restrict ink) {
  const bool hard = settings.hard, over = settings.over;
  const float level = settings.level, factor = 2.0f * settings.strength;
  for (int x = 0; x < width; ++x) {
    const float amount = over ? std::min(blurred[x], 1.0f - blurred[x]) : blurred[x];
    const float value = hard ? (amount > level ? 1.0f : 0.0f) : std::min(1.0f, std::max(0.0f, factor * amount));
    ink[x] = over || id[x] == 0 ? value : 0.0f;
  }
}

Image<float> silhouette_plane(const GBuffer& seen, const BlurSettings& settings) {
  Image<float> plane(seen.width, seen.height);
  blur_objects(
      seen, settings, [](std::int32_t id) { return id != 0 ? 1.0f : 0.0f; },
      [&](int y, const float* line) { std::copy_n(line, static_cast<size_t>(seen.width), &plane.at(0, y)); });
  return plane;
}

/// The silhouette buffer in the objects' colours, blurred and divided by its coverage.
Image<glm::vec3> object_colors(const BorderInput& input, const BlurSettings& settings) {
  const GBuffer& seen = input.gbuffer;
  const Image<float> silhouette = silhouette_plane(seen, settings);
  Image<glm::vec3> colors(seen.width, seen.height, glm::vec3(0.0f));
  for (int channel = 0; channel < 3; ++channel) {
    const auto value = [&](std::int32_t id) { return id == 0 ? 0.0f : input.model.colors[static_cast<size_t>(id - 1)][channel]; };
    blur_objects(seen, settings, value, [&](int y, const float* line) {
      const float* share = &silhouette.at(0, y);
      for (int x = 0; x < seen.width; ++x) {
        if (share[x] > 1e-6f) colors.at(x, y)[channel] = std::min(1.0f, line[x] / share[x]);
      }
    });
  }
  return colors;
}

void draw_all(const BorderInput& input, const BlurSettings& settings, Border& border) {
  const GBuffer& seen = input.gbuffer;
  blur_objects(
      seen, settings, [](std::int32_t id) { return id != 0 ? 1.0f : 0.0f; },
      [&](int y, const float* line) { ink_line(settings, line, &seen.id.at(0, y), seen.width, &border.coverage.at(0, y)); });
  if (settings.object_colors) border.colors = object_colors(input, settings);
  add_group_note("blur", input, border.notes);
}

Border draw(const BorderInput& input, const Parameters& parameters) {
  const BlurSettings settings = read_settings(parameters);
  const GroupSettings groups = group_settings(parameters);
  Border border;
  border.color = glm::vec3(parameters.vector3("color"));
  border.coverage = {input.gbuffer.width, input.gbuffer.height, 0.0f};
  if (groups.by == GroupBy::all) {
    draw_all(input, settings, border);
  } else {
    blur_groups(input, settings, groups.by, border);
  }
  if (groups.hidden) blur_hidden(input, settings, groups, border);
  return border;
}

}  // namespace

BorderMethod blur_method() {
  std::vector<Parameter> parameters{
      a_choice("kernel", {"gaussian", "box"}).help("kind of blur"),
      an_integer("radius", 8.0).in(1.0, 256.0).unit("px").help("half the kernel's size; a Gaussian's standard deviation is a third of it"),
      an_integer("scale", 1.0).in(1.0, 8.0).help("blurs a buffer this many times smaller: quicker, coarser"),
      a_choice("edge", {"glow", "hard"}).help("fading out, or cut at the level"),
      a_number("level", 0.05).in(0.0, 0.5).help("hard: ink where the blurred silhouette exceeds this"),
      a_number("strength", 1.0).in(0.0, 16.0).help("glow: factor of the ink, which ends at 1"),
      a_choice("place", {"outside", "over"}).help("outside the object only, or on both sides of the silhouette"),
      a_choice("colors", {"one", "objects"}).help("one ink, or the objects' own colours"),
      a_color("color", {0.0, 0.0, 0.0}).help("ink, linear RGB")};
  for (Parameter& parameter : group_parameters(GroupBy::all)) parameters.push_back(std::move(parameter));
  return {{"blur", "the silhouette blurred in two passes and laid around the object, as a glow or a hard line",
           "separable filters: Szeliski 2010, section 3.2"},
          {"Z", "id", "material"},
          parameters,
          [](const SceneModel&, const Scene&) { return std::string(); },
          draw};
}

}  // namespace limn
