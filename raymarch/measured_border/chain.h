#pragma once
// Marching squares over cells of four pixel centres: crossings are joined into directed curves.

#include "raymarch/measured_border/crossings.h"

namespace limn {

/// Curves, and of each of their points how deep the other side lies there.
struct ChainedCurves {
  BorderCurves border{};
  std::vector<std::vector<double>> other_depths{};  ///< World units, infinite where nothing is hit; by curve and point.
};

/// Curves of the crossings, directed as border_curves.h says. Where four crossings of a cell may be joined in two ways, a ray through its
/// middle decides; `rays` counts these. What is thinner than a pixel may come out as closed curves of two points. A curve that ends within
/// a cell (a cusp, a hidden stretch, another object) stays open there.
ChainedCurves chain_crossings(const SceneModel& model, const Camera& camera, const GBuffer& gbuffer, double threshold,
                              const std::vector<BorderCrossing>& crossings, std::int64_t& rays);

}  // namespace limn
