#include "sdf/level_set_nano.h"

#define NANOVDB_USE_TBB
#include <nanovdb/util/GridStats.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <new>
#include <optional>
#include <tuple>

#include "sdf/error.h"
#include "sdf/nano_memory.h"
#include "sdf/page_advice.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

using Grid = nanovdb::FloatGrid;
using Tree = Grid::TreeType;
using Root = Tree::RootType;
using Upper = nanovdb::NanoUpper<float>;
using Lower = nanovdb::NanoLower<float>;
using Leaf = nanovdb::NanoLeaf<float>;

constexpr int kUpperSide = 4096, kLowerSide = 128, kLeafSide = 8;

glm::ivec3 origin_of(const glm::ivec3& place, int side) { return place & ~(side - 1); }

bool less(const glm::ivec3& a, const glm::ivec3& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); }

nanovdb::Coord coord(const glm::ivec3& p) { return {p.x, p.y, p.z}; }

/// A leaf's place as a tree is walked: root tiles by their coordinates, then the children of each node in turn. Of equals the last in the
/// list comes first.
struct Place {
  std::uint64_t upper = 0, leaf = 0;
  glm::ivec3 origin{0};
  size_t index = 0;  ///< In the list.

  bool same(const Place& other) const { return upper == other.upper && leaf == other.leaf; }
  bool operator<(const Place& other) const {
    if (upper != other.upper) return upper < other.upper;
    return leaf != other.leaf ? leaf < other.leaf : index > other.index;
  }
};

/// x, y, z in `bits` bits each.
std::uint64_t joined(const glm::ivec3& place, int bits) {
  const auto part = [bits](int v) { return static_cast<std::uint64_t>(v) & ((std::uint64_t{1} << bits) - 1); };
  return (part(place.x) << bits | part(place.y)) << bits | part(place.z);
}

Place place_of(const glm::ivec3& origin, size_t index) {
  constexpr int kUpperBits = 20;  // a whole number of 32 bits without 12: a root tile is 4096 wide
  return {joined((origin >> 12) + (1 << (kUpperBits - 1)), kUpperBits), joined(origin >> 7, 5) << 12 | joined(origin >> 3, 4), origin,
          index};
}

/// In order, each place once.
std::vector<Place> in_order(std::vector<Place> places) {
  if (!std::is_sorted(places.begin(), places.end())) parallel_sort(places.begin(), places.end());
  places.erase(std::unique(places.begin(), places.end(), [](const Place& a, const Place& b) { return a.same(b); }), places.end());
  return places;
}

/// A node's children are those of the level below from `first` on, to the next node's.
struct Span {
  glm::ivec3 origin{0};
  size_t first = 0;
};

template <class OriginOf>
std::vector<Span> parents(size_t children, const OriginOf& origin_of_child, int side) {
  std::vector<Span> nodes;
  for (size_t i = 0; i < children; ++i) {
    const glm::ivec3 origin = origin_of(origin_of_child(i), side);
    if (nodes.empty() || nodes.back().origin != origin) nodes.push_back({origin, i});
  }
  return nodes;
}

/// The tree's nodes, in order, and where each kind begins in the buffer.
struct Layout {
  std::vector<Place> leaves{};
  std::vector<Span> lowers{}, uppers{};
  size_t root_tiles = 0;
  std::uint8_t* buffer = nullptr;
  std::uint64_t tree_at = 0, root_at = 0, uppers_at = 0, lowers_at = 0, leaves_at = 0, size = 0;

  template <class Node>
  Node& node(std::uint64_t at, size_t index = 0) const {
    return *reinterpret_cast<Node*>(buffer + at + index * sizeof(Node));
  }
  Upper& upper(size_t i) const { return node<Upper>(uppers_at, i); }
  Lower& lower(size_t i) const { return node<Lower>(lowers_at, i); }
  Leaf& leaf(size_t i) const { return node<Leaf>(leaves_at, i); }
};

Layout lay_out(std::vector<Place> places) {
  Layout layout;
  layout.leaves = in_order(std::move(places));
  layout.lowers = parents(
      layout.leaves.size(), [&](size_t i) { return layout.leaves[i].origin; }, kLowerSide);
  layout.uppers = parents(
      layout.lowers.size(), [&](size_t i) { return layout.lowers[i].origin; }, kUpperSide);
  return layout;
}

