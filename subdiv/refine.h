#pragma once
// Subdivision surfaces by OpenSubdiv: uniform refinement, limit positions, normals and curvature. No OpenSubdiv type leaves the .cpp files.

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "subdiv/mesh.h"

namespace limn {

/// How a cage is subdivided: Catmull and Clark 1978, Loop 1987, or by bilinear interpolation. In the terms of OpenSubdiv.
enum class Scheme { catmark, loop, bilinear };
const char* name_of(Scheme scheme);  ///< "catmark", "loop", "bilinear".
/// What a mesh is subdivided by where nobody says: Loop's where it has triangles only, else Catmull-Clark's.
Scheme default_scheme(const Mesh& mesh);

/// How a cage is refined.
struct RefineSettings {
  Scheme scheme = Scheme::catmark;  ///< `loop` wants triangles.
  int level = 2;                    ///< 0..8; 0 leaves the cage's faces as they are.
  bool to_limit = true;             ///< Vertices moved onto the limit surface (what the renderer wants); false keeps the refined cage.
  NormalKind normals = NormalKind::limit;          ///< Which corner normals the result has; only `limit` fills them.
  std::int64_t max_bytes = std::int64_t{8} << 30;  ///< Refuses (InputError, with the prediction) what would be larger.
  bool keep_holes = false;  ///< Faces with a hole tag stay, tagged: for who subdivides the result further. Else they are left out.
};

/// What a refinement would hold, known before memory is taken.
struct RefinedSize {
  std::int64_t vertices = 0,  ///< Of the refined mesh.
      faces = 0,              ///< Of the refined mesh.
      bytes = 0;              ///< Of the mesh and of what refining it takes.
};
/// Exact for Catmull-Clark, Loop and bilinear: counted from vertices, edges and corners. Level outside 0..8 is an InputError.
RefinedSize predict_refined_size(const Mesh& cage, Scheme scheme, int level);
/// The same of levels 0, ..., most_level: the cage is looked at once.
std::vector<RefinedSize> predict_refined_sizes(const Mesh& cage, Scheme scheme, int most_level);

/// The cage refined uniformly. Corner normals are filled for `limit` (split at infinitely sharp creases) and left empty otherwise.
/// Level 0 with `limit` normals projects the cage's own vertices. Loop wants triangles (others are an InputError naming the first face).
/// Faces keep their material and group. Throws InputError for a level outside 0..8 and for a prediction beyond max_bytes (with the size).
Mesh refine(const Mesh& cage, const RefineSettings& settings, const std::string& file = {});

/// A point of the limit surface with its derivatives by the face's own (u, v); Bfr parametrises n-gons as sub-quads.
struct LimitPoint {
  glm::dvec3 position{0.0},  ///< In the cage's units.
      du{0.0},               ///< First derivative by u.
      dv{0.0},               ///< First derivative by v.
      duu{0.0},              ///< Second derivative by u.
      duv{0.0},              ///< Mixed second derivative.
      dvv{0.0};              ///< Second derivative by v.
};
/// Curvatures from the first and second fundamental forms; positive where the surface bends away from its outward normal (sphere: 1/R).
struct SurfaceCurvature {
  glm::dvec3 normal{0.0};      ///< Unit.
  double k1 = 0.0,             ///< Principal, 1 / unit of length; k1 >= k2.
      k2 = 0.0;                ///< Principal.
  glm::dvec3 direction1{0.0};  ///< Unit, of k1.
};
/// Sets k1, k2 and direction1 from the normal curvature's quadratic form in the orthonormal tangents u and v.
void set_principal(SurfaceCurvature& surface, const glm::dvec3& u, const glm::dvec3& v, double uu, double uv, double vv);
/// Of the surface at a point of it; the normal and all else 0 where du and dv are parallel.
SurfaceCurvature curvature(const LimitPoint& point);
/// Normal curvature along a tangent direction (need not be unit): Euler's formula.
double curvature_along(const SurfaceCurvature& surface, const glm::dvec3& direction);

/// Which derivatives are evaluated; the others are 0.
enum class LimitOrder { first, second };

struct LimitSurfaceData;
/// The limit surface of a cage, evaluated face by face (Bfr). Immutable; evaluation is thread-safe.
class LimitSurface {
 public:
  /// Throws InputError for a cage that the scheme cannot subdivide; `file` goes into the message. The cage is needed no longer afterwards.
  LimitSurface(const Mesh& cage, Scheme scheme, const std::string& file = {});
  /// Of the cage, holes included. After them come the further pieces of faces that pass one of their vertices twice.
  int face_count() const;
  /// A face that is no part of the surface: one of Mesh::holes, one at an open edge under BoundaryRule::none, a collapsed one, a copy.
  bool is_hole(int face) const;
  /// Corners of the parametric domain: 4 for a quad, 3 for a triangle, n sub-quads otherwise.
  int face_size(int face) const;
  /// True where `evaluate` wants a sub-face: n-gons of a scheme made for quads. False without a limit surface.
  bool has_sub_faces(int face) const;
  /// Whether the corner (of the sub-face) of a face is an interior vertex of valence 2. The limit has no tangent plane there: the nearer to
  /// the vertex, the more often its normal swings to and fro.
  bool is_tip(int face, int sub_face, int corner) const;
  /// False where the face has no limit surface: a hole, or a corner where sheets touch whose rules OpenSubdiv mixes. Around extraordinary
  /// vertices the patches approximate the limit (normals within 0.01 degrees where measured), and at the ends of creases (darts) no better
  /// than OpenSubdiv's masks; refine() is exact at its vertices. (u, v) in [0,1]^2 for quads; n-gons: sub-face by corner.
  /// The first derivatives alone take half the time, and have the same bits.
  bool evaluate(int face, int sub_face, double u, double v, LimitPoint& out, LimitOrder order = LimitOrder::second) const;

 private:
  std::shared_ptr<const LimitSurfaceData> data_{};
};

}  // namespace limn
