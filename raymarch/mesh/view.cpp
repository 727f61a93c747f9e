#include "raymarch/mesh/view.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

namespace limn {
namespace {

// Beyond so many triangles for each pixel that the bounds cover, listing them all takes longer than a tree's search for each ray.
constexpr double kTrianglesPerPixel = 16.0;

/// A triangle whose box holds pixels: first to last inclusive, within the picture.
struct SeenTriangle {
  std::uint32_t triangle;
  std::int16_t x0, y0, x1, y1;
};

/// Pixels from the first to the last whole number of [low, high], perhaps one more on either side, within 0 .. size - 1.
struct PixelRun {
  int first, last;
};
PixelRun pixels_between(double low, double high, int size) {
  // Rounding up is casting what is almost one larger: for whole numbers and a hair beyond nothing is added.
  constexpr double kAlmostOne = 1.0 - 1e-6;
  const double first = std::clamp(low, -1.0, static_cast<double>(size)), last = std::clamp(high, -1.0, static_cast<double>(size));
  return {std::max(0, static_cast<int>(first + kAlmostOne)), std::min(size - 1, static_cast<int>(last + 1.0 + 1e-6) - 1)};
}

double covered_pixels(const Box& bounds, const Camera& camera) {
  Box image;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p(corner & 1 ? bounds.upper.x : bounds.lower.x, corner & 2 ? bounds.upper.y : bounds.lower.y,
                       corner & 4 ? bounds.upper.z : bounds.lower.z);
    const glm::dvec3 at = project(camera, p);
    if (!(at.z > 0.0)) return static_cast<double>(camera.width_px) * camera.height_px;
    image = include(image, {at.x, at.y, 0.0});
  }
  const Box seen = intersect(image, {glm::dvec3(0.0), glm::dvec3(camera.width_px, camera.height_px, 0.0)});
  return seen.empty() ? 0.0 : seen.size().x * seen.size().y;
}

// Lists longer than this are those of many large triangles behind each other: a tree sees less of them.
constexpr size_t kMostEntries = size_t{1} << 25;

/// A share of the triangles: those that may cover pixels, and how many of them each tile has.
struct Part {
  std::vector<SeenTriangle> seen{};
  std::vector<std::uint32_t> tiles{};
  size_t entries = 0;
};

size_t tiles_of(const SeenTriangle& s) {
  const auto along = [](int first, int last) { return static_cast<size_t>(last / kMeshTile_px - first / kMeshTile_px + 1); };
  return along(s.x0, s.x1) * along(s.y0, s.y1);
}

template <class Visit>
void for_each_tile(const SeenTriangle& s, int columns, const Visit& visit) {
  for (int row = s.y0 / kMeshTile_px; row <= s.y1 / kMeshTile_px; ++row) {
    for (int column = s.x0 / kMeshTile_px; column <= s.x1 / kMeshTile_px; ++column)
      visit(static_cast<size_t>(row) * static_cast<size_t>(columns) + static_cast<size_t>(column), column * kMeshTile_px,
            row * kMeshTile_px);
  }
}

Part see(const MeshView& view, size_t from, size_t to, const Camera& camera) {
  Part part;
  part.tiles.assign(static_cast<size_t>(view.columns) * static_cast<size_t>(view.rows), 0);
  part.seen.reserve((to - from) / 2);
  for (size_t i = from; i < to; ++i) {
    const glm::uvec3& corners = view.mesh->triangles[i];
    const ScreenVertex &a = view.vertices[corners.x], &b = view.vertices[corners.y], &c = view.vertices[corners.z];
    const PixelRun x = pixels_between(std::min(std::min(a.x, b.x), c.x), std::max(std::max(a.x, b.x), c.x), camera.width_px);
    const PixelRun y = pixels_between(std::min(std::min(a.y, b.y), c.y), std::max(std::max(a.y, b.y), c.y), camera.height_px);
    if (x.first > x.last || y.first > y.last) continue;
    part.seen.push_back({static_cast<std::uint32_t>(i), static_cast<std::int16_t>(x.first), static_cast<std::int16_t>(y.first),
                         static_cast<std::int16_t>(x.last), static_cast<std::int16_t>(y.last)});
    part.entries += tiles_of(part.seen.back());
    if (part.entries > kMostEntries) break;
    for_each_tile(part.seen.back(), view.columns, [&](size_t tile, int, int) { ++part.tiles[tile]; });
  }
  return part;
}

/// Each part's counts become where its entries start in each tile; the tiles' own starts and the end go to `first`.
void place(std::vector<Part>& parts, std::vector<std::uint32_t>& first) {
  const size_t tiles = parts[0].tiles.size();
  first.resize(tiles + 1);
  std::uint32_t sum = 0;
  for (size_t tile = 0; tile < tiles; ++tile) {
    first[tile] = sum;
    for (Part& part : parts) sum += std::exchange(part.tiles[tile], sum);
  }
  first[tiles] = sum;
}

void fill(Part& part, MeshView& view) {
  for (const SeenTriangle& s : part.seen) {
    for_each_tile(s, view.columns, [&](size_t tile, int x, int y) {
      const auto within = [](int v) { return static_cast<std::uint8_t>(std::clamp(v, 0, kMeshTile_px - 1)); };
      view.entries[part.tiles[tile]++] = {s.triangle, within(s.x0 - x), within(s.y0 - y), within(s.x1 - x), within(s.y1 - y)};
    });
  }
}

/// A counting sort of the triangles by tile, in shares, the order of which it keeps. False where the lists become too long.
bool list_triangles(const Camera& camera, MeshView& view) {
  view.columns = (camera.width_px + kMeshTile_px - 1) / kMeshTile_px;
  view.rows = (camera.height_px + kMeshTile_px - 1) / kMeshTile_px;
  constexpr size_t kShare = 8192, kMostShares = 32, kMostCounts = size_t{1} << 21;
  const size_t tiles = static_cast<size_t>(view.columns) * static_cast<size_t>(view.rows), triangles = view.mesh->triangles.size();
  const size_t shares = std::clamp<size_t>(std::min(triangles / kShare, kMostCounts / tiles), 1, kMostShares);
  std::vector<Part> parts(shares);
  tbb::parallel_for(size_t{0}, shares,
                    [&](size_t k) { parts[k] = see(view, triangles * k / shares, triangles * (k + 1) / shares, camera); });
  size_t entries = 0;
  for (const Part& part : parts) entries += part.entries;
  if (entries > kMostEntries) return false;
  place(parts, view.first);
  view.entries.resize(view.first[tiles]);
  tbb::parallel_for(size_t{0}, shares, [&](size_t k) { fill(parts[k], view); });
  return true;
}

bool project_all(const ViewRequest& request, const Box& bounds, MeshView& view) {
  const ScreenProjection projection = screen_projection(request);
  const std::vector<glm::dvec3>& positions = view.mesh->positions;
  view.vertices.resize(positions.size());
  // So near that the projection has few digits left counts as behind.
  const double nearest = 1e-6 * bounds.radius();
  constexpr size_t kShare = 16384;
  std::atomic<bool> before{true};
  tbb::parallel_for(size_t{0}, (positions.size() + kShare - 1) / kShare, [&](size_t k) {
    const size_t from = k * kShare, count = std::min(kShare, positions.size() - from);
    const double least =
        project_vertices(projection, std::span(positions).subspan(from, count), std::span(view.vertices).subspan(from, count));
    if (!(least > nearest)) before = false;
  });
  return before;
}

bool touches(const void* opaque, const PixelTile& tile) {
  const MeshView& view = *static_cast<const MeshView*>(opaque);
  for (int row = tile.y / kMeshTile_px; row <= (tile.y + tile.height - 1) / kMeshTile_px; ++row) {
    for (int column = tile.x / kMeshTile_px; column <= (tile.x + tile.width - 1) / kMeshTile_px; ++column) {
      if (!view.tile(column, row).empty()) return true;
    }
  }
  return false;
}

}  // namespace

SurfaceView view_mesh(std::shared_ptr<const void> keep, const TriangleMesh& mesh, const Box& bounds, const ViewRequest& request) {
  if (mesh.triangles.empty() || static_cast<double>(mesh.triangles.size()) > kTrianglesPerPixel * covered_pixels(bounds, request.camera))
    return {};
  auto view = std::make_shared<MeshView>();
  view->keep = std::move(keep);
  view->mesh = &mesh;
  view->eye = request.camera.eye;
  view->forward = -request.camera.world_from_camera[2];
  view->perspective = request.camera.projection == Projection::perspective;
  if (!project_all(request, bounds, *view) || !list_triangles(request.camera, *view)) return {};
  return {std::move(view), touches, [](const void* state, const PixelTile& tile, const RayBatch& rays, HitBatch& hits) {
            trace_mesh_tile(*static_cast<const MeshView*>(state), tile, rays, hits);
          }};
}

}  // namespace limn