/// Room for all nodes, and for as many root tiles between them as there could be: which of them are inside shows when nodes are written.
nanovdb::HostBuffer take_memory(Layout& layout) {
  layout.root_tiles = layout.uppers.size();
  for (size_t i = 0; i + 1 < layout.uppers.size(); ++i) {
    const glm::ivec3 a = layout.uppers[i].origin, b = layout.uppers[i + 1].origin;
    if (a.x == b.x && a.y == b.y) layout.root_tiles += static_cast<size_t>((std::int64_t{b.z} - a.z) / kUpperSide - 1);
  }
  layout.tree_at = Grid::memUsage();
  layout.root_at = layout.tree_at + Tree::memUsage();
  layout.uppers_at = layout.root_at + Root::memUsage(static_cast<std::uint32_t>(layout.root_tiles));
  layout.lowers_at = layout.uppers_at + layout.uppers.size() * Upper::memUsage();
  layout.leaves_at = layout.lowers_at + layout.lowers.size() * Lower::memUsage();
  layout.size = layout.leaves_at + layout.leaves.size() * sizeof(Leaf);
  nanovdb::HostBuffer buffer = in_nano_memory([&] { return nanovdb::HostBuffer::create(layout.size); });
  ask_for_large_pages(buffer.data(), layout.size);
  layout.buffer = buffer.data();
  return buffer;
}

size_t end_of(const std::vector<Span>& nodes, size_t i, size_t children) { return i + 1 < nodes.size() ? nodes[i + 1].first : children; }

/// Signs of nodes that have none of their own, from the one before along z, then along y, then along x, as SignedFloodFill.h has it.
/// `sign_at(n)` is the sign of entry n where it has one; `fill(n, inside)` gives it one where it has none.
template <int kLog2Side, class SignAt, class Fill>
void flood_fill(bool inside, const SignAt& sign_at, const Fill& fill) {
  constexpr std::uint32_t kSide = 1u << kLog2Side;
  bool x_inside = inside;
  for (std::uint32_t x = 0; x < kSide; ++x) {
    const std::uint32_t x00 = x << (2 * kLog2Side);
    if (const std::optional<bool> own = sign_at(x00)) x_inside = *own;
    bool y_inside = x_inside;
    for (std::uint32_t y = 0; y < kSide; ++y) {
      const std::uint32_t xy0 = x00 + (y << kLog2Side);
      if (const std::optional<bool> own = sign_at(xy0)) y_inside = *own;
      bool z_inside = y_inside;
      for (std::uint32_t xyz = xy0; xyz < xy0 + kSide; ++xyz) {
        if (const std::optional<bool> own = sign_at(xyz))
          z_inside = *own;
        else
          fill(xyz, z_inside);
      }
    }
  }
}

/// All bytes before a node's values, those that pad its members among them.
template <class Data, class Values>
void clear_head(Data& data, const Values& values) {
  auto* const first = reinterpret_cast<std::uint8_t*>(&data);
  std::fill(first, first + (reinterpret_cast<const std::uint8_t*>(&values) - first), std::uint8_t{0});
}

using InsideAt = std::function<bool(const glm::dvec3&)>;

/// flood_fill() of a leaf, row by row without a branch for each node. Some node is active.
void fill_signs(const LevelSetBlock& block, float background, float* to) {
  size_t first = 0;
  while (first < 8 && block.active[first] == 0) ++first;
  LIMN_CHECK(first < 8);
  first = first * 64 + static_cast<size_t>(std::countr_zero(block.active[first]));
  bool x_inside = block.values[first] < 0.0f;
  for (size_t x = 0; x < 8; ++x) {
    bool y_inside = x_inside;
    for (size_t y = 0; y < 8; ++y) {
      const std::uint64_t active = block.active[x] >> (8 * y) & 0xffu;
      const float* const from = block.values + x * 64 + y * 8;
      float* const row = to + x * 64 + y * 8;
      if ((active & 1u) != 0) y_inside = from[0] < 0.0f;
      if (y == 0) x_inside = y_inside;
      if (active == 0) {
        std::fill_n(row, 8, y_inside ? -background : background);
      } else if (active == 0xffu) {
        std::copy_n(from, 8, row);
      } else {
        float sign = y_inside ? -1.0f : 1.0f;
        for (size_t z = 0; z < 8; ++z) {
          const bool on = (active >> z & 1u) != 0;
          sign = on ? (from[z] < 0.0f ? -1.0f : 1.0f) : sign;
          row[z] = on ? from[z] : std::copysign(background, sign);
        }
      }
    }
  }
}

void write_leaf(const LevelSetBlock& block, float background, bool has_signs, Leaf& leaf) {
  auto& data = *leaf.data();
  clear_head(data, data.mValues);
  data.setOrigin(coord(origin_of(block.origin, kLeafSide)));
  for (int word = 0; word < 8; ++word) data.mValueMask.getWord<std::uint64_t>(word) = block.active[word];
  if (has_signs) {
    std::copy(std::begin(block.values), std::end(block.values), data.mValues);
    for (std::uint32_t n = 0; n < Leaf::SIZE; ++n)
      if (!data.mValueMask.isOn(n)) data.mValues[n] = block.values[n] < 0.0f ? -background : background;
    return;
  }
  fill_signs(block, background, data.mValues);
}

