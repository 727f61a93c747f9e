#pragma once
// The surface seam: batches of rays in, batches of hits out. A representation is one file in raymarch/surface/ and one registry line.

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "raymarch/scene.h"
#include "sdf/camera.h"
#include "sdf/registry.h"

namespace limn {

/// Most rays of a batch: a tile of 16 x 16 pixels.
inline constexpr int kRayBatchSize = 256;
/// Rays of one tile, in render space: world axes, origin at the scene's centre (so that float keeps its digits wherever the scene is).
struct RayBatch {
  int count = 0;                                 ///< At most kRayBatchSize; lanes beyond it hold no meaning.
  alignas(64) float origin_x[kRayBatchSize],     ///< Render space.
      origin_y[kRayBatchSize],                   ///< Render space.
      origin_z[kRayBatchSize];                   ///< Render space.
  alignas(64) float direction_x[kRayBatchSize],  ///< Unit.
      direction_y[kRayBatchSize],                ///< Unit.
      direction_z[kRayBatchSize];                ///< Unit.
  alignas(64) float t_min[kRayBatchSize];        ///< World units from the origin; a hit lies in [t_min, t_max).
  alignas(64) float t_max[kRayBatchSize];        ///< No more than t_min: the lane is idle.
  /// Fills lane `i` (0..kRayBatchSize - 1); `first` and `last` become t_min and t_max.
  void set(int i, const glm::dvec3& origin, const glm::dvec3& direction, double first, double last) {
    origin_x[i] = static_cast<float>(origin.x), origin_y[i] = static_cast<float>(origin.y), origin_z[i] = static_cast<float>(origin.z);
    direction_x[i] = static_cast<float>(direction.x), direction_y[i] = static_cast<float>(direction.y);
    direction_z[i] = static_cast<float>(direction.z);
    t_min[i] = static_cast<float>(first), t_max[i] = static_cast<float>(last);
  }
  glm::vec3 origin(int i) const { return {origin_x[i], origin_y[i], origin_z[i]}; }              ///< Of lane `i`.
  glm::vec3 direction(int i) const { return {direction_x[i], direction_y[i], direction_z[i]}; }  ///< Of lane `i`.
};

/// What became of a ray. One that ran out of steps is neither a hit nor a miss.
enum class HitStatus : std::uint8_t { miss = 0, hit = 1, out_of_steps = 2 };

/// Hits of a batch. A surface writes a lane only where it found a hit nearer than t_max (or ran out of steps there).
struct HitBatch {
  alignas(64) float t[kRayBatchSize];         ///< World units from the ray's origin.
  alignas(64) float normal_x[kRayBatchSize],  ///< Unit, outwards.
      normal_y[kRayBatchSize],                ///< Unit, outwards.
      normal_z[kRayBatchSize];                ///< Unit, outwards.
  std::int32_t face[kRayBatchSize];           ///< Polygon of a mesh, -1 elsewhere.
  std::int32_t material[kRayBatchSize];       ///< Added to the object's own; 0 where the surface has none.
  HitStatus status[kRayBatchSize];            ///< Set to `miss` by the caller.
};

/// A tile of a picture whose rays make up one batch, sixteen lanes a block of 4 x 4 pixels: block by block in rows, row by row in a block.
/// Lanes outside the picture have t_max <= t_min. Tiles are at most 16 x 16, and start anywhere.
struct PixelTile {
  int x = 0,       ///< Of the left pixel.
      y = 0,       ///< Of the top pixel.
      width = 0,   ///< Pixels, at most 16.
      height = 0;  ///< Pixels, at most 16.
};

/// The coherent rays of one picture: what a surface may prepare for all of its tiles at once.
struct ViewRequest {
  Camera camera{};              ///< Eye in render space.
  glm::dvec2 sample{0.5, 0.5};  ///< Where in each pixel its ray goes; of several samples at once the middle.
  glm::dvec2 spread{0.0};       ///< How far several samples lie to either side of it, px. 0 unless the surface `traces_samples`.
};

/// One sample of a tile's pixels: its rays, and what they hit.
struct SampleHits {
  const RayBatch* rays = nullptr;  ///< Not null.
  HitBatch* hits = nullptr;        ///< Not null.
};

/// A surface prepared for one picture (lists of what each tile sees). Immutable; read from many threads at a time.
struct SurfaceView {
  std::shared_ptr<const void> state{};  ///< Handed to the functions below; null where there is no view.
  /// False where no ray of the tile can meet the surface. May be null: any may.
  bool (*touches)(const void* state, const PixelTile& tile) = nullptr;
  /// As Surface::trace, for the rays of one tile. Null: Surface::trace is as good.
  void (*trace)(const void* state, const PixelTile& tile, const RayBatch& rays, HitBatch& hits) = nullptr;
  /// As `trace`, for several samples of the tile's pixels, which share what beams of pixels tell. Null where Surface::traces_samples is
  /// false.
  void (*trace_samples)(const void* state, const PixelTile& tile, std::span<const SampleHits> samples) = nullptr;
};

/// What building it cost and how large it came out.
struct SurfaceInfo {
  std::string kind{};                   ///< The representation's name; "mixed" for several (total()).
  double voxel_size = 0.0;              ///< World; 0 where there is no grid.
  std::int64_t voxels = 0;              ///< Active ones.
  std::int64_t triangles = 0;           ///< 0 where there are none.
  std::int64_t bytes = 0;               ///< All that the surface keeps.
  double build_ms = 0.0;                ///< Wall clock.
  std::int64_t ray_bytes = 0;           ///< Of `bytes`, what rays read (a level set's ray-ready form).
  double prepare_ms = 0.0;              ///< Of `build_ms`, making that.
  std::vector<std::string> warnings{};  ///< What a person should know before trusting the picture, a sentence each.
  std::vector<std::string> notes{};     ///< What is good to know and no reason to worry: how far a resampled volume lies from its file.
};

class Polygons;    // raymarch/mesh/polygons.h
class OpenSheet;   // raymarch/mesh/open_sheet.h
struct RayBricks;  // raymarch/level_set/bricks.h

/// A point of a surface whose curvature is asked for.
struct SurfacePoint {
  glm::dvec3 position{0.0};  ///< Render space, as near to the surface as float hits are.
  glm::dvec3 normal{0.0};    ///< Unit, outwards, as traced.
  std::int32_t face = -1;    ///< HitBatch's.
};

/// Where a surface's curvature comes from.
struct CurvatureSource {
  std::shared_ptr<const void> state{};  ///< Handed to `evaluate`.
  /// Curvatures in render space; NaN k1 and k2 where a point has none. Sizes equal. Called once a batch of points of any size, from many
  /// threads at a time. Null where the representation has none.
  void (*evaluate)(const void* state, std::span<const SurfacePoint> points, std::span<SurfaceCurvature> curvatures) = nullptr;
  std::string from{};  ///< What it is taken from, in words; where there is none, why not.
};

/// How far an offset surface stands off at a point of render space, world units: everywhere the same, or as many pixels at the point.
struct OffsetWidth {
  double world = 0.0;  ///< World units; what `per_depth` gives is added.
  /// Tangent of the angle that a pixel-width spans on the axis (px / focal_px); 0: none.
  double per_depth = 0.0;
  glm::dvec3 eye{0.0},          ///< Of the camera, render space; read where `per_depth` is not 0.
      backward{0.0, 0.0, 1.0};  ///< Of the camera, unit: from what is seen towards the eye.

