#include <fmt/format.h>
#include <openvdb/io/File.h>

#include <cmath>
#include <fstream>

#include "sdf/error.h"
#include "sdf/openvdb_grid.h"
#include "sdf/openvdb_metadata.h"
#include "sdf/openvdb_settle.h"
#include "sdf/volume_module.h"

namespace limn {
namespace {

/// OpenVDB stamps every file with a random number, so that no two runs would write the same bytes; the nil UUID says "none". In the stream
/// that wrote it: somebody may have removed the file meanwhile, and opening it again would fail.
void erase_uuid(std::fstream& stream) {
  // Magic number (8 bytes), file version, library version (4 + 4 + 4), whether there are offsets (1); then 36 characters.
  constexpr std::streamoff kUuid = 21;
  const std::string nil = "00000000-0000-0000-0000-000000000000";
  std::string found(nil.size(), ' ');
  stream.seekg(kUuid);
  stream.read(found.data(), static_cast<std::streamsize>(found.size()));
  // A disk that failed is the caller's to say; what arrived whole is of the form that OpenVDB writes.
  LIMN_CHECK(!stream || (found[8] == '-' && found[23] == '-'));
  stream.seekp(kUuid);
  stream.write(nil.data(), static_cast<std::streamsize>(nil.size()));
}

/// What openvdb::io::File writes, to a stream of ours: it opens one itself and never looks whether what it wrote arrived.
struct CheckedArchive : openvdb::io::Archive {
  using Archive::write;
};

/// The file's own doubles where there are any; nodes that it did not have keep what single precision made of them.
openvdb::DoubleGrid::Ptr with_doubles(const openvdb::FloatGrid& grid, const std::vector<DoubleBlock>& blocks) {
  const auto doubles = std::make_shared<openvdb::DoubleGrid>(grid);
  for (const DoubleBlock& block : blocks) {
    auto* leaf = doubles->tree().probeLeaf(openvdb::Coord(block.origin.x, block.origin.y, block.origin.z));
    if (leaf == nullptr) continue;
    for (auto node = leaf->beginValueOn(); node; ++node) {
      const double exact = block.values[node.pos()];
      if (static_cast<float>(exact) == static_cast<float>(*node)) node.setValue(exact);
    }
  }
  return doubles;
}

/// Voxels of our own may be smaller than OpenVDB's transforms can be.
openvdb::math::Transform::Ptr transform_of(const LevelSetInfo& info) {
  const Affine& map = info.world_from_index;
  constexpr double kLeastDeterminant = 1e-14;
  if (!(std::abs(glm::determinant(map.linear)) > kLeastDeterminant))
    throw InputError({{},
                      "voxel size",
                      fmt::format("{:.3g}", info.voxel_size),
                      "a .vdb file cannot hold voxels as small as this",
                      "voxels of 3e-5 or more: scale the scene up"});
  openvdb::math::Mat4d matrix = openvdb::math::Mat4d::identity();
  // OpenVDB multiplies row vectors from the left: its rows are our columns.
  for (int axis = 0; axis < 3; ++axis) {
    for (int k = 0; k < 3; ++k) matrix(axis, k) = map.linear[axis][k];
    matrix(3, axis) = map.translation[axis];
  }
  return openvdb::math::Transform::createLinearTransform(matrix);
}

/// Half precision ends at 65504, and near 0 it is coarser than a thousandth of such a voxel.
bool fits_half(const openvdb::FloatGrid& grid, double voxel_size) {
  return std::abs(static_cast<double>(grid.background())) < 65504.0 && voxel_size > 1e-4;
}

/// A grid as it is filed: of its value type and with its metadata.
openvdb::GridBase::Ptr filed(const LevelSet& level_set) {
  const GridFile& file = level_set.data().file;
  const openvdb::FloatGrid::Ptr grid = thaw(level_set);
  const openvdb::GridBase::Ptr result =
      file.value_type == "double" ? openvdb::GridBase::Ptr(with_doubles(*grid, file.doubles)) : openvdb::GridBase::Ptr(grid);
  add_metadata(file.metadata, *result);
  result->setName(level_set.info().name);
  result->setTransform(transform_of(level_set.info()));
  result->setGridClass(openvdb::GRID_LEVEL_SET);
  if (file.value_type == "half" && fits_half(*grid, level_set.info().voxel_size)) result->setSaveFloatAsHalf(true);
  return result;
}

}  // namespace

void volumes::write_level_sets(std::span<const LevelSet> level_sets, const std::filesystem::path& temporary,
                               const std::filesystem::path& file) {
  openvdb::GridCPtrVec grids;
  for (const LevelSet& level_set : level_sets) grids.push_back(filed(level_set));
  openvdb::MetaMap of_file;
  for (const LevelSet& level_set : level_sets) add_metadata(level_set.data().file.of_file, of_file);
  try {
    std::fstream stream(temporary, std::ios::binary | std::ios::in | std::ios::out | std::ios::trunc);
    CheckedArchive target;
    target.setCompression(openvdb::io::COMPRESS_ZIP | openvdb::io::COMPRESS_ACTIVE_MASK);
    target.write(stream, grids, true, of_file);
    erase_uuid(stream);
    stream.close();
    if (!stream) throw std::runtime_error("is the disk full?");
  } catch (const std::exception& problem) {
    throw MachineError(file.string() + ": writing failed: " + problem.what());
  }
}

std::shared_ptr<LevelSetData> volumes::rebuild(std::span<const LevelSetBlock> blocks, std::span<const VdbTile> tiles, float background,
                                               const Affine& world_from_index, const std::string& name) {
  const auto grid = empty_level_set(static_cast<double>(background));
  // Tiles first and the large ones before the small, so that nothing overwrites what is finer.
  for (int level = 3; level >= 1; --level)
    for (const VdbTile& tile : tiles)
      if (tile.level == level)
        grid->tree().addTile(static_cast<openvdb::Index>(level), openvdb::Coord(tile.origin.x, tile.origin.y, tile.origin.z), -background,
                             false);
  for (const LevelSetBlock& block : blocks) add_leaf(grid->tree(), block);
  std::shared_ptr<LevelSetData> data = freeze(*grid, world_from_index, name, 0.0);
  const std::int64_t torn = cells_lacking(LevelSet(data), find_gradient("cell"));
  if (torn == 0) return data;
  // Signs that no flood fill made jump at the edges of a band that is whole; at those of a torn one they jump after it, too.
  const std::shared_ptr<LevelSetData> filled = freeze(*flood_filled(*grid), world_from_index, name, 0.0);
  if (10 * cells_lacking(LevelSet(filled), find_gradient("cell")) > torn || filled->info.bounds.empty()) {
    seal_tiles(*grid, tiles);
    return freeze(*grid, world_from_index, name, 0.0);
  }
  filled->info.warnings.emplace_back("the signs outside the narrow band contradicted its edges at " + std::to_string(torn) +
                                     " cells (the file was not flood-filled); they are carried on from the band");
  return filled;
}

}  // namespace limn
