#pragma once
// The parts of the method `extrude`.

#include <optional>

#include "raymarch/border/object_groups.h"
#include "raymarch/mesh/polygons.h"
#include "sdf/large_pages.h"
#include "sdf/quantile.h"

namespace limn {

enum class ExtrudeDirection { position, normalized_position, vertex_normal, smooth_normal };
enum class ExtrudeSpace { clip, object };
enum class ExtrudeMask { back_faces, stencil };

struct ExtrudeSettings {
  ExtrudeDirection direction = ExtrudeDirection::smooth_normal;
  ExtrudeSpace space = ExtrudeSpace::clip;
  ExtrudeMask mask = ExtrudeMask::back_faces;
  double width_px = 3.0, object_width = 0.02;
  std::string direction_name{};
  GroupSettings groups{};
};

/// Width of the outline of object `object` (index from 0) at depth `z`.
double extrude_width_px(const BorderInput& input, size_t object, const ExtrudeSettings& settings, double z);

/// Width of the widest outline of the picture.
double widest_extrude_px(const BorderInput& input, const ExtrudeSettings& settings);

/// A point of render space in camera axes: x right, y up, z the depth.
glm::dvec3 in_camera_axes(const Camera& camera, const glm::dvec3& p);
/// A mesh grown: one point for each corner, in camera axes. `render_from_object` is about the object's origin; `camera` is in render
/// space.
PassingVector<glm::dvec3> extrude_corners(const Polygons& polygons, const Affine& render_from_object, const ExtrudeSettings& settings,
                                          const Camera& camera);

/// The offset surface of an object, and how far off it is.
struct OffsetShell {
  OffsetWidth width{};
  Surface surface{};
  std::optional<std::vector<Box>> places{};  ///< Where rays that become ink meet it, render space; unset: anywhere.
};
/// Null where the width is 0. `alike`: one of another mask, whose surface serves, too; may be null. Throws InputError where the object's
/// distances do not reach that far.
std::shared_ptr<const OffsetShell> offset_shell(const BorderInput& input, size_t object, const ExtrudeSettings& settings,
                                                const OffsetShell* alike = nullptr);
/// Ink of the offset surface of object `object` (index from 0), where it can come to.
WindowImage<float> ink_offset(const BorderInput& input, size_t object, const ExtrudeSettings& settings, const OffsetShell& offset);

/// Where the ray goes through its pixel changes neither a mesh grown nor an offset surface: all samples of a view share them.
struct SharedExtrusion {
  size_t object = 0;                           ///< Index from 0.
  ExtrudeSettings settings{};                  ///< Of the call that asked first.
  PassingVector<glm::dvec3> grown{};           ///< As extrude_corners() finds them; none of what has no polygons.
  std::shared_ptr<const OffsetShell> shell{};  ///< Null of what has polygons, and where the width is 0.
};
/// What is shared already, or made now, and shared where `input` has room for it.
std::shared_ptr<const SharedExtrusion> extrusion_of(const BorderInput& input, size_t object, const ExtrudeSettings& settings);

/// Pixels of objects beside what lies farther back, and runs (8-connected) of those without ink (1/2 or more) on any such neighbour.
struct OutlineGaps {
  std::int64_t outline_pixels = 0, gap_pixels = 0;
  std::int64_t gaps = 0, longest_px = 0;
};
OutlineGaps outline_gaps(const GBuffer& gbuffer, const Image<float>& coverage);
/// Of several objects: where a group's outline is due (BorderMethods' parameter `group`), rather than wherever depth changes.
OutlineGaps outline_gaps(const BorderInput& input, const GroupSettings& settings, const Image<float>& coverage);

/// Ink of one object, where it can come to: its hull or its offset, tested against what is seen. Nothing where it has neither.
WindowImage<float> ink_object(const BorderInput& input, size_t object, const ExtrudeSettings& settings);

/// Where objects touch, hulls lie in each other's surfaces, and what shows of them is decided by rounding: there the outline is drawn along
/// the places where the picture goes from one to the other instead, in front of the one that is behind elsewhere.
class ExtrudeGroups {
 public:
  ExtrudeGroups(const BorderInput& input, const ExtrudeSettings& settings);
  /// Lays what an object's ink shows over `coverage`, as far as it is an outline of its group.
  void lay(size_t object, const WindowImage<float>& ink, Image<float>& coverage) const;
  void draw_seams(Image<float>& coverage) const;
  void draw_hidden(Border& border) const;
  double widest_px() const { return widest_px_; }

 private:
  const BorderInput& input_;
  const ExtrudeSettings& settings_;
  double widest_px_;                        ///< Of all objects' outlines.
  std::optional<PictureGroups> objects_{};  ///< Unset where all objects count as one: nothing is drawn between them.
};

/// Pixels of ink beside all objects, and those of them that lie farther from the silhouette than `width_px` and a pixel: where f is no
/// distance (sharp CSG), its offset is mitred instead of round.
struct InkBeyond {
  std::int64_t ink_pixels = 0, beyond_pixels = 0;
  double farthest_px = 0.0;
};
InkBeyond ink_beyond(const GBuffer& gbuffer, const Image<float>& coverage, double width_px);

/// Widths of the drawn line along the visible contour edges of meshes, in pixels across the edge, negative inwards.
struct DrawnWidths {
  double low = 0.0, median = 0.0, high = 0.0;  ///< 5 %, 50 % and 95 % of the outline's length.
  double inward_share = 0.0;
};

/// Gathers, for all objects, what can be said of the hull where the contour is.
class HullNotes {
 public:
  void add(const BorderInput& input, size_t object, std::span<const glm::dvec3> grown, const ExtrudeSettings& settings);
  DrawnWidths widths() const;
  void write(const ExtrudeSettings& settings, std::vector<std::string>& notes) const;

 private:
  std::vector<WeightedValue> samples_{};  ///< Widths in pixels, by the lengths of what has them.
  std::int64_t corners_ = 0, wrong_corners_ = 0, inverted_objects_ = 0;
};

}  // namespace limn
