// A case file into a case, and a case with values for its parameters into a scene.

#include "samples/stability/case.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "samples/input/scene_file.h"
#include "samples/stability/case_tables.h"
#include "sdf/error.h"

namespace limn {
namespace {

constexpr std::array kOwnTables = {"case", "with", "set", "random", "mesh", "volume", "reference", "variant", "expect"};

bool is_own(const std::string& line) {
  const size_t first = line.find_first_not_of("[ \t"), last = line.find_first_of("]. \t", first);
  if (first == std::string::npos || last == std::string::npos) return false;
  const std::string name = line.substr(first, last - first);
  return std::find(kOwnTables.begin(), kOwnTables.end(), name) != kOwnTables.end();
}

/// The lines of the scene alone, the others empty: so messages keep their line numbers. `reference`: its tables as [[object]], and no
/// others.
std::string scene_lines(const std::string& text, bool reference) {
  std::istringstream stream(text);
  std::string out, line;
  bool keep = true, quoted = false;
  while (std::getline(stream, line)) {
    if (!quoted && line.starts_with('[')) {
      const bool of_reference = line.starts_with("[[reference]]");
      if (reference) {
        keep = of_reference;
        if (of_reference) line = "[[object]]";
      } else {
        keep = !is_own(line);
      }
    }
    for (size_t at = line.find("'''"); at != std::string::npos; at = line.find("'''", at + 3)) quoted = !quoted;
    out += (keep ? line : "") + "\n";
  }
  return out;
}

std::string number_text(double value) {
  return value == std::floor(value) && std::abs(value) < 1e15 ? fmt::format("{:.0f}", value) : fmt::format("{}", value);
}

std::string with_values(std::string text, const std::map<std::string, double>& values) {
  for (const auto& [name, value] : values) {
    const std::string token = "\"$" + name + "\"";
    for (size_t at = text.find(token); at != std::string::npos; at = text.find(token, at))
      text.replace(at, token.size(), number_text(value));
  }
  return text;
}

/// Fields as level sets, as if read from a file.
void sample_fields(const VolumeSettings& volume, Scene& scene) {
  for (SceneObject& object : scene.objects) {
    const auto* field = std::get_if<Field>(&object.source);
    if (field == nullptr) continue;
    LevelSetSettings settings;
    settings.voxel_size = bounds(object).longest_side() / volume.voxels;
    settings.half_width_voxels = volume.half_width_voxels;
    object.source = LevelSetSource{level_set_from_field(*field, settings), object.name + ".vdb"};
  }
}

}  // namespace

StabilityScene scene_of_case(const StabilityCase& one, const std::map<std::string, double>& values) {
  const std::string text = with_values(one.source, values);
  const CaseSources sources = read_sources(text, one.file);
  StabilityScene made;
  SceneReaders readers;
  readers.mesh = [&](const std::filesystem::path& file) {
    const auto found = sources.meshes.find(file.filename().string());
    return found == sources.meshes.end() ? load_mesh(file) : found->second;
  };
  made.input = parse_scene_file(scene_lines(text, false), one.file, readers);
  made.input.scene.name = one.text.name;
  if (sources.volume) sample_fields(*sources.volume, made.input.scene);
  if (text.find("[[reference]]") != std::string::npos) {
    made.reference = parse_scene_file(scene_lines(text, true), one.file, readers).scene;
  }
  return made;
}

// SplitMix64 (Steele et al. 2014): the standard's distributions are left to each library.
StabilityRandom::StabilityRandom(const std::string& name, std::uint64_t seed, int draw) : state_(seed) {
  for (const char c : name) {
    state_ = (state_ ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
    next();
  }
  state_ += static_cast<std::uint64_t>(draw);
  next();
}

double StabilityRandom::next() {
  state_ += 0x9e3779b97f4a7c15ULL;
  std::uint64_t z = state_;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  z ^= z >> 31;
  return static_cast<double>(z >> 11) * 0x1p-53;
}

std::map<std::string, double> drawn_parameters(const StabilityCase& one, std::uint64_t seed, int draw) {
  StabilityRandom random(one.text.name + " parameters", seed, draw);
  std::map<std::string, double> values = one.set;
  for (const auto& [name, range] : one.random) {
    const double share = random.next();
    values[name] = range.whole ? std::min(range.high, range.low + std::floor(share * (range.high - range.low + 1.0)))
                               : range.low + share * (range.high - range.low);
  }
  return values;
}

}  // namespace limn
