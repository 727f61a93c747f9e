#include "raymarch/border/group_silhouette.h"

#include <cmath>

namespace limn {

std::int32_t GroupSilhouette::square_at(int x, int y) const {
  const int u = x - window.x0, v = y - window.y0;
  return squares.inside(u, v) ? squares.at(u, v) : kFarSquared;
}

GroupSilhouette group_silhouette(const GBuffer& gbuffer, const PixelWindow& window, bool estimate,
                                 const std::function<bool(size_t)>& inside, const std::function<bool(size_t, size_t)>& keep) {
  GroupSilhouette out;
  out.window = window;
  out.picture_width = static_cast<size_t>(gbuffer.width);
  Silhouette& found = out.silhouette;
  const int width = window.width(), height = window.height();
  found.inside = {width, height, 0};
  found.to_right = {width, height, kNoCrossing};
  found.downwards = {width, height, kNoCrossing};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) found.inside.at(x, y) = inside(out.pixel(x, y));
  }
  const auto cross = [&](int x, int y, int u, int v, Image<std::int8_t>& into) {
    const bool first = found.inside.at(x, y) != 0;
    if (first == (found.inside.at(u, v) != 0)) return;
    const size_t i = out.pixel(x, y), j = out.pixel(u, v);
    if (!keep(first ? i : j, first ? j : i)) return;
    // Beyond the window the picture may go on.
    const int gx = window.x0 + x, gy = window.y0 + y;
    const bool before = u > x ? gx > 0 : gy > 0, after = u > x ? gx + 2 < gbuffer.width : gy + 2 < gbuffer.height;
    into.at(x, y) = crossing_place(gbuffer, i, j - i, first, before, after, estimate);
    ++found.crossings;
  };
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (x + 1 < width) cross(x, y, x + 1, y, found.to_right);
      if (y + 1 < height) cross(x, y, x, y + 1, found.downwards);
      const auto out_there = [&](int u, int v) { return found.inside.inside(u, v) && found.inside.at(u, v) == 0; };
      found.thin +=
          found.inside.at(x, y) != 0 && ((out_there(x - 1, y) && out_there(x + 1, y)) || (out_there(x, y - 1) && out_there(x, y + 1)));
    }
  }
  return out;
}

GroupSilhouette front_silhouette(const PictureGroups& groups, std::int32_t group, bool estimate, int reach_px,
                                 const SilhouetteSquares& squares) {
  const GBuffer& seen = groups.seen();
  GroupSilhouette outline = group_silhouette(
      seen, grown(groups.window(group), reach_px + 1, seen.width, seen.height), estimate, [&](size_t i) { return groups.of(i) == group; },
      [&](size_t inner, size_t outer) { return groups.in_front(inner, outer); });
  outline.squares = squares(outline.silhouette, reach_px);
  return outline;
}

GroupSilhouette hidden_silhouette(const GBuffer& seen, const GroupAlone& alone, const HiddenGroup& group, bool hidden, bool estimate,
                                  int reach_px, const SilhouetteSquares& squares) {
  GroupSilhouette outline = group_silhouette(
      alone.seen, grown(alone.window, reach_px + 1, seen.width, seen.height), estimate,
      [&](size_t i) { return alone.seen.id.pixels[i] != 0; }, [&](size_t inner, size_t) { return group.hides(seen, inner) == hidden; });
  outline.squares = squares(outline.silhouette, reach_px);
  return outline;
}

// The distance is exact, so that a crossing at exactly that distance is found on one of the lines through it: one place to look at in each
// line and column within reach.
std::optional<CrossingSides> nearest_crossing(const GroupSilhouette& outline, int x, int y) {
  const std::int64_t square = outline.squares.at(x, y);
  if (square == kFarSquared) return std::nullopt;
  const Silhouette& found = outline.silhouette;
  const int reach = static_cast<int>(std::sqrt(static_cast<double>(square)) / kSubPixels) + 1;
  // `along`: pixels of the line; `across`: lines away. at(k) reads the crossing after pixel k of that line.
  const auto look = [&](const Image<std::int8_t>& crossings, bool columns) -> std::optional<CrossingSides> {
    for (int across = -reach; across <= reach; ++across) {
      const std::int64_t rest = square - std::int64_t{kSubPixels} * kSubPixels * across * across;
      if (rest < 0) continue;
      const auto root = static_cast<std::int64_t>(std::llround(std::sqrt(static_cast<double>(rest))));
      if (root * root != rest) continue;
      for (const std::int64_t along : {root, -root}) {
        const std::int64_t place = std::int64_t{kSubPixels} * (columns ? y : x) + along;
        const auto first = static_cast<int>(std::floor(static_cast<double>(place) / kSubPixels));
        // A crossing on the centre of a pixel belongs to the segment on either side of it.
        for (const int k : {first, first - 1}) {
          const int u = columns ? x + across : k, v = columns ? k : y + across;
          if (!crossings.inside(u, v) || crossings.at(u, v) == kNoCrossing || std::int64_t{kSubPixels} * k + crossings.at(u, v) != place)
            continue;
          const size_t a = outline.pixel(u, v), b = columns ? outline.pixel(u, v + 1) : outline.pixel(u + 1, v);
          return found.inside.at(u, v) != 0 ? CrossingSides{a, b} : CrossingSides{b, a};
        }
      }
    }
    return std::nullopt;
  };
  const auto in_line = look(found.to_right, false);
  return in_line ? in_line : look(found.downwards, true);
}

bool ink_in_front(const PictureGroups& groups, std::int32_t group, const GroupSilhouette& outline, int x, int y) {
  const size_t at = outline.pixel(x, y);
  const std::int32_t there = groups.of(at);
  if (there == 0 || there == group) return true;
  const auto sides = nearest_crossing(outline, x, y);
  if (!sides) return false;
  return groups.of(sides->outer) == there || groups.in_front(sides->inner, at, true);
}

}  // namespace limn
