#pragma once
// An object as triangles, whatever it was: the first step of `mesh` and `mesh_level_set`.

#include <array>
#include <variant>

#include "raymarch/mesh/polygons.h"
#include "raymarch/surface.h"
#include "subdiv/mesh.h"
#include "subdiv/mesh_body.h"
#include "subdiv/tessellate.h"

namespace limn {

/// A face of a refined mesh as a part of a limit surface: the parameters at its corners.
struct LimitPiece {
  int face = 0, sub_face = 0;  ///< As LimitSurface numbers them.
  std::array<glm::dvec2, 4> corners{};
};

/// The cage that a mesh was refined from.
struct CageSource {
  Mesh cage{};
  Scheme scheme = Scheme::catmark;
  int level = 0;
  Affine render_from_cage{};
  bool mirrored = false;             ///< By render_from_cage: the refined faces were turned round.
  std::string file{};                ///< For messages.
  std::vector<LimitPiece> pieces{};  ///< Of each triangle of a local refinement, as it is traced; empty: refined `level` times.
};
/// The smooth surface that a mesh stands for: a field, a limit surface, or none.
using SmoothSource = std::variant<std::monostate, Field, CageSource>;

/// The body that a mesh bounds, once somebody has asked for it.
struct SharedBody {
  std::shared_ptr<const MeshBody> body{};
  double made_ms = 0.0;  ///< What making it took.
};

struct ObjectMesh {
  std::shared_ptr<const TriangleMesh> triangles;  ///< Render space: world minus `render_origin`, in double.
  /// What the triangles came from, in render space too; corner normals only where those are traced. Of a mesh as it is a copy, made only
  /// when somebody asks for it.
  std::shared_ptr<const Polygons> polygons{};
  NormalKind normals = NormalKind::vertex;  ///< Of the triangles.
  SmoothSource smooth{};
  std::vector<std::string> warnings;
  std::vector<std::string> notes{};
  double spared_ms = 0.0;                                                    ///< What making it took, where that was done before and kept.
  std::shared_ptr<SharedBody> shared_body = std::make_shared<SharedBody>();  ///< Of all copies.
};

/// The body of its triangles. Where it was there already, what making it took is added to `spared_ms`. By one thread at a time.
std::shared_ptr<const MeshBody> body_of(ObjectMesh& mesh);

struct LocalStart;  // raymarch/local/local_sources.h

/// What does not depend on how fine a mesh of an object is: its field's cage, and the coarse mesh that local ones are refined from.
struct KeptStart {
  glm::dvec3 render_origin{0.0};
  std::shared_ptr<const FieldCage> cage{};
  std::shared_ptr<const LocalStart> local{};
  double local_ms = 0.0;     ///< What making `local` took, the cage included.
  FieldCages refinements{};  ///< Of `cage`: uniform meshes of all levels and normals start from them.
  bool steady = false;       ///< Of `local`: whether it was made for a path.
};

/// The cage of a field in render space: what is kept for that origin, or a new one, which is kept. Where it was kept, what finding it
/// took is added to `spared_ms`. `kept` may be null.
std::shared_ptr<const FieldCage> kept_cage(const Field& field, const glm::dvec3& render_origin, KeptStart* kept, double& spared_ms);

/// For each object of the scene one for its mesh, and one for what that starts from.
void make_places(const Scene& scene, ObjectMeshCache& cache);

/// A mesh in an ObjectMeshCache, and all that it depends on beside the object.
struct KeptMesh {
  int level = 0;
  std::optional<Scheme> scheme{};
  std::optional<NormalKind> normals{};
  glm::dvec3 render_origin{0.0};
  ObjectMesh mesh{};
};

/// `settings` with the mesh of the only object of a scene in `cache`: who asks for it before build_model makes it for both. As they are
/// without a cache, or of several objects, which are modelled about another origin than their own.
SurfaceSettings keeping_mesh(SurfaceSettings settings, const Scene& scene, ObjectMeshCache* cache);

/// Refines a cage, tessellates a field, meshes a level set, or takes a mesh as it is. A reflection keeps faces wound outwards.
/// What `settings.kept_mesh` holds is taken where it fits; else it holds the new mesh afterwards. Throws InputError as those do.
ObjectMesh object_mesh(const SceneObject& object, const SurfaceSettings& settings, const glm::dvec3& render_origin);

/// The polygons of a cage refined so often, in render space, without normals: what is to know them only by their places has them in a third
/// of the time that an ObjectMesh takes.
std::shared_ptr<const Polygons> refined_polygons(const SceneObject& object, int level, std::int64_t max_bytes,
                                                 const glm::dvec3& render_origin);

/// Of the vertices that triangles use.
Box bounds_of_triangles(const TriangleMesh& mesh);

/// Empty where the object can be meshed, else why not.
std::string cannot_mesh(const SceneObject& object);

}  // namespace limn
