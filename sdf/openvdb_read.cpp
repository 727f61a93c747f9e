#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/io/io.h>

#include <cmath>
#include <fstream>

#include "sdf/error.h"
#include "sdf/guard.h"
#include "sdf/openvdb_grid.h"
#include "sdf/read_vdb.h"

namespace limn {
namespace {

namespace fs = std::filesystem;
using openvdb::io::GridDescriptor;

[[noreturn]] void refuse(const std::string& field, const std::string& value, const std::string& problem, const std::string& expected) {
  throw InputError({.file = {}, .field = field, .value = value, .problem = problem, .expected = expected});
}

/// Reads the table of grids, and one grid. OpenVDB's own File opens its stream itself and does not notice where a file breaks off; this
/// one reads from a stream that throws at the first missing byte.
class Archive : public openvdb::io::Archive {
 public:
  struct Entry {
    GridDescriptor descriptor;
    openvdb::GridBase::Ptr grid;  ///< Metadata and transform read; voxels only in a file without offsets.
  };

  explicit Archive(const fs::path& file) {
    initialize_openvdb();
    stream_.open(file, std::ios::binary);
    stream_.exceptions(std::ios::failbit | std::ios::badbit);
    openvdb::io::setStreamMetadataPtr(stream_, metadata_of_stream_, false);
    readHeader(stream_);
    openvdb::io::setVersion(stream_, libraryVersion(), fileVersion());
    openvdb::io::setDataCompression(stream_, compression());
    openvdb::MetaMap metadata;
    metadata.readMeta(stream_);
    const std::int32_t count = readGridCount(stream_);
    for (std::int32_t i = 0; i < count; ++i) read_entry();
  }

  const std::vector<Entry>& entries() const { return entries_; }
  bool has_voxels() const { return !inputHasGridOffsets(); }

  openvdb::GridBase::Ptr read_voxels(const Entry& entry) {
    if (has_voxels()) return entry.grid;
    const Entry& source = entry.descriptor.isInstance() ? parent_of(entry) : entry;
    const openvdb::GridBase::Ptr voxels = source.grid->copyGridWithNewTree();
    voxels->clearMetadata();
    source.descriptor.seekToGrid(stream_);
    readGrid(voxels, source.descriptor, stream_);
    if (&source != &entry) voxels->setTransform(entry.grid->transform().copy());
    return voxels;
  }

 private:
  void read_entry() {
    Entry entry;
    entry.grid = entry.descriptor.read(stream_);
    if (!inputHasGridOffsets()) {
      readGrid(entry.grid, entry.descriptor, stream_);
    } else {
      entry.descriptor.seekToGrid(stream_);
      readGridCompression(stream_);
      entry.grid->readMeta(stream_);
      entry.grid->readTransform(stream_);
      entry.descriptor.seekToEnd(stream_);
    }
    entries_.push_back(std::move(entry));
  }

  const Entry& parent_of(const Entry& entry) const {
    for (const Entry& other : entries_)
      if (other.descriptor.uniqueName() == entry.descriptor.instanceParentName() && !other.descriptor.isInstance()) return other;
    refuse("grid", entry.grid->getName(), "shares the voxels of a grid that is not in the file", "an undamaged file");
  }

