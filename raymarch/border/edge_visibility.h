#pragma once
// Which parts of a mesh's edges are seen, told from a G-buffer.

#include <vector>

#include "raymarch/border.h"
#include "raymarch/polygons.h"

namespace limn {

/// An edge as far as it lies before the camera and on the picture. Image points in pixels; `q` is linear along the image of the edge:
/// 1/Z in perspective, Z in parallel projection.
struct ImageEdge {
  glm::dvec2 a{0.0}, b{0.0};
  double q_a = 0.0, q_b = 0.0;
  std::int32_t object = 0;                ///< Index from 0.
  std::int32_t face_a = -1, face_b = -1;  ///< Polygons of that object.
  bool turned_away = false;               ///< Both faces show their backs: seen through an opening, or not at all.
};

/// A stretch of an image edge, from 0 at `a` to 1 at `b`.
struct Stretch {
  double from = 0.0, to = 1.0;
};

class EdgeVisibility {
 public:
  explicit EdgeVisibility(const BorderInput& input);

  /// The edge from `a` to `b` (render space), cut off before the camera and `margin_px` beyond the picture's sides; false where nothing
  /// is left.
  bool place(const glm::dvec3& a, const glm::dvec3& b, double margin_px, ImageEdge& edge) const;
  /// The stretches that nothing hides, to half a pixel, appended to `seen`.
  void visible_stretches(const ImageEdge& edge, std::vector<Stretch>& seen) const;

  /// At one point of the edge, 0 at `a` to 1 at `b`.
  bool visible(const ImageEdge& edge, double s) const;

  double depth_of(double q) const { return camera_.projection == Projection::perspective ? 1.0 / q : q; }
  const Camera& camera() const { return camera_; }  ///< In render space.
  /// Nearer to a pinhole than this depth, nothing is drawn.
  double near() const;

 private:
  bool shows_back(size_t pixel, std::int32_t object) const;
  bool hides(size_t pixel, const ImageEdge& edge, const glm::dvec2& at_px, double z) const;
  double seen_depth(size_t pixel, const CameraRay& ray) const;

  const BorderInput& input_;
  Camera camera_;
  double radius_ = 0.0;  ///< Of the sphere about the render origin in which rays are single precision.
};

}  // namespace limn
