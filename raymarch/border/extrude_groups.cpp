// Extruded outlines of several objects: which part of each hull is an outline, and lines where objects touch.

#include <cmath>

#include "raymarch/border/extrude.h"
#include "raymarch/border/group_silhouette.h"

namespace limn {
namespace {

/// Hulls come out of touching surfaces beyond their own width where corners are mitred.
int reach_of(double width_px) { return std::min(kLargestReach_px, static_cast<int>(std::ceil(2.0 * width_px)) + 2); }

}  // namespace

double extrude_width_px(const BorderInput& input, size_t object, const ExtrudeSettings& settings, double z) {
  if (settings.space == ExtrudeSpace::clip) return settings.width_px;
  double scale = 1.0;
  if (object < input.scene.objects.size())
    scale = std::cbrt(std::abs(glm::determinant(input.scene.objects[object].world_from_object.linear)));
  return std::isfinite(z) ? settings.object_width * scale * pixels_per_unit_at(input.camera, z) : 0.0;
}

double widest_extrude_px(const BorderInput& input, const ExtrudeSettings& settings) {
  if (settings.space == ExtrudeSpace::clip) return settings.width_px;
  const auto& depths = input.gbuffer.depth.pixels;
  const double nearest = *std::min_element(depths.begin(), depths.end());
  double widest = 0.0;
  for (size_t k = 0; k < input.model.surfaces.size(); ++k) widest = std::max(widest, extrude_width_px(input, k, settings, nearest));
  return std::min(widest, 0.5 * kLargestReach_px - 2.0);
}

ExtrudeGroups::ExtrudeGroups(const BorderInput& input, const ExtrudeSettings& settings)
    : input_(input), settings_(settings), widest_px_(widest_extrude_px(input, settings)) {
  if (settings.groups.by != GroupBy::all) objects_.emplace(input, GroupBy::object);
}

void ExtrudeGroups::lay(size_t object, const WindowImage<float>& ink, Image<float>& coverage) const {
  const GBuffer& seen = input_.gbuffer;
  const auto id = static_cast<std::int32_t>(object) + 1;
  const auto of_group = [&](size_t i) {
    if (settings_.groups.by == GroupBy::all) return true;
    return settings_.groups.by == GroupBy::material && seen.material.pixels[i] == input_.model.materials[object];
  };
  GroupSilhouette touching, in_front;
  if (const std::int32_t group = objects_ ? objects_->group_of_key(id) : 0; group != 0) {
    const int reach = reach_of(widest_px_);
    const PixelWindow window = grown(objects_->window(group), reach + 1, seen.width, seen.height);
    const auto inside = [&](size_t i) { return objects_->of(i) == group; };
    touching = group_silhouette(seen, window, false, inside, [&](size_t a, size_t b) { return objects_->touching(a, b); });
    touching.squares = exact_squares(touching.silhouette, reach);
    if (touching.silhouette.crossings > 0) {
      in_front = group_silhouette(seen, window, false, inside,
                                  [&](size_t a, size_t b) { return !objects_->touching(a, b) && objects_->in_front(a, b); });
      in_front.squares = exact_squares(in_front.silhouette, reach);
    }
  }
  for (int y = ink.window.y0; y < ink.window.y1; ++y) {
    for (int x = ink.window.x0; x < ink.window.x1; ++x) {
      const size_t i = coverage.index(x, y);
      if (ink.at(x, y) == 0.0f) continue;
      if (seen.id.pixels[i] != 0 && seen.id.pixels[i] != id) {
        if (of_group(i)) continue;
        // Hulls of what touches others also come out of surfaces on one plane, where nothing of the object is seen.
        const std::int32_t to_front = in_front.square_at(x, y);
        if (touching.silhouette.crossings > 0 && (to_front == kFarSquared || touching.square_at(x, y) <= to_front)) continue;
      }
      coverage.pixels[i] = 1.0f;
    }
  }
}

void ExtrudeGroups::draw_seams(Image<float>& coverage) const {
  if (settings_.groups.by == GroupBy::all) return;
  const GBuffer& seen = input_.gbuffer;
  const PictureGroups groups(input_, settings_.groups.by);
  const int reach = static_cast<int>(std::ceil(widest_px_)) + 1;
  for (std::int32_t group = 1; group <= groups.count(); ++group) {
    GroupSilhouette seam = group_silhouette(
        seen, grown(groups.window(group), reach + 1, seen.width, seen.height), false, [&](size_t i) { return groups.of(i) == group; },
        [&](size_t a, size_t b) { return groups.touching(a, b) && groups.in_front(a, b); });
    if (seam.silhouette.crossings == 0) continue;
    seam.squares = exact_squares(seam.silhouette, reach);
    for (int y = 0; y < seam.squares.height; ++y) {
      for (int x = 0; x < seam.squares.width; ++x) {
        const size_t at = seam.pixel(x, y);
        const std::int32_t square = seam.squares.at(x, y);
        if (square == kFarSquared || groups.of(at) == 0 || groups.of(at) == group) continue;
        const auto sides = nearest_crossing(seam, x, y);
        if (!sides) continue;
        const auto owner = static_cast<size_t>(seen.id.pixels[sides->inner] - 1);
        const double width = extrude_width_px(input_, owner, settings_, double{seen.depth.pixels[sides->inner]}) * kSubPixels;
        if (static_cast<double>(square) <= width * width && ink_in_front(groups, group, seam, x, y)) coverage.pixels[at] = 1.0f;
      }
    }
  }
}

void ExtrudeGroups::draw_hidden(Border& border) const {
  const GBuffer& seen = input_.gbuffer;
  Image<float> hidden(seen.width, seen.height, 0.0f);
  const int reach = reach_of(widest_px_);
  GroupAlone alone;
  for (const HiddenGroup& group : hidden_groups(input_, settings_.groups.by)) {
    render_alone(input_, group, alone);
    const BorderInput by_itself{alone.seen, input_.camera, input_.model, input_.scene};
    const GroupSilhouette unseen = hidden_silhouette(seen, alone, group, true, false, reach, exact_squares);
    const GroupSilhouette visible = hidden_silhouette(seen, alone, group, false, false, reach, exact_squares);
    for (const size_t object : group.objects) {
      const WindowImage<float> ink = ink_object(by_itself, object, settings_);
      for (int y = ink.window.y0; y < ink.window.y1; ++y) {
        for (int x = ink.window.x0; x < ink.window.x1; ++x) {
          const size_t i = seen.id.index(x, y);
          if (ink.at(x, y) == 0.0f || !group.hides(seen, i)) continue;
          const std::int32_t to_hidden = unseen.square_at(x, y);
          // Within the object its own folds are inked; beside it, its outline.
          if (alone.seen.id.pixels[i] != 0 || (to_hidden != kFarSquared && to_hidden <= visible.square_at(x, y))) hidden.pixels[i] = 1.0f;
        }
      }
    }
  }
  lay_hidden_ink(hidden, settings_.groups.hidden_color, border);
}

}  // namespace limn
