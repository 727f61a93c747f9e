#include "subdiv/gltf/document.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

namespace limn::gltf {
namespace {

constexpr std::uint32_t kMagic = 0x46546C67, kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;
constexpr const char* kWhole = "the whole file, as it was written";

std::uint32_t word(std::span<const std::byte> bytes, size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

Container open_version_1(std::span<const std::byte> file) {
  Container container;
  container.version = 1;
  const size_t json = word(file, 12);
  if (json > file.size() - 20) refuse("", "the file is cut short", kWhole);
  container.json = file.subspan(20, json);
  return container;
}

/// Of what is required, what does not change where the surface is or what colour it has without textures.
constexpr std::array kHarmlessPrefixes = {"KHR_materials_", "KHR_texture_", "EXT_texture_",  "MSFT_texture_",        "KHR_lights_",
                                          "EXT_lights_",    "KHR_xmp",      "KHR_technique", "KHR_animation_pointer"};
constexpr std::array kRead = {"KHR_mesh_quantization", "EXT_mesh_gpu_instancing", "KHR_node_visibility"};

std::string advice(const std::string& extension) {
  if (extension == "KHR_draco_mesh_compression") return "a file that is not compressed with Draco (exporters have a switch for it)";
  if (extension == "EXT_meshopt_compression" || extension == "KHR_meshopt_compression")
    return "a file that is not compressed with meshopt (gltfpack without -c, gltf-transform without meshopt)";
  return "a file that does without it";
}

std::string problem(const std::string& extension) {
  if (extension == "KHR_draco_mesh_compression") return "the meshes are compressed with Draco, which is not read";
  if (extension == "EXT_meshopt_compression" || extension == "KHR_meshopt_compression")
    return "the data are compressed with meshopt, which is not read";
  return "the file requires an extension that is not read";
}

void check_required(const Json& root, std::vector<std::string>& warnings) {
  const Json* required = find(root, "extensionsRequired");
  if (!required) return;
  if (!required->is_array()) {
    warnings.emplace_back("extensionsRequired is no list and was ignored");
    return;
  }
  for (const Json& item : *required) {
    if (!item.is_string()) continue;
    const std::string name = item.get<std::string>();
    const bool read = std::find(kRead.begin(), kRead.end(), name) != kRead.end();
    const bool harmless =
        std::any_of(kHarmlessPrefixes.begin(), kHarmlessPrefixes.end(), [&](const char* prefix) { return name.starts_with(prefix); });
    if (!read && !harmless) refuse("extensionsRequired", problem(name), advice(name), name);
  }
}

}  // namespace

Container open_container(std::span<const std::byte> file) {
  if (file.size() < 4 || word(file, 0) != kMagic) return {file, {}, false, 0};
  if (file.size() < 20) refuse("", "the file is cut short", kWhole);
  const std::uint32_t version = word(file, 4), length = word(file, 8);
  if (version == 1) return open_version_1(file);
  if (version != 2) refuse("header", "a GLB container of an unknown version", "version 2", fmt::format("{}", version));
  if (length > file.size()) refuse("", fmt::format("the file is cut short: {} bytes of {}", file.size(), length), kWhole);
  Container container;
  container.version = version;
  for (size_t at = 12; at + 8 <= length;) {
    const size_t size = word(file, at);
    const std::uint32_t kind = word(file, at + 4);
    if (size > length - at - 8) refuse("", fmt::format("a part of the file is cut short: {} bytes of {}", length - at - 8, size), kWhole);
    const std::span<const std::byte> chunk = file.subspan(at + 8, size);
    if (at == 12 && kind != kJsonChunk) refuse("", "the file's first part is not JSON", kWhole);
    if (kind == kJsonChunk && container.json.empty()) container.json = chunk;
    if (kind == kBinaryChunk && !container.has_binary) container.binary = chunk, container.has_binary = true;
    at += 8 + size;
  }
  if (container.json.empty()) refuse("", "the file holds no JSON", kWhole);
  return container;
}

Json parse_json(std::span<const std::byte> json) {
  const char* first = reinterpret_cast<const char*>(json.data());
  // Parts of a GLB are padded, some exporters use zeros.
  size_t size = json.size();
  while (size > 0 && first[size - 1] == '\0') --size;
  try {
    Json root = Json::parse(first, first + size);
    if (!root.is_object()) refuse("", "damaged or no glTF file: its JSON is no object", "a .gltf or .glb file");
    return root;
  } catch (const Json::parse_error& error) {
    const size_t byte = std::min<size_t>(error.byte, size);
    const auto line = std::count(first, first + byte, '\n') + 1;
    refuse(fmt::format("{}", line), fmt::format("damaged or no glTF file: its JSON breaks off or is wrong at byte {}", error.byte),
           "a .gltf or .glb file");
  } catch (const Json::exception&) {
    refuse("", "damaged or no glTF file: its JSON holds a number out of range", "a .gltf or .glb file");
  }
}

bool is_version_1(const Container& container, const Json& root) {
  if (container.version == 1) return true;
  const Json* asset = find_object(root, "asset");
  const std::string version = asset ? text(*asset, "version") : std::string();
  if (version.starts_with("1.")) return true;
  // Objects by name rather than lists: only glTF 1.0 has those.
  return version.empty() && find_object(root, "meshes") != nullptr;
}

void check_version_and_extensions(const Json& root, std::vector<std::string>& warnings) {
  const Json* asset = find_object(root, "asset");
  const std::string version = asset ? text(*asset, "version") : std::string(), least = asset ? text(*asset, "minVersion") : std::string();
  if (version.empty()) warnings.emplace_back("the file does not say its version (asset.version): read as glTF 2.0");
  if (!version.empty() && !version.starts_with("2")) refuse("asset.version", "an unknown version of glTF", "2.0 or 1.0", version);
  if (!least.empty() && least != "2.0") refuse("asset.minVersion", "an unknown version of glTF", "2.0", least);
  check_required(root, warnings);
}

}  // namespace limn::gltf
