#pragma once
// Internal: where curves pass behind folds and open edges in the image.

#include "raymarch/lines/surface_curves.h"

namespace limn {

struct NearerCrossing {
  double at = 0.0;          ///< Place on the curve behind: index of the step plus the share of it.
  int layers = 0;           ///< How many layers it adds to what lies in front of the curve, walking along.
  std::uint32_t curve = 0;  ///< In front.
  double on_nearer = 0.0;   ///< Place on it.
};

/// Of each curve, in order along it.
std::vector<std::vector<NearerCrossing>> nearer_crossings(const std::vector<SurfaceCurve>& curves, const Camera& camera);

}  // namespace limn
