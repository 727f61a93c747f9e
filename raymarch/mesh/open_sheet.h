#pragma once
// Open meshes seen from behind. What has no inside has no outside either: where a picture shows mostly the back of such a mesh, its normals
// are turned towards the eye, as those of a sheet with two sides; else N.V would be below 0 everywhere and all of it border.

#include <mutex>
#include <optional>
#include <span>

#include "raymarch/surface.h"

namespace limn {

/// The decision for one mesh, picture by picture: it depends on the mesh and the camera alone, not on the picture's size, its samples, its
/// other objects, tiles or threads. May be asked from many threads.
class OpenSheet {
 public:
  /// The surface's camera stands in render space. True where the mesh has open edges and more than half of what is seen of it (without
  /// what stands before it) is its back.
  bool shows_back(const Surface& surface, const Camera& camera) const;

 private:
  mutable std::mutex mutex_;
  mutable std::optional<Camera> camera_{};  ///< Asked for last.
  mutable bool shows_back_ = false;
};

/// For each surface of the model whether its normals are turned towards the eye in a picture. Empty: none is.
std::vector<char> turned_surfaces(std::span<const Surface> surfaces, const Camera& camera);

}  // namespace limn
