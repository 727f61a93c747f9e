#pragma once
// Internal: curves N.V = c on surface that has two derivatives everywhere, followed along their tangents from the crossings that cells
// found: where a curve turns within a cell, or two arms of it run through one, its crossings may be joined in the wrong way.

#include "raymarch/truth/strands.h"

namespace limn {

struct FollowSettings {
  double tolerance_px = 0.005;
  double longest_step = 1.0;  ///< World units: the size of what the surface resolves.
};

/// Each closed curve that goes by a point of a strand, once. Points may lie a little off the curve. Strands by whose points none is found
/// stay as they are, with their points brought onto the curve; those of a single point are left out. `field` is that of the strands'
/// branch.
std::vector<Strand> follow_strands(std::vector<Strand> found, const Field& field, const Camera& camera, const Viewer& viewer,
                                   const FollowSettings& settings, const ExecutionSettings& how);

}  // namespace limn
