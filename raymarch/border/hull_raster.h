#pragma once
// Triangles on a picture with depth: a small exact rasteriser.

#include <glm/glm.hpp>
#include <span>

#include "raymarch/border/pixel_window.h"
#include "sdf/camera.h"

namespace limn {

/// Triangles by the numbers of their corners, which are in camera axes: x right, y up, z = depth Z along the view (positive in front).
struct Hull {
  std::span<const glm::dvec3> corners{};
  std::span<const glm::uvec3> triangles{};
};

enum class HullFaces { all, back };

/// Depth Z of the nearest triangle at the point `sample` of each pixel that triangles come to; infinite where there is none. Image points
/// are rounded to 1/1024 px and edges are then decided in whole numbers by the top-left rule, so that triangles with a common edge leave no
/// pixel between them and share none. Clipped at depth `near` in perspective and at 0 in parallel projection. Front faces are those whose
/// corners run counter-clockwise. The same bytes for any number of threads.
WindowImage<double> rasterize_hull(const Hull& hull, HullFaces faces, const Camera& camera, double near, const glm::dvec2& sample);

}  // namespace limn
