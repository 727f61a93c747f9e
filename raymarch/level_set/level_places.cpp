#include "raymarch/level_set/level_places.h"

#include <bit>

#include "raymarch/scene/rays_of_box.h"
#include "sdf/level_set_band.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

/// Bits z of [x][y].
using Cells = std::uint8_t[8][8];

/// The trilinear gradient in a cell: each component lies between the differences along its four edges.
std::array<Interval, 3> gradient_in(const NodeWindow& nodes, size_t x, size_t y, size_t z) {
  std::array<Interval, 3> bounds;
  const auto value = [&](size_t i, size_t j, size_t k) { return double{nodes[x + i + 1][y + j + 1][z + k + 1]}; };
  for (size_t axis = 0; axis < 3; ++axis) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (size_t edge = 0; edge < 4; ++edge) {
      std::array<size_t, 3> from{};
      from[(axis + 1) % 3] = edge & 1;
      from[(axis + 2) % 3] = edge >> 1;
      std::array<size_t, 3> to = from;
      to[axis] = 1;
      const double difference = value(to[0], to[1], to[2]) - value(from[0], from[1], from[2]);
      low = std::min(low, difference), high = std::max(high, difference);
    }
    bounds[axis] = {low, high};
  }
  return bounds;
}

Box box_of(const glm::ivec3& first, int size) { return {glm::dvec3(first), glm::dvec3(first + size)}; }

/// Of the crossed cells those whose gradient may point away from the eye. False where there is none.
bool cells_facing_away(const NodeWindow& nodes, const RaySource& source, const glm::ivec3& origin, const CrossedCells& crossed,
                       Cells& away) {
  bool any = false;
  for (size_t x = 0; x < 8; ++x)
    for (size_t y = 0; y < 8; ++y) {
      away[x][y] = 0;
      for (unsigned bits = crossed.cells[x][y]; bits != 0; bits &= bits - 1) {
        const auto z = static_cast<size_t>(std::countr_zero(bits));
        if (may_face_away(gradient_in(nodes, x, y, z), ways_to(source, box_of(origin + glm::ivec3(x, y, z), 1))))
          away[x][y] = static_cast<std::uint8_t>(away[x][y] | 1u << z);
      }
      any = any || away[x][y] != 0;
    }
  return any;
}

/// Around the cells that a cube of `size` cells holds, index coordinates; empty where it holds none.
Box around(const Cells& cells, const glm::ivec3& first, int size, const glm::ivec3& origin) {
  Box box;
  const unsigned mask = ((1u << size) - 1u) << first.z;
  for (int x = first.x; x < first.x + size; ++x)
    for (int y = first.y; y < first.y + size; ++y) {
      const unsigned bits = cells[x][y] & mask;
      if (bits == 0) continue;
      const glm::dvec3 column(origin + glm::ivec3(x, y, 0));
      box = include(box, column + glm::dvec3(0.0, 0.0, std::countr_zero(bits)));
      box = include(box, column + glm::dvec3(1.0, 1.0, std::bit_width(bits)));
    }
  return box;
}

/// Cells to the side of a box that is no longer in the picture than asked for.
int cells_to_side(const Box& leaf, const MeetingRequest& request) {
  if (request.is_divided && !request.is_divided(leaf)) return 8;
  const double leaf_px = longest_px(request.camera, leaf);
  int cells = 8;
  while (cells > 1 && !(leaf_px * cells / 8.0 <= request.side_px)) cells /= 2;
  return cells;
}

void add_places(const WalkedGrid& grid, const Cells& cells, const glm::ivec3& origin, const MeetingRequest& request,
                std::vector<Box>& places) {
  const int size = cells_to_side(transform(grid.render_from_index, around(cells, glm::ivec3(0), 8, origin)), request);
  for (int x = 0; x < 8; x += size)
    for (int y = 0; y < 8; y += size)
      for (int z = 0; z < 8; z += size)
        if (const Box box = around(cells, {x, y, z}, size, origin); !box.empty()) places.push_back(transform(grid.render_from_index, box));
}

}  // namespace

std::vector<Box> level_meeting_places(const LevelSetData& data, const WalkedGrid& grid, const CrossedLeaves& leaves,
                                      const MeetingRequest& request) {
  const RaySource source = ray_source(request.camera, grid.index_from_render);
  std::vector<std::vector<Box>> of_leaves(leaves.cells.size());
  parallel_parts(leaves.cells.size(), size_t{32}, [&](const IndexRange<size_t>& range) {
    const auto accessor = data.accessor();
    NodeWindow nodes;
    for (size_t i = range.begin(); i < range.end(); ++i) {
      const CrossedCells& crossed = leaves.cells[i].crossed;
      if (!crossed.any) continue;
      const LeafWindow window(accessor, leaves.first_leaf[i].origin());
      const glm::ivec3 origin(window.origin()[0], window.origin()[1], window.origin()[2]);
      if (!request.facing_away) {
        add_places(grid, crossed.cells, origin, request, of_leaves[i]);
        continue;
      }
      load_nodes(window, nodes);
      if (Cells away; cells_facing_away(nodes, source, origin, crossed, away)) add_places(grid, away, origin, request, of_leaves[i]);
    }
  });
  std::vector<Box> places;
  for (const std::vector<Box>& of_one : of_leaves) places.insert(places.end(), of_one.begin(), of_one.end());
  return places;
}

}  // namespace limn
