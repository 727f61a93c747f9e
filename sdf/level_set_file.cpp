#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <optional>

#include "sdf/error.h"
#include "sdf/finite.h"
#include "sdf/guard.h"
#include "sdf/level_set_data.h"
#include "sdf/level_set_leaks.h"
#include "sdf/level_set_nano.h"
#include "sdf/local_grid.h"
#include "sdf/parallel.h"
#include "sdf/read_vdb.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

double ms_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

[[noreturn]] void refuse(const fs::path& file, const std::string& problem, const std::string& expected) {
  throw InputError({.file = file.string(), .field = "grid", .value = {}, .problem = problem, .expected = expected});
}

/// In proportion to the file: what takes longer or more than this is no honest volume of that size.
GuardLimits limits_for(const fs::path& file) {
  const auto bytes = static_cast<std::int64_t>(fs::file_size(file));
  GuardLimits limits;
  limits.memory_bytes = std::clamp<std::int64_t>((std::int64_t{2} << 30) + 64 * bytes, 0, std::int64_t{64} << 30);
  limits.answer_bytes = limits.memory_bytes / 2;
  limits.time = std::chrono::seconds(20 + bytes / 4'000'000);
  return limits;
}

MappedBytes ask(const fs::path& file, std::vector<std::string> arguments) {
  check_readable(file, "a volume (.vdb .nvdb)");
  // An absolute path is never taken for anything else by whoever reads it.
  arguments.insert(arguments.begin() + 1, fs::absolute(file).string());
  return run_guarded("limn-read-vdb", arguments, file, limits_for(file));
}

Affine read_map(ByteReader& answer, const fs::path& file) {
  Affine map;
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 3; ++row) (column < 3 ? map.linear[column][row] : map.translation[row]) = answer.get<double>();
  const Affine back = inverse(map);
  for (const Affine& each : {map, back})
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 4; ++column)
        if (!std::isfinite(column < 3 ? each.linear[column][row] : each.translation[row]))
          refuse(file, "its transform from voxels to world cannot be inverted", "voxels of a size above 0");
  return map;
}

/// A root node's tile is 4096 wide; beyond this index the arithmetic of coordinates would overflow.
constexpr int kLargestIndex = 1 << 28;

bool well_placed(const glm::ivec3& origin, int multiple) {
  for (int axis = 0; axis < 3; ++axis)
    if (origin[axis] % multiple != 0 || std::abs(static_cast<std::int64_t>(origin[axis])) > kLargestIndex) return false;
  return true;
}

void check_blocks(std::span<const LevelSetBlock> blocks, std::span<const VdbTile> tiles, const fs::path& file) {
  std::vector<std::array<int, 3>> origins(blocks.size());
  // All threads: whoever looks first at the answer's pages gets them from the system.
  const auto good_part = [&](const IndexRange<size_t>& part, bool so_far) {
    for (size_t i = part.first; i < part.last; ++i) {
      const glm::ivec3& origin = blocks[i].origin;
      origins[i] = {origin.x, origin.y, origin.z};
      so_far = so_far && well_placed(origin, 8) && all_finite(blocks[i].values);
    }
    return so_far;
  };
  bool good = parallel_reduce(blocks.size(), size_t{256}, true, good_part, std::logical_and<>());
  parallel_sort(origins.begin(), origins.end(), std::less<>());
  good = good && std::adjacent_find(origins.begin(), origins.end()) == origins.end();
  for (const VdbTile& tile : tiles) good = good && tile.level >= 1 && tile.level <= 3 && well_placed(tile.origin, 8);
  if (!good) refuse(file, "its tree of voxels is not in order", "an undamaged file");
}

std::vector<GridMetadata> read_metadata(ByteReader& answer) {
  std::vector<GridMetadata> entries;
  const auto count = answer.get<std::uint64_t>();
  for (std::uint64_t i = 0; i < count; ++i) {
    GridMetadata& entry = entries.emplace_back();
    entry.name = answer.get_text();
    entry.type = answer.get_text();
    entry.bytes = answer.get_text();
  }
  return entries;
}

GridFile read_beside(ByteReader& answer) {
  GridFile beside;
  beside.value_type = answer.get_text();
  beside.grid_class = answer.get_text();
  beside.metadata = read_metadata(answer);
  beside.of_file = read_metadata(answer);
  beside.doubles = answer.get_vector<DoubleBlock>();
  return beside;
}

