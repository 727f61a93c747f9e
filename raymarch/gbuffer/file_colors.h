#pragma once
// The colours that files give to their meshes (Mesh::material_colors times vertex_colors) and scenes to parts of their fields, drawn
// instead of the objects' own.

#include "raymarch/gbuffer.h"
#include "subdiv/mesh.h"

namespace limn {

/// A face's vertex colour at a point of it: mean value coordinates (Floater 2003), which are linear along edges and meet the vertices
/// exactly.
glm::vec3 vertex_color_at(const Mesh& mesh, std::int32_t first_corner, std::int32_t corners, const glm::dvec3& point);

class FieldParts;  // sdf/field_tree.h

struct FileColors {
  /// One an object; null where its own color is drawn.
  std::vector<const Mesh*> meshes{};
  /// One an object; null where no part of it has a colour of its own.
  std::vector<const FieldParts*> parts{};
  bool any = false, any_of_vertices = false, any_of_parts = false;
};
/// Refers to the model's meshes and fields. Asks nothing of models without colours.
FileColors file_colors(const SceneModel& model);

/// The layers that finding the colours reads, beside those that shading reads anyway.
GBufferLayers layers_read(const FileColors& colors);

/// Of each pixel that shows such a mesh or part: its colour. Elsewhere, and where a layer is missing, `result` stays as it is.
void find_file_colors(const FileColors& colors, const GBuffer& gbuffer, const Camera& camera, const glm::dvec3& render_origin,
                      Image<glm::vec3>& result);

}  // namespace limn
