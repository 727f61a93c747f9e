#pragma once
// What one ray says about a point of a grid edge, and what two of them say about the stretch between.

#include <limits>

#include "raymarch/gbuffer.h"

namespace limn {

/// A point on a line between two pixel centres. Depths are in world units, slopes in px of depth a px along the line, both at the scale of
/// the nearest of the points compared.
struct EdgeNode {
  double t = 0.0;  ///< From the line's first end, px.
  double depth = std::numeric_limits<double>::infinity();
  double slope = 0.0;
  glm::vec3 normal{0.0f};
  float n_dot_v = 0.0f;
  std::int32_t id = 0;  ///< Object from 1; 0: nothing known to be hit.
  bool hit() const { return id != 0; }
};

/// A grid line's start in the image, and its direction: (1, 0) or (0, 1).
struct EdgeLine {
  glm::dvec2 start_px{0.0}, along{0.0};
};

/// How much the ray through a place of the picture goes against the direction of view: -1 in the middle.
double ray_backwards(const Camera& camera, const glm::dvec2& px);
/// `backwards`: as ray_backwards of the pixel's own ray; read only where it hits.
EdgeNode node_of_pixel(const Camera& camera, const GBuffer& gbuffer, size_t pixel, const EdgeLine& line, double t, double backwards);
EdgeNode node_of_sample(const Camera& camera, const PointSample& sample, const EdgeLine& line, double t);

/// Depth from a to b, px at the scale of the nearer one. Both must be hits.
double depth_step_px(const Camera& camera, const EdgeNode& a, const EdgeNode& b);

/// How many px the depth step exceeds what a sheet through both points with their slopes would show; 0 where it does not.
double excess_step_px(const Camera& camera, const EdgeNode& a, const EdgeNode& b);

/// True where a sheet may end between the two. `settled`: the turn of the normal is explained already (one of them lies on a contour).
bool may_hold_jump(const Camera& camera, const EdgeNode& a, const EdgeNode& b, bool settled);

}  // namespace limn