  // The stream keeps the address of this pointer, as long as it is read.
  openvdb::io::StreamMetadata::Ptr metadata_of_stream_ = std::make_shared<openvdb::io::StreamMetadata>();
  std::ifstream stream_;
  std::vector<Entry> entries_;
};

std::string value_type(const Archive::Entry& entry) {
  const std::string type = entry.grid->valueType();
  return entry.descriptor.saveFloatAsHalf() && (type == "float" || type == "double") ? "half" : type;
}

std::string class_name(const openvdb::GridBase& grid) {
  const openvdb::GridClass grid_class = grid.getGridClass();
  return grid_class == openvdb::GRID_UNKNOWN ? "unknown" : openvdb::GridBase::gridClassToString(grid_class);
}

std::int64_t voxel_count(const openvdb::GridBase& grid, bool has_voxels) {
  if (has_voxels) return static_cast<std::int64_t>(grid.activeVoxelCount());
  const auto stored = grid.getMetadata<openvdb::Int64Metadata>(openvdb::GridBase::META_FILE_VOXEL_COUNT);
  return stored ? stored->value() : 0;
}

std::string described(const Archive::Entry& entry) {
  return "'" + entry.grid->getName() + "' (" + class_name(*entry.grid) + ", " + value_type(entry) + ")";
}

std::string all_described(const Archive& archive) {
  std::string text;
  for (const Archive::Entry& entry : archive.entries()) text += (text.empty() ? "" : ", ") + described(entry);
  return text.empty() ? "none" : text;
}

bool is_readable_type(const openvdb::GridBase& grid) { return grid.isType<openvdb::FloatGrid>() || grid.isType<openvdb::DoubleGrid>(); }

void check_kind(const Archive::Entry& entry) {
  const openvdb::GridBase& grid = *entry.grid;
  const std::string what = "the grid '" + grid.getName() + "'";
  if (!is_readable_type(grid)) refuse("grid", value_type(entry), what + " does not hold distances", "a level set of float, double or half");
  if (grid.getGridClass() == openvdb::GRID_FOG_VOLUME)
    refuse("grid", "fog volume", what + " is a fog volume: densities, without a surface of their own",
           "a grid of class 'level set' (extract the surface of the fog first)");
  if (grid.getGridClass() != openvdb::GRID_LEVEL_SET)
    refuse("grid", class_name(grid), what + " is not marked as a level set", "a grid of class 'level set'");
  if (!grid.transform().isLinear())
    refuse("grid", grid.transform().mapType(), what + " has a frustum transform, in which no distance is true",
           "a linear transform (resample it onto a uniform grid)");
}

const Archive::Entry& choose(const Archive& archive, const std::string& name) {
  const Archive::Entry* found = nullptr;
  int count = 0;
  for (const Archive::Entry& entry : archive.entries()) {
    const bool fits = name.empty() ? entry.grid->getGridClass() == openvdb::GRID_LEVEL_SET && is_readable_type(*entry.grid)
                                   : entry.grid->getName() == name || entry.descriptor.uniqueName() == name;
    if (!fits) continue;
    if (!found) found = &entry;
    ++count;
  }
  if (!name.empty() && !found) {
    std::vector<std::string> names;
    for (const Archive::Entry& entry : archive.entries()) names.push_back(entry.grid->getName());
    const std::string near = nearest_name(name, names);
    refuse("grid", name, "no such grid",
           (near.empty() ? "" : "did you mean '" + near + "'? ") + std::string("grids in the file: ") + all_described(archive));
  }
  if (name.empty() && !found && archive.entries().size() == 1) check_kind(archive.entries().front());
  if (name.empty() && !found) refuse("grid", "", "no level set in the file", "one of class 'level set'; grids: " + all_described(archive));
  if (name.empty() && count > 1) refuse("grid", "", "more than one level set", "one of them by name; grids: " + all_described(archive));
  return *found;
}

openvdb::FloatGrid::Ptr as_float(const openvdb::GridBase::Ptr& grid) {
  if (const auto single = openvdb::gridPtrCast<openvdb::FloatGrid>(grid)) return single;
  return std::make_shared<openvdb::FloatGrid>(*openvdb::gridPtrCast<openvdb::DoubleGrid>(grid));
}

void check_voxels(const openvdb::FloatGrid& grid, const std::string& name) {
  const std::string what = "the grid '" + name + "'";
  const float background = grid.background();
  if (grid.activeVoxelCount() == 0) refuse("grid", name, what + " is empty: it has no active voxel", "a narrow band of distances");
  if (!std::isfinite(background) || background <= 0.0f)
    refuse("grid", std::to_string(background), what + " is not initialised: its background is not a distance",
           "the band's half width, above 0");
  if (grid.tree().activeTileCount() > 0)
    refuse("grid", name, what + " has constant regions that are active: no band of distances", "active voxels in a narrow band only");
}

LevelSetBlock block_of(const openvdb::FloatTree::LeafNodeType& leaf, float background, const std::string& name) {
  LevelSetBlock block{};
  block.origin = {leaf.origin().x(), leaf.origin().y(), leaf.origin().z()};
  for (openvdb::Index word = 0; word < 8; ++word) block.active[word] = leaf.valueMask().getWord<openvdb::Index64>(word);
  for (openvdb::Index n = 0; n < 512; ++n) {
    const float value = leaf.getValue(n);
    if (leaf.isValueOn(n) && !std::isfinite(value))
      refuse("grid", std::to_string(value), "the grid '" + name + "' holds a distance that is no number", "finite values");
    block.values[n] = leaf.isValueOn(n) ? value : value < 0.0f ? -background : background;
  }
  return block;
}

std::vector<LevelSetBlock> blocks_of(const openvdb::FloatGrid& grid, const std::string& name) {
  std::vector<LevelSetBlock> blocks;
  blocks.reserve(grid.tree().leafCount());
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf)
    if (!leaf->isEmpty()) blocks.push_back(block_of(*leaf, grid.background(), name));
  return blocks;
}

std::vector<VdbTile> inner_tiles_of(const openvdb::FloatGrid& grid) {
  std::vector<VdbTile> tiles;
  auto tile = grid.tree().cbeginValueOff();
  tile.setMaxDepth(openvdb::FloatTree::ValueOffCIter::LEAF_DEPTH - 1);
  for (; tile; ++tile)
    if (*tile < 0.0f)
      tiles.push_back({{tile.getCoord().x(), tile.getCoord().y(), tile.getCoord().z()}, static_cast<std::int32_t>(tile.getLevel())});
  // A leaf without an active voxel is not sent; inside, it becomes a tile.
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf)
    if (leaf->isEmpty() && leaf->getFirstValue() < 0.0f) tiles.push_back({{leaf->origin().x(), leaf->origin().y(), leaf->origin().z()}, 1});
  return tiles;
}

