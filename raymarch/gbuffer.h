#pragma once
// What a picture shows before any outline is drawn, layer by layer, and single rays for what lies between the pixels.

#include <cstdint>

#include "raymarch/surface.h"
#include "sdf/camera.h"
#include "sdf/image.h"

namespace limn {

/// What is seen at each pixel, as plain buffers. Nothing hit: Z and position infinite, normal 0, NdotV 0, id 0.
struct GBuffer {
  int width = 0,                   ///< Pixels.
      height = 0;                  ///< Pixels; every layer that is not empty has this size.
  glm::dvec2 sample{0.5, 0.5};     ///< Where in each pixel its ray went.
  Image<float> depth{};            ///< Z along the view axis, world units, > 0 in front of a pinhole.
  Image<glm::vec3> position{};     ///< World.
  Image<glm::vec3> normal{};       ///< World, unit.
  Image<float> n_dot_v{};          ///< saturate(N.V), V the unit vector to the eye.
  Image<std::int32_t> id{};        ///< Object index from 1.
  Image<std::int32_t> material{};  ///< Of the object, plus the surface's own; 0 where nothing is hit.
  Image<std::int32_t> face{};      ///< Polygon of a mesh, -1 elsewhere.
  Image<std::uint8_t> status{};    ///< HitStatus.
  /// What the scene fills for edge methods (a section map): vertex colours, face groups, world position; or empty.
  Image<glm::vec3> custom{};
  /// Ids of open meshes that show mostly their back: their normals were turned towards the eye (raymarch/mesh/open_sheet.h). Rising.
  std::vector<std::int32_t> turned{};
};

/// Which layers of a G-buffer are wanted: what nobody reads is neither computed nor stored, its image stays empty.
struct GBufferLayers {
  bool depth = true,    ///< GBuffer::depth.
      position = true,  ///< GBuffer::position.
      normal = true,    ///< GBuffer::normal.
      n_dot_v = true,   ///< GBuffer::n_dot_v.
      id = true,        ///< GBuffer::id.
      material = true,  ///< GBuffer::material.
      face = true,      ///< GBuffer::face.
      status = true;    ///< GBuffer::status.
};

/// What a picture's pixels must not depend on.
struct ExecutionSettings {
  int threads = 0;                         ///< 0: all.
  int tile_px = 16;                        ///< Side of a square tile, 1..16 (a tile is one ray batch).
  std::function<void(double)> progress{};  ///< 0..1, from one thread at a time; may be empty.
  std::function<bool()> cancelled{};       ///< Polled for each tile; true throws Cancelled.
};

/// Thrown out of long work when ExecutionSettings::cancelled says so.
struct Cancelled {};

/// Traces one ray through (x + offset.x, y + offset.y) for each pixel (x, y); the default is the centre. The same bytes for any threads and
/// tiles.
GBuffer render_gbuffer(const SceneModel& model, const Camera& camera, const ExecutionSettings& how, glm::dvec2 offset = {0.5, 0.5});
/// The same into `out`, whose memory is used again where its images have the right size.
void render_gbuffer(const SceneModel& model, const Camera& camera, const ExecutionSettings& how, glm::dvec2 offset,
                    const GBufferLayers& layers, GBuffer& out);

/// What a ray through one image point hits. Without a hit, `position` and `n_dot_v` are NaN and the rest is as it is here.
struct PointSample {
  HitStatus status = HitStatus::miss;  ///< Only a hit has a point.
  std::int32_t id = 0;                 ///< Object index from 1.
  std::int32_t face = -1;              ///< Polygon of a mesh, -1 elsewhere.
  glm::dvec3 position{0.0};            ///< World.
  glm::vec3 normal{0.0f};              ///< World, unit.
  float n_dot_v = 0.0f;                ///< N.V, negative where the surface shows its back.
};
/// How rays through single image points are traced.
enum class PointRays : std::uint8_t {
  one_by_one,  ///< Each by itself; a level set's in double precision.
  in_packets   ///< As pictures are traced: many times as quick for level sets, whose hits then are a picture's own.
};
/// Makes what rays through single image points need, such as trees, by all threads: for before a loop over sample_points(), which would
/// leave it to one thread while the others wait.
void prepare_points(const SceneModel& model);
/// Traces single image points: for tests and for metrics at sub-pixel precision. Sizes equal.
void sample_points(const SceneModel& model, const Camera& camera, std::span<const glm::dvec2> points_px, std::span<PointSample> samples,
                   PointRays rays = PointRays::one_by_one);

/// Pixels by what became of their ray.
struct HitCounts {
  std::int64_t hits = 0,  ///< HitStatus::hit.
      misses = 0,         ///< HitStatus::miss.
      out_of_steps = 0;   ///< HitStatus::out_of_steps.
};
/// Reads the layer `status`.
HitCounts count_hits(const GBuffer& gbuffer);

}  // namespace limn
