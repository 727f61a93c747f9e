#pragma once

#include <cstdint>

#include "raymarch/surface.h"
#include "sdf/camera.h"
#include "sdf/image.h"

namespace limn {

/// What is seen at each pixel, as plain buffers. Nothing hit: Z and position infinite, normal 0, NdotV 0, id 0.
struct GBuffer {
  int width = 0, height = 0;
  glm::dvec2 sample{0.5, 0.5};  ///< Where in each pixel its ray went.
  Image<float> depth{};         ///< Z along the view axis, world units, > 0 in front of a pinhole.
  Image<glm::vec3> position{};  ///< World.
  Image<glm::vec3> normal{};    ///< World, unit.
  Image<float> n_dot_v{};       ///< saturate(N.V), V the unit vector to the eye.
  Image<std::int32_t> id{};     ///< Object index from 1.
  Image<std::int32_t> material{};
  Image<std::int32_t> face{};    ///< Polygon of a mesh, -1 elsewhere.
  Image<std::uint8_t> status{};  ///< HitStatus.
  Image<glm::vec3>
      custom{};  ///< What the scene fills for edge methods (a section map): vertex colours, face groups, world position; or empty.
  /// Ids of open meshes that show mostly their back: their normals were turned towards the eye (raymarch/open_sheet.h). Rising.
  std::vector<std::int32_t> turned{};
};

/// Which layers of a G-buffer are wanted: what nobody reads is neither computed nor stored, its image stays empty.
struct GBufferLayers {
  bool depth = true, position = true, normal = true, n_dot_v = true, id = true, material = true, face = true, status = true;
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

/// Traces single image points: for tests and for metrics at sub-pixel precision. Sizes equal; `n_dot_v` is not saturated; misses are NaN.
struct PointSample {
  HitStatus status = HitStatus::miss;
  std::int32_t id = 0;
  std::int32_t face = -1;    ///< Polygon of a mesh, -1 elsewhere.
  glm::dvec3 position{0.0};  ///< World.
  glm::vec3 normal{0.0f};
  float n_dot_v = 0.0f;
};
void sample_points(const SceneModel& model, const Camera& camera, std::span<const glm::dvec2> points_px, std::span<PointSample> samples);

struct HitCounts {
  std::int64_t hits = 0, misses = 0, out_of_steps = 0;
};
HitCounts count_hits(const GBuffer& gbuffer);

}  // namespace limn
