#include "raymarch/level_set/level_set_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "raymarch/level_set/projection.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr double kGroup_px = 9.0;

/// A brick that may be seen, with the pixels that it covers: first to last inclusive, within the picture.
struct SeenBrick {
  std::uint32_t brick;
  std::uint16_t depth;  ///< Nearest corner's, scaled over the bricks' range.
  std::int16_t x0, y0, x1, y1;
};

BrickProjection projection_of(const RayBricks& bricks, const Affine& index_from_render, float side, const ViewRequest& request) {
  const Camera& camera = request.camera;
  const Affine render_from_index = inverse(index_from_render);
  const glm::dmat3 camera_from_render = glm::transpose(camera.world_from_camera);
  const glm::dmat3 linear = camera_from_render * render_from_index.linear;
  const glm::dvec3 offset = camera_from_render * (render_from_index.translation - camera.eye);
  BrickProjection projection;
  projection.perspective = camera.projection == Projection::perspective;
  const double scale = projection.perspective ? camera.focal_px : camera.pixels_per_unit;
  for (int column = 0; column < 3; ++column) {
    const auto c = static_cast<size_t>(column);
    projection.x[c] = static_cast<float>(scale * linear[column].x);
    projection.y[c] = static_cast<float>(-scale * linear[column].y);
    projection.z[c] = static_cast<float>(-linear[column].z);
  }
  projection.x[3] = static_cast<float>(scale * offset.x);
  projection.y[3] = static_cast<float>(-scale * offset.y);
  projection.z[3] = static_cast<float>(-offset.z);
  // Pixel i is seen through i + sample; a brick at image point p may be met by the pixels i with p0 <= i + sample <= p1.
  projection.center_x = static_cast<float>(0.5 * camera.width_px - request.sample.x);
  projection.center_y = static_cast<float>(0.5 * camera.height_px - request.sample.y);
  projection.width = camera.width_px;
  projection.height = camera.height_px;
  const glm::dvec3 eye = index_from_render.point(camera.eye);
  const glm::dvec3 forward = index_from_render.vector(-camera.world_from_camera[2]);
  for (int axis = 0; axis < 3; ++axis) {
    projection.eye[axis] = static_cast<float>(eye[axis]);
    projection.forward[axis] = static_cast<float>(forward[axis]);
  }
  projection.side = side;
  const glm::dvec3 size(bricks.upper - bricks.lower);
  projection.near = static_cast<float>(1e-6 * glm::length(render_from_index.vector(size)));
  return projection;
}

/// Stable order by depth, two passes of a radix sort.
void sort_by_depth(std::vector<SeenBrick>& seen) {
  std::vector<SeenBrick> other(seen.size());
  for (const int shift : {0, 8}) {
    std::array<std::uint32_t, 257> start{};
    for (const SeenBrick& s : seen) ++start[static_cast<size_t>(s.depth >> shift & 255) + 1];
    for (size_t i = 1; i < start.size(); ++i) start[i] += start[i - 1];
    for (const SeenBrick& s : seen) other[start[static_cast<size_t>(s.depth >> shift & 255)]++] = s;
    seen.swap(other);
  }
}

std::vector<SeenBrick> see(const BrickGroups& groups, const BrickProjection& projection) {
  constexpr size_t kChunk = 2048;
  const size_t count = groups.bounds.size(), chunks = (count + kChunk - 1) / kChunk;
  std::vector<std::vector<ProjectedBrick>> parts(chunks);
  parallel_for(size_t{0}, chunks, [&](size_t chunk) {
    const size_t first = chunk * kChunk, number = std::min(kChunk, count - first);
    parts[chunk].resize(number);
    parts[chunk].resize(
        project_bricks(std::span(groups.bounds).subspan(first, number), static_cast<std::uint32_t>(first), projection, parts[chunk]));
  });
  float nearest = 1e30f, farthest = -1e30f;
  size_t total = 0;
  for (const auto& part : parts) {
    total += part.size();
    for (const ProjectedBrick& b : part) {
      nearest = std::min(nearest, b.depth);
      farthest = std::max(farthest, b.depth);
    }
  }
  const float scale = farthest > nearest ? 65535.0f / (farthest - nearest) : 0.0f;
  std::vector<SeenBrick> seen;
  seen.reserve(total);
  for (const auto& part : parts) {
    for (const ProjectedBrick& b : part) {
      const auto depth = static_cast<std::uint16_t>(std::clamp((b.depth - nearest) * scale, 0.0f, 65535.0f));
      seen.push_back({b.brick, depth, b.x0, b.y0, b.x1, b.y1});
    }
  }
  sort_by_depth(seen);
  return seen;
}

