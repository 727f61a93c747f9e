#pragma once
// Internal: a mesh prepared for a picture. Its triangles are listed by tiles of 16 x 16 pixels and tested there against the tile's rays
// (edge functions: Pineda, "A parallel algorithm for polygon rasterization", SIGGRAPH 1988), no tree being asked.

#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "raymarch/mesh/screen.h"
#include "raymarch/surface.h"
#include "subdiv/mesh.h"

namespace limn {

inline constexpr int kMeshTile_px = 16;
/// A tree over more triangles than this takes longer to make than lists for dozens of pictures, or than looking at each for a few rays.
inline constexpr size_t kManyTriangles = 1'000'000;

/// A triangle in a tile: the pixels of the tile that its box may cover, first to last inclusive, from the tile's corner.
struct TriangleInTile {
  std::uint32_t triangle = 0;
  std::uint8_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  float nearest = 0.0f;  ///< At least the ScreenVertex::nearness of its corners.
};

/// A triangle whose box holds pixels: first to last inclusive, within the picture.
struct SeenTriangle {
  std::uint32_t triangle = 0;
  std::int16_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  float nearest = 0.0f;
  std::uint32_t away = 0;  ///< 1 where it shows its back.
};
/// A share of the triangles: those that may be seen, and how many of them each half of a tile's list has.
struct SeenShare {
  std::vector<SeenTriangle> seen{};  ///< The first `found` count.
  size_t found = 0;
  std::vector<std::uint32_t> counts{};
  size_t entries = 0;
};

/// Each tile has two lists: triangles that show their front, and then those that show their back, which most often are hidden.
struct MeshView {
  const TriangleMesh* mesh = nullptr;
  glm::dvec3 eye{0.0}, forward{0.0, 0.0, -1.0};  ///< Render space.
  bool perspective = true;
  std::vector<ScreenVertex> vertices{};
  int columns = 0, rows = 0;
  std::vector<std::uint32_t> first{};  ///< Of each list in `entries`, and the end; two lists a tile, row by row.
  std::vector<TriangleInTile> entries{};
  std::vector<SeenShare> shares{};  ///< What the lists are made from.

  std::span<const TriangleInTile> list(int column, int row, int away) const {
    const auto i = 2 * (static_cast<size_t>(row) * static_cast<size_t>(columns) + static_cast<size_t>(column)) + static_cast<size_t>(away);
    return std::span(entries).subspan(first[i], first[i + 1] - first[i]);
  }
};

/// Keeps the memory of the last view for the next one: fresh pages take longer than what is written to them. Thread-safe.
class MeshViewMemory {
 public:
  std::unique_ptr<MeshView> take();
  void give_back(std::unique_ptr<MeshView> view);

 private:
  std::mutex mutex_;
  std::unique_ptr<MeshView> spare_;
};

/// A mesh that can be viewed: what `keep` holds, in render space.
struct ViewedMesh {
  std::shared_ptr<const void> keep{};  ///< Held as long as the view.
  const TriangleMesh* mesh = nullptr;
  Box bounds{};
  MeshViewMemory* memory = nullptr;
};

/// An empty view, which leaves the picture to Surface::trace, where a vertex lies at or behind the eye (or before its plane), and where the
/// mesh has so many triangles for the pixels that its bounds cover that a tree finds the few that count sooner.
SurfaceView view_mesh(const ViewedMesh& viewed, const ViewRequest& request);

/// Those of the triangles from .. to - 1 that may cover a pixel of a picture of this size; returns how many. Where the box holds 2 x 2
/// pixels at most the triangle itself is tested. `seen` has a place for each of them.
size_t find_seen(const MeshView& view, size_t from, size_t to, int width, int height, std::span<SeenTriangle> seen);

/// Hits of the tile's rays, as SurfaceView::trace.
void trace_mesh_tile(const MeshView& view, const PixelTile& tile, const RayBatch& rays, HitBatch& hits);

}  // namespace limn