  /// The width at a point of render space, world units.
  double at(const glm::dvec3& p) const {
    if (per_depth == 0.0) return world;
    const glm::dvec3 from_eye = p - eye;
    const double z = -glm::dot(from_eye, backward), distance = glm::length(from_eye);
    // The tangent plane at a contour point holds the eye; moved by w, it moves in the image by f w / (z |n_xy|), n_xy being the part of its
    // normal across the axis. Towards and away from the picture's middle |n_xy| is z / distance.
    return distance > 0.0 ? world + per_depth * z * std::abs(z) / distance : world;
  }
  bool zero() const { return world == 0.0 && per_depth == 0.0; }  ///< True where the offset surface is the surface itself.
  /// No smaller than |grad at| anywhere.
  double slope_bound() const { return 3.0 * per_depth; }
};

/// The surfaces at a distance from one that knows distances. Its trace finds the first place, in either direction, where the distance
/// crosses the width.
struct SurfaceOffset {
  std::shared_ptr<const void> state{};  ///< Handed to `make`.
  /// Null where the surface has no distances. Throws InputError where they do not reach that far.
  struct Surface (*make)(const void* state, const OffsetWidth& width) = nullptr;
};

/// Which places of an offset surface are asked for, and how finely.
struct MeetingRequest {
  Camera camera{};           ///< Eye in render space.
  bool facing_away = false;  ///< Only where it is met from its inside: N . direction >= 0.
  double side_px = 8.0;      ///< Boxes are divided until their sides are no longer in the picture.
  /// False for a box that is good as it is, however long. Called from many threads at a time; may be empty.
  std::function<bool(const Box&)> is_divided{};
};

/// One object, modelled. `trace` is called once for each batch and from many threads at a time; scratch memory is the callee's, on its
/// stack or per call.
struct Surface {
  std::shared_ptr<const void> state{};  ///< Handed to the functions below.
  /// Finds the first hit of each ray in [t_min, t_max). Never null in a surface that was built.
  void (*trace)(const void* state, const RayBatch& rays, HitBatch& hits) = nullptr;
  /// The same as pictures are traced: in packets, in single precision, for rays anywhere. Null: `trace` is as quick.
  void (*trace_packets)(const void* state, const RayBatch& rays, HitBatch& hits) = nullptr;
  /// Of an offset surface: boxes (render space) that hold all places where rays from the camera's eye meet it. Null: anywhere.
  std::vector<Box> (*where_met)(const void* state, const MeetingRequest& request) = nullptr;
  /// Makes what both need for rays anywhere, on the threads of the surrounding arena: in a loop over such rays the first would make it
  /// while all others wait. Null: nothing to make.
  void (*prepare)(const void* state) = nullptr;
  /// Prepares for a picture, on the threads of the surrounding arena. Null: nothing to prepare.
  SurfaceView (*view)(const std::shared_ptr<const void>& state, const ViewRequest& request) = nullptr;
  bool traces_samples = false;                 ///< `view` takes requests of several samples, and makes views that trace them together.
  Box bounds{};                                ///< Render space; infinite where the object is.
  SurfaceInfo info{};                          ///< See SurfaceInfo.
  std::shared_ptr<const Polygons> polygons{};  ///< What is traced, where it is made of polygons.
  std::shared_ptr<const RayBricks> bricks{};   ///< What is traced, where it is made of bricks.
  std::optional<LevelSet> level_set{};         ///< What is traced, in render space, where it is a grid made from the scene's object.
  /// What may have open edges, and in a picture that shows mostly its back has its normals turned towards the eye. Null: never.
  std::shared_ptr<const OpenSheet> open_sheet{};
  SurfaceOffset offset{};       ///< Null `make` where the representation knows no distances.
  CurvatureSource curvature{};  ///< Null `evaluate` where the representation has none.
};

struct FieldScratch;  // raymarch/analytic/tile.h: memory for threads, the same for all fields of a model
struct KeptMesh;      // raymarch/surface/object_mesh.h
struct KeptStart;     // raymarch/surface/object_mesh.h
/// Meshes of a scene's objects, the last one made of each: `mesh` and `mesh_level_set` start from the same. Owned by whoever models one
/// scene several times; used by one build_model at a time, and for one scene only (levels may differ).
struct ObjectMeshCache {
  std::vector<std::shared_ptr<const KeptMesh>> kept{};  ///< One an object; empty at first.
  std::vector<std::shared_ptr<KeptStart>> starts{};     ///< What meshes of any level start from, one an object; empty at first.
};

/// How to model, whatever the object. What a representation does not use is ignored by it.
struct SurfaceSettings {
  std::string kind = "analytic";                   ///< A name in surface_kinds(); empty: each object's natural one.
  int voxels = 256;                                ///< Along the longest side of the object's bounds; used where voxel_size is 0.
  double voxel_size = 0.0;                         ///< World; overrides `voxels`.
  double half_width_voxels = 0.0;                  ///< 0: what the gradient needs.
  std::string gradient = "central";                ///< A name in gradients().
  int level = 3;                                   ///< Subdivision or tessellation level.
  std::optional<Scheme> scheme{};                  ///< Overrides the objects'.
  std::optional<NormalKind> normals{};             ///< Unset: limit where there is a limit surface or a field, else vertex.
  bool resample_volumes = false;                   ///< Volumes take `voxels` and `voxel_size` too; else they are modelled as they are.
  std::int64_t max_bytes = std::int64_t{8} << 30;  ///< Refuses (InputError, with the estimate) what would be larger.
  int max_steps = 10'000;                          ///< Per ray; beyond it the pixel's status is out_of_steps.
  std::function<void(double)> progress{};          ///< 0..1 while building; may be empty.
  std::shared_ptr<const KeptMesh>* kept_mesh = nullptr;  ///< Of the object, in a cache: build_model sets it. May be null.
  std::shared_ptr<KeptStart> kept_start{};               ///< The same. May be empty.
  std::shared_ptr<FieldScratch> field_scratch{};         ///< build_model sets it. Empty: each field has its own.
};

/// A representation: a file in raymarch/surface/ and a line in its registry.
struct SurfaceDescriptor {
  Description about{};                  ///< Name, help and source.
  std::vector<std::string> settings{};  ///< The fields of SurfaceSettings it reads, as command-line names ("voxels", "gradient").
  /// Empty where it can model the object, else the reason why not, for a recorded skip or an error.
  std::string (*unsupported)(const SceneObject& object);
  /// Throws InputError. `render_origin` (world) is subtracted in double precision before anything becomes float.
  Surface (*build)(const SceneObject& object, const SurfaceSettings& settings, const glm::dvec3& render_origin);
};

/// All representations, in the order of raymarch/surface/all_surfaces.cpp.
const Registry<SurfaceDescriptor>& surface_kinds();
/// Throws InputError naming the nearest known representation. `file` and `field` go into the message.
inline const SurfaceDescriptor& find_surface(const std::string& name, const std::string& file = {}, const std::string& field = {}) {
  return surface_kinds().find(name, file, field);
}
/// The representation a source is closest to: analytic, mesh or level_set.
std::string natural_surface(const SceneObject& object);

/// A whole scene, modelled.
struct SceneModel {
  std::vector<Surface> surfaces{};  ///< One for each object, in order.
  std::vector<glm::vec3> colors{};  ///< Linear, one for each object.
  std::vector<int> materials{};     ///< One for each object.
  glm::dvec3 render_origin{0.0};    ///< World.
  Box bounds{};                     ///< World, of the bounded objects.
};

/// Models every object. `settings.kind` empty: each in its natural representation. Throws InputError where one cannot be.
/// `cache` spares meshing what was meshed before, and finding what meshes start from (build_ms counts it all the same); may be null.
SceneModel build_model(const Scene& scene, const SurfaceSettings& settings, ObjectMeshCache* cache = nullptr);

/// What the model traces, as a scene of its own: grids and polygons in place of what they were made from. A cage stays a cage, since what
/// is traced stands for its limit surface. Objects keep their names, colours and materials.
Scene modelled_scene(const Scene& scene, const SceneModel& model);

/// Sums of bytes, build times and so on; `kind` is the common one or "mixed".
SurfaceInfo total(const SceneModel& model);

}  // namespace limn
