#pragma once
// Curvature of surfaces from what representations know: a field's Hessian, a limit surface's derivatives, a mesh's normals. Positive where
// the surface bends away from its outward normal, as everywhere in limn.

#include "raymarch/surface.h"
#include "sdf/field.h"

namespace limn {

/// k1 and k2 NaN: where there is no curvature.
SurfaceCurvature no_curvature();

/// Of the surface across the unit `normal`, from a symmetric tensor whose quadratic form is the normal curvature along unit tangents.
SurfaceCurvature curvature_of_tensor(const glm::dmat3& tensor, const glm::dvec3& normal);

/// Of the level set through the jet's point: the tensor is the Hessian over |grad f| (Goldman 2005). Without a gradient: no_curvature().
SurfaceCurvature curvature_of_jet(const FieldJet& jet);

/// The same surface seen from its other side where its normal disagrees with `outward`.
SurfaceCurvature facing(SurfaceCurvature surface, const glm::dvec3& outward);

/// Curvature tensors of a triangle mesh at its corners, from the differences of normals along edges (Rusinkiewicz 2004). Corners of one
/// vertex share a tensor where they share their normal, so that creases stay sharp.
struct CornerTensors {
  std::vector<std::uint32_t> of_corner{};  ///< Three for each triangle: index into `tensors`.
  std::vector<glm::dmat3> tensors{};
};
/// `mesh.corner_normals` must be there.
CornerTensors corner_tensors(const TriangleMesh& mesh);

}  // namespace limn