/// OpenVDB's exceptions name the class they belong to, which says nothing to anyone who gave us a file.
template <class Read>
std::vector<std::byte> reading(Read&& read) {
  try {
    return read();
  } catch (const InputError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::ios::failure&) {
    refuse("", "", "breaks off before its end", "an undamaged .vdb");
  } catch (const std::exception& problem) {
    refuse("", "", std::string("cannot be read as a volume: ") + problem.what(), "an undamaged .vdb");
  }
}

}  // namespace

std::vector<std::byte> vdb_list_answer(const fs::path& file) {
  return reading([&] {
    const Archive archive(file);
    ByteWriter answer;
    answer.put(static_cast<std::uint64_t>(archive.entries().size()));
    for (const Archive::Entry& entry : archive.entries()) {
      answer.put_text(entry.grid->getName());
      answer.put_text(value_type(entry));
      answer.put_text(class_name(*entry.grid));
      answer.put(voxel_count(*entry.grid, archive.has_voxels()));
      const openvdb::Vec3d size = entry.grid->voxelSize();
      answer.put(std::min({size.x(), size.y(), size.z()}));
    }
    return answer.bytes;
  });
}

std::vector<std::byte> vdb_grid_answer(const fs::path& file, const std::string& name) {
  return reading([&] {
    Archive archive(file);
    const Archive::Entry& entry = choose(archive, name);
    check_kind(entry);
    const openvdb::FloatGrid::Ptr grid = as_float(archive.read_voxels(entry));
    const std::string grid_name = entry.grid->getName();
    check_voxels(*grid, grid_name);

    ByteWriter answer;
    answer.put_text(grid_name);
    const openvdb::math::Mat4d matrix = grid->transform().baseMap()->getAffineMap()->getMat4();
    for (int row = 0; row < 4; ++row)
      for (int k = 0; k < 3; ++k) answer.put(matrix(row, k));
    answer.put(grid->background());
    answer.put_span(std::span<const LevelSetBlock>(blocks_of(*grid, grid_name)));
    answer.put_span(std::span<const VdbTile>(inner_tiles_of(*grid)));
    return answer.bytes;
  });
}

}  // namespace limn
