#include "raymarch/border/blur_groups.h"

#include "raymarch/border/group_silhouette.h"

namespace limn {
namespace {

Image<float> blurred(const Image<float>& plane, const BlurSettings& settings) {
  if (settings.scale == 1) return blur_separable(plane, settings.kernel, settings.radius_px);
  const int radius = std::max(1, (settings.radius_px + settings.scale / 2) / settings.scale);
  return enlarged(blur_separable(reduced(plane, settings.scale), settings.kernel, radius), settings.scale, plane.width, plane.height);
}

/// The pixels that a group's ink can come to, cut so that a smaller buffer has the same blocks as the whole picture's.
PixelWindow blur_window(const PixelWindow& group, const BlurSettings& settings, const GBuffer& seen) {
  return grown(group, settings.radius_px + 2 * settings.scale, seen.width, seen.height, settings.scale);
}

/// What `value(i)` is at the window's pixels.
template <class Value>
Image<float> plane_of(const PixelWindow& window, int picture_width, const Value& value) {
  Image<float> plane(window.width(), window.height());
  for (int y = 0; y < plane.height; ++y) {
    const size_t first = static_cast<size_t>(window.y0 + y) * static_cast<size_t>(picture_width) + static_cast<size_t>(window.x0);
    for (int x = 0; x < plane.width; ++x) plane.at(x, y) = value(first + static_cast<size_t>(x));
  }
  return plane;
}

/// The members' colours, blurred and divided by their coverage.
Image<glm::vec3> group_colors(const BorderInput& input, const PictureGroups& groups, std::int32_t group, const PixelWindow& window,
                              const Image<float>& coverage, const BlurSettings& settings) {
  Image<glm::vec3> colors(window.width(), window.height(), glm::vec3(0.0f));
  for (int channel = 0; channel < 3; ++channel) {
    const auto value = [&](size_t i) {
      return groups.of(i) == group ? input.model.colors[static_cast<size_t>(input.gbuffer.id.pixels[i] - 1)][channel] : 0.0f;
    };
    const Image<float> plane = blurred(plane_of(window, input.gbuffer.width, value), settings);
    for (size_t i = 0; i < colors.size(); ++i) {
      if (coverage.pixels[i] > 1e-6f) colors.pixels[i][channel] = std::min(1.0f, plane.pixels[i] / coverage.pixels[i]);
    }
  }
  return colors;
}

}  // namespace

void blur_groups(const BorderInput& input, const BlurSettings& settings, GroupBy by, Border& border) {
  const GBuffer& seen = input.gbuffer;
  const PictureGroups groups(input, by);
  const int reach = std::min(kLargestReach_px, 2 * settings.radius_px);
  if (settings.object_colors) border.colors = {seen.width, seen.height, border.color};
  for (std::int32_t group = 1; group <= groups.count(); ++group) {
    const PixelWindow window = blur_window(groups.window(group), settings, seen);
    const auto inside = [&](size_t i) { return groups.of(i) == group; };
    const Image<float> plane = blurred(plane_of(window, seen.width, [&](size_t i) { return inside(i) ? 1.0f : 0.0f; }), settings);
    const GroupSilhouette front = front_silhouette(groups, group, false, reach, exact_squares);
    GroupSilhouette behind;  // Where another group's outline runs instead.
    if (settings.over) {
      behind = group_silhouette(seen, front.window, false, inside, [&](size_t a, size_t b) { return !groups.in_front(a, b); });
      behind.squares = exact_squares(behind.silhouette, reach);
    }
    Image<glm::vec3> colors;
    if (settings.object_colors) colors = group_colors(input, groups, group, window, plane, settings);
    for (int y = 0; y < plane.height; ++y) {
      for (int x = 0; x < plane.width; ++x) {
        const int u = window.x0 + x, v = window.y0 + y;
        const size_t at = seen.id.index(u, v);
        const float ink = blur_ink(settings, plane.at(x, y));
        if (!(ink > border.coverage.pixels[at])) continue;
        if (inside(at) && (!settings.over || front.square_at(u, v) > behind.square_at(u, v))) continue;
        if (groups.of(at) != 0 && front.square_at(u, v) == kFarSquared) continue;
        if (!inside(at) && front.square_at(u, v) != kFarSquared &&
            !ink_in_front(groups, group, front, u - front.window.x0, v - front.window.y0))
          continue;
        border.coverage.pixels[at] = ink;
        if (settings.object_colors) border.colors.pixels[at] = colors.at(x, y);
      }
    }
  }
}

void blur_hidden(const BorderInput& input, const BlurSettings& settings, const GroupSettings& groups, Border& border) {
  const GBuffer& seen = input.gbuffer;
  const int reach = std::min(kLargestReach_px, 2 * settings.radius_px);
  Image<float> ink(seen.width, seen.height, 0.0f);
  GroupAlone alone;
  for (const HiddenGroup& group : hidden_groups(input, groups.by)) {
    render_alone(input, group, alone);
    const GroupSilhouette hidden = hidden_silhouette(seen, alone, group, true, false, reach, exact_squares);
    const GroupSilhouette visible = hidden_silhouette(seen, alone, group, false, false, reach, exact_squares);
    const PixelWindow window = blur_window(alone.window, settings, seen);
    const Image<float> plane =
        blurred(plane_of(window, seen.width, [&](size_t i) { return alone.seen.id.pixels[i] != 0 ? 1.0f : 0.0f; }), settings);
    for (int y = window.y0; y < window.y1; ++y) {
      for (int x = window.x0; x < window.x1; ++x) {
        const size_t at = seen.id.index(x, y);
        if (!group.hides(seen, at) || (alone.seen.id.pixels[at] != 0 && !settings.over)) continue;
        const std::int32_t to_hidden = hidden.square_at(x, y);
        if (to_hidden == kFarSquared || to_hidden > visible.square_at(x, y)) continue;
        ink.pixels[at] = std::max(ink.pixels[at], blur_ink(settings, plane.at(x - window.x0, y - window.y0)));
      }
    }
  }
  lay_hidden_ink(ink, groups.hidden_color, border);
}

}  // namespace limn