float first_value(const Leaf& leaf) { return leaf.data()->mValues[0]; }
float last_value(const Leaf& leaf) { return leaf.data()->mValues[Leaf::SIZE - 1]; }
float first_value(const Lower& node);
float last_value(const Lower& node);

template <class Node>
float value_at(const Node& node, std::uint32_t n, bool first) {
  const auto& data = *node.data();
  if (!data.mChildMask.isOn(n)) return data.getValue(n);
  return first ? first_value(*data.getChild(n)) : last_value(*data.getChild(n));
}
float first_value(const Lower& node) { return value_at(node, 0, true); }
float last_value(const Lower& node) { return value_at(node, Lower::SIZE - 1, false); }
float first_value(const Upper& node) { return value_at(node, 0, true); }
float last_value(const Upper& node) { return value_at(node, Upper::SIZE - 1, false); }

/// Its children [first, last) of the level below are written already; `child(i)` is one, `origin_of_child(i)` where.
template <class Node, class Child, class OriginOf>
void write_internal(const glm::ivec3& origin, size_t first, size_t last, float background, const InsideAt& inside_at, const Child& child,
                    const OriginOf& origin_of_child, Node& node) {
  auto& data = *node.data();
  clear_head(data, data.mTable);
  data.setOrigin(coord(origin));
  data.mBBox.max() = data.mBBox.min();
  for (size_t i = first; i < last; ++i) {
    const std::uint32_t n = Node::CoordToOffset(coord(origin_of_child(i)));
    data.mChildMask.setOn(n);
    data.setChild(n, &child(i));
  }
  const auto sign_at = [&](std::uint32_t n) {
    return data.mChildMask.isOn(n) ? std::optional<bool>(last_value(*data.getChild(n)) < 0.0f) : std::optional<bool>();
  };
  const bool inside = first_value(child(first)) < 0.0f;
  flood_fill<Node::LOG2DIM>(inside, sign_at, [&](std::uint32_t n, bool in) {
    if (inside_at) {
      const nanovdb::Coord local = Node::OffsetToLocalCoord(n);
      const double side = double{Node::DIM} / (1 << Node::LOG2DIM);
      in = inside_at(glm::dvec3(origin) + side * (glm::dvec3(local[0], local[1], local[2]) + 0.5));
    }
    data.mTable[n].child = 0;  // all of its bytes
    data.setValue(n, in ? -background : background);
  });
}

/// Inside tiles between inside nodes of one row along z.
std::vector<glm::ivec3> root_tiles_inside(const Layout& layout) {
  std::vector<glm::ivec3> tiles;
  for (size_t i = 0; i + 1 < layout.uppers.size(); ++i) {
    const glm::ivec3 a = layout.uppers[i].origin, b = layout.uppers[i + 1].origin;
    if (a.x != b.x || a.y != b.y || !(last_value(layout.upper(i)) < 0.0f) || !(first_value(layout.upper(i + 1)) < 0.0f)) continue;
    for (glm::ivec3 tile = a + glm::ivec3(0, 0, kUpperSide); tile.z != b.z; tile.z += kUpperSide) tiles.push_back(tile);
  }
  return tiles;
}

void write_root(const Layout& layout, std::span<const glm::ivec3> inside, float background) {
  auto& data = *layout.node<Root>(layout.root_at).data();
  std::fill_n(layout.buffer + layout.root_at, Root::memUsage(static_cast<std::uint32_t>(layout.root_tiles)), std::uint8_t{0});
  data.mBackground = data.mMinimum = data.mMaximum = background;
  data.mBBox.min() = nanovdb::Coord::max();
  data.mBBox.max() = nanovdb::Coord::min();
  size_t upper = 0, tile = 0;
  while (upper < layout.uppers.size() || tile < inside.size()) {
    auto* const entry = data.tile(data.mTableSize++);
    if (tile == inside.size() || (upper < layout.uppers.size() && less(layout.uppers[upper].origin, inside[tile]))) {
      entry->setChild(coord(layout.uppers[upper].origin), &layout.upper(upper), &data);
      ++upper;
    } else {
      entry->setValue(coord(inside[tile++]), false, -background);
    }
  }
}

void write_tree(const Layout& layout) {
  auto& data = *layout.node<Tree>(layout.tree_at).data();
  std::fill_n(layout.buffer + layout.tree_at, Tree::memUsage(), std::uint8_t{0});
  data.setRoot(&layout.node<Root>(layout.root_at));
  data.setFirstNode(&layout.upper(0));
  data.setFirstNode(&layout.lower(0));
  data.setFirstNode(&layout.leaf(0));
  data.mNodeCount[0] = static_cast<std::uint32_t>(layout.leaves.size());
  data.mNodeCount[1] = static_cast<std::uint32_t>(layout.lowers.size());
  data.mNodeCount[2] = static_cast<std::uint32_t>(layout.uppers.size());
  data.mVoxelCount += parallel_reduce(
      layout.leaves.size(), size_t{1024}, std::uint64_t{0},
      [&](const IndexRange<size_t>& part, std::uint64_t count) {
        for (size_t i = part.first; i < part.last; ++i) count += layout.leaf(i).data()->mValueMask.countOn();
        return count;
      },
      std::plus<>());
}

