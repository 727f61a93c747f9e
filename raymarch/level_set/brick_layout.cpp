#include "raymarch/level_set/brick_layout.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "sdf/level_set_band.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

using Leaf = nanovdb::FloatGrid::TreeType::LeafNodeType;
using Accessor = nanovdb::FloatGrid::AccessorType;

size_t at(int x, int y, int z) { return static_cast<size_t>(brick_element(x, y, z)); }

/// Bit f is set where a crossed cell lies at face f (see BrickNeighbors): its stencil reaches into the neighbour.
std::uint8_t touched_faces(const CrossedCells& crossed) {
  std::uint8_t x0 = 0, x7 = 0, y0 = 0, y7 = 0, all = 0;
  for (int k = 0; k < 8; ++k) {
    x0 |= crossed.cells[0][k];
    x7 |= crossed.cells[7][k];
    y0 |= crossed.cells[k][0];
    y7 |= crossed.cells[k][7];
    for (int y = 0; y < 8; ++y) all |= crossed.cells[k][y];
  }
  const bool bits[6] = {x0 != 0, x7 != 0, y0 != 0, y7 != 0, (all & 1) != 0, (all & 128) != 0};
  std::uint8_t faces = 0;
  for (int f = 0; f < 6; ++f) faces = static_cast<std::uint8_t>(faces | bits[f] << f);
  return faces;
}

std::vector<Candidate> candidates_of(std::span<const CrossedBlock> crossed) {
  std::vector<Candidate> candidates(crossed.size());
  parallel_parts(crossed.size(), size_t{1024}, [&](const IndexRange<size_t>& range) {
    for (size_t i = range.begin(); i < range.end(); ++i)
      candidates[i] = {
          .origin = crossed[i].origin, .faces = touched_faces(crossed[i].cells), .largest = crossed[i].largest, .cells = crossed[i].cells};
  });
  return candidates;
}

/// From a block to its neighbour over a face (see BrickNeighbors).
glm::ivec3 face_step(int face) {
  glm::ivec3 step(0);
  step[face / 2] = face % 2 ? 1 : -1;
  return step;
}

/// Which of them, in order, stands over each face that is reached: BrickLayout::beside.
std::vector<std::array<std::int32_t, 6>> find_beside(std::span<const Candidate> crossed) {
  std::vector<std::uint64_t> keys(crossed.size());
  parallel_for(size_t{0}, crossed.size(), [&](size_t i) { keys[i] = key_of(crossed[i].origin); });
  std::vector<std::array<std::int32_t, 6>> beside(crossed.size());
  parallel_for(size_t{0}, crossed.size(), [&](size_t i) {
    for (int face = 0; face < 6; ++face) {
      std::int32_t& other = beside[i][static_cast<size_t>(face)];
      other = -1;
      if ((crossed[i].faces >> face & 1) == 0) continue;
      const std::uint64_t key = key_of(crossed[i].origin + kBrickCells * face_step(face));
      const auto found = std::lower_bound(keys.begin(), keys.end(), key);
      if (found != keys.end() && *found == key) other = static_cast<std::int32_t>(found - keys.begin());
    }
  });
  return beside;
}

/// The crossed ones, by key_of, each once. Their places are sorted, since they themselves are six times as large.
std::vector<Candidate> crossed_in_order(std::span<const Candidate> candidates) {
  using Place = std::pair<std::uint64_t, size_t>;  // key, number
  std::vector<Place> places;
  places.reserve(candidates.size());
  for (size_t i = 0; i < candidates.size(); ++i)
    if (candidates[i].cells.any) places.emplace_back(key_of(candidates[i].origin), i);
  parallel_sort(places.begin(), places.end());
  places.erase(std::unique(places.begin(), places.end(), [](const Place& a, const Place& b) { return a.first == b.first; }), places.end());
  std::vector<Candidate> crossed(places.size());
  parallel_parts(places.size(), size_t{1024}, [&](const IndexRange<size_t>& range) {
    for (size_t i = range.begin(); i < range.end(); ++i) crossed[i] = candidates[places[i].second];
  });
  return crossed;
}

/// Those over whose faces no brick stands.
void find_layers(BrickLayout& layout) {
  for (size_t i = 0; i < layout.crossed.size(); ++i) {
    layout.first_layer.push_back(static_cast<std::uint32_t>(layout.layers.size()));
    for (int face = 0; face < 6; ++face) {
      const bool reached = (layout.crossed[i].faces >> face & 1) != 0;
      if (reached && layout.beside[i][static_cast<size_t>(face)] < 0)
        layout.layers.push_back({.brick = static_cast<std::uint32_t>(i), .face = face});
    }
  }
  layout.first_layer.push_back(static_cast<std::uint32_t>(layout.layers.size()));
}

