#include "raymarch/gbuffer/gbuffer_tile.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "raymarch/gbuffer/gbuffer_lanes.h"
#include "raymarch/gbuffer/stream_fill.h"

namespace limn {
namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();

/// Calls `value(lane)` for each pixel of the tile and stores what it returns.
template <class T, class Value>
void write_layer(Image<T>& image, const PixelTile& tile, const Value& value) {
  if (image.pixels.empty()) return;
  for (int y = 0; y < tile.height; ++y) {
    T* const row = &image.pixels[image.index(tile.x, tile.y + y)];
    for (int x = 0; x < tile.width; x += 4) {
      const int lane = lane_of(tile, x, y);
      for (int k = 0; k < std::min(4, tile.width - x); ++k) row[x + k] = value(lane + k);
    }
  }
}

/// The same from values at hand, four at a time.
template <class T>
void copy_layer(Image<T>& image, const PixelTile& tile, const T* lanes) {
  if (image.pixels.empty()) return;
  const int whole = tile.width / 4, rest = tile.width % 4;
  for (int y = 0; y < tile.height; ++y) {
    T* const row = &image.pixels[image.index(tile.x, tile.y + y)];
    const T* const from = lanes + lane_of(tile, 0, y);
    for (int x = 0; x < whole; ++x)
      std::memcpy(row + 4 * x, from + 16 * x, 4 * sizeof(T));  // std::copy_n calls memmove, which takes longer than the copy
    std::copy_n(from + 16 * whole, rest, row + 4 * whole);
  }
}

}  // namespace

void write_nothing(const TileWriter& writer, const PixelTile& tile) {
  GBuffer& out = *writer.out;
  fill_rows(out.depth, tile, kFar);
  fill_rows(out.position, tile, glm::vec3(kFar));
  fill_rows(out.normal, tile, glm::vec3(0.0f));
  fill_rows(out.n_dot_v, tile, 0.0f);
  fill_rows(out.id, tile, 0);
  fill_rows(out.material, tile, 0);
  fill_rows(out.face, tile, -1);
  fill_rows(out.status, tile, static_cast<std::uint8_t>(HitStatus::miss));
}

void write_tile(const TileWriter& writer, const PixelTile& tile, const RayBatch& rays, const SceneHits& found) {
  GBuffer& out = *writer.out;
  const HitBatch& hits = found.hits;
  const auto seen = [&](int i) { return found.object[i] >= 0; };
  LaneLayers lanes;
  const GBufferLayers wanted{
      .depth = !out.depth.pixels.empty(), .normal = !out.normal.pixels.empty(), .n_dot_v = !out.n_dot_v.pixels.empty()};
  lane_layers(rays, found, {writer.forward, writer.shift}, wanted, lanes);
  copy_layer(out.depth, tile, lanes.depth);
  copy_layer(out.normal, tile, lanes.normal);
  copy_layer(out.n_dot_v, tile, lanes.n_dot_v);
  write_layer(out.position, tile, [&](int i) {
    if (!seen(i)) return glm::vec3(kFar);
    const glm::dvec3 p = glm::dvec3(rays.origin(i)) + static_cast<double>(hits.t[i]) * glm::dvec3(rays.direction(i));
    return glm::vec3(p + writer.model->render_origin);
  });
  if (!out.id.pixels.empty()) {
    alignas(64) std::int32_t ids[kRayBatchSize];
    for (int i = 0; i < rays.count; ++i) ids[i] = found.object[i] + 1;
    copy_layer(out.id, tile, ids);
  }
  write_layer(out.material, tile,
              [&](int i) { return seen(i) ? writer.model->materials[static_cast<size_t>(found.object[i])] + hits.material[i] : 0; });
  write_layer(out.face, tile, [&](int i) { return seen(i) ? hits.face[i] : -1; });
  write_layer(out.status, tile, [&](int i) { return static_cast<std::uint8_t>(hits.status[i]); });
}

}  // namespace limn
