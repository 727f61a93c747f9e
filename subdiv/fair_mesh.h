#pragma once
// Fairing: the short waves of a mesh, such as a scan's noise, are smoothed away, and the long ones stay.

#include "subdiv/mesh.h"

namespace limn {

/// The positions of the vertices of a mesh of triangles, of whose waves those as long as `wavelength` (above 0, the mesh's units) keep
/// half of their height, those twice as long 0.94 and those half as long 0.06: the low-pass filter of implicit fairing (Desbrun, Meyer,
/// Schroeder & Barr 1999, "Implicit fairing of irregular meshes using diffusion and curvature flow") with the square of the Laplacian.
/// Creases of infinite sharpness and open edges are faired along themselves; where they end or more than two of them meet they stay.
std::vector<glm::dvec3> faired_positions(const Mesh& triangles, double wavelength);

/// Moves the vertices of a mesh of triangles there, `edges` times its mean edge being the wavelength, and takes back creases that are
/// shorter than that. Returns how far a vertex moved at most.
double fair(double edges, Mesh& triangles);

/// The mean length of the edges of a mesh of triangles, each counted once for each of its faces; 0 for a mesh without faces.
double mean_edge(const Mesh& triangles);

}  // namespace limn