/// Of a brick over a face: node -1 is node 7 of the one before, node 9 is node 1 of the one behind.
int node_over(int face) { return face % 2 == 0 ? kBrickCells - 1 : 1; }
/// And that of both.
int node_on(int face) { return face % 2 == 0 ? kBrickCells : 0; }

/// What each brick's own stencils read of it, and those of the bricks beside it.
void find_rows(BrickLayout& layout) {
  layout.rows.resize(layout.crossed.size());
  parallel_parts(layout.crossed.size(), size_t{256}, [&](const IndexRange<size_t>& range) {
    for (size_t i = range.begin(); i < range.end(); ++i) layout.rows[i] = rows_read(layout.crossed[i].cells);
  });
  parallel_parts(layout.crossed.size(), size_t{256}, [&](const IndexRange<size_t>& range) {
    for (size_t i = range.begin(); i < range.end(); ++i)
      for (int face = 0; face < 6; ++face) {
        const std::int32_t other = layout.beside[i][static_cast<size_t>(face)];
        if (other < 0) continue;
        BrickRows read = rows_read_over(layout.crossed[i].cells, face, node_over(face));
        // With the face's own nodes, so that cells are kept on both sides of it.
        if (face < 4) read.add(rows_read_over(layout.crossed[i].cells, face, node_on(face)));
        BrickRows& rows = layout.rows[static_cast<size_t>(other)];
        std::atomic_ref(rows.low).fetch_or(read.low, std::memory_order_relaxed);
        std::atomic_ref(rows.high).fetch_or(read.high, std::memory_order_relaxed);
      }
  });
}

/// Of so many bricks one after the other, and of their layers.
class PartOfRows {
 public:
  void place(BrickLayout& layout, size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      layout.first_row[i] = packing_.place(layout.rows[i]);
      for (size_t k = layout.first_layer[i]; k < layout.first_layer[i + 1]; ++k) {
        BrickLayer& layer = layout.layers[k];
        layer.rows = rows_read_over(layout.crossed[i].cells, layer.face, 0);
        if (layer.face < 4)
          layer.first_row = packing_.place(layer.rows);
        else
          add_across_z(layer);
      }
    }
    place_across_z();
  }
  std::int64_t size() const { return packing_.size(); }

 private:
  void add_across_z(BrickLayer& layer) {
    layer.slot = layer_depth(2) * static_cast<int>(waiting_.size());
    waiting_.push_back(&layer);
    rows_.add(layer.rows);
    if (waiting_.size() == kBrickNodes / layer_depth(2)) place_across_z();
  }
  void place_across_z() {
    const std::int64_t row = packing_.place(rows_);
    for (BrickLayer* const layer : waiting_) layer->first_row = row;
    waiting_.clear();
    rows_ = {};
  }

  RowPacking packing_;
  std::vector<BrickLayer*> waiting_{};  ///< Across z, that share rows.
  BrickRows rows_{};                    ///< That they read.
};

/// Parts of the bricks by themselves, so that threads share the work; the same ones whatever their number.
void place_rows(BrickLayout& layout) {
  constexpr size_t kPart = 4096;
  const size_t count = layout.crossed.size();
  layout.first_row.resize(count);
  std::vector<PartOfRows> parts((count + kPart - 1) / kPart);
  parallel_for(size_t{0}, parts.size(), [&](size_t k) { parts[k].place(layout, k * kPart, std::min((k + 1) * kPart, count)); });
  std::int64_t before = kBrickRows;
  for (size_t k = 0; k < parts.size(); before += parts[k++].size()) {
    for (size_t i = k * kPart; i < std::min((k + 1) * kPart, count); ++i) {
      layout.first_row[i] += before;
      for (size_t l = layout.first_layer[i]; l < layout.first_layer[i + 1]; ++l) layout.layers[l].first_row += before;
    }
  }
  layout.row_count = before + kBrickRows;
}

BrickLayout lay_out(std::span<const Candidate> candidates) {
  BrickLayout layout;
  layout.crossed = crossed_in_order(candidates);
  layout.beside = find_beside(layout.crossed);
  find_layers(layout);
  find_rows(layout);
  place_rows(layout);
  return layout;
}

}  // namespace

void load_nodes(const Accessor& accessor, const glm::ivec3& origin, NodeValues& values) {
  for (int corner = 0; corner < 8; ++corner) {
    const int dx = corner & 1, dy = (corner >> 1) & 1, dz = corner >> 2;
    const nanovdb::Coord first(origin.x + 8 * dx, origin.y + 8 * dy, origin.z + 8 * dz);
    const Leaf* leaf = accessor.probeLeaf(first);
    const float* from = leaf ? leaf->data()->mValues : nullptr;
    float tiles[8];
    if (!leaf) std::fill_n(tiles, 8, accessor.getValue(first));
    for (int x = 0; x < (dx ? 1 : 8); ++x) {
      for (int y = 0; y < (dy ? 1 : 8); ++y) {
        float* const to = &values[at(8 * dx + x, 8 * dy + y, 8 * dz)];
        const float* const row = from ? from + x * 64 + y * 8 : tiles;
        // std::copy_n would call a function for each row, which takes longer than to copy it.
        if (dz)
          *to = *row;
        else
          std::memcpy(to, row, 8 * sizeof(float));
      }
    }
  }
}

