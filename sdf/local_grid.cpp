#include "sdf/local_grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <tuple>

#include "sdf/error.h"
#include "sdf/level_set_data.h"

namespace limn {
namespace {

constexpr const char* kName = "limn_local";
constexpr int kVersion = 1;
/// More sizes than there can be.
constexpr int kMostSizes = 32;
/// Index coordinates have 28 bits where bricks are numbered.
constexpr int kFarthestBrick = 1 << 23;

std::string with_length(const std::string& text) {
  const auto length = static_cast<std::uint32_t>(text.size());
  std::string bytes(sizeof length, '\0');
  std::memcpy(bytes.data(), &length, sizeof length);
  return bytes + text;
}

/// Words of a text, one after the other.
class Words {
 public:
  explicit Words(std::string_view text) : left_(text) {}
  std::string_view next() {
    const size_t first = std::min(left_.find_first_not_of(' '), left_.size()), end = std::min(left_.find(' ', first), left_.size());
    const std::string_view word = left_.substr(first, end - first);
    left_.remove_prefix(end);
    return word;
  }
  /// False where the next word is none.
  template <class Number>
  bool number(Number& out) {
    const std::string_view word = next();
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), out);
    return error == std::errc() && end == word.data() + word.size();
  }
  bool done() { return left_.find_first_not_of(' ') == std::string_view::npos; }
  /// The rest, as it is, after one blank.
  std::string_view rest() { return left_.empty() ? left_ : left_.substr(1); }

 private:
  std::string_view left_;
};

bool read_head(Words& words, LocalGrid& grid) {
  int version = 0;
  if (!words.number(version) || version != kVersion || !words.number(grid.size) || !words.number(grid.sizes)) return false;
  grid.gradient = std::string(words.next());
  if (!words.number(grid.half_width)) return false;
  for (int axis = 0; axis < 3; ++axis)
    if (!words.number(grid.bounds.lower[axis])) return false;
  for (int axis = 0; axis < 3; ++axis)
    if (!words.number(grid.bounds.upper[axis])) return false;
  return grid.sizes >= 1 && grid.sizes <= kMostSizes && grid.size >= 0 && grid.size < grid.sizes && grid.bounds.finite() &&
         std::isfinite(grid.half_width) && grid.half_width > 0.0;
}

bool read_bricks(Words& words, LocalGrid& grid) {
  size_t count = 0;
  // Each takes six characters at least, so that no file makes room for more than it has.
  if (!words.number(count) || count == 0 || count > words.rest().size() / 5 + 1) return false;
  grid.bricks.resize(count);
  for (glm::ivec3& place : grid.bricks)
    for (int axis = 0; axis < 3; ++axis)
      if (!words.number(place[axis]) || std::abs(place[axis]) > kFarthestBrick) return false;
  const auto before = [](const glm::ivec3& a, const glm::ivec3& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); };
  for (size_t i = 1; i < count; ++i)
    if (!before(grid.bricks[i - 1], grid.bricks[i])) return false;
  return true;
}

}  // namespace

GridMetadata local_metadata(const LocalGrid& grid) {
  // Shortest digits that read back to the same bits. The object's name comes last: it may hold anything.
  std::string text = fmt::format("{} {} {} {} {} {} {} {} {} {} {} {}", kVersion, grid.size, grid.sizes, grid.gradient, grid.half_width,
                                 grid.bounds.lower.x, grid.bounds.lower.y, grid.bounds.lower.z, grid.bounds.upper.x, grid.bounds.upper.y,
                                 grid.bounds.upper.z, grid.bricks.size());
  for (const glm::ivec3& place : grid.bricks) text += fmt::format(" {} {} {}", place.x, place.y, place.z);
  return {kName, "string", with_length(text + " " + grid.object)};
}

std::optional<LocalGrid> local_grid_of(const LevelSet& level_set, const std::string& file) {
  const std::vector<GridMetadata>& entries = level_set.data().file.metadata;
  const auto entry = std::find_if(entries.begin(), entries.end(), [](const GridMetadata& e) { return e.name == kName; });
  if (entry == entries.end()) return {};
  LocalGrid grid;
  Words words(std::string_view(entry->bytes).substr(std::min(sizeof(std::uint32_t), entry->bytes.size())));
  if (entry->type != "string" || !read_head(words, grid) || !read_bricks(words, grid))
    throw InputError({file, "grid", level_set.info().name, std::string("its metadata '") + kName + "' are not those of a local level set",
                      "a file as limn exported it, or the grid without that entry"});
  grid.object = std::string(words.rest());
  return grid;
}

const LocalVolume* local_volume(const LevelSet& level_set) { return level_set.data().local.get(); }

std::vector<LevelSet> grids_of(const LevelSet& level_set) {
  std::vector<LevelSet> grids{level_set};
  if (const LocalVolume* const local = local_volume(level_set)) grids.insert(grids.end(), local->larger.begin(), local->larger.end());
  return grids;
}

namespace {

struct Found {
  ReadGrid grid;
  LocalGrid said;
};

/// Of one object: all sizes are there, and are of the same.
void check(const std::vector<Found>& found, const std::string& file) {
  const LocalGrid& first = found.front().said;
  for (size_t k = 0; k < found.size(); ++k) {
    const LocalGrid& said = found[k].said;
    const std::string& name = found[k].grid.name;
    const char* const expected = "a file as limn exported it; grids = NAME draws one by itself";
    if (said.size != static_cast<int>(k) || said.sizes != static_cast<int>(found.size()))
      throw InputError(
          {file, "grid", name,
           fmt::format("it is voxel size {} of {} of a local level set, of which {} can be read", said.size + 1, said.sizes, found.size()),
           expected});
    if (said.gradient != first.gradient || said.bounds.lower != first.bounds.lower || said.bounds.upper != first.bounds.upper)
      throw InputError({file, "grid", name, "it and '" + found.front().grid.name + "' are not of the same local level set", expected});
  }
}

}  // namespace

std::vector<ReadGrid> join_local_grids(std::vector<ReadGrid> grids, const std::string& file) {
  std::vector<std::vector<Found>> objects;
  std::vector<ReadGrid> result;
  for (ReadGrid& grid : grids) {
    std::optional<LocalGrid> said = local_grid_of(LevelSet(grid.data), file);
    if (!said) {
      result.push_back(std::move(grid));
      continue;
    }
    // Two objects may have one name: each begins with its smallest voxels.
    const bool follows = !objects.empty() && objects.back().front().said.object == said->object && said->size != 0;
    if (!follows) objects.emplace_back();
    objects.back().push_back({std::move(grid), std::move(*said)});
  }
  for (std::vector<Found>& found : objects) {
    check(found, file);
    if (found.size() == 1) {
      result.push_back(std::move(found.front().grid));
      continue;
    }
    auto local = std::make_shared<LocalVolume>();
    for (Found& of : found) {
      if (&of != &found.front()) local->larger.emplace_back(of.grid.data);
      local->said.push_back(std::move(of.said));
    }
    ReadGrid& smallest = found.front().grid;
    smallest.data->local = local;
    result.push_back({local->said.front().object, std::move(smallest.data)});
  }
  return result;
}

}  // namespace limn
