#include "subdiv/import.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <memory>
#include <system_error>

#include "sdf/error.h"
#include "subdiv/mesh_bytes.h"
#include "subdiv/read_obj.h"
#include "subdiv/read_off.h"
#include "subdiv/read_ply.h"
#include "subdiv/read_stl.h"

namespace limn {
namespace {

constexpr std::array kExtensions = {".obj", ".ply", ".stl", ".off", ".gltf", ".glb"};
constexpr const char* kExpected = "a mesh: .obj, .ply, .stl, .off, .gltf or .glb";

std::string extension_of(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return extension;
}

/// All of a file, read once into memory that nobody cleared before.
struct FileBytes {
  std::unique_ptr<char[]> data{};
  size_t size = 0;
  std::string_view view() const { return {data.get(), size}; }
};

FileBytes read_bytes(const std::filesystem::path& file, std::int64_t max_bytes) {
  std::error_code error;
  const auto size = static_cast<std::int64_t>(std::filesystem::file_size(file, error));
  if (error || size > max_bytes)
    throw InputError({file.string(), "", error ? error.message() : fmt::format("{} bytes", size), "the file cannot be read into memory",
                      fmt::format("at most {} bytes", max_bytes)});
  FileBytes bytes{std::make_unique_for_overwrite<char[]>(static_cast<size_t>(size)), static_cast<size_t>(size)};
  std::ifstream stream(file, std::ios::binary);
  stream.read(bytes.data.get(), size);
  if (!stream) throw InputError({file.string(), "", "", "the file cannot be read", kExpected});
  return bytes;
}

using Parser = Mesh (*)(std::string_view bytes, const std::string& file, std::int64_t max_elements);

/// The readers of our own; empty where a helper program reads.
Parser parser_of(const std::string& extension) {
  if (extension == ".obj") return parse_obj;
  if (extension == ".ply") return parse_ply;
  if (extension == ".stl") return parse_stl;
  if (extension == ".off") return parse_off;
  return nullptr;
}

/// In proportion to the file: what takes longer is no honest mesh of that size. A .gltf's data lie in files beside it.
GuardLimits limits_for(const std::filesystem::path& file, const GuardLimits& most) {
  constexpr std::int64_t kBytesPerSecond = 500'000;
  GuardLimits limits = most;
  const auto bytes = static_cast<std::int64_t>(std::filesystem::file_size(file));
  if (extension_of(file) != ".gltf")
    limits.time = std::min<std::chrono::milliseconds>(most.time, std::chrono::seconds(20 + bytes / kBytesPerSecond));
  return limits;
}

Mesh read_in_helper(const std::filesystem::path& file, const ImportSettings& settings) {
  const std::string arguments[] = {file.string(), std::to_string(settings.max_elements)};
  const MappedBytes answer = run_guarded("limn-read-mesh", arguments, file, limits_for(file, settings.limits));
  ByteReader reader(answer, file.string());
  return get_mesh(reader);
}

}  // namespace

bool is_mesh_file(const std::filesystem::path& file) {
  return std::find(kExtensions.begin(), kExtensions.end(), extension_of(file)) != kExtensions.end();
}

Mesh load_mesh(const std::filesystem::path& file, const ImportSettings& settings) {
  check_readable(file, kExpected);
  if (!is_mesh_file(file))
    throw InputError({file.string(), "", file.extension().string(), "the extension is not that of a mesh", kExpected});
  const Parser parse = parser_of(extension_of(file));
  Mesh mesh = parse ? parse(read_bytes(file, settings.limits.memory_bytes).view(), file.string(), settings.max_elements)
                    : read_in_helper(file, settings);
  const auto elements = static_cast<std::int64_t>(mesh.vertex_count() + mesh.corner_vertices.size());
  if (elements > settings.max_elements)
    throw InputError({file.string(), "", fmt::format("{}", elements), "more vertices and corners than allowed",
                      fmt::format("at most {}", settings.max_elements)});
  validate(mesh, file.string());
  return mesh;
}

}  // namespace limn
