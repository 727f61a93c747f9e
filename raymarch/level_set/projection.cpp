#include "raymarch/level_set/projection.h"

#include <algorithm>
#include <cmath>

namespace limn {
namespace {

constexpr float kSlack_px = 0.02f;
constexpr float kSlack_voxels = 4e-3f;

/// True where every point of the crossed cells is seen from its back: gradient . (p - eye) > 0 for all gradients and points of the brick.
bool shows_its_back(const SurfaceBound& bound, const BrickProjection& projection) {
  float sum = 0.0f, gradient2 = 0.0f, half2 = 0.0f;
  for (size_t axis = 0; axis < 3; ++axis) {
    const float half = 0.5f * static_cast<float>(bound.upper[axis] - bound.lower[axis]) + kSlack_voxels;
    const float middle = static_cast<float>(bound.origin[axis]) + 0.5f * static_cast<float>(bound.upper[axis] + bound.lower[axis]);
    const float away = projection.perspective ? middle - projection.eye[axis] : projection.forward[axis];
    sum += projection.side * bound.normal[axis] * away - bound.spread[axis] * std::abs(away);
    const float largest = std::abs(bound.normal[axis]) + bound.spread[axis];
    gradient2 += largest * largest;
    half2 += half * half;
  }
  return projection.perspective ? sum > 0.0f && sum * sum > gradient2 * half2 * 1.001f : sum > 0.0f;
}

/// The pixels that the crossed cells' box may cover; false where none.
bool cover(const SurfaceBound& bound, const BrickProjection& projection, ProjectedBrick& out) {
  float low[3], high[3];
  for (size_t axis = 0; axis < 3; ++axis) {
    low[axis] = static_cast<float>(bound.origin[axis] + bound.lower[axis]) - kSlack_voxels;
    high[axis] = static_cast<float>(bound.origin[axis] + bound.upper[axis]) + kSlack_voxels;
  }
  float x0 = 1e30f, x1 = -1e30f, y0 = 1e30f, y1 = -1e30f, nearest = 1e30f, farthest = -1e30f;
  for (int corner = 0; corner < 8; ++corner) {
    const float p[3] = {corner & 1 ? high[0] : low[0], corner & 2 ? high[1] : low[1], corner & 4 ? high[2] : low[2]};
    const auto row = [&](const float* r) { return r[0] * p[0] + r[1] * p[1] + r[2] * p[2] + r[3]; };
    const float z = row(projection.z);
    const float scale = projection.perspective ? 1.0f / std::max(z, projection.near) : 1.0f;
    const float x = row(projection.x) * scale, y = row(projection.y) * scale;
    x0 = std::min(x0, x), x1 = std::max(x1, x);
    y0 = std::min(y0, y), y1 = std::max(y1, y);
    nearest = std::min(nearest, z), farthest = std::max(farthest, z);
  }
  if (projection.perspective && farthest <= 0.0f) return false;
  out.depth = nearest;
  const auto last_x = static_cast<float>(projection.width - 1), last_y = static_cast<float>(projection.height - 1);
  if (projection.perspective && nearest <= projection.near) {
    x0 = y0 = -1e30f;
    x1 = y1 = 1e30f;
  }
  x0 = std::ceil(x0 + projection.center_x - kSlack_px), x1 = std::floor(x1 + projection.center_x + kSlack_px);
  y0 = std::ceil(y0 + projection.center_y - kSlack_px), y1 = std::floor(y1 + projection.center_y + kSlack_px);
  if (x0 > x1 || y0 > y1 || x1 < 0.0f || y1 < 0.0f || x0 > last_x || y0 > last_y) return false;
  out.x0 = static_cast<std::int16_t>(std::clamp(x0, 0.0f, last_x)), out.x1 = static_cast<std::int16_t>(std::clamp(x1, 0.0f, last_x));
  out.y0 = static_cast<std::int16_t>(std::clamp(y0, 0.0f, last_y)), out.y1 = static_cast<std::int16_t>(std::clamp(y1, 0.0f, last_y));
  return true;
}

}  // namespace

size_t project_bricks(std::span<const SurfaceBound> bounds, std::uint32_t first, const BrickProjection& projection,
                      std::span<ProjectedBrick> out) {
  size_t count = 0;
  for (size_t i = 0; i < bounds.size(); ++i) {
    if (shows_its_back(bounds[i], projection) || !cover(bounds[i], projection, out[count])) continue;
    out[count++].brick = first + static_cast<std::uint32_t>(i);
  }
  return count;
}

}  // namespace limn
