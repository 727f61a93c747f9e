#pragma once
// Lines of meshes as the smooth surfaces that their vertex normals describe.

#include "raymarch/lines/surface_curves.h"

namespace limn {

/// Contours where the interpolated N.V is 0; open edges, creases and edges of materials as they are.
LineContribution smooth_mesh_lines(const LineTask& task, const std::vector<size_t>& objects);

}  // namespace limn
