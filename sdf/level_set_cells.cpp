#include <algorithm>
#include <cstring>

#include "sdf/error.h"
#include "sdf/level_set_band.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

/// True where the leaf has a node of the other sign among those that the block `side` steps before it reaches (bits: x, y, z).
bool changes_sign(const NanoLeaf& leaf, int side, bool inside) {
  const int dx = side & 1, dy = (side >> 1) & 1, dz = side >> 2;
  const float* const values = leaf.data()->mValues;
  for (int x = 0; x < (dx ? 1 : 8); ++x)
    for (int y = 0; y < (dy ? 1 : 8); ++y)
      for (int z = 0; z < (dz ? 1 : 8); ++z)
        if ((values[x * 64 + y * 8 + z] < 0.0f) != inside) return true;
  return false;
}

}  // namespace

std::vector<nanovdb::Coord> blocks_with_cells(const nanovdb::FloatGrid& grid) {
  const size_t count = grid.tree().nodeCount(0);
  const NanoLeaf* leaves = grid.tree().getFirstNode<0>();
  using Blocks = std::vector<nanovdb::Coord>;
  Blocks blocks(count);
  Blocks before = parallel_reduce(
      count, size_t{256}, Blocks{},
      [&](const IndexRange<size_t>& range, Blocks found) {
        const NanoAccessor accessor = grid.getAccessor();
        for (size_t i = range.begin(); i < range.end(); ++i) {
          const nanovdb::Coord o = leaves[i].origin();
          blocks[i] = o;
          for (int side = 1; side < 8; ++side) {
            const nanovdb::Coord at = o.offsetBy(-8 * (side & 1), -8 * ((side >> 1) & 1), -8 * (side >> 2));
            if (!accessor.probeLeaf(at) && changes_sign(leaves[i], side, accessor.getValue(at) < 0.0f)) found.push_back(at);
          }
        }
        return found;
      },
      [](Blocks a, const Blocks& b) {
        a.insert(a.end(), b.begin(), b.end());
        return a;
      });
  std::sort(before.begin(), before.end());
  before.erase(std::unique(before.begin(), before.end()), before.end());
  blocks.insert(blocks.end(), before.begin(), before.end());
  return blocks;
}

ActiveRows active_rows(const LeafWindow& window) {
  ActiveRows rows;
  for (size_t x = 0; x < rows.size(); ++x) {
    const int at = static_cast<int>(x) + 6, block_x = at >> 3;  // x - 2, from the first block on
    // Bytes of the rows along z: of y = -8 to 15.
    std::uint8_t planes[3][24];
    for (int block_z = 0; block_z < 3; ++block_z)
      for (int block_y = 0; block_y < 3; ++block_y) {
        const std::uint64_t plane = window.active_plane(block_x, block_y, block_z, at);
        std::memcpy(planes[block_z] + 8 * block_y, &plane, sizeof plane);
      }
    for (size_t y = 0; y < 16; ++y)
      rows[x][y] = static_cast<std::uint32_t>(planes[0][y + 6] >> 6 | planes[1][y + 6] << 2 | (planes[2][y + 6] & 7) << 10);
    rows[x][13] = rows[x][14] = rows[x][15] = 0;
  }
  return rows;
}

void load_nodes(const LeafWindow& window, NodeWindow& nodes) {
  window.for_each_column(-1, 8, [&](const LeafWindow::Column& column, int x, int y) {
    column.load_row(x, y, nodes[static_cast<size_t>(x) + 1][static_cast<size_t>(y) + 1].data());
  });
}

CrossedCells cells_crossed(const NodeWindow& nodes) {
  return crossed_cells([&](int x, int y) { return &nodes[static_cast<size_t>(x) + 1][static_cast<size_t>(y) + 1][1]; });
}

CrossedCells cells_crossed(const NodeBits& inside) {
  SignRows rows;
  for (size_t x = 0; x < 9; ++x)
    for (size_t y = 0; y < 9; ++y) rows[x][y] = inside.row(x + 1, y + 1) >> 1;
  return crossed_cells_of_signs(rows);
}

namespace {

/// For a kind of row in a stencil: byte y of a row x has bit z set where the row of the cell z reads a node outside the band.
struct RowsOutside {
  std::uint8_t bytes[13][16];
};

RowsOutside rows_outside(const ActiveRows& rows, std::uint8_t mask) {
  RowsOutside result;
  for (size_t x = 0; x < 13; ++x) {
    std::array<std::uint32_t, 16> bits{};
    for (int dz = 0; dz < 6; ++dz) {
      if ((mask >> dz & 1) == 0) continue;
      for (size_t y = 0; y < 16; ++y) bits[y] |= (~rows[x][y] & 0x1fffu) >> dz;
    }
    for (size_t y = 0; y < 16; ++y) result.bytes[x][y] = static_cast<std::uint8_t>(bits[y] & 0xffu);
  }
  return result;
}

/// Eight bytes from `at` on, for the eight rows of cells along y.
std::uint64_t eight(const std::uint8_t* at) {
  std::uint64_t bytes = 0;
  std::memcpy(&bytes, at, sizeof bytes);
  return bytes;
}

}  // namespace

CrossedCells cells_outside(const CrossedCells& crossed, const ActiveRows& rows, const Stencil& stencil) {
  std::array<std::uint64_t, 8> found{};
  std::array<bool, 64> done{};
  for (size_t first = 0; first < 36; ++first) {
    const std::uint8_t mask = stencil[first / 6][first % 6];
    LIMN_CHECK(mask < done.size());
    if (mask == 0 || done[mask]) continue;
    done[mask] = true;
    const RowsOutside outside = rows_outside(rows, mask);
    for (size_t place = first; place < 36; ++place) {
      const size_t dx = place / 6, dy = place % 6;
      if (stencil[dx][dy] != mask) continue;
      for (size_t x = 0; x < 8; ++x) found[x] |= eight(&outside.bytes[x + dx][dy]);
    }
  }
  CrossedCells result;
  for (size_t x = 0; x < 8; ++x) {
    const std::uint64_t lacking = found[x] & eight(crossed.cells[x]);
    std::memcpy(result.cells[x], &lacking, sizeof lacking);
    result.any = result.any || lacking != 0;
  }
  return result;
}

}  // namespace limn
