#pragma once
// Internal: how many layers of surface a ray goes through, where everything is a mesh: given ones, and fine ones of limit surfaces.

#include "raymarch/lines/surface_curves.h"
#include "raymarch/truth/proxy.h"

namespace limn {

/// Safe from many threads.
class MeshLayers {
 public:
  /// Cages are refined until their edges are about `edge_px` long.
  MeshLayers(const LineTask& task, const std::vector<size_t>& objects, double edge_px);

  /// Hits between the sample, lifted off by more than the mesh lies beside the surface, and the eye.
  int before(const CurveSample& sample) const;

 private:
  Camera camera_;
  SceneModel model_;
  double lift_px_;
};

}  // namespace limn
