// The grids of a .vdb file.

#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/io/io.h>

#include <fstream>
#include <map>

#include "sdf/error.h"
#include "sdf/openvdb_grid.h"
#include "sdf/openvdb_metadata.h"
#include "sdf/openvdb_stored.h"

namespace limn {
namespace {

namespace fs = std::filesystem;
using openvdb::io::GridDescriptor;

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
    size_ = static_cast<std::int64_t>(fs::file_size(file));
    stream_.open(file, std::ios::binary);
    stream_.exceptions(std::ios::failbit | std::ios::badbit);
    openvdb::io::setStreamMetadataPtr(stream_, metadata_of_stream_, false);
    readHeader(stream_);
    openvdb::io::setVersion(stream_, libraryVersion(), fileVersion());
    openvdb::io::setDataCompression(stream_, compression());
    metadata_.readMeta(stream_);
    const std::int32_t count = readGridCount(stream_);
    for (std::int32_t i = 0; i < count; ++i) read_entry();
  }

  const std::vector<Entry>& entries() const { return entries_; }
  const openvdb::MetaMap& metadata() const { return metadata_; }
  bool has_voxels() const { return !inputHasGridOffsets(); }

  openvdb::GridBase::Ptr read_voxels(const Entry& entry) {
    if (has_voxels() && !entry.descriptor.isInstance()) return entry.grid;
    const Entry& source = entry.descriptor.isInstance() ? parent_of(entry) : entry;
    openvdb::GridBase::Ptr voxels;
    if (has_voxels()) {
      voxels = source.grid->deepCopyGrid();
    } else {
      // A grid before this one may have been broken.
      stream_.clear();
      voxels = source.grid->copyGridWithNewTree();
      voxels->clearMetadata();
      source.descriptor.seekToGrid(stream_);
      readGrid(voxels, source.descriptor, stream_);
    }
    voxels->clearMetadata();
    for (auto meta = entry.grid->beginMeta(); meta != entry.grid->endMeta(); ++meta)
      if (meta->second) voxels->insertMeta(meta->first, *meta->second);
    if (&source != &entry) voxels->setTransform(entry.grid->transform().copy());
    return voxels;
  }

  /// The entry that a grid's voxels are filed with: its own, or another's whose tree it shares.
  const Entry& parent_of(const Entry& entry) const {
    for (const Entry& other : entries_)
      if (other.descriptor.uniqueName() == entry.descriptor.instanceParentName() && !other.descriptor.isInstance()) return other;
    throw InputError({.file = {},
                      .field = "grid",
                      .value = entry.grid->getName(),
                      .problem = "shares the voxels of a grid that is not in the file",
                      .expected = "an undamaged file"});
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
      // Going beyond the end of a file is no error to a stream.
      if (static_cast<std::int64_t>(stream_.tellg()) > size_) throw std::ios::failure("breaks off");
    }
    entries_.push_back(std::move(entry));
  }

  // The stream keeps the address of this pointer, as long as it is read.
  openvdb::io::StreamMetadata::Ptr metadata_of_stream_ = std::make_shared<openvdb::io::StreamMetadata>();
  std::ifstream stream_;
  std::int64_t size_ = 0;
  openvdb::MetaMap metadata_;
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

std::int64_t voxel_count(const Archive& archive, const Archive::Entry& entry) {
  const Archive::Entry& filed = entry.descriptor.isInstance() ? archive.parent_of(entry) : entry;
  if (archive.has_voxels()) return static_cast<std::int64_t>(filed.grid->activeVoxelCount());
  const auto stored = filed.grid->getMetadata<openvdb::Int64Metadata>(openvdb::GridBase::META_FILE_VOXEL_COUNT);
  return stored ? stored->value() : -1;
}

StoredGrid stored(const Archive& archive, const Archive::Entry& entry) {
  const openvdb::GridBase& grid = *entry.grid;
  const openvdb::Vec3d size = grid.voxelSize();
  return {.name = grid.getName(),
          .shown = GridDescriptor::nameAsString(entry.descriptor.uniqueName()),
          .value_type = value_type(entry),
          .grid_class = class_name(grid),
          .warped = grid.transform().isLinear() ? "" : grid.transform().mapType(),
          .voxels = voxel_count(archive, entry),
          .voxel_size = std::min({size.x(), size.y(), size.z()}),
          .is_distance = grid.isType<openvdb::FloatGrid>() || grid.isType<openvdb::DoubleGrid>()};
}

}  // namespace

StoredGrids stored_in_vdb(const fs::path& file) {
  const auto archive = std::make_shared<Archive>(file);
  StoredGrids grids;
  grids.metadata = plain_metadata(archive->metadata());
  for (const Archive::Entry& entry : archive->entries()) grids.list.push_back(stored(*archive, entry));
  grids.read = [archive](size_t i) { return archive->read_voxels(archive->entries()[i]); };
  return grids;
}

void number_equal_names(std::vector<StoredGrid>& grids) {
  std::map<std::string, int> count, next;
  for (const StoredGrid& grid : grids) ++count[grid.name];
  for (StoredGrid& grid : grids) {
    const bool numbered = count[grid.name] > 1 || grid.name.empty();
    grid.shown = numbered ? grid.name + "[" + std::to_string(next[grid.name]++) + "]" : grid.name;
  }
}

}  // namespace limn