CrossedCells crossed_cells_of(const NodeSteps& steps) {
  static_assert(std::endian::native == std::endian::little);
  // Bits 15, 31, 47 and 63 become bits 0 to 3.
  const auto signs_of_four = [](const std::int16_t* from) {
    std::uint64_t four = 0;
    std::memcpy(&four, from, sizeof four);
    return static_cast<std::uint32_t>((four >> 15 & 0x0001'0001'0001'0001) * 0x0001'0002'0004'0008 >> 48 & 15);
  };
  SignRows inside;
  const std::int16_t* row = steps.data();
  for (auto& plane : inside)
    for (std::uint32_t& bits : plane) {
      bits = signs_of_four(row) | signs_of_four(row + 4) << 4 | (row[8] < 0 ? 0x100u : 0u);
      row += kBrickNodes;
    }
  return crossed_cells_of_signs(inside);
}

CrossedCells without_covered(CrossedCells crossed, std::uint64_t covered) {
  if (covered == 0 || !crossed.any) return crossed;
  crossed.any = false;
  for (int x = 0; x < kBrickCells; ++x)
    for (int y = 0; y < kBrickCells; ++y) {
      const std::uint64_t four = covered >> covered_bit(x, y, 0) & 15;
      // Bit k of `four` becomes bits 2 k and 2 k + 1.
      const std::uint64_t apart = (four & 1) | (four & 2) << 1 | (four & 4) << 2 | (four & 8) << 3;
      crossed.cells[x][y] = static_cast<std::uint8_t>(crossed.cells[x][y] & ~(apart | apart << 1));
      crossed.any = crossed.any || crossed.cells[x][y] != 0;
    }
  return crossed;
}

std::uint64_t key_of(const glm::ivec3& origin) {
  const auto part = [](int v) { return static_cast<std::uint64_t>((v >> 3) + (1 << 20)) & 0x1fffff; };
  return part(origin.x) << 42 | part(origin.y) << 21 | part(origin.z);
}

BrickNeighbors BrickLayout::neighbors_of(size_t brick) const {
  constexpr int kStep[3] = {kBrickNodes * kBrickNodes, kBrickNodes, 1};
  BrickNeighbors neighbors;
  // From node 0 of a cell at the brick's start, or node 7 of one at its end, to node `to` along the axis of what lies at another row.
  const auto set = [&](int face, std::int64_t row, int to) {
    const std::int64_t elements = (row - first_row[brick]) * kBrickNodes + (to - (face % 2 == 0 ? 0 : kBrickCells - 1)) * kStep[face / 2];
    neighbors.face[face] = static_cast<std::int32_t>(elements * static_cast<std::int64_t>(sizeof(std::int16_t)));
  };
  for (int face = 0; face < 6; ++face) {
    const std::int32_t other = beside[brick][static_cast<size_t>(face)];
    if (other >= 0) set(face, first_row[static_cast<size_t>(other)], node_over(face));
  }
  for (size_t k = first_layer[brick]; k < first_layer[brick + 1]; ++k)
    set(layers[k].face, layers[k].first_row, layers[k].slot + (layers[k].face == 5 ? 1 : 0));
  return neighbors;
}

BrickLayout lay_out_bricks(const LevelSetData& data) {
  return lay_out(candidates_of(data.crossed ? *data.crossed : crossed_blocks(*data.grid)));
}

BrickLayout lay_out_bricks(const NodeReader& nodes, std::span<const BrickPlace> places) {
  std::vector<Candidate> candidates(places.size());
  parallel_parts(places.size(), size_t{64}, [&](const IndexRange<size_t>& range) {
    NodeSteps steps;
    for (size_t i = range.begin(); i < range.end(); ++i) {
      Candidate& candidate = candidates[i];
      candidate.origin = places[i].origin;
      candidate.covered = places[i].covered;
      candidate.place = static_cast<std::uint32_t>(i);
      if (places[i].crossed) {
        candidate.cells = *places[i].crossed;
      } else {
        nodes.load(candidate, steps);
        candidate.cells = without_covered(crossed_cells_of(steps), candidate.covered);
      }
      if (candidate.cells.any) candidate.faces = touched_faces(candidate.cells);
    }
  });
  return lay_out(candidates);
}

}  // namespace limn
