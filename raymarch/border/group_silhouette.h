#pragma once
// The silhouette of one group of objects, in a window of the picture, and where its outline is seen.

#include <functional>
#include <optional>

#include "raymarch/border/object_groups.h"
#include "raymarch/border/silhouette.h"

namespace limn {

struct GroupSilhouette {
  PixelWindow window{};
  Silhouette silhouette{};        ///< In the window's coordinates; only the crossings that were kept.
  Image<std::int32_t> squares{};  ///< To its nearest crossing, as exact_squares.
  size_t picture_width = 0;

  size_t pixel(int x, int y) const { return static_cast<size_t>(window.y0 + y) * picture_width + static_cast<size_t>(window.x0 + x); }
  /// In 1/32 px, squared, at picture pixel (x, y); kFarSquared outside the window.
  std::int32_t square_at(int x, int y) const;
};

using SilhouetteSquares = std::function<Image<std::int32_t>(const Silhouette&, int reach_px)>;

/// `inside(i)`: pixel i of the picture belongs to the group; `keep(inner, outer)`: the crossing between these two is part of the outline.
GroupSilhouette group_silhouette(const GBuffer& gbuffer, const PixelWindow& window, bool estimate,
                                 const std::function<bool(size_t)>& inside, const std::function<bool(size_t, size_t)>& keep);

/// The outline of a group as far as it is in front of what lies beside it, with distances up to `reach_px` around it.
GroupSilhouette front_silhouette(const PictureGroups& groups, std::int32_t group, bool estimate, int reach_px,
                                 const SilhouetteSquares& squares);
/// Of the outline of a group seen alone the part where the picture shows others, or (`hidden` false) the rest.
GroupSilhouette hidden_silhouette(const GBuffer& seen, const GroupAlone& alone, const HiddenGroup& group, bool hidden, bool estimate,
                                  int reach_px, const SilhouetteSquares& squares);

/// The pixels on both sides of the crossing that (x, y) of the window is nearest to.
struct CrossingSides {
  size_t inner = 0, outer = 0;
};
std::optional<CrossingSides> nearest_crossing(const GroupSilhouette& outline, int x, int y);
/// Whether the outline's ink at (x, y) of the window lies in front of what the picture shows there.
bool ink_in_front(const PictureGroups& groups, std::int32_t group, const GroupSilhouette& outline, int x, int y);

}  // namespace limn
