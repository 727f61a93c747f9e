#include <openvdb/io/File.h>

#include <fstream>

#include "sdf/error.h"
#include "sdf/openvdb_grid.h"
#include "sdf/output_file.h"
#include "sdf/read_vdb.h"

namespace limn {
namespace {

/// OpenVDB stamps every file with a random number, so that no two runs would write the same bytes; the nil UUID says "none".
void erase_uuid(const std::filesystem::path& path) {
  // Magic number (8 bytes), file version, library version (4 + 4 + 4), whether there are offsets (1); then 36 characters.
  constexpr std::streamoff kUuid = 21;
  const std::string nil = "00000000-0000-0000-0000-000000000000";
  std::fstream stream(path, std::ios::binary | std::ios::in | std::ios::out);
  std::string found(nil.size(), ' ');
  stream.seekg(kUuid);
  stream.read(found.data(), static_cast<std::streamsize>(found.size()));
  LIMN_CHECK(stream && found[8] == '-' && found[23] == '-');
  stream.seekp(kUuid);
  stream.write(nil.data(), static_cast<std::streamsize>(nil.size()));
  stream.close();
  if (!stream) throw MachineError(path.string() + ": writing failed (is the disk full?)");
}

/// What openvdb::io::File writes, to a stream of ours: it opens one itself and never looks whether what it wrote arrived.
struct CheckedArchive : openvdb::io::Archive {
  using Archive::write;
};

}  // namespace

void write_level_set(const LevelSet& level_set, const std::filesystem::path& file) {
  const auto grid = thaw(level_set);
  write_whole(file, [&](const std::filesystem::path& path) {
    try {
      std::ofstream stream(path, std::ios::binary | std::ios::trunc);
      CheckedArchive target;
      target.setCompression(openvdb::io::COMPRESS_ZIP | openvdb::io::COMPRESS_ACTIVE_MASK);
      target.write(stream, openvdb::GridCPtrVec{grid}, true);
      stream.close();
      if (!stream) throw std::runtime_error("is the disk full?");
    } catch (const std::exception& problem) {
      throw MachineError(file.string() + ": writing failed: " + problem.what());
    }
    erase_uuid(path);
  });
}

std::shared_ptr<LevelSetData> rebuild(std::span<const LevelSetBlock> blocks, std::span<const VdbTile> tiles, float background,
                                      const Affine& world_from_index, const std::string& name) {
  const auto grid = empty_level_set(static_cast<double>(background));
  // Tiles first and the large ones before the small, so that nothing overwrites what is finer.
  for (int level = 3; level >= 1; --level)
    for (const VdbTile& tile : tiles)
      if (tile.level == level)
        grid->tree().addTile(static_cast<openvdb::Index>(level), openvdb::Coord(tile.origin.x, tile.origin.y, tile.origin.z), -background,
                             false);
  for (const LevelSetBlock& block : blocks) add_leaf(grid->tree(), block);
  return freeze(*grid, world_from_index, name, 0.0);
}

}  // namespace limn
