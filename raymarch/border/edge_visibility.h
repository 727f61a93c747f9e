#pragma once
// Which parts of a mesh's edges are seen, told by rays through the edges themselves: pixels are too coarse to tell an edge from what lies
// a pixel beside it.

#include <vector>

#include "raymarch/border.h"
#include "raymarch/mesh/polygons.h"

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
struct EdgeStretch {
  double from = 0.0, to = 1.0;
};

class EdgeVisibility {
 public:
  explicit EdgeVisibility(const BorderInput& input);

  /// The edge from `a` to `b` (render space), cut off before the camera and `margin_px` beyond the picture's sides; false where nothing
  /// is left.
  bool place(const glm::dvec3& a, const glm::dvec3& b, double margin_px, ImageEdge& edge) const;
  /// Memory for visible_stretches, one for each thread; its contents mean nothing to the caller.
  struct Scratch {
    std::vector<double> places;
    std::vector<glm::dvec2> points_px;
    std::vector<PointSample> samples;
    std::vector<char> visible;
    std::vector<EdgeStretch> changes;
  };
  /// The stretches that nothing hides, appended to `seen`: their ends to 1/64 px. Rays go through points a quarter of a pixel apart: what
  /// is drawn of a hidden edge lies within 1/8 px, along the edge, of a point that is seen; a stretch seen is missed only where it is
  /// shorter than 1/4 px.
  void visible_stretches(const ImageEdge& edge, Scratch& scratch, std::vector<EdgeStretch>& seen) const;

  /// At one point of the edge, 0 at `a` to 1 at `b`: one ray.
  bool visible(const ImageEdge& edge, double s) const;

  double depth_of(double q) const { return camera_.projection == Projection::perspective ? 1.0 / q : q; }
  const Camera& camera() const { return camera_; }  ///< In render space.
  /// Nearer to a pinhole than this depth, nothing is drawn.
  double near() const;

 private:
  void ask(const ImageEdge& edge, std::span<const double> places, Scratch& scratch) const;
  bool shows(const PointSample& seen, const ImageEdge& edge, double s) const;
  double bias(const PointSample& seen, const glm::dvec3& facet, const glm::dvec3& direction, double distance) const;

  const BorderInput& input_;
  Camera camera_;
  double radius_ = 0.0;  ///< Of the sphere about the render origin in which rays are single precision.
  bool bounded_ = true;
};

}  // namespace limn
