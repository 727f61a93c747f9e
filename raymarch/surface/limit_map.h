#pragma once
// Internal: from the faces of a refined cage to the parameters of its limit surface.

#include "raymarch/surface/object_mesh.h"
#include "subdiv/refine.h"

namespace limn {

/// A limit surface and the way from a refined face to its parameters. Refinement numbers the children of each face in a row, face by face.
class LimitMap {
 public:
  LimitMap(const Mesh& cage, Scheme scheme, int level, const std::string& file);
  /// Whether a mesh of so many faces can be the refinement: faces that it leaves out (collapsed ones) shift the numbers of all others.
  bool maps(size_t refined_faces) const { return first_child_.back() == static_cast<std::int64_t>(refined_faces); }
  /// False where a face has no parameters: an n-gon that is not refined.
  bool piece_of(std::int32_t refined_face, LimitPiece& piece) const;

  LimitSurface surface;

 private:
  std::vector<std::int32_t> face_sizes_{};
  std::vector<std::int64_t> first_child_{};  ///< Of each face of the cage, with one past the end.
  Scheme scheme_;
  int level_;
};

}  // namespace limn