/// Counting sort of the bricks by tile, which keeps their order.
void fill_tiles(const std::vector<SeenBrick>& seen, BrickView& view) {
  const size_t tiles = static_cast<size_t>(view.columns) * static_cast<size_t>(view.rows);
  view.first.assign(tiles + 1, 0);
  const auto for_each_tile = [&](const SeenBrick& s, const auto& visit) {
    for (int row = s.y0 / kViewTile_px; row <= s.y1 / kViewTile_px; ++row) {
      for (int column = s.x0 / kViewTile_px; column <= s.x1 / kViewTile_px; ++column)
        visit(static_cast<size_t>(row) * static_cast<size_t>(view.columns) + static_cast<size_t>(column), column * kViewTile_px,
              row * kViewTile_px);
    }
  };
  for (const SeenBrick& s : seen) for_each_tile(s, [&](size_t tile, int, int) { ++view.first[tile + 1]; });
  for (size_t i = 1; i <= tiles; ++i) view.first[i] += view.first[i - 1];
  view.entries.resize(view.first[tiles]);
  std::vector<std::uint32_t> next(view.first.begin(), view.first.end() - 1);
  for (const SeenBrick& s : seen) {
    for_each_tile(s, [&](size_t tile, int x, int y) {
      const auto within = [](int v) { return static_cast<std::uint8_t>(std::clamp(v, 0, kViewTile_px - 1)); };
      view.entries[next[tile]++] = {s.brick, within(s.x0 - x), within(s.y0 - y), within(s.x1 - x), within(s.y1 - y)};
    });
  }
}

/// The smallest groups that are about as large in the picture as a packet of rays.
const BrickGroups& groups_for(const RayBricks& bricks, const Affine& index_from_render, const Camera& camera) {
  const Affine render_from_index = inverse(index_from_render);
  const glm::dvec3 middle = render_from_index.point(0.5 * glm::dvec3(bricks.lower + bricks.upper));
  const double depth = -glm::dot(middle - camera.eye, camera.world_from_camera[2]);
  const double voxel = std::cbrt(std::abs(glm::determinant(render_from_index.linear)));
  const double voxel_px = depth > 0.0 ? voxel * pixels_per_unit_at(camera, depth) : std::numeric_limits<double>::infinity();
  size_t k = 0;
  while (k + 1 < bricks.groups.size() && voxel_px * (1 << bricks.groups[k].shift) < kGroup_px) ++k;
  return bricks.groups[k];
}

/// True where the plane Z = 0 of a parallel projection leaves all bricks on its far side.
bool all_before(const RayBricks& bricks, const Affine& index_from_render, const Camera& camera) {
  const Box box = transform(inverse(index_from_render), {glm::dvec3(bricks.lower), glm::dvec3(bricks.upper)});
  double nearest = std::numeric_limits<double>::infinity();
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p(corner & 1 ? box.upper.x : box.lower.x, corner & 2 ? box.upper.y : box.lower.y,
                       corner & 4 ? box.upper.z : box.lower.z);
    nearest = std::min(nearest, -glm::dot(p - camera.eye, camera.world_from_camera[2]));
  }
  return nearest > 0.0;
}

}  // namespace

bool touches(const BrickView& view, const PixelTile& tile) {
  for (int row = tile.y / kViewTile_px; row <= (tile.y + tile.height - 1) / kViewTile_px; ++row) {
    for (int column = tile.x / kViewTile_px; column <= (tile.x + tile.width - 1) / kViewTile_px; ++column) {
      if (!view.tile(column, row).empty()) return true;
    }
  }
  return false;
}

std::shared_ptr<const BrickView> view_bricks(const std::shared_ptr<const RayBricks>& bricks, const Affine& index_from_render, bool inside,
                                             const ViewRequest& request) {
  const bool parallel = request.camera.projection == Projection::orthographic;
  if (!bricks->groups.empty() && parallel && !all_before(*bricks, index_from_render, request.camera)) return nullptr;
  auto view = std::make_shared<BrickView>();
  view->bricks = bricks;
  view->index_from_render = index_from_render;
  const glm::dvec3 middle = 0.5 * glm::dvec3(bricks->lower + bricks->upper), size(bricks->upper - bricks->lower);
  const double reach = glm::length(index_from_render.point(request.camera.eye) - middle) + glm::length(size) + glm::length(middle);
  view->slack_voxels = static_cast<float>(std::max(1e-3, 16.0 * reach * std::numeric_limits<float>::epsilon()));
  view->side = inside && !parallel ? -1.0f : 1.0f;
  view->columns = (request.camera.width_px + kViewTile_px - 1) / kViewTile_px;
  view->rows = (request.camera.height_px + kViewTile_px - 1) / kViewTile_px;
  std::vector<SeenBrick> seen;
  if (!bricks->groups.empty()) {
    view->groups = &groups_for(*bricks, index_from_render, request.camera);
    seen = see(*view->groups, projection_of(*bricks, index_from_render, view->side, request));
  }
  fill_tiles(seen, *view);
  return view;
}

}  // namespace limn
