#include "raymarch/border/outline.h"

namespace limn {
namespace {

/// An outer outline's ink ends at the object within the pixels that both share: what it leaves free there is the object's.
void find_beneath(const GroupSilhouette& outline, const Image<float>& ink, const OutlineBand& band, Border& border) {
  // Where the line is so narrow that it also ends outwards in the same pixel, nobody knows whose the rest is.
  if (band.side != OutlineSide::outside || band.softness_px == 0.0 || band.width_px - 0.5 * band.softness_px < 0.5) return;
  if (border.beneath.pixels.empty()) border.beneath = {border.coverage.width, border.coverage.height, -1};
  const Silhouette& found = outline.silhouette;
  for (int y = 0; y < ink.height; ++y) {
    for (int x = 0; x < ink.width; ++x) {
      if (found.inside.at(x, y) != 0 || !(ink.at(x, y) > 0.0f) || !(ink.at(x, y) < 1.0f)) continue;
      if (border.coverage.pixels[outline.pixel(x, y)] > ink.at(x, y)) continue;
      int nearest = kSubPixels / 2 + 1;
      const auto look = [&](const Image<std::int8_t>& crossings, int u, int v, bool backwards, int inner_x, int inner_y) {
        if (!crossings.inside(u, v) || crossings.at(u, v) == kNoCrossing) return;
        const int away = backwards ? kSubPixels - crossings.at(u, v) : crossings.at(u, v);
        if (away >= nearest) return;
        nearest = away;
        border.beneath.pixels[outline.pixel(x, y)] = static_cast<std::int32_t>(outline.pixel(inner_x, inner_y));
      };
      look(found.to_right, x, y, false, x + 1, y);
      look(found.to_right, x - 1, y, true, x - 1, y);
      look(found.downwards, x, y, false, x, y + 1);
      look(found.downwards, x, y - 1, true, x, y - 1);
    }
  }
}

void draw_group(const PictureGroups& groups, std::int32_t group, const GroupSilhouette& outline, const OutlineBand& band, Border& border) {
  Image<float> ink = ink_band(outline.silhouette, outline.squares, band);
  for (int y = 0; y < ink.height; ++y) {
    for (int x = 0; x < ink.width; ++x) {
      if (!(ink.at(x, y) > 0.0f)) continue;
      if (!ink_in_front(groups, group, outline, x, y)) ink.at(x, y) = 0.0f;
      float& whole = border.coverage.pixels[outline.pixel(x, y)];
      whole = std::max(whole, ink.at(x, y));
    }
  }
  find_beneath(outline, ink, band, border);
}

void draw_hidden(const BorderInput& input, const GroupSettings& settings, const OutlineBand& band, bool estimate,
                 const SilhouetteSquares& squares, Border& border) {
  Image<float> hidden(border.coverage.width, border.coverage.height, 0.0f);
  GroupAlone alone;
  for (const HiddenGroup& group : hidden_groups(input, settings.by)) {
    render_alone(input, group, alone);
    const GroupSilhouette outline = hidden_silhouette(input.gbuffer, alone, group, true, estimate, band.reach_px(), squares);
    const Image<float> ink = ink_band(outline.silhouette, outline.squares, band);
    for (int y = 0; y < ink.height; ++y) {
      for (int x = 0; x < ink.width; ++x) {
        const size_t at = outline.pixel(x, y);
        if (group.hides(input.gbuffer, at)) hidden.pixels[at] = std::max(hidden.pixels[at], ink.at(x, y));
      }
    }
  }
  lay_hidden_ink(hidden, settings.hidden_color, border);
}

}  // namespace

std::vector<Parameter> outline_parameters() {
  std::vector<Parameter> parameters = {
      a_number("width", 3.0).in(0.0, 480.0).unit("px").help("width of the outline"),
      a_number("softness", 1.0).in(0.0, 32.0).unit("px").help("width over which its edges fade; 1 is anti-aliased, 0 hard"),
      a_choice("side", {"outside", "inside", "centered"}).help("which side of the silhouette has the ink"),
      a_choice("seeds", {"estimated", "half"})
          .help("where the silhouette crosses between two pixels: estimated from N.V on smooth surfaces, or half-way"),
      a_color("color", {0.0, 0.0, 0.0}).help("ink, linear RGB"),
  };
  for (Parameter& parameter : group_parameters(GroupBy::all)) parameters.push_back(std::move(parameter));
  return parameters;
}

Border draw_outline(const std::string& name, const BorderInput& input, const Parameters& parameters, const SilhouetteSquares& squares) {
  const OutlineBand band = outline_band(parameters);
  const GroupSettings settings = group_settings(parameters);
  const bool estimate = parameters.choice("seeds") == "estimated";
  Border border;
  border.color = glm::vec3(parameters.vector3("color"));
  if (settings.by == GroupBy::all) {
    GroupSilhouette outline;
    outline.picture_width = static_cast<size_t>(input.gbuffer.width);
    outline.silhouette = find_silhouette(input.gbuffer, estimate);
    border.coverage = ink_band(outline.silhouette, squares(outline.silhouette, band.reach_px()), band);
    find_beneath(outline, border.coverage, band, border);
    add_silhouette_notes(name, outline.silhouette, border.notes);
    add_group_note(name, input, border.notes);
  } else {
    border.coverage = {input.gbuffer.width, input.gbuffer.height, 0.0f};
    const PictureGroups groups(input, settings.by);
    Silhouette all;
    for (std::int32_t group = 1; group <= groups.count(); ++group) {
      const GroupSilhouette outline = front_silhouette(groups, group, estimate, band.reach_px(), squares);
      draw_group(groups, group, outline, band, border);
      all.thin += outline.silhouette.thin;
    }
    add_silhouette_notes(name, all, border.notes);
  }
  if (settings.hidden) draw_hidden(input, settings, band, estimate, squares, border);
  return border;
}

}  // namespace limn