void write_grid(const Layout& layout) {
  std::fill_n(layout.buffer, Grid::memUsage(), std::uint8_t{0});
  auto& data = *layout.node<Grid>(0).data();
  data.mMagic = NANOVDB_MAGIC_NUMBER;
  data.mVersion = nanovdb::Version();
  data.mFlags = static_cast<std::uint32_t>(nanovdb::GridFlags::IsBreadthFirst);
  data.mGridCount = 1;
  data.mGridSize = layout.size;
  data.mWorldBBox = nanovdb::BBox<nanovdb::Vec3R>();
  data.mGridClass = nanovdb::GridClass::LevelSet;
  data.mGridType = nanovdb::GridType::Float;
  data.mVoxelSize = nanovdb::Vec3R(1.0);
  const std::array<std::array<double, 4>, 4> identity{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
  data.mMap.set(identity, identity, 1.0);
}

/// `fill` is asked for each of 0, ..., count - 1; what has no place is left out.
nanovdb::GridHandle<nanovdb::HostBuffer> grid_of(std::vector<Place> places, size_t count, const FillLeaves& fill, float background,
                                                 const InsideAt& inside) {
  Layout layout = lay_out(std::move(places));
  LIMN_CHECK(!layout.leaves.empty());
  nanovdb::HostBuffer buffer = take_memory(layout);
  constexpr size_t kNone = std::numeric_limits<size_t>::max();
  std::vector<size_t> leaf_of(count, kNone);
  for (size_t i = 0; i < layout.leaves.size(); ++i) leaf_of[layout.leaves[i].index] = i;
  parallel_parts(count, size_t{1}, [&](const IndexRange<size_t>& part) {
    fill(part, [&](size_t i, const LevelSetBlock& block) {
      if (leaf_of[i] != kNone) write_leaf(block, background, inside != nullptr, layout.leaf(leaf_of[i]));
    });
  });
  parallel_for(size_t{0}, layout.lowers.size(), [&](size_t i) {
    write_internal(
        layout.lowers[i].origin, layout.lowers[i].first, end_of(layout.lowers, i, layout.leaves.size()), background, inside,
        [&](size_t k) -> Leaf& { return layout.leaf(k); }, [&](size_t k) { return layout.leaves[k].origin; }, layout.lower(i));
  });
  parallel_for(size_t{0}, layout.uppers.size(), [&](size_t i) {
    write_internal(
        layout.uppers[i].origin, layout.uppers[i].first, end_of(layout.uppers, i, layout.lowers.size()), background, inside,
        [&](size_t k) -> Lower& { return layout.lower(k); }, [&](size_t k) { return layout.lowers[k].origin; }, layout.upper(i));
  });
  write_root(layout, root_tiles_inside(layout), background);
  write_tree(layout);
  write_grid(layout);
  nanovdb::GridHandle<nanovdb::HostBuffer> handle(std::move(buffer));
  nanovdb::gridStats(*handle.grid<float>(), nanovdb::StatsMode::BBox);
  return handle;
}

}  // namespace

nanovdb::GridHandle<nanovdb::HostBuffer> nano_grid(std::span<const LevelSetBlock> blocks, float background, const InsideAt& inside) {
  std::vector<std::uint8_t> active(blocks.size());
  parallel_for(size_t{0}, blocks.size(), [&](size_t i) { active[i] = has_active_node(blocks[i]) ? 1 : 0; });
  std::vector<Place> places;
  places.reserve(blocks.size());
  for (size_t i = 0; i < blocks.size(); ++i)
    if (active[i] != 0) places.push_back(place_of(blocks[i].origin, i));
  const FillLeaves fill = [&](const IndexRange<size_t>& part, const WriteLeaf& write) {
    for (size_t i = part.first; i < part.last; ++i) write(i, blocks[i]);
  };
  return grid_of(std::move(places), blocks.size(), fill, background, inside);
}

nanovdb::GridHandle<nanovdb::HostBuffer> nano_grid(std::span<const glm::ivec3> origins, const FillLeaves& fill, float background,
                                                   const InsideAt& inside) {
  std::vector<Place> places;
  places.reserve(origins.size());
  for (size_t i = 0; i < origins.size(); ++i) places.push_back(place_of(origins[i], i));
  return grid_of(std::move(places), origins.size(), fill, background, inside);
}

}  // namespace limn
