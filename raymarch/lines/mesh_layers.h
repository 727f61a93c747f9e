#pragma once
// Internal: what rays and lines meet where everything is a mesh: given ones, and fine ones of limit surfaces.

#include <array>
#include <memory>

#include "raymarch/lines/surface_curves.h"

namespace limn {

/// A triangle's side of a ray.
struct LayerHit {
  double t = 0.0;
  std::uint32_t triangle = 0;
};

/// A triangle of vertices that are the same where they lie at one place.
struct LayerTriangle {
  std::array<std::uint32_t, 3> corners{};
  std::uint32_t part = 0;  ///< Connected by vertices.
  int object = 1;          ///< Index from 1.
  int material = 0;
};

/// Triangles in solver space that are searched along rays, and which connected part each belongs to. Safe from many threads.
class MeshLayers {
 public:
  /// Cages are refined until their edges are about `edge_px` long.
  MeshLayers(const LineTask& task, const std::vector<size_t>& objects, double edge_px);
  ~MeshLayers();
  MeshLayers(const MeshLayers&) = delete;
  MeshLayers& operator=(const MeshLayers&) = delete;

  const std::vector<glm::dvec3>& positions() const;
  const std::vector<LayerTriangle>& triangles() const;

  /// Hits between the sample, lifted off by more than the mesh lies beside the surface, and the eye.
  int before(const CurveSample& sample) const;
  /// These hits, in order from the sample.
  std::vector<LayerHit> hits_to_eye(const CurveSample& sample) const;
  /// Whether there is more than one part, so that curves of one may go through another.
  bool several_parts() const;
  /// Marks the places where the curve goes through other parts than its own: CurveSample::pierced.
  void pierce(SurfaceCurve& curve) const;
  /// Where parts go through each other.
  std::vector<SurfaceCurve> intersections() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// What meshes add to curves that were traced: where these go through other sheets, where parts go through each other, and the counting.
void add_mesh_layers(const std::shared_ptr<const MeshLayers>& layers, LineContribution& out);

}  // namespace limn
