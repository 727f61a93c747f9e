#include "raymarch/gbuffer_tile.h"

#include <algorithm>
#include <limits>

#include "raymarch/stream_fill.h"

namespace limn {
namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();

// Pictures of more pixels than this do not stay in a cache until somebody reads them.
constexpr size_t kLargePicture = size_t{1} << 20;

template <class T>
void fill_rows(Image<T>& image, const PixelTile& tile, const T& value) {
  if (image.pixels.empty()) return;
  const bool past_caches = image.size() >= kLargePicture;
  for (int y = tile.y; y < tile.y + tile.height; ++y) {
    T* const row = &image.pixels[image.index(tile.x, y)];
    if (past_caches)
      stream_fill(row, static_cast<size_t>(tile.width), value);
    else
      std::fill_n(row, tile.width, value);
  }
}

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
  const glm::vec3 forward = writer.forward;
  const auto seen = [&](int i) { return found.object[i] >= 0; };
  write_layer(out.depth, tile, [&](int i) {
    const float along = rays.direction_x[i] * forward.x + rays.direction_y[i] * forward.y + rays.direction_z[i] * forward.z;
    return seen(i) ? static_cast<float>(writer.shift + static_cast<double>(hits.t[i])) * along : kFar;
  });
  write_layer(out.position, tile, [&](int i) {
    if (!seen(i)) return glm::vec3(kFar);
    const glm::dvec3 p = glm::dvec3(rays.origin(i)) + static_cast<double>(hits.t[i]) * glm::dvec3(rays.direction(i));
    return glm::vec3(p + writer.model->render_origin);
  });
  write_layer(out.normal, tile,
              [&](int i) { return seen(i) ? glm::vec3(hits.normal_x[i], hits.normal_y[i], hits.normal_z[i]) : glm::vec3(0.0f); });
  write_layer(out.n_dot_v, tile, [&](int i) {
    const float against =
        -(hits.normal_x[i] * rays.direction_x[i] + hits.normal_y[i] * rays.direction_y[i] + hits.normal_z[i] * rays.direction_z[i]);
    return seen(i) ? std::clamp(against, 0.0f, 1.0f) : 0.0f;
  });
  write_layer(out.id, tile, [&](int i) { return found.object[i] + 1; });
  write_layer(out.material, tile,
              [&](int i) { return seen(i) ? writer.model->materials[static_cast<size_t>(found.object[i])] + hits.material[i] : 0; });
  write_layer(out.face, tile, [&](int i) { return seen(i) ? hits.face[i] : -1; });
  write_layer(out.status, tile, [&](int i) { return static_cast<std::uint8_t>(hits.status[i]); });
}

}  // namespace limn
