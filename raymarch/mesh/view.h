#pragma once
// Internal: a mesh prepared for a picture. Its triangles are listed by tiles of 16 x 16 pixels and tested there against the tile's rays
// (edge functions: Pineda, "A parallel algorithm for polygon rasterization", SIGGRAPH 1988), no tree being asked.

#include <memory>
#include <span>
#include <vector>

#include "raymarch/mesh/screen.h"
#include "raymarch/surface.h"
#include "subdiv/mesh.h"

namespace limn {

inline constexpr int kMeshTile_px = 16;

/// A triangle in a tile: the pixels of the tile that its box may cover, first to last inclusive, from the tile's corner.
struct TriangleInTile {
  std::uint32_t triangle = 0;
  std::uint8_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

struct MeshView {
  std::shared_ptr<const void> keep{};  ///< Holds the mesh.
  const TriangleMesh* mesh = nullptr;
  glm::dvec3 eye{0.0}, forward{0.0, 0.0, -1.0};  ///< Render space.
  bool perspective = true;
  std::vector<ScreenVertex> vertices{};
  int columns = 0, rows = 0;
  std::vector<std::uint32_t> first{};  ///< Of each tile in `entries`, and the end; row by row.
  std::vector<TriangleInTile> entries{};

  std::span<const TriangleInTile> tile(int column, int row) const {
    const auto i = static_cast<size_t>(row) * static_cast<size_t>(columns) + static_cast<size_t>(column);
    return std::span(entries).subspan(first[i], first[i + 1] - first[i]);
  }
};

/// `keep` is held as long as the view; `mesh` lies in it, in render space. An empty view, which leaves the picture to Surface::trace, where
/// a vertex lies at or behind the eye (or before its plane), and where the mesh has so many triangles for the pixels that `bounds` covers
/// that a tree finds the few that count sooner.
SurfaceView view_mesh(std::shared_ptr<const void> keep, const TriangleMesh& mesh, const Box& bounds, const ViewRequest& request);

/// Hits of the tile's rays, as SurfaceView::trace.
void trace_mesh_tile(const MeshView& view, const PixelTile& tile, const RayBatch& rays, HitBatch& hits);

}  // namespace limn
