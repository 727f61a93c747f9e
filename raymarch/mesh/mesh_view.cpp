#include "raymarch/mesh/mesh_view.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "sdf/parallel.h"

namespace limn {
namespace {

// Beyond so many triangles for each pixel that the bounds cover, listing them all takes longer than a tree's search for each ray.
constexpr double kTrianglesPerPixel = 16.0;
// Of many triangles so many are listed for each pixel.
constexpr double kManyTrianglesPerPixel = 512.0;
// Lists longer than this are those of many large triangles behind each other: a tree sees less of them.
constexpr size_t kMostEntries = size_t{1} << 25;

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

size_t tiles_of(const SeenTriangle& s) {
  const auto along = [](int first, int last) { return static_cast<size_t>(last / kMeshTile_px - first / kMeshTile_px + 1); };
  return along(s.x0, s.x1) * along(s.y0, s.y1);
}

template <class Visit>
void for_each_list(const SeenTriangle& s, int columns, const Visit& visit) {
  for (int row = s.y0 / kMeshTile_px; row <= s.y1 / kMeshTile_px; ++row) {
    for (int column = s.x0 / kMeshTile_px; column <= s.x1 / kMeshTile_px; ++column)
      visit(2 * (static_cast<size_t>(row) * static_cast<size_t>(columns) + static_cast<size_t>(column)) + s.away, column * kMeshTile_px,
            row * kMeshTile_px);
  }
}

void see(const MeshView& view, size_t from, size_t to, const Camera& camera, SeenShare& share) {
  share.counts.assign(2 * static_cast<size_t>(view.columns) * static_cast<size_t>(view.rows), 0);
  share.entries = 0;
  // Piece by piece: of a fine mesh few triangles cover a pixel, and only for those there shall be room.
  constexpr size_t kPiece = 4096;
  share.found = 0;
  for (size_t first = from; first < to; first += kPiece) {
    const size_t last = std::min(first + kPiece, to);
    if (share.seen.size() < share.found + (last - first)) share.seen.resize(share.found + share.found / 2 + (last - first));
    const std::span<SeenTriangle> room = std::span(share.seen).subspan(share.found, last - first);
    share.found += find_seen(view, first, last, camera.width_px, camera.height_px, room);
  }
  const std::span<const SeenTriangle> seen = std::span(share.seen).first(share.found);
  for (const SeenTriangle& s : seen) share.entries += tiles_of(s);
  if (share.entries > kMostEntries) return;
  for (const SeenTriangle& s : seen) for_each_list(s, view.columns, [&](size_t list, int, int) { ++share.counts[list]; });
}

/// Each share's counts become where its entries start in each list; the lists' own starts and the end go to `first`.
void place(std::vector<SeenShare>& shares, std::vector<std::uint32_t>& first) {
  const size_t lists = shares[0].counts.size();
  first.resize(lists + 1);
  std::uint32_t sum = 0;
  for (size_t list = 0; list < lists; ++list) {
    first[list] = sum;
    for (SeenShare& share : shares) sum += std::exchange(share.counts[list], sum);
  }
  first[lists] = sum;
}

void fill(SeenShare& share, MeshView& view) {
  for (const SeenTriangle& s : std::span(share.seen).first(share.found)) {
    for_each_list(s, view.columns, [&](size_t list, int x, int y) {
      const auto within = [](int v) { return static_cast<std::uint8_t>(std::clamp(v, 0, kMeshTile_px - 1)); };
      view.entries[share.counts[list]++] = {s.triangle, within(s.x0 - x), within(s.y0 - y), within(s.x1 - x), within(s.y1 - y), s.nearest};
    });
  }
}

/// A counting sort of the triangles by tile, in shares, the order of which it keeps. False where the lists become too long.
bool list_triangles(const Camera& camera, MeshView& view) {
  view.columns = (camera.width_px + kMeshTile_px - 1) / kMeshTile_px;
  view.rows = (camera.height_px + kMeshTile_px - 1) / kMeshTile_px;
  constexpr size_t kShare = 8192, kMostShares = 8, kMostCounts = size_t{1} << 21;
  const size_t tiles = static_cast<size_t>(view.columns) * static_cast<size_t>(view.rows), triangles = view.mesh->triangles.size();
  const size_t shares = std::clamp<size_t>(std::min(triangles / kShare, kMostCounts / tiles), 1, kMostShares);
  view.shares.resize(shares);
  parallel_for(size_t{0}, shares,
               [&](size_t k) { see(view, triangles * k / shares, triangles * (k + 1) / shares, camera, view.shares[k]); });
  size_t entries = 0;
  for (const SeenShare& share : view.shares) entries += share.entries;
  if (entries > kMostEntries) return false;
  place(view.shares, view.first);
  view.entries.resize(entries);
  parallel_for(size_t{0}, shares, [&](size_t k) { fill(view.shares[k], view); });
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
  parallel_for(size_t{0}, (positions.size() + kShare - 1) / kShare, [&](size_t k) {
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
      if (!view.list(column, row, 0).empty() || !view.list(column, row, 1).empty()) return true;
    }
  }
  return false;
}

}  // namespace

std::unique_ptr<MeshView> MeshViewMemory::take() {
  const std::lock_guard lock(mutex_);
  return spare_ ? std::move(spare_) : std::make_unique<MeshView>();
}

void MeshViewMemory::give_back(std::unique_ptr<MeshView> view) {
  const std::lock_guard lock(mutex_);
  spare_ = std::move(view);
}

SurfaceView view_mesh(const ViewedMesh& viewed, const ViewRequest& request) {
  const Camera& camera = request.camera;
  const size_t triangles = viewed.mesh->triangles.size();
  const double most_per_pixel = triangles > kManyTriangles ? kManyTrianglesPerPixel : kTrianglesPerPixel;
  if (triangles == 0 || static_cast<double>(triangles) > most_per_pixel * covered_pixels(viewed.bounds, camera)) return {};
  const std::shared_ptr<MeshView> view(viewed.memory->take().release(), [keep = viewed.keep, memory = viewed.memory](MeshView* used) {
    memory->give_back(std::unique_ptr<MeshView>(used));
  });
  view->mesh = viewed.mesh;
  view->eye = camera.eye;
  view->forward = -camera.world_from_camera[2];
  view->perspective = camera.projection == Projection::perspective;
  if (!project_all(request, viewed.bounds, *view) || !list_triangles(camera, *view)) return {};
  return {view, touches, [](const void* state, const PixelTile& tile, const RayBatch& rays, HitBatch& hits) {
            trace_mesh_tile(*static_cast<const MeshView*>(state), tile, rays, hits);
          }};
}

}  // namespace limn
