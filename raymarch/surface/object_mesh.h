#pragma once
// An object as triangles, whatever it was: the first step of `mesh` and `mesh_level_set`.

#include "raymarch/surface.h"
#include "subdiv/mesh.h"

namespace limn {

struct ObjectMesh {
  TriangleMesh triangles;  ///< Render space: world minus `render_origin`, in double.
  Mesh polygons{};         ///< What the triangles came from, in render space too; corner normals only where those are traced.
  NormalKind normals = NormalKind::vertex;  ///< Of the triangles.
  std::vector<std::string> warnings;
};

/// Refines a cage, tessellates a field, meshes a level set, or takes a mesh as it is. A reflection keeps faces wound outwards.
/// Throws InputError as those do.
ObjectMesh object_mesh(const SceneObject& object, const SurfaceSettings& settings, const glm::dvec3& render_origin);

/// Empty where the object can be meshed, else why not.
std::string cannot_mesh(const SceneObject& object);

}  // namespace limn
