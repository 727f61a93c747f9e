// Extrude: the object again, behind itself, grown.

#include "raymarch/border/extrude.h"

#include <fmt/core.h>

#include "raymarch/border.h"
#include "raymarch/border/edge_visibility.h"
#include "raymarch/border/hull_raster.h"
#include "raymarch/border/specks.h"

namespace limn {
namespace {

ExtrudeSettings read_settings(const Parameters& parameters) {
  ExtrudeSettings settings;
  settings.direction_name = parameters.choice("direction");
  settings.direction = settings.direction_name == "position"              ? ExtrudeDirection::position
                       : settings.direction_name == "normalized_position" ? ExtrudeDirection::normalized_position
                       : settings.direction_name == "vertex_normal"       ? ExtrudeDirection::vertex_normal
                                                                          : ExtrudeDirection::smooth_normal;
  settings.space = parameters.choice("space") == "clip" ? ExtrudeSpace::clip : ExtrudeSpace::object;
  settings.mask = parameters.choice("mask") == "back_faces" ? ExtrudeMask::back_faces : ExtrudeMask::stencil;
  settings.width_px = parameters.number("width");
  settings.object_width = parameters.number("object_width");
  settings.groups = group_settings(parameters);
  return settings;
}

bool grows_alike(const ExtrudeSettings& a, const ExtrudeSettings& b) {
  return a.direction == b.direction && a.space == b.space && a.width_px == b.width_px && a.object_width == b.object_width;
}

/// Of a mesh about its own origin, of a field (which has no object space left) about the middle of its bounds.
Affine render_from_object(const BorderInput& input, size_t object) {
  Affine result;
  if (object < input.scene.objects.size()) {
    const SceneObject& source = input.scene.objects[object];
    result = source.world_from_object;
    if (std::holds_alternative<Field>(source.source)) result.translation = bounds(source).center();
  }
  result.translation -= input.model.render_origin;
  return result;
}

WindowImage<float> ink_hull(const BorderInput& input, size_t object, std::span<const glm::dvec3> grown, const ExtrudeSettings& settings,
                            double near) {
  const GBuffer& seen = input.gbuffer;
  const bool back = settings.mask == ExtrudeMask::back_faces;
  Camera camera = input.camera;
  camera.width_px = seen.width;
  camera.height_px = seen.height;
  const WindowImage<double> depth = rasterize_hull({grown, input.model.surfaces[object].polygons->corner_triangles()},
                                                   back ? HullFaces::back : HullFaces::all, camera, near, seen.sample);
  const auto id = static_cast<std::int32_t>(object) + 1;
  WindowImage<float> ink = window_image(depth.window, 0.0f);
  for (int y = depth.window.y0; y < depth.window.y1; ++y) {
    for (int x = depth.window.x0; x < depth.window.x1; ++x) {
      if (!std::isfinite(depth.at(x, y)) || (!back && seen.id.at(x, y) == id)) continue;
      if (static_cast<float>(depth.at(x, y)) <= seen.depth.at(x, y)) ink.at(x, y) = 1.0f;
    }
  }
  return ink;
}

void add_mitre_note(const BorderInput& input, const ExtrudeSettings& settings, Border& border) {
  const bool by_offset = std::any_of(input.model.surfaces.begin(), input.model.surfaces.end(),
                                     [](const Surface& surface) { return !surface.polygons && surface.offset.make; });
  if (!by_offset || settings.space != ExtrudeSpace::clip || input.gbuffer.id.size() == 0) return;
  const InkBeyond beyond = ink_beyond(input.gbuffer, border.coverage, settings.width_px);
  if (beyond.beyond_pixels == 0) return;
  border.notes.push_back(
      fmt::format("extrude by exact offset: {} of {} pixels beside the object lie beyond the {:.4g} px asked for, up to {:.1f} px: "
                  "f is no distance at corners cut sharply",
                  beyond.beyond_pixels, beyond.ink_pixels, settings.width_px, beyond.farthest_px));
}

WindowImage<float> ink_one(const BorderInput& input, size_t object, const ExtrudeSettings& settings, const EdgeVisibility& view,
                           HullNotes* notes) {
  const Surface& surface = input.model.surfaces[object];
  if (!surface.polygons && !surface.offset.make) return {};
  const std::shared_ptr<const SharedExtrusion> extrusion = extrusion_of(input, object, settings);
  if (!surface.polygons) return extrusion->shell ? ink_offset(input, object, settings, *extrusion->shell) : WindowImage<float>{};
  if (notes != nullptr) notes->add(input, object, extrusion->grown, settings);
  return ink_hull(input, object, extrusion->grown, settings, view.near());
}

void lay_ink(const WindowImage<float>& ink, Image<float>& coverage) {
  for (int y = ink.window.y0; y < ink.window.y1; ++y) {
    for (int x = ink.window.x0; x < ink.window.x1; ++x) coverage.at(x, y) = std::max(coverage.at(x, y), ink.at(x, y));
  }
}

/// Where objects touch, and where a hull folds in a concave corner, rounding leaves pieces of ink on objects that are smaller than any
/// outline. Of thinner lines such pieces are all that pixels show.
void drop_specks_on_objects(const BorderInput& input, double width_px, Image<float>& coverage) {
  constexpr double kThin_px = 2.0;
  if (width_px < kThin_px) return;
  drop_specks(
      kSpeckPx, [&](size_t i) { return input.gbuffer.id.pixels[i] != 0; }, coverage);
}

void draw_objects(const BorderInput& input, const ExtrudeSettings& settings, HullNotes* notes, Border& border) {
  const EdgeVisibility view(input);
  const size_t objects = input.model.surfaces.size();
  if (objects == 1) {
    lay_ink(ink_one(input, 0, settings, view, notes), border.coverage);
    return drop_specks_on_objects(input, widest_extrude_px(input, settings), border.coverage);
  }
  const ExtrudeGroups groups(input, settings);
  for (size_t object = 0; object < objects; ++object) groups.lay(object, ink_one(input, object, settings, view, notes), border.coverage);
  groups.draw_seams(border.coverage);
  drop_specks_on_objects(input, groups.widest_px(), border.coverage);
  if (settings.groups.by == GroupBy::all) add_group_note("extrude", input, border.notes);
  if (settings.groups.hidden) groups.draw_hidden(border);
}

void add_notes(const BorderInput& input, const ExtrudeSettings& settings, const HullNotes& notes, Border& border) {
  const auto without = std::count_if(input.model.surfaces.begin(), input.model.surfaces.end(),
                                     [](const Surface& surface) { return !surface.polygons && !surface.offset.make; });
  if (without > 0)
    border.notes.push_back(
        fmt::format("extrude: {} of {} objects have neither polygons nor distances", without, input.model.surfaces.size()));
  const OutlineGaps gaps = input.model.surfaces.size() > 1 ? outline_gaps(input, settings.groups, border.coverage)
                                                           : outline_gaps(input.gbuffer, border.coverage);
  if (gaps.gaps > 0) {
    const bool hull = !input.model.surfaces.empty() && input.model.surfaces[0].polygons;
    border.notes.push_back(fmt::format("extrude {}: {} gap{}, longest {} px, {:.1f} % of the outline",
                                       hull ? "by " + settings.direction_name : "by exact offset", gaps.gaps, gaps.gaps == 1 ? "" : "s",
                                       gaps.longest_px,
                                       100.0 * static_cast<double>(gaps.gap_pixels) / static_cast<double>(gaps.outline_pixels)));
  }
  notes.write(settings, border.notes);
  add_mitre_note(input, settings, border);
}

Border draw(const BorderInput& input, const Parameters& parameters) {
  const ExtrudeSettings settings = read_settings(parameters);
  Border border;
  border.color = glm::vec3(parameters.vector3("color"));
  border.coverage = {input.gbuffer.width, input.gbuffer.height, 0.0f};
  HullNotes notes;
  draw_objects(input, settings, input.with_notes ? &notes : nullptr, border);
  if (input.with_notes) add_notes(input, settings, notes, border);
  return border;
}

std::string unsupported(const SceneModel& model, const Scene&) {
  for (const Surface& surface : model.surfaces) {
    if (surface.polygons || surface.offset.make) return {};
  }
  return "it grows polygons or distances, and no object is modelled by either";
}

}  // namespace

std::shared_ptr<const SharedExtrusion> extrusion_of(const BorderInput& input, size_t object, const ExtrudeSettings& settings) {
  const Surface& surface = input.model.surfaces[object];
  const OffsetShell* alike = nullptr;
  if (input.shared != nullptr) {
    for (const auto& kept : input.shared->extrusions) {
      if (kept->object != object || !grows_alike(kept->settings, settings)) continue;
      // Only the places where rays of a shell become ink hang on the mask.
      if (!kept->shell || kept->settings.mask == settings.mask) return kept;
      alike = kept->shell.get();
    }
  }
  auto extrusion = std::make_shared<SharedExtrusion>(SharedExtrusion{object, settings});
  if (surface.polygons)
    extrusion->grown =
        extrude_corners(*surface.polygons, render_from_object(input, object), settings, moved(input.camera, input.model.render_origin));
  else
    extrusion->shell = offset_shell(input, object, settings, alike);
  if (input.shared != nullptr) input.shared->extrusions.push_back(extrusion);
  return extrusion;
}

WindowImage<float> ink_object(const BorderInput& input, size_t object, const ExtrudeSettings& settings) {
  return ink_one(input, object, settings, EdgeVisibility(input), nullptr);
}

BorderMethod extrude_method() {
  std::vector<Parameter> parameters{
      a_number("width", 3.0).in(0.0, 256.0).unit("px").help("in clip space"),
      a_number("object_width", 0.02)
          .in(0.0, 1e9)
          .unit("world")
          .help("in object space, where it grows with the object and shrinks with distance; by position: a share of the distance to the "
                "origin"),
      a_choice("space", {"clip", "object"}).help("clip: as many pixels everywhere; object: as much of the object's own units"),
      a_choice("direction", {"position", "normalized_position", "vertex_normal", "smooth_normal"})
          .chosen(3.0)
          .help("of meshes: away from the origin, along the normals, or along normals baked smooth"),
      a_choice("mask", {"back_faces", "stencil"}).help("draw back faces only (inner contours too), or everything beside the object"),
      a_color("color", {0.0, 0.0, 0.0}).help("ink, linear RGB")};
  for (Parameter& parameter : group_parameters(GroupBy::object)) parameters.push_back(std::move(parameter));
  return {
      {"extrude", "the object again, grown and behind itself: an inverted hull of a mesh, the exact offset f = w of a field or level set",
       "Rossignac and van Emmerik 1992; Raskar and Cohen 1999"},
      {"Z", "id", "mesh or distances"},
      parameters,
      unsupported,
      draw};
}

}  // namespace limn
