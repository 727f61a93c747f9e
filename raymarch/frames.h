#pragma once
// Pictures of a camera that moves: where it stands frame by frame, and which pixel showed the same before.

#include <cstdint>
#include <vector>

#include "raymarch/gbuffer.h"
#include "sdf/geometry.h"

namespace limn {

/// A wander by parts of a pixel about where a camera stands, the same for the same seed.
struct FramePath {
  int frames = 16;         ///< Pictures, the first from where the camera stands; >= 1.
  double step_px = 0.1;    ///< What is nearest moves by this from frame to frame, in (0, 1]; nothing moves farther.
  std::uint64_t seed = 1;  ///< Of the directions.
  /// Farthest from the first frame, px: half a pixel where the step allows.
  double reach_px() const { return step_px < 0.5 ? 0.5 : step_px; }
};

/// Offsets of the path in the picture's plane, px, x right and y up; the first is 0. Each is `step_px` from the one before.
std::vector<glm::dvec2> path_offsets(const FramePath& path);

/// The cameras of the path. The eye moves across the view axis, so that perspective shifts near things more than far ones. `bounds` (world)
/// tell what is nearest; nearer than a tenth of their radius counts as that far. Empty or infinite bounds: as far as the eye is from the
/// origin.
std::vector<Camera> path_cameras(const Camera& camera, const Box& bounds, const FramePath& path);

/// The camera carried round `target` (world): turned by `angle` radians about `axis` (any length), counter-clockwise seen from where it
/// points.
Camera turned_camera(const Camera& camera, const glm::dvec3& target, const glm::dvec3& axis, double angle);

/// For each pixel of a frame the index of the pixel that showed the same piece of surface the frame before, geometry at rest; -1 where none
/// did: it was hidden, outside the picture, or beyond a jump or a crease (normals that differ by more than a quarter of a radian). Where
/// nothing is hit, the same pixel if nothing was hit there either. Reads Z, N and id of both; same size. `memory` is drawn into if it has
/// that size, too.
Image<std::int32_t> pixels_before(const GBuffer& now, const Camera& camera, const GBuffer& before, const Camera& camera_before,
                                  Image<std::int32_t> memory = {});

}  // namespace limn
