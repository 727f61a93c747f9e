#pragma once
// What is to be drawn: objects and a camera, before anyone has decided how to model them.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "sdf/camera.h"
#include "sdf/level_set.h"
#include "sdf/shape.h"
#include "subdiv/mesh.h"
#include "subdiv/refine.h"

namespace limn {

/// A mesh that is never changed, so that scenes, models and methods hold one copy between them. It reads as a `const Mesh&`; who wants
/// another takes a copy, changes that, and assigns it.
class SharedMesh {
 public:
  /// A mesh without faces.
  SharedMesh() : mesh_(std::make_shared<const Mesh>()) {}
  /// Shares a mesh that somebody else holds too; not null.
  explicit SharedMesh(std::shared_ptr<const Mesh> mesh) : mesh_(std::move(mesh)) {}
  /// Takes the mesh over.
  SharedMesh(Mesh mesh) : mesh_(std::make_shared<const Mesh>(std::move(mesh))) {}  // NOLINT: as a Mesh in braces
  /// The mesh; valid as long as a copy of this is.
  operator const Mesh&() const { return *mesh_; }  // NOLINT: where a Mesh is read
  /// The mesh; valid as long as a copy of this is.
  const Mesh& operator*() const { return *mesh_; }
  /// The mesh, never null; valid as long as a copy of this is.
  const Mesh* operator->() const { return mesh_.get(); }

 private:
  std::shared_ptr<const Mesh> mesh_;
};

/// A subdivision cage (`scheme` set) or a mesh taken as it is (`scheme` empty: level 0, its own facets).
struct MeshSource {
  SharedMesh mesh{};               ///< As loaded, its inverted parts turned round.
  std::optional<Scheme> scheme{};  ///< Set for a cage.
  std::string file{};              ///< For messages.
  std::int64_t turned_parts = 0;   ///< Parts that came inside out and were turned round, for the audit to tell.
  /// Without a scheme: vertex normals are averaged across edges up to this angle, whatever the file says. Unset: the file's own normals,
  /// else its smoothing groups, else kSmoothAngle_deg.
  std::optional<double> smooth_angle_deg{};
};
/// MeshSource::smooth_angle_deg where neither the caller nor the file says anything.
inline constexpr double kSmoothAngle_deg = 30.0;

/// An object from a mesh: a cage where `scheme` is set or the mesh has subdivision tags (by default_scheme), else the mesh as it is; what
/// is inside out is turned round (subdiv/face_orientation.h). `file` goes into messages.
MeshSource mesh_source(Mesh mesh, std::optional<Scheme> scheme, const std::string& file);

/// A volume, as read from a file or built.
struct LevelSetSource {
  LevelSet level_set;  ///< Where it stands before SceneObject::world_from_object.
  std::string file{};  ///< For messages.
};

/// One object: a shape and where it stands.
struct SceneObject {
  std::string name{};                                      ///< For messages and captions; need not be unique.
  std::variant<Field, MeshSource, LevelSetSource> source;  ///< A closed set: what files and shapes can give.
  Affine world_from_object{};         ///< Applied to meshes and level sets; a Field has its transforms folded in (identity here).
  glm::vec3 color{0.8f, 0.8f, 0.8f};  ///< Linear.
  int material = 0;                   ///< For material edges; mesh faces with materials of their own add their index to it.
  std::optional<int> level{};         ///< Subdivision level of this object, over the settings'.
};

/// Objects and a camera.
struct Scene {
  std::string name{};                  ///< For captions and the names of outputs.
  CameraSettings camera{};             ///< What it leaves open is framed from bounds().
  std::vector<SceneObject> objects{};  ///< Ids in a G-buffer are indices into it plus 1.
};

/// World bounds of one object's surface; infinite where it has no end.
Box bounds(const SceneObject& object);
/// World bounds of all objects. Unbounded fields (planes) count as empty, so they are not framed.
Box bounds(const Scene& scene);

}  // namespace limn
