#pragma once
// Curvature at the hits of a traced mesh, from the smooth surface that it stands for where there is one.

#include <mutex>
#include <variant>

#include "raymarch/scene/curvature.h"
#include "raymarch/surface/object_mesh.h"
#include "sdf/field.h"

namespace limn {

/// Made when first asked for, then kept; thread-safe. Refers to the mesh and the polygons it was made for.
class MeshCurvature {
 public:
  /// `polygons` are those that `triangles` came from, traced with `normals`.
  MeshCurvature(const TriangleMesh& triangles, const Polygons& polygons, NormalKind normals, SmoothSource source);
  ~MeshCurvature();

  /// As CurvatureSource::evaluate.
  void evaluate(std::span<const SurfacePoint> points, std::span<SurfaceCurvature> curvatures) const;
  /// What is taken, in words; or why there is none.
  std::string from() const;
  bool available() const;

 private:
  struct Made;
  const TriangleMesh& triangles_;
  const Polygons& polygons_;
  NormalKind normals_;
  SmoothSource source_;
  mutable std::once_flag once_;
  mutable std::unique_ptr<const Made> made_;
};

}  // namespace limn