/// Of a grid whose signs are in order and whose band holds all cells of the surface, without OpenVDB; of any other with it.
std::shared_ptr<LevelSetData> rebuilt(std::span<const LevelSetBlock> blocks, std::span<const VdbTile> tiles, float background,
                                      const Affine& world_from_index, const std::string& name) {
  if (auto grid = nano_grid_as_filed(blocks, tiles, background)) {
    std::shared_ptr<LevelSetData> data = make_level_set(std::move(*grid), world_from_index, name, 0.0);
    if (cells_lacking(LevelSet(data), find_gradient("cell")) == 0) return data;
  }
  return rebuild(blocks, tiles, background, world_from_index, name);
}

std::vector<GridSummary> read_list(ByteReader& answer) {
  std::vector<GridSummary> grids;
  const auto count = answer.get<std::uint64_t>();
  for (std::uint64_t i = 0; i < count; ++i) {
    GridSummary& grid = grids.emplace_back();
    grid.name = answer.get_text();
    grid.value_type = answer.get_text();
    grid.grid_class = answer.get_text();
    grid.active_voxels = answer.get<std::int64_t>();
    grid.voxel_size = answer.get<double>();
  }
  return grids;
}

void check_surface(LevelSetData& data, const fs::path& file) {
  if (data.info.bounds.empty())
    refuse(file, no_surface_problem(data.info.name, data.info.band), "a level set with an inside (" + with_inside_remedy() + ")");
  if (std::string warning = unsigned_surface_warning(data.info.band); !warning.empty()) data.info.warnings.push_back(std::move(warning));
}

}  // namespace

std::vector<GridSummary> list_grids(const fs::path& file) { return grids_from_answer(ask(file, {"list"}), file); }

std::vector<GridSummary> grids_from_answer(std::span<const std::byte> bytes, const fs::path& file) {
  ByteReader answer(bytes, file.string());
  return read_list(answer);
}

LevelSet read_level_set(const fs::path& file, const std::string& grid) {
  const auto started = std::chrono::steady_clock::now();
  const auto data = level_set_from_answer(ask(file, {"grid", grid}), file);
  data->info.build_ms = ms_since(started);
  return LevelSet(data);
}

std::shared_ptr<LevelSetData> level_set_from_answer(std::span<const std::byte> bytes, const fs::path& file) {
  ByteReader answer(bytes, file.string());
  const std::string name = answer.get_text();
  const Affine world_from_index = read_map(answer, file);
  const auto background = answer.get<float>();
  const auto blocks = answer.get_in_place<LevelSetBlock>();
  const auto tiles = answer.get_vector<VdbTile>();
  GridFile beside = read_beside(answer);
  if (!answer.done() || !std::isfinite(background) || !(background > 0.0f) || blocks.empty())
    refuse(file, "the reader's answer is not in order", "an undamaged file");
  check_blocks(blocks, tiles, file);

  std::shared_ptr<LevelSetData> data = rebuilt(blocks, tiles, background, world_from_index, name);
  check_surface(*data, file);
  if (beside.grid_class != "level set")
    data->info.warnings.emplace_back("the grid '" + name + "' has no class; it is read as a level set, since its values change sign");
  data->file = std::move(beside);
  return data;
}

VdbFile vdb_file_from_answer(std::span<const std::byte> bytes, const fs::path& file) {
  ByteReader answer(bytes, file.string());
  VdbFile result;
  result.grids = read_list(answer);
  if (answer.get<std::uint8_t>() == 0) {
    result.only = level_set_from_answer(answer.get_bytes(), file);
    return result;
  }
  std::vector<ReadGrid> grids;
  std::optional<InputError> first;
  const auto leave_out = [&](const std::string& name, const InputError& error) {
    if (!first) first = error;
    result.several.left_out.emplace_back("'" + name + "' is left out: " + error.fault().problem);
  };
  while (!answer.done()) {
    const std::string name = answer.get_text();
    if (answer.get<std::uint8_t>() == 0) {
      leave_out(name, InputError({file.string(), "grid", name, answer.get_text(), ""}));
      continue;
    }
    const std::span<const std::byte> own = answer.get_bytes();
    try {
      grids.push_back({name, level_set_from_answer(own, file)});
    } catch (const InputError& error) {
      leave_out(name, error);
    }
  }
  if (grids.empty() && first) throw *first;
  for (const ReadGrid& grid : join_local_grids(std::move(grids), file.string()))
    result.several.grids.push_back({grid.name, LevelSet(grid.data)});
  return result;
}

VdbFile read_vdb_file(const fs::path& file) {
  const auto started = std::chrono::steady_clock::now();
  VdbFile result = vdb_file_from_answer(ask(file, {"all"}), file);
  if (result.only) result.only->info.build_ms = ms_since(started);
  return result;
}

}  // namespace limn
